"""Contacts that open at edges; events that depend on contacts, frictions and forces; and values right after an input is set."""

import re
from ctypes import c_double

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model
from fmpy.fmi3 import FMU3Model

import fmu
from fmu import DISCARD, build_systems, lagc
from test_switching import value

COUNTERS = ["rises", "falls", "passes", "over"]
COUNTING = '<event when="{0}" direction="{1}"><set mode="{2}">{2} + 1</set></event>'
YARD = """<system name="{name}">
  <input name="u"/>
  <!-- A ball that rolls over the edge of a table, one that flies over a ridge, and one that slides into a valley. -->
  <coordinate name="x" velocity="vx" velocityStart="1"/><coordinate name="y" velocity="vy"/>
  <particle mass="1" x="x" y="y"/><contact name="table" gap="if(x &lt; 1, y, y + 0.8)"/>
  <coordinate name="rx" velocity="rvx" velocityStart="3"/><coordinate name="ry" velocity="rvy" velocityStart="1.5"/>
  <particle mass="1" x="rx" y="ry"/><contact name="roof" gap="ry - 0.5*(1 - abs(rx - 1))"/>
  <coordinate name="sx" velocity="svx" velocityStart="2"/><coordinate name="sy" velocity="svy" start="0.5" velocityStart="-1"/>
  <particle mass="1" x="sx" y="sy"/><contact name="valley" gap="sy - 0.5*abs(sx - 1)"/>
  <!-- A ball that bounces, whose impacts, landings and first weight on the ground are noted. -->
  <coordinate name="h" velocity="v" start="1"/><particle mass="1" y="h"/><contact name="ground" gap="h" restitution="0.5"/>
  <mode name="hits"/><mode name="lands"/><mode name="weight"/><mode name="starts"/>
  <event when="v" direction="rising"><set mode="hits">hits + 1</set></event>
  <event when="ground.closed"><set mode="lands">lands + 1</set></event>
  <event when="ground.force > 5"><set mode="weight">weight + ground.force</set></event>
  <event when="table.closed"><set mode="starts">starts + 1</set></event>
  <!-- A latch that opens at a force of 5. -->
  <coordinate name="l" velocity="lv"/><particle mass="1" z="l"/><force coordinate="l">10*time</force>
  <mode name="latched" start="1"/><mode name="broke"/><constraint name="latch">if(latched, l, 0)</constraint>
  <event when="latch.force - 2.5 - 5*time" direction="rising"><set mode="latched">0</set><set mode="broke">latch.force + time</set></event>
  <!-- A block on a spring that is drawn: what it slips at, and how often. -->
  <coordinate name="b" velocity="bv"/><particle mass="1" z="b"/><potential>10*(b - 0.5*time)^2/2</potential>
  <friction name="rub" coordinate="b" force="1" stiction="2"/>
  <mode name="slips"/><mode name="pulled"/>
  <event when="rub.sliding^2 > 0.5"><set mode="slips">slips + 1</set></event>
  <event when="rub.force - 1.5" direction="rising"><set mode="pulled">time</set></event>
  <output name="rubs">rub.force</output>
  <!-- Three frictions that hold one body, by forces that are not determined. -->
  <coordinate name="q" velocity="qv"/><particle mass="1" z="q"/><force coordinate="q">8</force>
  <friction name="f1" coordinate="q" force="1"/><friction name="f2" coordinate="q" force="10"/><friction name="f3" coordinate="q" force="3"/>
  <!-- What only touches: a parabola, a time; a time that passes by a point of inflection; an input. -->
  <coordinate name="p" velocity="pv" start="0.5" velocityStart="-1"/><particle mass="1" z="p"/><force coordinate="p">1</force>
  <mode name="touched"/><mode name="inflected"/><mode name="went_on"/><mode name="rises"/><mode name="falls"/><mode name="passes"/><mode name="over"/>
  <!-- What comes to 0 and rests there: a velocity that sticks, and pieces that end. -->
  <coordinate name="e" velocity="ev" velocityStart="2"/><particle mass="1" z="e"/><friction name="drag" coordinate="e" force="10"/>
  {counting}
  <event when="u > 0.5"><set mode="over">over + 1</set></event>
  <!-- What an input decides on. -->
  <coordinate name="c" velocity="cv"/><particle mass="1" z="c"/><force coordinate="c">if(u > 0.7, 6, 2)</force>
  <friction name="brake" coordinate="c" force="if(u > 0.9, 1, 4)"/><output name="pace">der(cv)</output>
  <coordinate name="d" velocity="dv"/><particle mass="1" y="d"/><force coordinate="d">20*u</force><contact name="floor" gap="d"/>
  <!-- A ball at rest that an event throws up. -->
  <coordinate name="k" velocity="kv"/><particle mass="1" y="k"/><contact name="racket" gap="k"/><event when="time &gt; 0.4"><set velocity="kv">2</set></event>
  <gravity y="-10"/>
  <solver method="{method}" tolerance="1e-10"/>
</system>"""
COUNTED = [
    ("p", "both", "touched"), ("(time - 1)^2", "both", "touched"), ("0.5 - p - (time - 1)^2 - 1", "both", "touched"), ("(time - 1)^3", "both", "inflected"),
    ("ev", "both", "touched"), ("max(0, time - 1.1) + max(0, 0.3 - time)", "both", "touched"),
    ("max(0, time - 1.1) - max(0, 0.3 - time)", "both", "went_on"),
    ("u - 0.5", "rising", "rises"), ("u - 0.5", "falling", "falls"), ("0.5 - u", "both", "passes"),
]  # fmt: skip
WORKED = """<system name="Worked">
  <coordinate name="h" velocity="v" start="1"/><coordinate name="x" velocity="u" velocityStart="3"/>
  <mode name="n"/><particle mass="1" x="x" y="h"/><gravity y="-9.81"/><dissipation>0.15*(u^2 + v^2)</dissipation>
  <contact name="ground" gap="h" restitution="1"/><stop coordinate="x" min="-0.2" max="0.5" restitution="1"/>
  <event when="v"><set mode="n">n + 1</set></event><work/>
</system>"""
MISTAKES = {
    "Ledge": '<coordinate name="x" velocity="v" velocityStart="1"/><coordinate name="y" velocity="w"/><particle mass="1" x="x" y="y"/><gravity y="-10"/>'
    '<contact name="floor" gap="if(x &lt; 0.5, y, y - 0.1)"/>',
    "Pushes": '<coordinate name="x" velocity="v" velocityStart="1"/><particle mass="1" x="x"/><friction name="rub" coordinate="x" force="0.1 - x"/>',
    "Bounces": '<coordinate name="h" velocity="v" start="1"/><particle mass="1" y="h"/><gravity y="-9.81"/><event when="h"><set velocity="v">-0.5*v</set></event>',
}  # fmt: skip
STEPPED = {
    "Ledge": (0.5, "the contact 'floor' is penetrated at an event that switches the gap: its gap is -0.1; expected conditions and modes"),
    "Pushes": (None, "the force of the friction 'rub' is -1.02089; expected 0 or more"),
    "Bounces": (3 * np.sqrt(2 / 9.81), r"events accumulate \(Zeno behaviour\), as bounces by an <event> do; a <contact> comes to rest$"),
}  # fmt: skip


