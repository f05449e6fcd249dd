"""
Quotients and logarithms of exponentials, such as 1/(1 + exp(-x/d)), whose exp overflows beyond 709 d. Each drives a body of its own through the
origin; functions of NumPy that do not overflow give the same motion.
"""

import fmpy
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fmu
from fmu import build_systems, lagc

pytestmark = pytest.mark.long

D = 1e-3
METHODS = ["taylor", "erk", "radau", "bdf", "auto"]


def logistic(u):
    return np.exp(-np.logaddexp(0, -u))


def gompertz(u):
    return np.exp(-np.exp(np.minimum(-u, 600)))


def sech(u):
    return 2 * np.exp(-np.logaddexp(u, -u))


# The acceleration of x by u = x/d, and the same without overflow. Bodies start at -2 m with 3 m/s, and back.
FORCES = {
    "1/(1 + exp(-u))": logistic,
    "-exp(u)/(1 + exp(u))": lambda u: -logistic(u),
    "d*log(1 + exp(u))": lambda u: D * np.logaddexp(0, u),
    "5*d*log(cosh(u))": lambda u: 5 * D * (np.logaddexp(u, -u) - np.log(2)),
    "-log(1 + 3*exp(-u))*d": lambda u: -D * np.logaddexp(0, np.log(3) - u),
    "-1/cosh(u)^2/d": lambda u: -(sech(u) ** 2) / D,
    "(exp(u) - exp(-u))/(exp(u) + exp(-u))": np.tanh,
    "-sinh(u)/cosh(u)": lambda u: -np.tanh(u),
    "k/(2 + c*exp(-u))": lambda u: 5 * logistic(u) / (2 * logistic(u) + 3 * logistic(-u)),
    "exp(-u)/(1 + exp(-u))^2/d": lambda u: logistic(u) * logistic(-u) / D,
    "-1/(2 + exp(u) + exp(2*u))": lambda u: -(logistic(-u) ** 2) / (2 * logistic(-u) ** 2 + logistic(u) * logistic(-u) + logistic(u) ** 2),
    "1/(1 + cosh(u))/d": lambda u: sech(u / 2) ** 2 / 2 / D,
    "1/(1 + 10^(-u))": lambda u: logistic(np.log(10) * u),
    "(1 + 2*exp(u))/(1 + exp(u))": lambda u: 1 + logistic(u),
    "-1/sqrt(1 + exp(-u))": lambda u: -np.sqrt(logistic(u)),
    "exp(u)*exp(-2*u)*exp(u)": np.ones_like,
    "exp(-exp(-u))": gompertz,
    "-exp(-3*exp(u))": lambda u: -np.exp(-3 * np.exp(np.minimum(u, 600))),
    "exp(-u - exp(-u))/d": lambda u: np.exp(-u - np.exp(np.minimum(-u, 600))) / D,
    "tanh(exp(u))": lambda u: np.tanh(np.exp(np.minimum(u, 600))),
    "-atan(2*exp(-u))": lambda u: -np.arctan(2 * np.exp(np.minimum(-u, 600))),
    "exp(-(1 + exp(u))^2)": lambda u: np.exp(-((1 + np.exp(np.minimum(u, 300))) ** 2)),
    "1/(1 + exp(exp(u)))": lambda u: logistic(-np.exp(np.minimum(u, 600))),
    "exp(u)/(1 + exp(2*u))": lambda u: sech(u) / 2,
    "-1/(1 + (1 + exp(u))^2)": lambda u: -1 / (1 + (1 + np.exp(np.minimum(u, 300))) ** 2),
    "1/((1 + exp(u))*(1 + exp(2*u)))": lambda u: logistic(-u) * logistic(-2 * u),
    "(1 + exp(u))^2/(1 + exp(2*u))": lambda u: 1 + sech(u),
    "-1/(1 + (exp(u) + exp(-u))^2)/d": lambda u: -(sech(u) ** 2) / (sech(u) ** 2 + 4) / D,
    "(exp(u) - 1)^2/(exp(u) + 1)^2": lambda u: np.tanh(u / 2) ** 2,
    "exp(-c*exp(-u))*k": lambda u: 5 * np.exp(-3 * np.exp(np.minimum(-u, 600))),
}  # fmt: skip
BODY = '<coordinate name="x{0}" velocity="v{0}" start="{1}" velocityStart="{2}"/><kinetic>v{0}^2/2</kinetic><force coordinate="x{0}">{3}</force>'
LEAVES = [(i, formula, side) for i, formula in enumerate(FORCES) for side in (-1, 1)]
NAMES = [f"x{i}{'l' if side < 0 else 'r'}" for i, _, side in LEAVES]


