"""Look up variables of an FMU by name, and suggest names for unknown ones."""

import difflib
import itertools
import math
import re
from collections.abc import Iterable, Mapping
from numbers import Real
from pathlib import Path

from .problem import Problem
from .quantities import numbers_of, truth_of

LIKE = 0.65  # smallest ratio of difflib at which a word is suggested


def settable(description):
    """Return the names of the real variables whose start values can be set: parameters, inputs and states."""
    return [v.name for v in description.modelVariables if v.start is not None and v.type in ("Real", "Float64")]


def startable(description):
    """Return the names of the variables that take a start value, integers and Booleans too."""
    return [v.name for v in description.modelVariables if v.start is not None and v.type not in ("String", "Binary")]


def elements(name, shape):
    """Return the names of an array's elements as in FMI 2.0, such as der(theta[1]); for a scalar a list of its name."""
    places = itertools.product(*(range(1, count + 1) for count in shape or ()))
    return [re.sub(r"(\)*)$", rf"[{','.join(map(str, place))}]\1", name, count=1) for place in places] if shape else [name]


def start_values(description):
    """Return the start values of all variables that have one, as numbers by name; arrays by their elements."""
    numbers = {"true": 1.0, "false": 0.0}
    found = {}
    for v in description.modelVariables:
        if v.start is not None:
            found |= {name: numbers[text] if text in numbers else float(text) for name, text in zip(elements(v.name, v.shape), v.start.split())}
    return found


def whole_kind(name, description):
    """Return "an Integer" or "a Boolean" for a variable of this type that has a start value; None for others."""
    kinds = [v.type for v in description.modelVariables if v.name == name and v.start is not None]
    return {"Boolean": "a Boolean", "Integer": "an Integer", "Int32": "an Integer", "Int64": "an Integer"}.get(kinds[0]) if kinds else None


def unsettable_reason(name, description):
    """Return the end of a message that explains why a variable cannot be set; "" if no explanation is needed."""
    kind = whole_kind(name, description)
    if kind:
        return f", as it is {kind}"
    calculated = [v.name for v in description.modelVariables if v.causality == "calculatedParameter"]
    return ", as it follows from other parameters" if name in calculated else ""


def nearest(word, words):
    """Return the most similar word; None if there is none, or if several begin with `word` and differ after that of the shortest."""
    by_lower = {str(one).lower(): str(one) for one in words}
    word = str(word).lower()
    begins = [one for one in by_lower if one.startswith(word)]
    shortest = min(begins, key=len, default=None)
    if shortest and all(one.startswith(shortest) for one in begins):
        begins = [shortest]
    if word in by_lower or len(begins) > 1 or len(word) < 3:
        return by_lower.get(word)
    found = begins or difflib.get_close_matches(word, by_lower, 1, LIKE)
    return by_lower[found[0]] if found else None


def suggestion(word, words, what="these are"):
    """Return the end of a message: the most similar word, or the list of all words."""
    words = list(words)
    near = nearest(word, words)
    return f"did you mean '{near}'?" if near else f"{what}: {', '.join(map(str, words))}" if words else "there are none"


def near_file(path):
    """Return the end of a message about a missing file: a file of a similar name in its folder, or ""."""
    path = Path(path)
    others = sorted(path.parent.iterdir(), key=lambda other: (other.suffix == path.suffix, other.name)) if path.parent.is_dir() else []
    beside = {other.stem: other.name for other in others}  # other files by stem; of several, the one with the same suffix
    near = nearest(path.stem, beside)
    return f"; did you mean '{path.with_name(beside[near])}'?" if near else ""


def units_of(description):
    """Return the units of all variables and elements of arrays by name; "1" for variables without unit."""
    return {name: v.unit or "1" for v in description.modelVariables for name in (v.name, *elements(v.name, v.shape))}


def _is_finite(value):
    """Return True for a finite number, and for an array of finite numbers."""
    if isinstance(value, Iterable) and not isinstance(value, (str, bytes)) and getattr(value, "shape", (1,)):
        return all(map(_is_finite, value))
    return not isinstance(value, (str, bytes)) and (isinstance(value, Real) or hasattr(value, "__float__")) and math.isfinite(value)


def numbers_by_name(given, what="start_values"):
    """
    Return a dict by name of finite numbers, arrays of them, or texts with units, which quantities.py converts; {} for None.

    Raise Problem for other values.
    """
    if given is not None and not isinstance(given, Mapping):
        raise Problem(f"{what} is a {type(given).__name__}; expected a dict of numbers by name, such as {{'theta': 1.0}}")
    for name, value in (given or {}).items():
        if not isinstance(value, str) and not _is_finite(value):
            raise Problem(f"{what} has {value!r} for '{name}'; expected a finite number, or a text such as '30deg'")
    return dict(given or {})


def pairs_by_name(given):
    """Return bounds as a dict of pairs; raise Problem for others."""
    bounds = {} if given is None else given
    if not isinstance(bounds, Mapping):
        raise Problem(f"bounds is {bounds!r}; expected a dict of pairs by name, such as {{'l': (0.5, 2)}}")
    for name, pair in bounds.items():
        if isinstance(pair, (str, Mapping, set)) or not isinstance(pair, Iterable) or len(list(pair)) != 2:
            raise Problem(f"bounds has {pair!r} for '{name}'; expected a pair (LOW, HIGH)")
    return dict(bounds)


def names_of(given, what):
    """Return a list of names, which may be given as a single name; raise Problem if one is not a text, or is given twice."""
    if isinstance(given, str):
        return [given]
    names = list(given) if isinstance(given, Iterable) else [given]
    for name in names:
        if not isinstance(name, str):
            raise Problem(f"{what} has {name!r}; expected names of variables")
        if names.count(name) > 1:
            raise Problem(f"'{name}' is given twice in {what}; expected each name once")
    return names


def some_names(given, what):
    """Return names as names_of() does; raise Problem if there are none."""
    names = names_of(given, what)
    if not names:
        raise Problem(f"{what} is empty; expected one name at least")
    return names


def known(names, among, description, what="is not a variable"):
    """Return the names as a list; raise Problem if one is not in `among`."""
    for name in names:
        if name not in among:
            raise Problem(f"'{name}' {what} of {description.modelName}{unsettable_reason(name, description)}; {suggestion(name, among)}")
    return list(names)


def _flat(value):
    """Return the numbers of a number, or of nested lists and arrays."""
    return [value] if isinstance(value, Real) else [number for part in value for number in _flat(part)]


def checked_start(start, description, free=None, arguments=()):
    """
    Return the start values as numbers; raise Problem if one is for a variable that does not exist, or is not in `free`, by default settable().

    `arguments` are further words that a misspelt name may stand for.
    """
    variables = {variable.name: variable for variable in description.modelVariables}
    free = settable(description) if free is None else free
    for name in start:
        if name in variables and name not in free:
            raise Problem(f"'{name}' of {description.modelName} cannot be set{unsettable_reason(name, description)}; these can be: {', '.join(free)}")
        if name not in free:
            near = nearest(name, free) or nearest(name, arguments)
            raise Problem(f"'{name}' is not a variable of {description.modelName}; {suggestion(name, [near] if near else free, 'these can be')}")
    numbers = numbers_of({name: truth_of(variables[name], value) for name, value in start.items()}, units_of(description))
    for name, value in numbers.items():
        kind = whole_kind(name, description)
        if kind and not all(number in (0, 1) if kind == "a Boolean" else number % 1 == 0 for number in _flat(value)):
            raise Problem(f"'{name}' is set to {start[name]!r}; expected {'True or False' if kind == 'a Boolean' else 'a whole number'}")
    return numbers
