"""Conditions in `when` of modes and Boolean parameters alone, joined by and, or and not."""

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


@pytest.fixture(scope="module", autouse=True)
def built():
    fmu.build_systems("conditions", {"Conditions": SYSTEM}, versions=[2])


def turns(mode, time):
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
        values = {"a": turns("a", time), "b": turns("b", time), "flag": flag, "x": time}
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
