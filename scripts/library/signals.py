"""
Represent the inputs of an FMU as piecewise polynomials in time, from tables or functions.

- Between the rows of a table an input is linear, or held on request. Two rows of one time are a jump. Outside of the rows it is constant.
- An input of a prescribed motion has its derivatives as inputs, der(zb) and der(der(zb)). It is a cubic spline through its rows, or, if its
  derivative has a column, a cubic Hermite interpolant. Derivatives without a column are those of these polynomials.
- A function of time is interpolated in each step by the cubic through its values at four Lobatto nodes.

The cubic spline solves a tridiagonal system by Thomas' algorithm, with O(n) operations for n rows (C. de Boor: A practical guide to splines).
"""

import inspect
from collections.abc import Mapping

import numpy as np

from .problem import Problem
from .variables import known

ORDER = 3  # order of the polynomials
NODES = 0.5 + 0.5 * np.array([-1.0, -(5**-0.5), 5**-0.5, 1.0])  # Lobatto nodes in [0, 1], whose quadrature is exact to order 5
FROM_NODES = np.linalg.inv(np.vander(NODES, increasing=True))  # matrix from values at the nodes to coefficients
SAME = 1e-10  # difference, relative to the largest value, below which values are equal
REAL = ("Real", "Float64", "Float32")
PIECES = 100  # linear pieces in place of a curved polynomial, for importers that accept tables only
EXPECTED = "expected the path of a CSV, a structured array, a dict of arrays or a DataFrame with time and names of inputs, or a function of time"


def derivative(coefficients):
    """Return the coefficients of the polynomials' derivatives; the first axis is the order."""
    found = np.zeros_like(coefficients)
    found[:-1] = coefficients[1:] * np.arange(1, len(coefficients)).reshape(-1, *[1] * (coefficients.ndim - 1))
    return found


def value(coefficients, s):
    """Return the values of cubic polynomials at a time s after their begin."""
    return coefficients[0] + s * (coefficients[1] + s * (coefficients[2] + s * coefficients[3]))


def _end_slope(times, values):
    """Return the slope at the first row of the polynomial through the first four rows."""
    times, values = times[: ORDER + 1], values[: ORDER + 1]
    span = times[-1] - times[0]
    return np.polynomial.polynomial.polyfit((times - times[0]) / span, values, len(times) - 1)[1] / span


def spline_slopes(times, values):
    """Return the slopes at the rows of the cubic spline whose end slopes are those of _end_slope(), by Thomas' algorithm."""
    count = len(times)
    if count == 1:
        return np.zeros(1)
    slopes = np.zeros(count)
    slopes[0], slopes[-1] = _end_slope(times, values), -_end_slope(-times[::-1], values[::-1])
    weight = 1 / np.diff(times)
    pull = 3 * np.diff(values) * weight**2
    pivot, right = np.ones(count), slopes.copy()
    above = np.concatenate([[0.0], weight[1:]])  # superdiagonal; the first unknown is known
    for i in range(1, count - 1):
        share = weight[i - 1] / pivot[i - 1]
        pivot[i] = 2 * (weight[i - 1] + weight[i]) - share * above[i - 1]
        right[i] = pull[i - 1] + pull[i] - share * right[i - 1]
    for i in range(count - 2, 0, -1):
        slopes[i] = (right[i] - above[i] * slopes[i + 1]) / pivot[i]
    return slopes


class Column:
    """The values of an input at the rows of a table; `kind` is "held", "linear" or "cubic", and `slopes` are the given slopes or None."""

    def __init__(self, kind, values, slopes=None):
        self.kind, self.values, self.slopes = kind, values, slopes

    def pieces(self, times, rises):
        """Return the coefficients, 4 x n, of the pieces that begin at the n rows `rises`, whose next rows have later times."""
        step, low, high = times[rises + 1] - times[rises], self.values[rises], self.values[rises + 1]
        found = np.zeros((ORDER + 1, len(rises)))
        found[0] = low
        if self.kind == "linear":
            found[1] = (high - low) / step
        if self.kind == "cubic":
            slopes, mean = self._slopes(times), (high - low) / step
            first, last = slopes[rises], slopes[rises + 1]
            found[1:] = first, (3 * mean - 2 * first - last) / step, (first + last - 2 * mean) / step**2
        return found

    def _slopes(self, times):
        if self.slopes is not None:
            return self.slopes
        parts = np.split(np.arange(len(times)), np.flatnonzero(np.diff(times) == 0) + 1)
        return np.concatenate([spline_slopes(times[part], self.values[part]) for part in parts])


