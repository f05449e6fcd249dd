"""Redundant constraints: of all forces that give the motion, those of least norm, against NumPy and closed forms."""

import numpy as np
import pytest

import fmu

# A plate on four parallel rods, two of which are redundant. The constraints have different scales, one of which depends on the state.
PLATE = """
<system name="Plate" description="plate on four parallel rods">
  <parameter name="m" start="2"/><parameter name="J" start="0.7"/><parameter name="g" start="9.81"/>
  <parameter name="R" start="0.8"/>
  <parameter name="a" values="-0.5 -0.1 0.3 0.6"/>
  <input name="F" start="1.5"/><input name="tau" start="-0.6"/>
  <coordinate name="x" velocity="vx"/>
  <coordinate name="y" velocity="vy" start="-0.8"/>
  <coordinate name="f" velocity="vf"/>
  <body name="plate" mass="m" inertia="J" x="x + 0.05*cos(f)" y="y + 0.05*sin(f)" angle="f"/>
  <potential>m*g*plate.y</potential>
  <force coordinate="x">F</force><force coordinate="f">tau</force>
  <for index="i" from="1" to="4">
    <define name="square[i]">(x + a[i]*cos(f) - a[i])^2 + (y + a[i]*sin(f))^2</define>
  </for>
  <constraint name="c1">sqrt(square[1]) - R</constraint>
  <constraint name="c2">square[2] - R^2</constraint>
  <constraint name="c3">(square[3] - R^2)*(1 + 0.3*x)/R</constraint>
  <constraint name="c4">{scale}*(sqrt(square[4]) - R)</constraint>
  <output name="F1">c1.force</output><output name="F2">c2.force</output>
  <output name="F3">c3.force</output><output name="F4">c4.force</output>
  <experiment stopTime="3"/>
</system>
"""
SAME = """
<system name="Same">
  <coordinate name="x" velocity="vx" start="0.8"/><coordinate name="y" velocity="vy" start="-0.6"/>
  <particle mass="1.5" x="x" y="y"/>
  <potential>1.5*9.81*y</potential>
  <constraint name="rod">sqrt(x^2 + y^2) - 1</constraint>
  <constraint name="twin">sqrt(x^2 + y^2) - 1</constraint>
  <constraint name="opposite">1 - sqrt(x^2 + y^2)</constraint>
  <experiment stopTime="2"/>
</system>
"""
# A driven crank turns two wheels, one of which has two constraints.
PRESCRIBED = """
<system name="DrivenTwice">
  <coordinate name="t" velocity="w" velocityStart="2" acceleration="0.5"/>
  <coordinate name="p" velocity="vp"/>
  <kinetic>0.3*vp^2*(1 + 0.2*cos(p))</kinetic>
  <constraint name="gear">p - 2*t</constraint>
  <constraint name="second">3*(p - 2*t)</constraint>
  <experiment stopTime="1"/>
</system>
"""
SCALES = {"Plate": 1.0, "PlateInMillimetres": 1000.0, "PlateInKilometres": 1e-3}
SYSTEMS = {name: PLATE.replace('"Plate"', f'"{name}"').format(scale=scale) for name, scale in SCALES.items()}
SYSTEMS |= {"Same": SAME, "DrivenTwice": PRESCRIBED}
ATTACHED = np.array([-0.5, -0.1, 0.3, 0.6])


@pytest.fixture(scope="module", autouse=True)
def systems():
    fmu.build_systems("redundant", SYSTEMS)
    fmu.build_systems(
        "redundant-tables", {f"{name}T": text.replace(f'"{name}"', f'"{name}T"') for name, text in SYSTEMS.items()}, "--form", "tables"
    )


def least_forces(x, y, vx, vy, scale, m=2.0, g=9.81, J=0.7, R=0.8, F=1.5, tau=-0.6):
    """Forces of least norm at f = 0 and without spin, where the plate moves as a particle: the plate's Newton-Euler equations, by pinv."""
    jacobian = np.array([[x / R, y / R, a * y / R] for a in ATTACHED])  # Jacobian of the distances
    jacobian *= np.array([1, 2 * R, 2 * (1 + 0.3 * x), scale])[:, None]
    angular = (-F / m * y - g * x) / R**2  # p'' with x = R sin(p), y = -R cos(p): R p'' = F/m cos(p) - g sin(p)
    rate = (vx**2 + vy**2) / R**2  # p'^2
    ax, ay = -y * angular - x * rate, x * angular - y * rate
    balance = np.array([F - m * ax, -m * g - m * ay, tau - 0.05 * m * (g + ay)])
    return np.linalg.pinv(jacobian.T, rcond=1e-9) @ balance


