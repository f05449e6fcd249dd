"""Read inputs and measurements from a CSV."""

import csv
import re

import numpy as np

from .problem import Problem
from .variables import near_file

NOTHING = ("", "NA", "nan")  # cells of missing values


def _rows_of(path):
    """Return the rows that are not empty, as (number of the line, cells), and the separator of the file."""
    try:
        with open(path, newline="", encoding="utf-8-sig") as file:
            first = file.readline()
            file.seek(0)
            separator = next((mark for mark in ";\t" if mark in first), ",")
            reader = csv.reader(file, delimiter=separator)
            return [(reader.line_num, [word.strip() for word in row]) for row in reader if row], separator
    except FileNotFoundError:
        raise Problem(f"there is no file {path}{near_file(path) or '; expected a CSV with time and names of variables'}") from None
    except (UnicodeDecodeError, csv.Error) as problem:
        raise Problem(f"{path} is not a text of UTF-8 with columns ({problem}); expected a CSV, which a spreadsheet saves as 'CSV UTF-8'") from None


def _name_in(word, units, path):
    """Return the name in the head of a column, such as theta in "theta [rad]"; raise Problem if the unit is not the variable's."""
    name, unit = re.fullmatch(r"(.*?)(?:\s+[\[(](.*)[\])])?", word).groups()
    expected = "s" if name == "time" else units.get(name) or "1"
    if unit is not None and (name == "time" or name in units) and unit.strip() != expected:
        raise Problem(f"{path}: '{name}' is in '{unit}'; expected it in {expected}, as the system has it")
    return name


def _number(word, separator, place):
    if word in NOTHING:
        return np.nan
    try:
        return float(word if separator == "," else word.replace(",", "."))
    except ValueError:
        raise Problem(f"{place} '{word}' is not a number; expected one such as 0.5") from None


def read_table(path, units):
    """
    Return the table of a CSV as a structured array, whose first field is "time", in s; missing values are NaN.

    The first line has the names of the columns, optionally with units, as in "theta [rad]"; these must be equal to `units[name]`. Commas,
    semicolons or tabs separate columns. With the latter two, decimal commas are allowed. Raise Problem with file and line for malformed input.
    """
    rows, separator = _rows_of(path)
    names = [_name_in(word, units, path) for word in rows[0][1]] if rows else []
    if names[:1] != ["time"] or len(names) < 2 or len({*names} - {""}) < len(names):
        first = separator.join(rows[0][1]) if rows else ""
        raise Problem(f"{path}: the first line is '{first}'; expected time and names of variables, each once, such as time,theta")
    if separator != "," and all(any(mark in word for _, row in rows[1:] for word in row) for mark in ",."):
        raise Problem(f"{path}: numbers have decimal commas and decimal points; expected one kind, and no separators of thousands")
    values = np.empty((len(rows) - 1, len(names)))
    for place, (line, row) in enumerate(rows[1:]):
        if len(row) != len(names):
            raise Problem(f"{path}:{line}: '{separator.join(row)}' is not {len(names)} numbers; expected one for each name of the first line")
        values[place] = [_number(word, separator, f"{path}:{line}:") for word in row]
    return np.rec.fromarrays(values.T, names=names).view(np.ndarray)


def read_input(path, units):
    """Return a table of inputs as read_table() does; raise Problem if a value is missing or times decrease."""
    data = read_table(path, units)
    if len(data) < 1 or not all(np.isfinite(data[name]).all() for name in data.dtype.names) or (np.diff(data["time"]) < 0).any():
        raise Problem(f"{path}: expected lines of finite numbers, whose times do not decrease")
    return data
