"""Parts of the report that fail on a machine: the others go on."""

import sys


def failure(what, error):
    """The sentence that takes the place of what failed, also as a warning."""
    sentence = f"Left out, {what}: {error or type(error).__name__}."
    print(f"scripts/report: {sentence}", file=sys.stderr)
    return sentence
