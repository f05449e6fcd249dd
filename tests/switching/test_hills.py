"""
Event indicators that are flat at the start of a step and have a narrow hill within it. No method misses a hill, in one communication step or many.
"""

import math

import pytest
from fmpy import simulate_fmu

from fmu import archive, build_systems

METHODS = ["taylor", "auto", "radau", "bdf", "erk"]
# Hills of height 1 in s, and their half-widths at half height.
HILLS = {
    "exp(-s^2)": math.sqrt(math.log(2)),
    "1/(1 + s^2)": 1.0,
    "1/cosh(s)": math.acosh(2),
    "(tanh(s + 1) - tanh(s - 1))/(2*tanh(1))": math.acosh(math.sqrt(2 * math.cosh(1) ** 2 - math.sinh(1) ** 2)),
    "cos(w*s/2)^(2*40000)": 2 * math.acos(0.5 ** (1 / 80000)),
    "1/(1 + asinh(s)^2)": math.sinh(1),
    "max(0, 1 - abs(s))": 0.5,
}


def system(name, method):
    """Masses pushed by hills, one after the other in time and along x; events count the hills; a ball meets one."""
    parts = []
    for i, hill in enumerate(HILLS):
        place = "time" if i % 2 == 0 else "x"
        hill = hill.replace("s)", f"s{i})").replace("s^", f"s{i}^").replace("(s ", f"(s{i} ").replace("*s/", f"*s{i}/")
        parts.append(
            f'<define name="s{i}">({place} - {0.31 + 0.05 * i})/w</define><coordinate name="y{i}" velocity="v{i}"/><mode name="n{i}"/><kinetic>v{i}^2/2</kinetic>'
            f'<force coordinate="y{i}">if({hill} &gt; 0.5, 1/w, 0)</force><event when="{hill} - 0.5" direction="rising"><set mode="n{i}">n{i} + 1</set></event>'
        )
    return (
        f'<system name="{name}"><parameter name="w" start="0.1"/><coordinate name="x" velocity="vx" velocityStart="1"/><kinetic>vx^2/2</kinetic>{"".join(parts)}'
        '<coordinate name="a" velocity="va" velocityStart="1"/><coordinate name="b" velocity="vb" start="0.1"/><particle mass="1" x="a" y="b"/>'
        '<contact name="hill" gap="b - 0.5*exp(-((a - 0.6)/w)^2)" restitution="1"/>'
        f'<solver method="{method}" tolerance="1e-8"/></system>'
    )


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("hills", {f"Hills{method}": system(f"Hills{method}", method) for method in METHODS})


@pytest.mark.parametrize("method", METHODS)
def test_no_hill_is_passed_over(method):
    last = len(HILLS)
    for w in (1e-2, 1e-3, 1e-5):
        for steps in (1, 61):
            outputs = [f"{letter}{i}" for i in range(last) for letter in "vn"] + ["va", "vb"]
            result = simulate_fmu(
                archive(f"Hills{method}"), stop_time=1, output_interval=1 / steps, start_values={"w": w}, output=outputs
            )[-1]
            for i, (hill, half) in enumerate(HILLS.items()):
                half = half / w if hill.startswith("cos") else half
                assert result[f"n{i}"] == 1, (hill, w, steps)
                # Rounding of the time is some 1e-16 / w of the width.
                assert result[f"v{i}"] == pytest.approx(2 * half, rel=1e-9, abs=1e-14 / w), (hill, w, steps)
            # The ball meets the slope of the hill at the height 0.1, and is reflected about its normal.
            slope = 2 * 0.1 * math.sqrt(math.log(5)) / w
            rotated = (1 - slope**2) / (1 + slope**2), 2 * slope / (1 + slope**2)
            assert (result["va"], result["vb"]) == pytest.approx(rotated, abs=1e-10), (w, steps)
