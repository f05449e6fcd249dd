"""
Differentiate by finite differences of fourth order within bounds.

A rule is a tuple of pairs (k, w): f'(x) h = sum of w f(x + k h), with an error of O(h^5). Central, forward and backward rules are used; one
that stays between the bounds is chosen (B. Fornberg: Generation of finite difference formulas on arbitrarily spaced grids, 1988).
"""

from .problem import Problem

CENTRAL = ((-2, 1 / 12), (-1, -2 / 3), (1, 2 / 3), (2, -1 / 12))
FORWARD = ((0, -25 / 12), (1, 4), (2, -3), (3, 4 / 3), (4, -1 / 4))
BACKWARD = tuple((-steps, -weight) for steps, weight in FORWARD)
SECOND_ORDER = {CENTRAL: {-1: -1 / 2, 1: 1 / 2}, FORWARD: {0: -3 / 2, 1: 2, 2: -1 / 2}, BACKWARD: {0: 3 / 2, -1: -2, -2: 1 / 2}}  # on the points of each rule; differences from it estimate its error


def rules_within(value, step, limits):
    """
    Return the rules whose points value + k*step lie within the limits, the central rule first.

    Raise Problem if there is none.
    """
    low, high = ((limit - value) / step for limit in limits)
    rules = [rule for rule in (CENTRAL, FORWARD, BACKWARD) if all(low <= steps <= high for steps, _ in rule)]
    if not rules:
        raise Problem(f"the limits {limits[0]:g} and {limits[1]:g} are too close together for a derivative by a value between them; expected limits further apart")
    return rules


def difference(function, rule):
    """Return h f'(x) by the rule, and its absolute difference from the rule of second order; function(k) returns the array f(x + k h)."""
    found = {steps: function(steps) for steps, _ in rule}
    change = sum(weight * found[steps] for steps, weight in rule)
    return change, abs(sum(weight * found[steps] for steps, weight in SECOND_ORDER[rule].items()) - change)


def relevant(changes, names):
    """
    Return the names that have an effect, by bisection: k of n names take O(k log n) calls.

    changes(names) is True if changing all these names together has an effect.
    """
    if not names or not changes(names):
        return []
    if len(names) == 1:
        return list(names)
    half = len(names) // 2
    return relevant(changes, names[:half]) + relevant(changes, names[half:])
