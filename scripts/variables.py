"""The variables of an FMU."""

import difflib
import itertools
import math
import re
from collections.abc import Iterable, Mapping
from numbers import Real
from pathlib import Path

from .problem import Problem
from .quantities import numbers_of

LIKE = 0.65  # difflib's ratio of a word and the one that was meant, at least


def settable(description):
    """The names of those whose start values can be set: parameters, inputs, states."""
    return [v.name for v in description.modelVariables if v.start is not None and v.type in ("Real", "Float64")]


def elements(name, shape):
    """The names of an array's elements as FMI 2.0 has them, such as der(theta[1]); that of a scalar."""
    places = itertools.product(*(range(1, count + 1) for count in shape or ()))
    return [re.sub(r"(\)*)$", rf"[{','.join(map(str, place))}]\1", name, count=1) for place in places] if shape else [name]


def start_values(description):
    """Of all that have one, as numbers; those of an array by its elements."""
    numbers = {"true": 1.0, "false": 0.0}
    found = {}
    for v in description.modelVariables:
        if v.start is not None:
            found |= {name: numbers[text] if text in numbers else float(text) for name, text in zip(elements(v.name, v.shape), v.start.split())}
    return found


def why_not(name, description):
    """Why it cannot be set, where that needs a word."""
    calculated = [v.name for v in description.modelVariables if v.causality == "calculatedParameter"]
    return ", as it follows from other parameters" if name in calculated else ""


def nearest(word, words):
    """The one that was meant, most likely; None where none is like it, or several begin so."""
    by_lower = {str(one).lower(): str(one) for one in words}
    word = str(word).lower()
    begins = [one for one in by_lower if one.startswith(word)]
    if word in by_lower or len(begins) > 1 or len(word) < 3:
        return by_lower.get(word)
    found = begins or difflib.get_close_matches(word, by_lower, 1, LIKE)
    return by_lower[found[0]] if found else None


def instead(word, words, what="these are"):
    """The end of a message: the word that was meant, or all that there are."""
    near = nearest(word, words)
    return f"did you mean '{near}'?" if near else f"{what}: {', '.join(map(str, words))}"


def near_file(path):
    """The end of a message about a file that is not there: one beside it with nearly this name."""
    path = Path(path)
    beside = {other.stem: other.name for other in path.parent.iterdir()} if path.parent.is_dir() else {}
    near = nearest(path.stem, beside)
    return f"; did you mean '{path.with_name(beside[near])}'?" if near else ""


def units_of(description):
    """By name; "1" of what has none."""
    return {name: v.unit or "1" for v in description.modelVariables for name in (v.name, *elements(v.name, v.shape))}


def _is_finite(value):
    """True of a number, and of an array of some."""
    if isinstance(value, Iterable) and not isinstance(value, (str, bytes)) and getattr(value, "shape", (1,)):
        return all(map(_is_finite, value))
    return not isinstance(value, (str, bytes)) and (isinstance(value, Real) or hasattr(value, "__float__")) and math.isfinite(value)


def numbers_by_name(given, what="start_values"):
    """Those of a dict, or of nothing; arrays of them too, and texts, which quantities.py reads."""
    if given is not None and not isinstance(given, Mapping):
        raise Problem(f"{what} is a {type(given).__name__}; expected a dict of numbers by name, such as {{'theta': 1.0}}")
    for name, value in (given or {}).items():
        if not isinstance(value, str) and not _is_finite(value):
            raise Problem(f"{what} has {value!r} for '{name}'; expected a finite number, or a text such as '30deg'")
    return dict(given or {})


def names_of(given, what):
    """Some names, of which one may stand alone."""
    if isinstance(given, str):
        return [given]
    names = list(given) if isinstance(given, Iterable) else [given]
    for name in names:
        if not isinstance(name, str):
            raise Problem(f"{what} has {name!r}; expected names of variables")
    return names


def known(names, among, description, what="is not a variable"):
    """The names, all of which are among those."""
    for name in names:
        if name not in among:
            raise Problem(f"'{name}' {what} of {description.modelName}{why_not(name, description)}; {instead(name, among)}")
    return list(names)


def checked_start(start, description):
    """Start values as numbers; all of them are of variables that take them."""
    names, free = [variable.name for variable in description.modelVariables], settable(description)
    for name in start:
        if name in names and name not in free:
            raise Problem(f"'{name}' of {description.modelName} cannot be set{why_not(name, description)}; these can be: {', '.join(free)}")
        if name not in free:
            raise Problem(f"'{name}' is not a variable of {description.modelName}; {instead(name, free, 'these can be')}")
    return numbers_of(start, units_of(description))
