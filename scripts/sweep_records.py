"""Parse the records of a sweep: values at times, extremes, and events of each run. Also a module of the wheel."""

import math

import numpy as np

from .problem import Problem
from .signals import REAL
from .variables import instead, names_of, nearest

VALUE, MAXIMUM, MINIMUM, EVENTS, FIRST = range(5)  # enum RecordKind of sweep_runs.c
EXTREMES, COUNTS = {".max": MAXIMUM, ".min": MINIMUM}, {".events": EVENTS, ".first": FIRST}
COUNTER = "events"  # variable of the FMU that counts events
FORMS = "NAME.max, NAME.min, NAME@end, NAME@TIME, events, events.first, or of a single contact or friction NAME.events, NAME.first"
SAMPLES = 1000  # for extremes, in a run of an FMU without step size


def items_of(given):
    """Return the list of items of a text such as "height.max,omega@end", or of several such texts."""
    return list(dict.fromkeys(item.strip() for text in names_of(given or [], "record") for item in text.split(",") if item.strip()))


def _split(text, ends):
    """Return the text before a suffix of `ends`, and the value of the suffix; (None, None) if it has none."""
    return next(((text.removesuffix(end), kind) for end, kind in ends.items() if text.endswith(end) and text != end), (None, None))


def _time_of(item, text, stop):
    """Return the time in s that follows the @ of an item; raise Problem if it is not from 0 to `stop`."""
    try:
        time = stop if text == "end" else float(text)
    except ValueError:
        time = math.nan
    if not 0 <= time <= stop:
        raise Problem(f"'{item}' of record has no time from 0 to {stop:g} s; expected NAME@end or NAME@TIME")
    return time


def _check_switching(item, name, description):
    """Raise Problem unless all events of the FMU are those of this contact or friction."""
    names = [v.name for v in description.modelVariables]
    switching = [other for v in names for other, _ in [_split(v, {".closed": 1, ".sliding": 1})] if other]
    if name not in [COUNTER, *switching]:
        raise Problem(f"'{name}' of '{item}' is neither a contact nor a friction of {description.modelName}; {instead(name, [COUNTER, *switching])}")
    others = [other for other in dict.fromkeys(switching) if other != name]
    own = 2 if f"{name}.across.force" in names else 1  # indicators
    if name != COUNTER and (others or description.numberOfEventIndicators > own):
        those = " and ".join(f"'{other}'" for other in others) if 0 < len(others) <= 3 else f"{len(others)} others" if others else "conditions and other expressions"
        total = COUNTER + (item.removeprefix(name) if item.endswith(".first") else "")
        raise Problem(f"the events of '{name}' are not known apart from those of {those} of {description.modelName}; expected {total}, of them all")


def _record(item, reals, counts, stop, description):
    """Return (kind, name, time) of an item; raise Problem if it is unknown."""
    name, separator, at = item.rpartition("@")
    counted, count = _split(item, COUNTS)
    extreme, kind = _split(item, EXTREMES)
    if item in reals:
        return VALUE, item, stop
    if counts and (item == COUNTER or counted is not None):
        _check_switching(item, counted or COUNTER, description)
        return (EVENTS if count is None else count), None, stop
    if separator and name in reals:
        return VALUE, name, _time_of(item, at, stop)
    if extreme in reals:
        return kind, extreme, stop
    near = nearest(item, [f"{real}{end}" for real in reals for end in ("", *EXTREMES, f"@{at}" if separator else "@end")])
    raise Problem(f"'{item}' of record is not known in {description.modelName}; " + (f"did you mean '{near}'?" if near else f"expected {FORMS}, of these: {', '.join(reals)}"))


def records_of(given, description, stop):
    """Return the list of (column, kind, name of a variable or None, time) for the items of --record."""
    reals = [v.name for v in description.modelVariables if v.type in REAL]
    has_counter = any(v.name == COUNTER for v in description.modelVariables)
    found = {f"{item}@end" if item in reals else item: _record(item, reals, has_counter, stop, description) for item in items_of(given)}
    return [(column, *record) for column, record in found.items()]


def times_of(records, description, stop, step):
    """
    Return the ends of the communication steps: equal steps of about the length `step`, or one, and the times of recorded values.

    Extremes are sampled at these times; their step is by default the FMU's step size.
    """
    experiment = description.defaultExperiment
    if step is None and any(kind in (MAXIMUM, MINIMUM) for _, kind, _, _ in records):
        step = float(experiment.stepSize) if experiment and experiment.stepSize else stop / SAMPLES
    steps = max(1, round(stop / step)) if step else 1
    grid = stop * np.arange(1, steps + 1) / steps
    return np.unique([*grid, *(time for _, kind, _, time in records if kind == VALUE and time > 0)])
