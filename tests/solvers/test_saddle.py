"""Saddle-point systems of constraints, from the C code alone: forces of redundant constraints, and of open contacts, whose rows are 0."""

import ctypes

import numpy as np
import pytest
from building import functions_of

SOURCES = ["src/runtime/support/saddle.c", "src/runtime/support/ldlt.c"]


@pytest.fixture(scope="module")
def solve(tmp_path_factory):
    """Return a function that returns accelerations a and forces F of least norm: M a + J^T F = b, J a = d."""
    library = functions_of(tmp_path_factory.mktemp("saddle") / "saddle.so", *SOURCES)
    library.saddle_factor.restype = ctypes.c_size_t

    def solve(mass, jacobian, forces, rates, order):
        count, constraints = len(mass) + len(jacobian), len(jacobian)
        matrix = np.block([[mass, jacobian.T], [jacobian, np.zeros((constraints, constraints))]])[np.ix_(order, order)]
        start = np.array([i * (i + 1) // 2 for i in range(count + 1)], dtype=np.uintp)
        column = np.concatenate([np.arange(i + 1) for i in range(count)]).astype(np.uintp)
        places = np.flatnonzero(matrix[np.tril_indices(count)])
        given, elements = matrix[np.tril_indices(count)][places], len(column)
        column = np.concatenate([column, np.searchsorted(places, start), column[places]]).astype(np.uintp)
        coordinate = np.array([i + 1 if i < len(mass) else -1 for i in order], dtype=np.int32)
        packed = elements + count + elements // 2 + 2  # SADDLE_PACKED of saddle.h
        work = np.full(elements + len(given) + 1 + 2 * count + packed + constraints * (constraints + 1) // 2, np.nan)
        work[elements : elements + len(given)] = given
        right = np.zeros(4 * count)
        right[:count] = np.concatenate([forces, rates])[order]
        pattern = [ctypes.c_size_t(count), *(array.ctypes.data_as(ctypes.c_void_p) for array in (start, column))]
        known, values, result = (array.ctypes.data_as(ctypes.c_void_p) for array in (coordinate, work, right))
        assert library.saddle_factor(*pattern, known, values) == 0
        library.saddle_solve(*pattern, values, result)
        library.saddle_least_forces(*pattern, known, values, result)
        solution = np.empty(count)
        solution[order] = right[:count]
        return np.split(solution, [len(mass)])

    return solve


def random_system(random, coordinates, constraints):
    """Return M, and J with rows that repeat, depend on two others or are 0."""
    root = np.tril(random.normal(size=(coordinates, coordinates)) * (random.random((coordinates, coordinates)) < 0.3), -1) + np.eye(coordinates)
    mass = root * 10 ** random.uniform(-1, 1, coordinates) @ root.T
    jacobian = random.normal(size=(constraints, coordinates)) * (random.random((constraints, coordinates)) < 0.5)
    for i in range(2, constraints):
        kind = random.integers(5)
        if kind == 0: jacobian[i] = jacobian[random.integers(i)]
        if kind == 1: jacobian[i] = jacobian[i - 1] - 2 * jacobian[i - 2]
        if kind == 2: jacobian[i] = 0
    return mass, jacobian


@pytest.mark.parametrize("coordinates, constraints", [(1, 1), (3, 2), (6, 12), (12, 10), (20, 40)])
def test_accelerations_and_forces_of_least_norm(solve, coordinates, constraints):
    """Both equations hold, and forces of least norm have no part that the coordinates do not feel: F = J J^+ F."""
    random = np.random.default_rng(coordinates)
    for k in range(100):
        mass, jacobian = random_system(random, coordinates, constraints)
        forces, rates = random.normal(size=coordinates), jacobian @ random.normal(size=coordinates)
        order = np.arange(coordinates + constraints)
        if k % 2 == 1:  # constraints stand among the coordinates, each after its own
            order = order[np.argsort([i if i < coordinates else max(np.flatnonzero(jacobian[i - coordinates]), default=0) + 0.5 for i in order], kind="stable")]
        acceleration, held = solve(mass, jacobian, forces, rates, order)
        size = np.abs(jacobian.T @ held).max() + np.abs(forces).max()
        assert np.abs(mass @ acceleration + jacobian.T @ held - forces).max() < 1e-9 * size
        assert np.abs(jacobian @ acceleration - rates).max() < 1e-9 * max(1, np.abs(acceleration).max())
        assert np.abs(held - jacobian @ (np.linalg.pinv(jacobian) @ held)).max() < 1e-5 * max(1, np.abs(held).max())
