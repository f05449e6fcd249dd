"""
Impulses and forces of contacts with Coulomb friction, from the solvers alone (tests/c/cones.c).

The law is that of chapter 5 of the theory: with u = rate + W p, each contact has u >= 0, p >= 0 and u p = 0. Its friction is at most mu p, and
exactly that against a velocity that is not 0. Problems with a known solution begin with p and u that fulfil the law.
"""

import ctypes

import clarabel
import numpy as np
import pytest
from building import functions_of
from scipy import sparse

SOURCES = [
    "tests/c/cones.c", "src/runtime/support/elimination.c",
    *(f"src/runtime/nonsmooth/cones/{name}.c" for name in ("active_set", "cones", "cone_impulses", "interior/cone_interior", "interior/cone_pairs", "cone_newton", "cone_search", "impulses")),
]  # fmt: skip


@pytest.fixture(scope="module")
def solve(tmp_path_factory):
    """Return a function that returns impulses, or forces at rest, and whether they are found."""
    library = functions_of(tmp_path_factory.mktemp("cones") / "cones.so", *SOURCES)

    def solve(delassus, friction, given, rate, at_rest):
        impulse = np.zeros(len(rate))
        arrays = [np.ascontiguousarray(array) for array in (delassus, friction, given, rate)]
        pointers = [array.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for array in (*arrays, impulse)]
        found = library.solve_cones(ctypes.c_size_t(len(friction)), *pointers[:4], int(at_rest), pointers[4])
        return impulse, bool(found)

    return solve


def tangents(contacts):
    """Return the rows of the two tangents of each contact."""
    return [[contacts + 2 * i, contacts + 2 * i + 1] for i in range(contacts)]


def residual(delassus, friction, given, rate, impulse):
    """Return how far the impulses are from their projections, p = proj(p - u / w), as rates relative to the largest one."""
    behind, size, worst = rate + delassus @ impulse, np.diag(delassus), 0.0
    for i, rows in enumerate(tangents(len(friction))):
        normal = size[i] * impulse[i]
        worst = max(worst, abs(normal - max(0.0, normal - behind[i])))
        scale = size[rows].max()
        trial = scale * impulse[rows] - behind[rows]
        limit = scale * (friction[i] * max(0.0, impulse[i]) + given[2 * i])
        length = np.linalg.norm(trial)
        worst = max(worst, np.abs(scale * impulse[rows] - trial * min(1.0, limit / length if length > 0 else 1.0)).max())
    return worst / max(np.abs(size * impulse).max(), np.abs(rate).max())