@pytest.fixture(scope="module", autouse=True)
def built():
    counting = "".join(COUNTING.format(*words) for words in COUNTED)
    texts = {f"Yard_{method}": YARD.format(name=f"Yard_{method}", method=method, counting=counting) for method in ("taylor", "bdf")}
    texts |= {name: f'<system name="{name}">{text}</system>' for name, text in MISTAKES.items()}
    build_systems("by-contacts", texts | {"Worked": WORKED}, versions=[2, 3])


# --- Closed forms ---


def expected(t):
    """Values at 0.45, 0.6 or 1.2 s, by hand for g = 10."""
    fall = max(t - 1, 0)
    # Up to the ridge at 0.5 s with a velocity of 1 along x; in the air until 0.7 s; then down with the velocity component along the roof.
    flight, slide = t - 0.5, t - 0.7
    rx = 3 * t - 2 * t**2 if flight < 0 else 0.5 + t if slide < 0 else 1.2 + 1.4 * slide + 2 * slide**2
    ry = 0.5 + 0.5 * flight - 5 * flight**2 if flight > 0 > slide else 0.5 * (1 - abs(rx - 1))
    # Down into the valley, where 0.6 of the velocity is along the other side, and up.
    climb = t - (np.sqrt(12) - 2) / 4
    sx = 1 + 0.6 * np.sqrt(12) * climb - 2 * climb**2
    # The first three impacts are at t0, 2 t0 and 2.5 t0.
    hits = np.sum(t > np.sqrt(0.2) * np.array([1, 2, 2.5]))
    l = 10 * (t**3 - 0.125) / 6 - 1.25 * (t - 0.5) if t > 0.5 else 0
    return dict(x=t, y=-5 * fall**2, vy=-10 * fall, rx=rx, ry=ry, sx=sx, sy=0.5 * abs(sx - 1), hits=hits, lands=0, weight=0, starts=0, l=l,
                broke=5.5 if t > 0.5 else 0, slips=float(t > 0.4), pulled=0.3, q=0, touched=0, inflected=float(t > 1), went_on=float(t > 1.1), over=0,
                k=max(2 * (t - 0.4) - 5 * (t - 0.4) ** 2, 0) if t > 0.4 else 0)  # fmt: skip


