"""Parse the records of a sweep: values at times, extremes, and events of each run. Also a module of the wheel."""

import math
import zipfile

import numpy as np

from ..problem import Problem
from ..signals import REAL
from ..variables import suggestion, names_of, nearest

VALUE, MAXIMUM, MINIMUM, EVENTS, FIRST, EVENTS_OF, FIRST_OF = range(7)  # enum RecordKind of single_runs.c
EXTREMES, COUNTS = {".max": MAXIMUM, ".min": MINIMUM}, {".events": EVENTS_OF, ".first": FIRST_OF}
SWITCHES = "and what switches"  # in the description of the log category logEvents
OF_ALL = {"events": EVENTS, "events.first": FIRST}
COUNTER = "events"  # variable of the FMU that counts events
FORMS = "NAME.max, NAME.min, NAME@end, NAME@TIME, events, events.first, or of a contact or friction NAME.events, NAME.first"
SAMPLES = 1000  # samples for extremes, in a run of an FMU without step size


def items_of(given):
    """Return the list of items of a text such as "height.max,omega@end", or of several such texts."""
    return list(dict.fromkeys(item.strip() for text in names_of([] if given is None else given, "record") for item in text.split(",") if item.strip()))


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
    """Raise Problem unless the FMU has a contact or friction of this name, and reports its events."""
    switching = [other for v in description.modelVariables for other, _ in [_split(v.name, {".closed": 1, ".sliding": 1})] if other]
    if name not in switching:
        raise Problem(f"'{name}' of '{item}' is neither a contact nor a friction of {description.modelName}; {suggestion(name, [COUNTER, *switching])}")


def check_log(path, records):
    """Raise Problem if the log of an FMU does not name what switches, which records of single contacts and frictions need."""
    with zipfile.ZipFile(path) as archive:
        is_silent = SWITCHES not in archive.read("modelDescription.xml").decode()
    if is_silent and any(kind >= EVENTS_OF for _, kind, _, _ in records):
        raise Problem(f"{path} does not report which contact or friction switches; expected an FMU that is built anew, or --record {COUNTER}")


def _record(item, reals, counts, stop, description):
    """Return (kind, name, time) of an item; raise Problem if it is unknown."""
    name, separator, at = item.rpartition("@")
    counted, count = _split(item, COUNTS)
    extreme, kind = _split(item, EXTREMES)
    if item in reals:
        return VALUE, item, stop
    if counts and item in OF_ALL:
        return OF_ALL[item], None, stop
    if counts and counted is not None:
        _check_switching(item, counted, description)
        return count, counted, stop
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
