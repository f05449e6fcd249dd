"""Arguments of the package that are empty, given twice, not finite, reversed or of another type give sentences."""

import math

import numpy as np
import pytest

import fmi3
import fmu
from fmu import build_systems
from motions import lagrange_fmu  # noqa: F401

SWITCHED = """<system name="SwitchedSpring"><parameter name="k" start="50" unit="N/m" min="0"/><parameter name="n" type="Integer" start="1"/>
  <parameter name="on" type="Boolean" start="true"/><input name="u" unit="N"/><coordinate name="x" velocity="v" unit="m" start="0.3"/>
  <particle mass="2" x="x"/><potential>k*x^2/2</potential><force coordinate="x">on*n*u</force><output name="y" unit="m">x</output>
  <experiment stopTime="1" stepSize="0.1"/></system>"""
# The root ends at x = 1 m.
ENDS = """<system name="RootThatEnds"><coordinate name="x" velocity="v" unit="m" velocityStart="1"/><parameter name="L" start="1" unit="m"/>
  <particle mass="1" x="x"/><force coordinate="x">0.1*sqrt(1 - x/L)</force><experiment stopTime="2" stepSize="0.25"/></system>"""
DATA = {"time": np.linspace(0, 1, 11), "x": 0.3 * np.cos(5 * np.linspace(0, 1, 11))}


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("arguments", {"SwitchedSpring": SWITCHED, "RootThatEnds": ENDS}, versions=(2, 3))


@pytest.mark.parametrize(
    "function, values, words, message",
    [
        ("fit", [[], ["k"]], {}, "data is empty; expected the measurements of one experiment at least"),
        ("fit", [DATA, []], {}, "nothing varies"),
        ("fit", [DATA, ["k", "k"]], {}, "'k' is given twice in vary"),
        ("fit", [DATA, ["n"]], {}, "'n' is an Integer, which has no derivatives; expected some of k, u, v, x"),
        ("fit", [DATA, ["k"]], {"each": ["on"]}, "'on' is a Boolean, which has no derivatives"),
        ("fit", [DATA, ["k"]], {"bounds": {"k": (60, 40)}}, "the bounds of 'k' are 60 and 40; expected two numbers, the smaller one first"),
        ("fit", [DATA, ["k"]], {"bounds": {"k": (math.nan, 60)}}, "the bounds of 'k' are nan and 60"),
        ("fit", [DATA, ["k"]], {"bounds": {"k": {40: 60, 1: 2}}}, r"bounds has .* for 'k'; expected a pair \(LOW, HIGH\)"),
        ("simulate", [], {"output": ["x", "x"]}, "'x' is given twice in output; expected each name once"),
        ("simulate", [], {"stop_time": math.nan}, "stop_time is nan; expected a finite number of seconds"),
        ("simulate", [], {"stop_time": math.inf}, "stop_time is inf; expected a finite number of seconds"),
        ("simulate", [], {"step": math.nan}, "step is nan"),
        ("simulate", [], {"start_time": "nan"}, "start_time: 'nan' is not finite"),
        ("simulate", [], {"tolerance": 0}, "the tolerance is 0; expected one between 0 and 1"),
        ("simulate", [{"n": 1.5}], {}, "'n' is set to 1.5; expected a whole number"),
        ("simulate", [{"on": 2}], {}, "'on' is set to 2; expected True or False"),
        ("start", [], {"tolerance": math.nan}, "the tolerance is nan"),
        ("equilibrium", [], {"vary": ["u", "u"], "hold": {"y": 0.1}}, "'u' is given twice in vary"),
        ("equilibrium", [], {"vary": ["n"]}, "'n' is no input or parameter of SwitchedSpring, as it is an Integer"),
        ("linearize", [{"k": 3}, {"k": 4}], {}, "'k' is in at and in parameters; expected it once"),
        ("linearize", [{"on": 0}], {}, "'on' of SwitchedSpring cannot be set, as it is a Boolean"),
        ("sensitivities", [[], ["k"], [0, 1]], {}, "of is empty; expected one name at least"),
        ("sensitivities", [["x"], [], [0, 1]], {}, "by is empty"),
        ("sensitivities", [["x"], ["k"], []], {}, "times is empty; expected one time at least, in s"),
        ("sensitivities", [["x", "x"], ["k"], [0, 1]], {}, "'x' is given twice in of"),
        ("gradient", ["x", [], 1], {}, "by is empty"),
        ("gradient", ["x", ["k"], math.nan], {}, "stop_time is nan"),
        ("sweep", [{"n": (1, 2, 3)}], {}, "'n' is an Integer, and 1.5 is none; expected whole numbers, such as n=1:5:5"),
        ("sweep", [{"k": [1, 2]}], {"stop_time": math.nan}, "stop_time is nan"),
        ("sweep", [{"k": [1, 2]}], {"tolerance": 0}, "the tolerance is 0"),
    ],
)
def test_sentences(lagrange_fmu, function, values, words, message, tmp_path):  # noqa: F811
    if function == "sweep":
        words = words | {"output": tmp_path / "runs.parquet"}
    with pytest.raises(lagrange_fmu.Problem, match=message):
        getattr(lagrange_fmu, function)(fmu.archive("SwitchedSpring"), *values, **words)


@pytest.mark.parametrize("archive", [fmu.archive, fmi3.archive])
def test_a_reset_that_fails(lagrange_fmu, archive):  # noqa: F811
    """What is read after it names the cause; a state can be restored, and another reset starts."""
    with lagrange_fmu.start(archive("SwitchedSpring"), x=0.2) as sim:
        saved = sim.save()
        with pytest.raises(lagrange_fmu.Problem, match="cannot start: .*-3 for 'k' is below its minimum, 0"):
            sim.reset(k=-3)
        for use in (lambda: sim["x"], lambda: sim.step(0.1), sim.save):
            with pytest.raises(lagrange_fmu.Problem, match=r"SwitchedSpring has not started, since .*-3 for 'k' is below its minimum, 0; expected reset\(\)"):
                use()
        sim.reset(x=0.4)
        assert sim["x"] == 0.4
        with pytest.raises(lagrange_fmu.Problem, match="below its minimum"):
            sim.reset(k=-3)
        sim.restore(saved)
        assert sim["x"] == 0.2


@pytest.mark.parametrize("archive", [fmu.archive, fmi3.archive])
def test_model_exchange_that_stops_has_the_message_of_the_fmu(lagrange_fmu, archive, capfd):  # noqa: F811
    with pytest.raises(lagrange_fmu.Problem, match="RootThatEnds.fmu: .*accelerations are not finite"):
        lagrange_fmu.simulate(archive("RootThatEnds"), fmi_type="ModelExchange")
    assert "Traceback" not in capfd.readouterr().err
