"""Load FMUs by FMPy without effect on the working directory. Also a module of the wheel."""

import os
import threading
from contextlib import contextmanager

_one_at_a_time = threading.RLock()


@contextmanager
def loading():
    """
    Restore the working directory at the end; threads wait for each other.

    FMPy changes it for the whole process while it loads a library, and does not restore it if that fails.
    """
    with _one_at_a_time:
        folder = os.getcwd()
        try:
            yield
        finally:
            os.chdir(folder)
