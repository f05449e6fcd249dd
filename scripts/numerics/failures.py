"""Report parts of the report that fail, while the others continue."""

import sys


def failure(what, error):
    """Return a sentence in place of the failed part, and print it as a warning."""
    sentence = f"Left out, {what}: {error or type(error).__name__}."
    print(f"scripts/report: {sentence}", file=sys.stderr)
    return sentence
