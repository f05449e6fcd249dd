"""
FMUs as WebAssembly components (the draft FMI-LS-WASM), run by wasmtime through the functions of the draft, against the native FMUs through
FMI 3.0.
"""

import functools
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from lxml import etree
from wasmtime import Engine, Store, component

import fmu
from building import bring_up_to_date
from fmu import BUILD, ROOT

pytestmark = pytest.mark.release

FOLDER = BUILD / "wasm"
# taylor, with impacts, auto with a closed loop, and one without states.
SYSTEMS = ["DoublePendulum", "BouncingBall", "FourBar", "StateFeedback"]
ENGINE = Engine()


@functools.cache
def archives():
    """Build the FMUs of FMI 3.0 for this machine and for WebAssembly, in one archive each; return their folder."""
    bring_up_to_date(ROOT / "build")
    FOLDER.mkdir(parents=True, exist_ok=True)
    systems = ";".join(str(ROOT / "fmu" / name) for name in SYSTEMS)
    words = [f"-DSYSTEMS={systems}", "-DPLATFORMS=linux64;wasm32", "-DFMI_VERSIONS=3", f"-DTOOLS={ROOT / 'build'}", f"-DLAGRANGE_PYTHON={sys.executable}"]
    subprocess.run([ROOT / "scripts" / "build", FOLDER, *words], check=True)
    return FOLDER / "fmi3"


@functools.cache
def component_of(name):
    with zipfile.ZipFile(archives() / f"{name}.fmu") as archive:
        return component.Component(ENGINE, archive.read(f"binaries/wasm32-wasip2/{name}.wasm"))


@functools.cache
def description_of(name):
    return fmpy.read_model_description(archives() / f"{name}.fmu")


def references(name, *variables):
    by_name = {variable.name: variable.valueReference for variable in description_of(name).modelVariables}
    return [by_name[variable] for variable in variables]


def states_of(name):
    return [derivative.variable.derivative.name for derivative in description_of(name).derivatives]


class Instance:
    """An instance in a component, with the draft's methods, whose names have _ in place of -. messages: its log."""

    def __init__(self, name, kind="co-simulation", token=None, memory=-1):
        self.kind, self.messages, self.store = kind, [], Store(ENGINE)
        self.store.set_limits(memory_size=memory)
        linker = component.Linker(ENGINE)
        with linker.root() as root, root.add_instance("fmi:fmi3/callbacks@3.0.0") as callbacks:
            callbacks.add_func("log-message", lambda store, *words: self.messages.append(words))
        self.component = linker.instantiate(self.store, component_of(name))
        self.interface = self.component.get_export_index(self.store, f"fmi:fmi3/{kind}@3.0.0")
        flags = [False, False, []] if kind == "co-simulation" else []
        instantiate = self.function(f"[static]{kind}-instance.instantiate-{kind}")
        self.handle = instantiate(self.store, f"my {name}", description_of(name).instantiationToken if token is None else token, False, True, *flags)

    def function(self, name):
        return self.component.get_func(self.store, self.component.get_export_index(self.store, name, self.interface))

    def __getattr__(self, name):
        function = self.function(f"[method]{self.kind}-instance.{name.replace('_', '-')}")
        return lambda *words: function(self.store, self.handle, *words)

    def started(self, start=None):
        for reference, value in (start or {}).items():
            assert self.set_float64([reference], [value]) == "ok"
        assert self.enter_initialization_mode(1e-8, 0.0, None) == "ok"
        assert self.exit_initialization_mode() == "ok"
        return self


def native(name, kind="co-simulation"):
    folder = fmpy.extract(archives() / f"{name}.fmu", FOLDER / "native" / name)
    make = fmpy.fmi3.FMU3Slave if kind == "co-simulation" else fmpy.fmi3.FMU3Model
    description = description_of(name)
    instance = make(guid=description.guid, unzipDirectory=folder, modelIdentifier=name, instanceName=name)
    instance.instantiate()
    instance.enterInitializationMode(tolerance=1e-8)
    instance.exitInitializationMode()
    return instance


@pytest.mark.parametrize("name", ["DoublePendulum", "BouncingBall", "FourBar"])
def test_steps(name):
    """The states are those of the native FMU at every step."""
    ours, theirs = Instance(name).started(), native(name)
    of_states = references(name, *states_of(name))
    for k in range(50):
        result = ours.do_step(0.05 * k, 0.05, True)
        theirs.doStep(currentCommunicationPoint=0.05 * k, communicationStepSize=0.05)
        assert result.__dict__["last-successful-time"] == 0.05 * k + 0.05
        assert np.allclose(ours.get_float64(of_states), theirs.getFloat64(of_states), rtol=1e-12, atol=1e-12), k
    theirs.terminate()
    assert ours.terminate() == "ok"
    theirs.freeInstance()


def test_saved_states():
    """A step repeated from saved bytes, also in another instance, gives the same bits."""
    name = "BouncingBall"
    of_states = references(name, *states_of(name))
    first, second = Instance(name).started(), Instance(name).started()
    first.do_step(0.0, 0.3, False)
    saved = first.get_fmu_state()
    first.do_step(0.3, 1.0, False)
    ends = first.get_float64(of_states)
    for instance in (first, second):
        assert instance.set_fmu_state(saved) == "ok"
        instance.do_step(0.3, 1.0, False)
        assert instance.get_float64(of_states) == ends
    assert first.set_fmu_state(saved[:-1]) == "error"