def place(angle, rate, R=0.8):
    return {
        "x": R * np.sin(angle), "y": -R * np.cos(angle), "f": 0.0,
        "vx": R * rate * np.cos(angle), "vy": R * rate * np.sin(angle), "vf": 0.0,
    }  # fmt: skip


def expected_at(instance, name):
    return least_forces(*instance.get("x", "y", "vx", "vy"), SCALES[name])


@pytest.mark.parametrize("form", ["", "T"])
@pytest.mark.parametrize("name", SCALES)
def test_forces_at_random_states(name, form, open_fmu):
    random = np.random.default_rng(3)
    for _ in range(10):
        instance = open_fmu(name + form).initialize(place(random.uniform(-1.2, 1.2), random.uniform(-3, 3)))
        expected = expected_at(instance, name)
        np.testing.assert_allclose(instance.get("F1", "F2", "F3", "F4"), expected, rtol=1e-9, atol=1e-9 * max(abs(expected)))
        instance.free()


def test_forces_do_not_jump_in_motion(open_fmu):
    instance = open_fmu("Plate").initialize(place(1.1, 0.5))
    assert sum("is redundant" in text for _, _, text in instance.messages) == 2
    before = None
    for _ in range(300):
        instance.step(0.01)
        forces = np.array(instance.get("F1", "F2", "F3", "F4"))
        np.testing.assert_allclose(forces, expected_at(instance, "Plate"), atol=1e-8)
        assert before is None or np.max(np.abs(forces - before)) < 1.0
        before = forces


@pytest.mark.parametrize("form", ["", "T"])
@pytest.mark.parametrize("name", ["Plate", "PlateInMillimetres"])
def test_directional_derivatives(name, form, open_fmu):
    """Derivatives agree with central differences along directions that keep the constraints satisfied."""
    instance = open_fmu(name + form)
    instance.fmu.setupExperiment()
    instance.fmu.enterInitializationMode()
    states, outputs = list(place(0, 0)), ["F1", "F2", "F3", "F4"]

    def compare(known, seed, change):
        ours = instance.fmu.getDirectionalDerivative(instance.vr(*outputs), instance.vr(*known), seed)
        values = []
        for sign in (1, -1):
            instance.set(change(sign * 1e-5))
            values.append(np.array(instance.get(*outputs)))
        instance.set(change(0.0))
        np.testing.assert_allclose(ours, (values[0] - values[1]) / 2e-5, rtol=1e-6, atol=1e-6)

    for angle, rate in [(0.4, 1.5), (-0.9, -2.0)]:
        instance.set(place(angle, rate))
        slope = [
            (np.array(list(place(angle + 1e-4, rate).values())) - np.array(list(place(angle - 1e-4, rate).values()))) / 2e-4,
            np.array(list(place(angle, 1).values())) - np.array(list(place(angle, 0).values())),
        ]
        compare(states, list(slope[0]), lambda h: place(angle + h, rate))
        compare(states, list(slope[1]), lambda h: place(angle, rate + h))
        compare(["m"], [1.0], lambda h: {"m": 2 + h})
        compare(["tau"], [1.0], lambda h: {"tau": -0.6 + h})


def test_the_same_constraint_twice(open_fmu):
    """Three identical constraints carry a third of m (v^2 - g y) each; the one of opposite sign has the opposite force."""
    instance = open_fmu("Same").initialize()
    for _ in range(20):
        instance.step(0.1)
        y, vx, vy, *forces = instance.get("y", "vx", "vy", "rod.force", "twin.force", "opposite.force")
        np.testing.assert_allclose(forces, 0.5 * (vx**2 + vy**2 - 9.81 * y) * np.array([1, 1, -1]), atol=1e-11)


@pytest.mark.parametrize("form", ["", "T"])
def test_drive_of_a_doubly_constrained_wheel(form, open_fmu):
    """Two constraints share the gear's load 0.6 (1 + 0.2 cos(p)) p'' - 0.06 sin(p) p'^2 as 1 to 3; the drive supplies twice the load."""
    instance = open_fmu("DrivenTwice" + form).initialize()
    for _ in range(5):
        instance.step(0.2)
        p, vp, first, second, drive = instance.get("p", "vp", "gear.force", "second.force", "t.force")
        load = 0.6 * (1 + 0.2 * np.cos(p)) * 1.0 - 0.06 * np.sin(p) * vp**2
        np.testing.assert_allclose([first, second, drive], [-0.1 * load, -0.3 * load, 2 * load], atol=1e-11)
