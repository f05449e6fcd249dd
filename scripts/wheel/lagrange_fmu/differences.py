"""Derivatives by differences of fourth order, which stay within what a value may be."""

from .problem import Problem

CENTRAL = ((-2, 1 / 12), (-1, -2 / 3), (1, 2 / 3), (2, -1 / 12))
FORWARD = ((0, -25 / 12), (1, 4), (2, -3), (3, 4 / 3), (4, -1 / 4))
BACKWARD = tuple((-steps, -weight) for steps, weight in FORWARD)
SECOND_ORDER = {CENTRAL: {-1: -1 / 2, 1: 1 / 2}, FORWARD: {0: -3 / 2, 1: 2, 2: -1 / 2}, BACKWARD: {0: 3 / 2, -1: -2, -2: 1 / 2}}  # of what the rule looks at


def rules_within(value, step, limits):
    """So many steps, and by what what is found there counts: the sum is the change over a step, to first order. The best is the first; one at least."""
    low, high = ((limit - value) / step for limit in limits)
    rules = [rule for rule in (CENTRAL, FORWARD, BACKWARD) if all(low <= steps <= high for steps, _ in rule)]
    if not rules:
        raise Problem(f"the limits {limits[0]:g} and {limits[1]:g} are too close together for a derivative by what is between them; expected limits further apart")
    return rules


def difference(function, rule):
    """The change over a step, and how far that of second order is from it; function(steps): an array."""
    found = {steps: function(steps) for steps, _ in rule}
    change = sum(weight * found[steps] for steps, weight in rule)
    return change, abs(sum(weight * found[steps] for steps, weight in SECOND_ORDER[rule].items()) - change)


def relevant(changes, names):
    """Those of the names by which something changes; changes(names): whether it does by all of these together. Few questions where few do."""
    if not names or not changes(names):
        return []
    if len(names) == 1:
        return list(names)
    half = len(names) // 2
    return relevant(changes, names[:half]) + relevant(changes, names[half:])