def system(method):
    bodies = ""
    for name, (_, formula, side) in zip(NAMES, LEAVES):
        text = formula.replace("exp(", "EXP(").replace("u", f"({name}/d)").replace("EXP(", "exp(")
        bodies += BODY.format(name[1:], 2 * side, -3 * side, text)
    parameters = "".join(f'<parameter name="{name}" start="{value}"/>' for name, value in {"d": D, "k": 5, "c": 3}.items())
    return f'<system name="Overflowing{method.title()}">{parameters}{bodies}<solver method="{method}" tolerance="1e-10"/></system>'


# A plate that rises 0.39 m in 1e-4 s throws a body up from its steepest place; an event counts how often it passes 0.3.
THROWN = """<system name="{0}"><mode name="n"/><coordinate name="y" velocity="w" start="0.5"/><particle mass="1" x="y"/><potential>9.81*y</potential>
<contact name="plate" gap="y - 0.5 - 0.39/(1 + exp(-(time - 0.2)/1e-4))"/>
<event when="0.3 - 0.39/(1 + exp(-(time - 0.2)/1e-4))"><set mode="n">n + 1</set></event>
<output name="passed">n</output><solver method="{1}" tolerance="1e-10"/></system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {f"Overflowing{method.title()}": system(method) for method in METHODS}
    texts |= {f"Thrown{method.title()}": THROWN.format(f"Thrown{method.title()}", method) for method in METHODS}
    build_systems("overflowing", texts)


@pytest.fixture(scope="module")
def truth():
    def slope(t, y):
        return np.concatenate([y[len(NAMES) :], [FORCES[formula](y[i] / D) for i, (_, formula, _) in enumerate(LEAVES)]])

    start = [2.0 * side for _, _, side in LEAVES] + [-3.0 * side for _, _, side in LEAVES]
    return solve_ivp(slope, (0, 2), start, method="DOP853", rtol=1e-12, atol=1e-12, max_step=1e-3).y[: len(NAMES), -1]


@pytest.mark.parametrize("steps", [1, 20])
@pytest.mark.parametrize("method", METHODS)
def test_motions(open_fmu, method, steps, truth):
    instance = open_fmu(f"Overflowing{method.title()}").initialize()
    instance.run(2, 2 / steps)
    assert instance.get(*NAMES) == pytest.approx(truth, abs=1e-7)


def test_in_model_exchange(truth):
    archive = str(fmu.archive("OverflowingTaylor"))
    rows = fmpy.simulate_fmu(archive, fmi_type="ModelExchange", stop_time=2, output_interval=2e-3, output=NAMES, relative_tolerance=1e-9)
    assert [rows[-1][name] for name in NAMES] == pytest.approx(truth, abs=1e-5)


def check_thrown(y, passed):
    assert y == pytest.approx(0.5 + 0.195 + 975 * 0.3 - 9.81 * 0.3**2 / 2, abs=1e-4) and passed == 1


@pytest.mark.parametrize("method", METHODS)
def test_a_plate_that_rises(open_fmu, method):
    instance = open_fmu(f"Thrown{method.title()}").initialize()
    instance.run(0.5, 0.1)
    check_thrown(*instance.get("y", "passed"))


def test_a_plate_that_rises_in_model_exchange():
    rows = fmpy.simulate_fmu(str(fmu.archive("ThrownTaylor")), fmi_type="ModelExchange", stop_time=0.5, output_interval=1e-4,
                             output=["y", "passed"], relative_tolerance=1e-9)  # fmt: skip
    check_thrown(rows[-1]["y"], rows[-1]["passed"])