class Table:
    """Piecewise polynomials through the rows of a table. Piece i begins at starts[i]; the first and last are constant."""

    def __init__(self, times, columns):
        rises = np.flatnonzero(np.diff(times) > 0)
        self.starts = np.concatenate([times[:1], times[rises], times[-1:]])  # starts of the pieces before the first row, between rows, and after the last
        self.coefficients = np.zeros((ORDER + 1, len(self.starts), len(columns)))
        for k, column in enumerate(columns):
            self.coefficients[0, [0, -1], k] = column.values[[0, -1]]
            self.coefficients[:, 1:-1, k] = column.pieces(times, rises)
        self.breaks = self._breaks()

    def _breaks(self):
        """Return the starts of the pieces whose polynomials are not the continuation of the piece before."""
        before, after = self.coefficients[:, :-1], self.coefficients[:, 1:]
        length, differs = np.diff(self.starts)[:, None], np.zeros(len(self.starts) - 1, bool)
        for _ in range(ORDER + 1):
            differs |= (abs(after[0] - value(before, length)) > SAME * abs(after[0]).max(axis=0)).any(axis=1)
            before, after = derivative(before), derivative(after)
        return np.unique(self.starts[1:][differs])

    def over(self, begin, end):
        """Return the coefficients about `begin`, 4 x columns, of the polynomials between two times without a break between them."""
        piece = np.searchsorted(self.starts[1:], (begin + end) / 2, side="right")
        here, s, factor = self.coefficients[:, piece], begin - self.starts[piece], 1.0
        found = np.empty_like(here)
        for order in range(ORDER + 1):
            found[order] = value(here, s) / factor
            here, factor = derivative(here), factor * (order + 1)
        return found


class Function:
    """Polynomials that interpolate a function of time, which returns a value for each column."""

    breaks = np.empty(0)

    def __init__(self, evaluate, hold):
        self.evaluate, self.hold = evaluate, hold

    def over(self, begin, end):
        if self.hold:
            first = self.evaluate(begin)
            return np.concatenate([[first], np.zeros((ORDER, len(first)))])
        values = np.stack([self.evaluate(begin + (end - begin) * node) for node in NODES])
        return (FROM_NODES @ values) / ((end - begin) ** np.arange(ORDER + 1))[:, None]


class Signals:
    """
    The inputs of an FMU as polynomials of a Table or a Function.

    `variables` and `sizes` are the input variables and their numbers of columns: first the given ones, then derivatives that are inputs, too.
    `moving` lists inputs of prescribed motions.
    """

    def __init__(self, own, source, inputs):
        rates = [(rate, name, order) for name in own for rate, order in _rates(name, own, inputs)]
        self.variables = [inputs[name] for name in (*own, *(rate for rate, _, _ in rates))]
        self.sizes = [_size(variable) for variable in self.variables]
        places = dict(zip(own, np.split(np.arange(sum(self.sizes)), np.cumsum(self.sizes))))
        self.source = source
        self.rates = [(places[name], order) for _, name, order in rates]
        self.moving = [name for name in own if f"der({name})" in inputs]

    @property
    def breaks(self):
        return self.source.breaks

    def over(self, begin, end):
        """Return the coefficients about `begin`, 4 x columns of all variables."""
        own = self.source.over(begin, end)
        parts = [own]
        for places, order in self.rates:
            part = own[:, places]
            for _ in range(order):
                part = derivative(part)
            parts.append(part)
        return np.hstack(parts)

    def breaks_between(self, begin, end, near):
        """Return the breaks between two times; breaks within `near` of an end do not count."""
        return self.breaks[np.searchsorted(self.breaks, begin + near, side="right") : np.searchsorted(self.breaks, end - near, side="left")]

    def as_table(self, start, stop, step):
        """Return a structured array that approximates the inputs by linear pieces, with two rows at a jump, for importers that accept tables only."""
        rows = []
        ends = [start, *self.breaks_between(start, stop, 0.0), stop]
        for begin, end in zip(ends[:-1], ends[1:]):
            parts = np.linspace(begin, end, 1 + int(np.ceil((end - begin) / step - SAME))) if isinstance(self.source, Function) else (begin, end)
            for low, high in zip(parts[:-1], parts[1:]):
                piece = self.over(low, high)
                inner = np.linspace(0.0, high - low, 1 + PIECES) if np.any(piece[2:]) else (0.0, high - low)
                found = [(low + s, *value(piece, s)) for s in inner]
                rows += found[1:] if rows and np.allclose(found[0], rows[-1], rtol=SAME, atol=0.0) else found
        rows, ends = np.array(rows), np.cumsum([1, *self.sizes])
        table = np.empty(len(rows), dtype=[("time", float), *((v.name, float, v.shape or ()) for v in self.variables)])
        table["time"] = rows[:, 0]
        for variable, begin, end in zip(self.variables, ends[:-1], ends[1:]):
            table[variable.name] = rows[:, begin:end].reshape(table[variable.name].shape)
        return table


def _size(variable):
    return int(np.prod(variable.shape)) if variable.shape else 1


def _rates(name, own, inputs):
    """Yield the derivatives of an input that are inputs, too, and are not given, with their order."""
    rate, order = f"der({name})", 1
    while rate in inputs and rate not in own:
        yield rate, order
        rate, order = f"der({rate})", order + 1


def columns_of(data):
    """Return the columns of a table as arrays by name; the index of a DataFrame may be the time."""
    if hasattr(data, "reset_index"):
        data = data if "time" in data.columns else data.reset_index()
        return {str(name): np.asarray(data[name]) for name in data.columns}
    names = data if isinstance(data, Mapping) else data.dtype.names
    return {name: _column(name, data[name]) for name in names}


