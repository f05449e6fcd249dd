"""The rope against forces written by hand, its catenary, and the modes of a hanging rope in closed form."""

import numpy as np
import pytest
from scipy.optimize import root
from scipy.special import j0, jn_zeros

import fmu
from rope import MASSES, START, D, L, N, accelerations
from test_derivation import TOLERANCE

FEW = 20  # links of a short rope


def names(letter, n=N):
    return [f"{letter}[{i}]" for i in range(1, n + 1)]


def start_values(places, x="x", y="y"):
    return {name: value for k, letter in enumerate((x, y)) for name, value in zip(names(letter, len(places)), places[:, k])}


def places_of(instance, n=N):
    return np.column_stack([instance.get(*names("x", n)), instance.get(*names("y", n))])


def test_accelerations(open_fmu):
    instance, random = open_fmu("Rope"), np.random.default_rng(7)
    for _ in range(10):
        p = {name: value * random.uniform(0.5, 2) for name, value in (START | dict(kEnd=50.0, yEnd=0.3)).items()}
        places = np.cumsum(D * random.normal(size=(N, 2)), axis=0)
        velocities = random.normal(size=(N, 2))
        instance.reset().initialize(p | start_values(places) | start_values(velocities, "vx", "vy"))
        ours = np.column_stack([instance.get(*(f"der({name})" for name in names(v))) for v in ("vx", "vy")])
        exact = accelerations(p, places, velocities)
        assert np.max(np.abs(ours - exact)) <= 10 * TOLERANCE * np.max(np.abs(exact))


def test_energy_balance(open_fmu):
    """The energy decreases by the work of internal damping and drag."""
    instance = open_fmu("Rope").initialize(tolerance=1e-7)
    rows = np.array(instance.run(0.5, 0.1, "totalEnergy", "nonConservativeWork", "kineticEnergy"))
    assert rows[-1, 2] < -1e-4 and rows[-1, 3] > 0.1
    assert np.ptp(rows[:, 1] - rows[:, 2]) < 1e-5


@pytest.fixture(scope="module")
def short_rope():
    """A rope of few links, which comes to rest fast."""
    text = (fmu.ROOT / "fmu" / "Rope" / "system.xml").read_text()
    text = text.replace('name="Rope"', f'name="RopeOf{FEW}"').replace('name="N" value="200"', f'name="N" value="{FEW}"')
    fmu.build_systems("rope", {f"RopeOf{FEW}": text})
    return f"RopeOf{FEW}"


def catenary(p, n):
    """Positions of the masses in equilibrium without bending, and the tension at the upper end."""
    weight, d = p["M"] * p["g"] / n, L / n

    def shape(unknown):
        pull = np.column_stack([np.full(n, unknown[0]), unknown[1] + weight * np.arange(n)])
        size = np.hypot(*pull.T)[:, None]
        return np.cumsum(d * (1 + size / p["EA"]) * pull / size, axis=0), pull, size

    def imbalance(unknown):
        places, pull, _ = shape(unknown)
        return p["kEnd"] * (np.array([p["xEnd"], p["yEnd"]]) - places[-1]) - pull[-1] - [0, weight / 2]

    places, _, size = shape(root(imbalance, [0.3, -1.0], tol=1e-13).x)
    return places, size[0, 0]


@pytest.mark.parametrize("end", [dict(xEnd=1.0, yEnd=0.0), dict(xEnd=1.5, yEnd=-0.4)])
def test_catenary(end, short_rope, open_fmu):
    """Released beside it, the rope with both ends fixed comes to rest in the catenary of its masses."""
    p = START | end | dict(EI=0.0, kEnd=1e4, EA=1e3, b=1.0)
    places, tension = catenary(p, FEW)
    assert np.abs(places[-1] - [end["xEnd"], end["yEnd"]]).max() < 1e-3
    bump = 0.05 * np.sin(np.pi * np.arange(1, FEW + 1) / FEW)[:, None]
    instance = open_fmu(short_rope).initialize(p | start_values(places + bump), tolerance=1e-6)
    instance.step(12.0)
    np.testing.assert_allclose(places_of(instance, FEW), places, atol=1e-6)
    assert instance.get("tension") == pytest.approx(tension, rel=1e-5)


@pytest.mark.parametrize("mode", [1, 2, 3])
def test_small_swings(mode, open_fmu):
    """x = J0(j sqrt(1 - s / L)) cos(j / 2 sqrt(g / L) t) for the zeros j of J0 (D. Bernoulli), up to the error of lumped masses."""
    p = START | dict(EI=0.0, b=0.0, EA=1e6)
    s, zero, width = D * np.arange(1, N + 1), jn_zeros(0, mode)[-1], 1e-3
    shape = width * j0(zero * np.sqrt(1 - s / L))
    below = np.cumsum(MASSES[::-1])[::-1]
    places = np.column_stack([shape, -np.cumsum(D * (1 + p["M"] * p["g"] * below / p["EA"]))])
    frequency = zero / 2 * np.sqrt(p["g"] / L)
    instance = open_fmu("Rope").initialize(p | start_values(places), tolerance=1e-8)
    half = np.pi / frequency
    for t, sign in ((half / 2, 0), (half, -1), (2 * half, 1)):
        instance.step(t - instance.time)
        np.testing.assert_allclose(places_of(instance)[:, 0], sign * shape, atol=5e-4 * mode**2 * width)
