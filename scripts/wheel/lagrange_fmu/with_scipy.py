"""Raise Problem if SciPy is missing. Modules that use it import this one first."""

from .problem import Problem

try:
    import scipy  # noqa: F401
except ImportError:
    raise Problem("derivatives of motions and fits need SciPy; install it with: pip install 'lagrange-fmu[fit]'") from None