def run(kind, names, end, opened):
    """Values at a time, reached by communication steps of 0.15 s."""
    if kind == "exchange":
        words = dict(fmi_type="ModelExchange", stop_time=end, output_interval=0.15, relative_tolerance=1e-9, output=names)
        result = fmpy.simulate_fmu(str(fmu.archive("Yard_taylor")), **words)
        return [result[name][-1] for name in names]
    instance = opened("Yard_taylor").initialize() if kind == "fmi3" else kind.initialize()
    while instance.time < end - 1e-9:
        instance.step(0.15)
    return list(instance.get(*names))


@pytest.mark.parametrize("end", [0.45, 0.6, 1.2])
@pytest.mark.parametrize("kind", ["taylor", "bdf", "fmi3", "exchange"])
def test_contacts_open_at_edges_and_events_see_contacts(open_fmu, opened, kind, end):
    right = expected(end)
    instance = open_fmu(f"Yard_{kind}") if kind in ("taylor", "bdf") else kind
    found = run(instance, list(right), end, opened)
    assert dict(zip(right, found)) == pytest.approx(right, abs=2e-5 if kind == "exchange" else 1e-6)
    if kind in ("taylor", "bdf"):
        assert [value(instance, f"f{i}.sliding") for i in (1, 2, 3)] == [0, 0, 0] and instance.get("qv") == 0
        assert sum(instance.get("f1.force", "f2.force", "f3.force")) == pytest.approx(8)
        assert instance.get("rubs") == instance.get("rub.force") == 1.0


def test_falling_bodies_land_below(open_fmu):
    instance = open_fmu("Yard_taylor").initialize()
    instance.step(1.5)
    assert instance.get("x", "y", "vy", "hits", "lands", "starts") == pytest.approx([1.5, -0.8, 0, instance.get("hits"), 1, 1], abs=1e-12)
    assert instance.get("weight") == pytest.approx(10) and value(instance, "table.closed") == 1


@pytest.mark.parametrize("state", [{"v": -1e-6}, {"v": 1e-6}, {"h": 1e-7, "v": -1e-5}, {"h": -1e-7}])
def test_integration_errors_of_a_closed_contact_are_no_impact(open_fmu, state):
    """A ball at rest, with restitution 0.8, stays at rest in event mode despite the error of an integrator."""
    instance = open_fmu("BouncingBall", kind=FMU2Model).initialize({"h": 0})
    instance.fmu.newDiscreteStates()
    instance.fmu.enterContinuousTimeMode()
    instance.fmu.setContinuousStates((c_double * 2)(state.get("h", 0), state.get("v", 0)), 2)
    instance.fmu.enterEventMode()
    instance.fmu.newDiscreteStates()
    assert instance.get("h", "v") == pytest.approx([0, 0], abs=1e-15) and value(instance, "ground.closed") == 1


# --- Inputs ---

# An input, and counters of it: rises, falls, passes, and times it became larger than 0.5.
TOUCHES = [
    (0, [0, 0, 0, 0]), (0.5, [0, 0, 0, 0]), (0, [0, 0, 0, 0]), (0.5, [0, 0, 0, 0]), (1, [1, 0, 1, 1]), (0.5, [1, 0, 1, 1]),
    (1, [1, 0, 1, 2]), (0, [1, 1, 2, 2]), (0.5, [1, 1, 2, 2]), (0.6, [2, 1, 3, 3]),
]  # fmt: skip


@pytest.mark.parametrize("kind", ["taylor", "bdf", "fmi3", "fmi3-exchange", "exchange"])
def test_an_input_that_touches_passes_nothing(open_fmu, opened, kind):
    fmi3_kind = dict(kind=FMU3Model) if kind == "fmi3-exchange" else {}
    name = "Yard_bdf" if kind == "bdf" else "Yard_taylor"
    if kind.startswith("fmi3"):
        instance = opened(name, **fmi3_kind).initialize()
    else:
        instance = open_fmu(name, **(dict(kind=FMU2Model) if kind == "exchange" else {})).initialize()
    for u, counts in TOUCHES:
        instance.set(u=u)
        if kind == "exchange":
            instance.fmu.newDiscreteStates()
        elif kind == "fmi3-exchange":
            instance.fmu.updateDiscreteStates()
        else:
            instance.step(0.01)
        assert list(instance.get(*COUNTERS)) == counts, u