def test_model_exchange():
    """Rates, indicators, nominal values and Jacobians are those of the native FMU."""
    name = "BouncingBall"
    ours, theirs = Instance(name, "model-exchange").started(), native(name, "model-exchange")
    info = ours.update_discrete_states()
    assert not info.__dict__["new-discrete-states-needed"] and not info.__dict__["terminate-simulation"]
    theirs.updateDiscreteStates()
    count = ours.get_number_of_continuous_states()
    assert count == description_of(name).numberOfContinuousStates
    assert ours.get_number_of_event_indicators() == description_of(name).numberOfEventIndicators
    assert ours.enter_continuous_time_mode() == "ok"
    theirs.enterContinuousTimeMode()
    state = np.linspace(0.3, 0.7, count)
    assert ours.set_time(0.5) == "ok" and ours.set_continuous_states(list(state)) == "ok"
    theirs.setTime(0.5)
    theirs.setContinuousStates((fmpy.fmi3.fmi3Float64 * count)(*state), count)
    rates = (fmpy.fmi3.fmi3Float64 * count)()
    theirs.getContinuousStateDerivatives(rates, count)
    assert ours.get_continuous_states() == list(state)
    assert ours.get_continuous_state_derivatives() == list(rates)
    assert all(nominal > 0 for nominal in ours.get_nominals_of_continuous_states())
    result = ours.completed_integrator_step(True).__dict__
    assert result == {"enter-event-mode": False, "terminate-simulation": False}
    theirs.freeInstance()


def test_derivatives():
    name = "DoublePendulum"
    ours, theirs = Instance(name).started(), native(name)
    knowns, unknowns = references(name, *states_of(name)), [derivative.variable.valueReference for derivative in description_of(name).derivatives]
    seed = list(np.linspace(1, 2, len(knowns)))
    assert ours.get_directional_derivative(unknowns, knowns, seed) == list(theirs.getDirectionalDerivative(unknowns, knowns, seed))
    assert ours.get_adjoint_derivative(unknowns, knowns, seed) == list(theirs.getAdjointDerivative(unknowns, knowns, seed))
    theirs.freeInstance()


def test_messages():
    """Errors are logged through the host's function, and returned as a status."""
    name = "DoublePendulum"
    wrong = Instance(name, token="{no}")
    assert wrong.handle is None and "expected '{" in wrong.messages[-1][3]
    instance = Instance(name)
    assert instance.do_step(0.0, 0.1, True) == "error"
    assert instance.messages[-1][:2] == (f"my {name}", "error") and "fmi3DoStep" in instance.messages[-1][3]
    for call in ("get_clock", "get_string", "get_binary", "get_shift_decimal"):
        instance = Instance(name).started()
        assert getattr(instance, call)([]) == []
        assert getattr(instance, call)([1]) == "error", call
    assert Instance(name).started().set_string([1], ["text"]) == "error"
    assert Instance(name).started().set_input_derivatives([(1, 1)], [0.0]) == "error"
    assert Instance(name).started().set_float64([1, 2], [0.0]) == "error"


def test_memory():
    """Lists passed in and out leak no memory: 800 MB of them pass through 16 MB."""
    name = "DoublePendulum"
    instance = Instance(name, memory=16 << 20).started()
    of_states = references(name, *states_of(name)) * 250
    for _ in range(50_000 // 50):
        values = instance.get_float64(of_states)
        assert len(values) == len(of_states)
        assert instance.set_debug_logging(True, ["logEvents"] * 100) == "ok"
        assert instance.set_fmu_state(instance.get_fmu_state()) == "ok"


def test_archive():
    """The manifest is valid by FMI's schema and the draft; the component imports only the function for messages."""
    with zipfile.ZipFile(archives() / "DoublePendulum.fmu") as archive:
        manifest, as_in_fmi = (etree.fromstring(archive.read(f"extra/org.modelica.fmi-ls-wasm/{file}.xml")) for file in ("manifest", "fmi-ls-manifest"))
    schema = Path(fmpy.__path__[0]) / "schema" / "fmi3" / "fmi3LayeredStandardManifest.xsd"
    etree.XMLSchema(etree.parse(schema)).assertValid(manifest)
    assert etree.tostring(manifest) == etree.tostring(as_in_fmi)
    assert manifest.get("{http://fmi-standard.org/fmi-ls-manifest}fmi-ls-name") == "org.modelica.fmi-ls-wasm"
    types = component_of("DoublePendulum").type
    assert set(types.imports(ENGINE)) == {"fmi:fmi3/types@3.0.0", "fmi:fmi3/callbacks@3.0.0"}
    assert set(types.exports(ENGINE)) == {f"fmi:fmi3/{name}@3.0.0" for name in ("common", "co-simulation", "model-exchange")}
    assert not fmpy.validation.validate_fmu(archives() / "DoublePendulum.fmu")


@pytest.mark.parametrize("solver, words", [("bdf", "expected another <solver> than erk and bdf"), (None, "FMI 2.0 knows no platform wasm32; expected FMI 3")])
def test_errors(tmp_path, solver, words):
    fmu.lagc(ROOT / "fmu" / "DoublePendulum" / "system.xml", "-o", tmp_path, *(["--solver", solver] if solver else []))
    command = [sys.executable, ROOT / "scripts" / "package" / "cross.py", "fmu", "wasm32", tmp_path / "system.c", tmp_path / "binaries", "DoublePendulum"]
    result = subprocess.run([*command, "--fmi", "3" if solver else "2"], capture_output=True, text=True)
    assert result.returncode != 0 and words in result.stderr
