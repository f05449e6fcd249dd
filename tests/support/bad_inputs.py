"""
Inputs that lagc rejects, or about which it warns, one file each.

The last line of a file is a comment with the line and the message that lagc must report: `<!-- 3: unknown name 'G'; did you mean ... -->`. The
message may have more words before it, and three dots stand for any text. The comment is removed before lagc reads the file.
"""

import re
from pathlib import Path

import pytest

from fmu import ROOT, lagc


def inputs(folder):
    """The mark that runs a test for each file of a folder below tests/."""
    files = sorted((ROOT / "tests" / folder).iterdir())
    return pytest.mark.parametrize("file", files, ids=[file.stem for file in files])


def expected_of(file):
    """Return the text of a file without its last line, and from that line the number and the pattern of the message."""
    text, comment = file.read_text().rstrip("\n").rsplit("\n", 1)
    line, message = re.fullmatch(r"<!-- (\d+): (.*) -->", comment).groups()
    return text, line, ".*".join(map(re.escape, message.split("...")))


def run(text, name, folder):
    Path(folder, name).write_text(text)
    return lagc(name, "-o", "out", cwd=folder)


def check_error(file, name, folder):
    """lagc reports the expected error first, and leaves no output. Returns all lines that it prints."""
    text, line, pattern = expected_of(file)
    result = run(text, name, folder)
    first = next((message for message in result.stderr.splitlines() if ": warning: " not in message), "")
    assert result.returncode == 1 and re.fullmatch(f"{name}:{line}: .*{pattern}", first), result.stderr
    # The words of libxml2 and of its schemas never reach users.
    assert not re.search("facet|atomic type|Element '|content type|cvc|Expected is|xs:", result.stderr)
    assert not (folder / "out").exists() and result.stdout == ""
    return result.stderr.splitlines()


def check_warning(file, name, folder):
    """lagc reports the expected warning alone, and writes the sources of the FMU."""
    text, line, pattern = expected_of(file)
    result = run(text, name, folder)
    assert result.returncode == 0 and re.fullmatch(f"{name}:{line}: warning: .*{pattern}\n", result.stderr), result.stderr
    assert (folder / "out" / "system.c").exists()
