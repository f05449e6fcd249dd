"""Location of a fault: by its text, or by its text within a function, in any file."""

import functools
import re
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent.parent
FOLDERS = ["src", "modelDescription", "include"]


class Fault(NamedTuple):
    right: str  # unique in all files, ignoring white space
    wrong: str
    test: tuple
    function: str = None


class Location(NamedTuple):
    file: Path  # relative to ROOT
    start: int
    end: int


@functools.cache
def sources():
    """Texts by file, each also without white space."""
    files = sorted(path for folder in FOLDERS for end in "ch" for path in (ROOT / folder).rglob(f"*.{end}"))
    texts = {path.relative_to(ROOT): path.read_text() for path in files}
    return {path: (text, "".join(text.split())) for path, text in texts.items()}


def spans(text, function):
    """Start and end of the definitions of a function; of the whole text without a function."""
    if function is None:
        return [(0, len(text))]
    found = re.finditer(rf"^[A-Za-z][^\n;]*\b{function}\([^;{{}}]*\)\s*\{{.*?^\}}", text, re.MULTILINE | re.DOTALL)
    return [match.span() for match in found]


def locations_of(fault):
    wanted = "".join(fault.right.split())
    for path, (text, squeezed) in sources().items():
        if wanted not in squeezed:
            continue
        for first, last in spans(text, fault.function):
            marks = [i for i in range(first, last) if not text[i].isspace()]
            part = "".join(text[i] for i in marks)
            for match in re.finditer(re.escape(wanted), part):
                yield Location(path, marks[match.start()], marks[match.end() - 1] + 1)


def find(fault):
    """Return the location of a fault; raise LookupError if there is none, or several."""
    locations = list(locations_of(fault))
    if len(locations) == 1:
        return locations[0]
    where = f" in {fault.function}()" if fault.function else ""
    files = ", ".join(sorted({str(location.file) for location in locations})) or "no file"
    raise LookupError(f"{fault.right!r}{where} stands {len(locations)} times, in {files}; expected once (or the name of a function, or more of the text)")
