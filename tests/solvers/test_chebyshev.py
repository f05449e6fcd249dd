"""Chebyshev polynomials of the search for events, from the C code alone, beside those of NumPy."""

import ctypes

import numpy as np
import pytest
from building import functions_of
from numpy.polynomial import chebyshev


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    library = functions_of(tmp_path_factory.mktemp("chebyshev") / "chebyshev.so", "src/runtime/detection/chebyshev.c")
    for name in ("chebyshev_time", "chebyshev_range", "chebyshev_tail", "chebyshev_value"):
        getattr(library, name).restype = ctypes.c_double
    return library


def numbers(*arrays):
    return [array.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for array in arrays]


def test_polynomials(library):
    """Coefficients, bounds, derivatives and values of polynomials of degree 8 at random, from their values at the nodes of an interval."""
    random = np.random.default_rng(1)
    for _ in range(200):
        first, last = np.sort(random.normal(size=2))
        expected, times, found, slope, power = random.normal(size=9), *np.zeros((4, 9))
        library.chebyshev_times(ctypes.c_double(first), ctypes.c_double(last), *numbers(times))
        assert times[0] == last and times[8] == first and library.chebyshev_time(ctypes.c_double(first), ctypes.c_double(last), 3) == times[3]
        places = (2 * times - first - last) / (last - first)
        library.chebyshev_coefficients(*numbers(chebyshev.chebval(np.cos(np.pi * np.arange(9) / 8), expected), found))
        assert places == pytest.approx(np.cos(np.pi * np.arange(9) / 8), abs=1e-9) and found == pytest.approx(expected, abs=1e-14)
        assert library.chebyshev_range(*numbers(found)) == pytest.approx(np.abs(expected[1:]).sum(), rel=1e-13)
        assert library.chebyshev_tail(*numbers(found)) == pytest.approx(np.abs(expected[7:]).sum(), abs=1e-13)
        library.chebyshev_derivative(*numbers(found, slope))
        assert slope[:8] == pytest.approx(chebyshev.chebder(expected), abs=1e-11) and slope[8] == 0
        place, half = random.uniform(-1, 1), 0.5 * (last - first)
        assert library.chebyshev_value(*numbers(found), ctypes.c_double(place)) == pytest.approx(chebyshev.chebval(place, expected), abs=1e-13)
        library.chebyshev_powers(*numbers(found), ctypes.c_double(half), *numbers(power))
        assert power * half ** np.arange(9) == pytest.approx(chebyshev.cheb2poly(expected), abs=1e-11)
