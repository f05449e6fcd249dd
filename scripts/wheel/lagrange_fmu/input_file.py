"""The signals of an FMU's inputs, from a CSV."""

import csv

import numpy as np

from .problem import Problem


def read_input(path):
    """A structured array of time, in s and not decreasing, and the inputs, whose names are in the first line; linear between the lines."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.reader(file) if row]
    names = [name.strip() for name in rows[0]] if rows else []
    if names[:1] != ["time"] or len(names) < 2 or len(set(names)) < len(names):
        raise Problem(f"{path}: the first line is '{','.join(names)}'; expected time and names of inputs, such as time,tau")
    values = np.empty((len(rows) - 1, len(names)))
    for line, row in enumerate(rows[1:], 2):
        try:
            values[line - 2] = [float(word) for word in row]
        except ValueError:
            raise Problem(f"{path}:{line}: '{','.join(row)}' is not {len(names)} numbers") from None
    if len(values) < 1 or not np.isfinite(values).all() or (np.diff(values[:, 0]) < 0).any():
        raise Problem(f"{path}: expected lines of finite numbers, whose times do not decrease")
    return np.rec.fromarrays(values.T, names=names).view(np.ndarray)
