"""Conditions in `when` of only modes and Boolean parameters, joined by and, or and not."""

import itertools

import pytest

import fmu

# Two modes that change at known times, and a tunable Boolean; the number of times each condition becomes true.
CONDITIONS = {
    "both": "a and b", "either": "a or b", "neither": "not a and not b", "one": "(a or b) and not (a and b)",
    "tuned": "flag", "lowered": "not flag", "allowed": "flag and a", "mixed": "flag and x > 0.33", "barred": "a and not flag or b and flag",
}  # fmt: skip
TIMES = {"a": (1, 0.1, 0.3), "b": (0, 0.2, 0.4)}  # of each mode: the start value, and the times of its changes
SYSTEM = """
<system name="Conditions">
  <parameter name="flag" type="Boolean" start="false"/>
  <coordinate name="x" velocity="v" velocityStart="1"/>
  <mode name="a" start="1"/>
  <mode name="b" start="0"/>
  <particle mass="1" x="x"/>
  <event when="x &gt; 0.1"><set mode="a">0</set></event>
  <event when="x &gt; 0.2"><set mode="b">1</set></event>
  <event when="x &gt; 0.3"><set mode="a">1</set></event>
  <event when="x &gt; 0.4"><set mode="b">0</set></event>
  {counters}
</system>
""".format(counters="".join(f'<mode name="{name}"/><event when="{when.replace(">", "&gt;")}"><set mode="{name}">{name} + 1</set></event>' for name, when in CONDITIONS.items()))

# n counts the samples, taken every 0.1 s from the start on. Events of expressions of modes and parameters record n when these pass 0.
PASSAGES = {"lim - n": ("falling", [4]), "n - 2*lim": ("rising", [7]), "5.5 - n": ("falling", [6]), "n - 5.5": ("falling", []), "(n - 2)*(n - 4)": ("both", [3, 5]), "sin(n - 0.5)": ("rising", [1, 7])}
COUNTER = """
<system name="Passages{method}">
  <parameter name="lim" start="3"/>
  <state name="x" rate="-x"/>
  <mode name="n"/>
  <sample every="0.1"><set mode="n">n + 1</set></sample>
  {events}
  <solver method="{method}"/>
</system>
"""
EVENTS = "".join(f'<mode name="at[{i}]"/><event when="{when}" direction="{direction}"><set mode="at[{i}]">100*at[{i}] + n</set></event>' for i, (when, (direction, _)) in enumerate(PASSAGES.items()))
METHODS = ["taylor", "auto", "radau", "bdf", "erk"]


@pytest.fixture(scope="module", autouse=True)
def built():
    counters = {f"Passages{method}": COUNTER.format(method=method, events=EVENTS) for method in METHODS}
    fmu.build_systems("conditions", {"Conditions": SYSTEM, **counters}, versions=[2])


def noted(counts):
    return sum(n * 100**i for i, n in enumerate(reversed(counts)))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("step", [1.0, 0.07, 0.001])
def test_expressions_of_modes_pass_zero(method, step):
    """lim - n is 0 at n = 3, and has passed 0 at n = 4, where the event occurs; the others likewise."""
    instance = fmu.Instance(f"Passages{method}").initialize()
    instance.run(1.0, step, "n")
    assert [instance.get(f"at[{i}]") for i in range(len(PASSAGES))] == [noted(counts) for _, counts in PASSAGES.values()]


def test_a_tuned_parameter_brings_the_passage(open_fmu):
    instance = open_fmu("Passagestaylor").initialize()
    instance.step(0.05)
    instance.set(lim=0.5)
    instance.step(0.01)
    assert instance.get("at[0]") == 1


def rotations(mode, time):
    start, *times = TIMES[mode]
    return bool((start + sum(time > t for t in times)) % 2)


@pytest.mark.parametrize("flags", list(itertools.product([False, True], repeat=5)))
def test_how_often_conditions_become_true(flags):
    """The Boolean is set between steps of 0.1; Python evaluates the conditions before and after each change."""
    instance = fmu.Instance("Conditions").initialize()
    reference = instance.references["flag"]
    flag, before, counts = False, None, dict.fromkeys(CONDITIONS, 0)

    def look(time):
        nonlocal before
        values = {"a": rotations("a", time), "b": rotations("b", time), "flag": flag, "x": time}
        present = {name: bool(eval(when, values)) for name, when in CONDITIONS.items()}
        for name in CONDITIONS:
            counts[name] += present[name] and before is not None and not before[name]
        before = present

    look(0.0)
    for i, next_flag in enumerate(flags):
        time = 0.05 + 0.1 * i
        for passed in (0.1 * i + 0.01, 0.1 * i + 0.04, time):
            look(passed)
        instance.step(time - instance.time)
        instance.time = time
        instance.fmu.setBoolean([reference], [next_flag])
        flag = next_flag
        look(time)
    instance.step(0.001)
    assert dict(zip(CONDITIONS, instance.get(*CONDITIONS))) == counts