def random_delassus(random, contacts, decades=0.0, repeated=False):
    """Return J M^-1 J^T with some couplings; with masses over some decades; with half of the contacts twice."""
    freedoms = random.integers(contacts, 6 * contacts + 2)
    jacobian = random.normal(size=(3 * contacts, freedoms)) * (random.random((3 * contacts, freedoms)) < 0.5)
    empty = np.abs(jacobian).sum(axis=1) == 0
    jacobian[empty] = random.normal(size=(empty.sum(), freedoms))
    for i in range(contacts // 2 if repeated else 0):
        last = contacts - 1 - i
        jacobian[[last, *tangents(contacts)[last]]] = jacobian[[i, *tangents(contacts)[i]]]
    return jacobian / 10 ** random.uniform(-decades / 2, decades / 2, freedoms) @ jacobian.T


def pile_delassus(random, bodies, contacts):
    """Return J M^-1 J^T of solid spheres that touch others, or the ground, in random directions."""
    jacobian = np.zeros((3 * contacts, 6 * bodies))
    for i, rows in enumerate(tangents(contacts)):
        normal = random.normal(size=3)
        normal /= np.linalg.norm(normal)
        one, other = i % bodies, random.integers(-1, bodies)
        for row, direction in zip([i, *rows], [normal, *np.linalg.svd([normal])[2][1:]]):
            column = np.concatenate([direction, np.cross(-normal, direction) * np.sqrt(2.5)])
            jacobian[row, 6 * one : 6 * one + 6] = column
            if other not in (-1, one):
                jacobian[row, 6 * other : 6 * other + 6] = column * np.repeat([-1, 1], 3)
    return jacobian @ jacobian.T


def random_solution(random, friction, given, indifferent=0.0):
    """
    Return impulses and rates behind them that fulfil the law: contacts are open, stick or slide.

    This share of them is indifferent: an open one stays, one that sticks is at its limit, and one that slides has no velocity.
    """
    contacts = len(friction)
    impulse, behind = np.zeros((2, 3 * contacts))
    for i, rows in enumerate(tangents(contacts)):
        mode, angle = random.integers(3), random.uniform(0, 2 * np.pi)
        direction = np.array([np.cos(angle), np.sin(angle)])
        (behind if mode == 0 else impulse)[i] = random.exponential()
        limit = friction[i] * impulse[i] + given[2 * i]
        impulse[rows] = direction * limit * (random.random() if mode == 1 else -1.0)
        behind[rows] = direction * (random.exponential() if mode != 1 else 0.0)
        if random.random() < indifferent:
            behind[[i, *rows]] = 0.0
            impulse[rows] = direction * limit
    return impulse, behind


@pytest.mark.parametrize("at_rest", [False, True])
@pytest.mark.parametrize("contacts, problems", [(1, 1000), (2, 500), (5, 200), (10, 60), (30, 6)])
def test_usual_frictions(solve, contacts, problems, at_rest):
    """With mu up to 1, 99 % of problems that have a solution are solved, 97 % to rounding, half of them with redundant contacts."""
    random, misses, none = np.random.default_rng(contacts), [], np.zeros(2 * contacts)
    for k in range(problems):
        delassus, friction = random_delassus(random, contacts, repeated=k % 2 == 1), random.uniform(0, 1, contacts)
        known, behind = random_solution(random, friction, none)
        delassus /= max(1e-9, np.abs(delassus @ known).max())
        rate = behind - delassus @ known
        assert residual(delassus, friction, none, rate, known) < 1e-14
        impulse, found = solve(delassus, friction, none, rate, at_rest)
        misses.append(residual(delassus, friction, none, rate, impulse) if found else 1.0)
    assert np.quantile(misses, 0.97) < 1e-8 and np.quantile(misses, 0.99) < 1e-4


@pytest.mark.parametrize("at_rest", [False, True])
@pytest.mark.parametrize("bodies, contacts", [(4, 8), (8, 18), (8, 24)])
def test_piles_that_nearly_slip(solve, bodies, contacts, at_rest):
    """Where most contacts are indifferent, 95 % of problems are solved to rounding, though impulses and rates are 0 on either piece of the law."""
    random, misses, none = np.random.default_rng(contacts), [], np.zeros(2 * contacts)
    for _ in range(40):
        delassus, friction = pile_delassus(random, bodies, contacts), np.full(contacts, random.uniform(0.05, 1.0))
        known, behind = random_solution(random, friction, none, 0.7)
        delassus /= np.abs(delassus @ known).max()
        rate = behind - delassus @ known
        impulse, found = solve(delassus, friction, none, rate, at_rest)
        misses.append(residual(delassus, friction, none, rate, impulse) if found else 1.0)
    assert np.quantile(misses, 0.95) < 1e-8


@pytest.mark.parametrize("contacts", [1, 2, 3])
def test_large_frictions_and_light_bodies(solve, contacts):
    """With mu up to 10 and masses over 12 decades, 96 % are solved."""
    random, misses, none = np.random.default_rng(contacts), [], np.zeros(2 * contacts)
    for _ in range(500):
        delassus, friction = random_delassus(random, contacts, decades=12.0), random.uniform(0, 10, contacts)
        known, behind = random_solution(random, friction, none)
        delassus /= max(1e-300, np.abs(delassus @ known).max())
        rate = behind - delassus @ known
        impulse, found = solve(delassus, friction, none, rate, False)
        misses.append(residual(delassus, friction, none, rate, impulse) if found else 1.0)
    assert np.quantile(misses, 0.96) < 1e-4


@pytest.mark.parametrize("at_rest", [False, True])
@pytest.mark.parametrize("contacts", [1, 3, 10, 40, 100])
def test_given_limits(solve, contacts, at_rest):
    """If no limit depends on a contact, the problem is convex, and the rates are unique, with redundant contacts too."""
    random, friction = np.random.default_rng(contacts), np.zeros(contacts)
    for k in range(max(2, 100 // contacts**2)):
        delassus, given = random_delassus(random, contacts, 4.0, k % 2 == 1), np.repeat(random.exponential(size=contacts), 2)
        known, behind = random_solution(random, friction, given)
        delassus /= np.abs(delassus @ known).max()
        impulse, found = solve(delassus, friction, given, behind - delassus @ known, at_rest)
        assert found and np.abs(delassus @ (impulse - known)).max() < 1e-10


def minimum(delassus, given, rate):
    """Return the impulses that minimize p W p / 2 + rate p in the cones of given sizes, by another interior-point method."""
    contacts = len(given) // 2
    rows, bounds = [-np.eye(3 * contacts)[:contacts]], [np.zeros(contacts)]
    for i, pair in enumerate(tangents(contacts)):
        rows.append(np.vstack([np.zeros(3 * contacts), -np.eye(3 * contacts)[pair]]))
        bounds.append(np.array([given[2 * i], 0.0, 0.0]))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    cones = [clarabel.NonnegativeConeT(contacts), *[clarabel.SecondOrderConeT(3)] * contacts]
    triangle = sparse.csc_matrix(np.triu(delassus))
    solver = clarabel.DefaultSolver(triangle, rate, sparse.csc_matrix(np.vstack(rows)), np.concatenate(bounds), cones, settings)
    return np.array(solver.solve().x)


@pytest.mark.parametrize("contacts", [1, 3, 10, 30])
def test_another_solver_of_convex_problems(solve, contacts):
    """Rates at random have no solution that is known; impulses of two methods then make the same rates."""
    random, friction = np.random.default_rng(contacts), np.zeros(contacts)
    for k in range(6):
        delassus, given = random_delassus(random, contacts, repeated=k % 2 == 1), np.repeat(random.exponential(size=contacts), 2)
        rate = np.abs(delassus).max() * delassus @ random.normal(size=3 * contacts) / np.abs(delassus).sum()
        impulse, found = solve(delassus, friction, given, rate, False)
        other = minimum(delassus, given, rate)
        assert found and residual(delassus, friction, given, rate, impulse) < 1e-12
        assert np.abs(delassus @ (impulse - other)).max() < 1e-3 * np.abs(rate).max()