REPORTED = ["pace", "der(cv)", "der(dv)", "brake.force", "floor.force", "over", "cv", "d"]


@pytest.mark.parametrize("version", [2, 3])
def test_set_values_show_at_once_and_reading_changes_nothing(open_fmu, opened, version):
    """
    Friction of up to 4 keeps the block sticking at first; later a force of 6 moves it against 4 or 1. The body on the floor lifts off from
    u = 0.5 on. Reading values does not change the saved state.
    """
    instance = (open_fmu if version == 2 else opened)("Yard_taylor").initialize()
    model = instance.fmu
    take, restore = (model.getFMUState, model.setFMUState)
    serialize = lambda state: model.serializeFMUState(state)
    for u, right in [(0.6, (0, 0, 2, 2, 0, 1, 0)), (0.8, (2, 2, 6, 4, 0, 1, 0)), (1.0, (5, 5, 10, 1, 0, 1, None)), (0.1, (-2, -2, -8, 4, 0, 1, None))]:
        instance.set(u=u)
        before = take()
        reported = list(instance.get(*REPORTED))
        assert reported[:6] == pytest.approx(right[:6], abs=1e-12), u
        again = take()
        assert serialize(before) == serialize(again)
        if version == 2:
            slope = model.getDirectionalDerivative(instance.vr("der(dv)"), instance.vr("u"), [1.0])
            assert slope[0] == pytest.approx(20)
        time = instance.time
        instance.step(1e-9)
        assert list(instance.get(*REPORTED)) == pytest.approx(reported, abs=1e-6)
        after = serialize(take())
        restore(before)
        instance.time = time
        instance.step(1e-9)
        assert serialize(take()) == after
        instance.step(0.02)


# --- Work and mistakes ---


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_work_is_that_of_forces_between_events(kind):
    names = ["nonConservativeWork", "totalEnergy", "n"]
    result = fmpy.simulate_fmu(str(fmu.archive("Worked")), fmi_type=kind, stop_time=3, output_interval=0.1, output=names)
    assert result["totalEnergy"] - result["nonConservativeWork"] == pytest.approx(np.full(len(result), 9.81 + 4.5), abs=1e-8 if kind == "CoSimulation" else 1e-4)
    assert result["nonConservativeWork"][-1] < -5 and result["n"][-1] >= 2


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes(open_fmu, name):
    instance = open_fmu(name).initialize()
    time, message = STEPPED[name]
    with instance.fails(DISCARD, message):
        instance.step(1.0 if name == "Pushes" else 3.0)
    assert not any("closest to singular" in text or "lagc" in text for _, _, text in instance.messages)


@pytest.mark.parametrize("version", [2, 3])
def test_a_negative_gap_at_the_start_is_an_error_in_model_exchange(open_fmu, opened, version):
    instance = open_fmu("Yard_taylor", kind=FMU2Model) if version == 2 else opened("Yard_taylor", kind=FMU3Model)
    with pytest.raises(FMICallException):
        instance.initialize({"d": -0.25})
    assert any("the contact 'floor' is penetrated at the start: its gap is -0.25" in text for _, _, text in instance.messages)


@pytest.mark.parametrize(
    "element, message",
    [
        ('<event when="der(v) - 1"><set mode="m">1</set></event>', r"an <event> cannot depend on accelerations, but this one does on 'der\(v\)'"),
        ('<event when="x"><set mode="m">if(der(v) > 0, 1, 2)</set></event>', r"an <event> cannot depend on accelerations, but this one does on 'der\(v\)'"),
        ('<define name="on">wall.closed</define><force coordinate="x">on</force>', "the force cannot depend on whether contacts are closed"),
        ('<friction name="f" coordinate="x" force="1"/><contact name="c" gap="x + f.sliding"/>', "gap of <contact> cannot depend on whether contacts are closed"),
    ],
)
def test_names_for_events_alone(tmp_path, element, message):
    start = '<mode name="m"/><coordinate name="x" velocity="v"/><particle mass="1" x="x"/><contact name="wall" gap="x"/>'
    (tmp_path / "system.xml").write_text(f'<system name="A">{start}{element}</system>')
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and re.search(message, result.stderr), result.stderr