def _column(name, values):
    try:
        return np.atleast_1d(values)
    except ValueError:
        raise Problem(f"'{name}' of the input has rows of different lengths; expected a number for each time") from None


def _checked(columns):
    """Return the columns as arrays of floats; raise Problem for missing values, wrong lengths or decreasing times."""
    if "time" not in columns:
        raise Problem(f"the input has no 'time' but {', '.join(map(repr, columns))}; expected the times of its rows under this name")
    if np.ndim(columns["time"]) != 1:
        raise Problem(f"'time' of the input has the shape {np.shape(columns['time'])}; expected one time for each row")
    count, found = len(columns["time"]), {}
    for name, values in columns.items():
        if len(values) != count or count == 0:
            raise Problem(f"'{name}' of the input has {len(values)} values and 'time' {count}; expected one for each time")
        try:
            found[name] = np.asarray(values, dtype=float)
        except (TypeError, ValueError):
            raise Problem(f"'{name}' of the input has values that are no numbers; expected finite numbers") from None
        if not np.isfinite(found[name]).all():
            raise Problem(f"'{name}' of the input has values that are missing or infinite; expected finite numbers")
    back = np.flatnonzero(np.diff(found["time"]) < 0)
    if len(back):
        raise Problem(f"the time {found['time'][back[0] + 1]:.15g} s of the input follows {found['time'][back[0]]:.15g} s; expected times that do not decrease")
    return found


def _kind(variable, inputs, hold):
    if hold or variable.type not in REAL or variable.variability in ("discrete", "tunable"):
        return "held"
    return "cubic" if f"der({variable.name})" in inputs else "linear"


def _from_table(data, inputs, description, hold):
    given = _checked(columns_of(data))
    times, columns = given.pop("time"), []
    known(given, list(inputs), description, "is not an input")
    for name, values in given.items():
        values = given[name] = values.reshape(len(times), -1)
        if values.shape[1] != _size(inputs[name]):
            raise Problem(f"'{name}' of the input has {values.shape[1]} values in a row; expected {_size(inputs[name])}")
    for name, values in given.items():
        kind, slopes = _kind(inputs[name], inputs, hold), given.get(f"der({name})")
        columns += [Column(kind, values[:, k], None if slopes is None else slopes[:, k]) for k in range(values.shape[1])]
    return Signals(list(given), Table(times, columns), inputs)


def _finite(numbers, time):
    try:
        found = np.asarray(numbers, dtype=float).ravel()
    except (TypeError, ValueError):
        raise Problem(f"the input at {time:.15g} s is {numbers!r}; expected numbers") from None
    if not np.isfinite(found).all():
        raise Problem(f"the input at {time:.15g} s is {numbers!r}; expected finite numbers")
    return found


def _check_takes_time(function):
    try:
        inspect.signature(function).bind(0.0)
    except ValueError:  # NumPy's functions have no signature
        pass
    except TypeError:
        raise Problem("the function of the input cannot be called with the time alone; expected one such as lambda t: 2*t, or lambda t, sim: -sim['x'] for a controller") from None


def _function_of(data):
    """Return a function of time; a dict of functions and numbers becomes a function that returns a dict."""
    for function in filter(callable, data.values() if isinstance(data, Mapping) else [data]):
        _check_takes_time(function)
    if isinstance(data, Mapping):
        return lambda time: {name: one(time) if callable(one) else one for name, one in data.items()}
    return data


def _from_function(function, inputs, description, start, hold):
    first = function(start)
    if isinstance(first, Mapping):
        own = known(first, list(inputs), description, "is not an input")
        pick = lambda found: [number for name in own for number in np.ravel(found[name])]  # noqa: E731
    else:
        own = [name for name in inputs if not name.startswith("der(")]
        pick = lambda found: found  # noqa: E731
    count, found = sum(_size(inputs[name]) for name in own), len(_finite(pick(first), start))
    if found != count:
        raise Problem(f"the input at {start:.15g} s has {found} numbers; expected {count}, of {', '.join(own) or 'no inputs'}, or a dict of numbers by name")
    return Signals(own, Function(lambda time: _finite(pick(function(time)), time), hold), inputs)


def signals_of(data, description, start=0.0, hold=False):
    """
    Return the Signals of a table or function of the user; raise Problem if they do not fit the FMU's inputs.

    If `hold`, the values of a table are held from row to row, and those of a function over each step.
    """
    inputs = {variable.name: variable for variable in description.modelVariables if variable.causality == "input"}
    if callable(data) or (isinstance(data, Mapping) and "time" not in data and all(callable(one) or np.ndim(one) == 0 for one in data.values())):
        return _from_function(_function_of(data), inputs, description, start, hold)
    if isinstance(data, Mapping) or hasattr(data, "reset_index") or getattr(getattr(data, "dtype", None), "names", None):
        return _from_table(data, inputs, description, hold)
    raise Problem(f"the input is a {type(data).__name__}; {EXPECTED}")
