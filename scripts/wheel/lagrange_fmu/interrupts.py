"""End the command without a traceback at Ctrl-C while its modules are imported. Imports nothing that takes long."""

import os
import signal
import sys

COMMAND = "lagrange-fmu"


def is_command():
    """Return True in the process of the command; argv[0] is "-m" while Python imports the package of `python -m`."""
    first = (getattr(sys, "argv", None) or [""])[0]
    return first == "-m" or os.path.splitext(os.path.basename(first))[0] == COMMAND


def _end(*received):
    os._exit(130)


def end_quietly():
    """Let an interrupt end the process: KeyboardInterrupt during imports may be swallowed or replaced by another exception."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)


def raise_again():
    """Let an interrupt raise KeyboardInterrupt again, after end_quietly()."""
    if signal.getsignal(signal.SIGINT) is _end:
        signal.signal(signal.SIGINT, signal.default_int_handler)


if is_command():
    end_quietly()
