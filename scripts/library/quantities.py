"""Convert values given as texts, such as "30deg", "pi/2" and "20cm", to the unit of a variable, by lagc. Also a module of the wheel."""

import argparse
import functools
import math
import os
import subprocess
from pathlib import Path

from .problem import Problem

HERE = Path(__file__).resolve().parent
NAME = "lagc.exe" if os.name == "nt" else "lagc"
PLACES = (HERE / "bin" / NAME, HERE.parents[1] / "build" / "bin" / NAME)  # in the wheel, and in a clone


@functools.cache
def _converted(name, text, unit):
    lagc = next((path for path in PLACES if path.exists()), None)
    if lagc is None:
        raise Problem(f"{name}: '{text}' is not a number; expected one in {unit}")
    result = subprocess.run([lagc, "--value", f"{name}={text}", "--unit", unit], capture_output=True, text=True)
    if result.returncode != 0:
        raise Problem(result.stderr.strip() or f"{name}: '{text}' has no finite value; expected a number in {unit}")
    return float(result.stdout)


def number_of(name, value, unit, is_limit=False):
    """Return a value, a number or a text, as a number in the unit; raise Problem if it is not finite, unless `is_limit` allows infinity."""
    if not isinstance(value, str):
        return value
    value = value.strip()
    try:
        number = float(value)
    except ValueError:
        number = _converted(name, value, unit)
    if math.isnan(number) or math.isinf(number) and not is_limit:
        raise Problem(f"{name}: '{value}' is not finite; expected a finite number in {unit}")
    return number


def truth_of(variable, value):
    """Return the number of the text "true" or "false" for a Boolean variable; any other value as it is."""
    is_text = variable.type == "Boolean" and isinstance(value, str)
    return {"true": 1.0, "false": 0.0}.get(value.strip(), value) if is_text else value


def numbers_of(values, units):
    """Return the values of a dict as numbers; `units` has the units of variables by name, and "1" is the default."""
    return {name: number_of(name, value, units.get(name, "1")) for name, value in values.items()}


def assignment(text):
    """Parse NAME=VALUE of a command line; return the name, and the value as text."""
    name, separator, value = text.partition("=")
    if not separator or not name or not value.strip():
        raise argparse.ArgumentTypeError(f"'{text}' is not NAME=VALUE; expected one such as theta=30deg")
    return name, value
