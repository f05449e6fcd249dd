"""The functions that lagc writes, in both forms, called one by one at random points: against SymPy's derivation."""

import subprocess

import mpmath
import numpy as np
import pytest
import sympy as sp

from fmu import BUILD, ROOT, lagc
from mechanics import System, time

# Three coordinates with a sparse block of M, factored at run time and out of order; and one uncoupled coordinate.
TEXT = """<system name="Code">
  <parameter name="a" start="1.5"/><parameter name="b" start="0.7"/><input name="u"/>
  <coordinate name="r" velocity="w"/><coordinate name="q" velocity="v"/><coordinate name="s" velocity="x"/>
  <coordinate name="p" velocity="y" start="1"/>
  <particle mass="a" x="q" y="sin(r)"/>
  <kinetic>(2 + cos(q))*(v - w)^2/2 + w^2/2 + b*(w + x*s)^2/2 + x^2</kinetic>
  <kinetic>exp(p/2)*y^2</kinetic>
  <potential>a*q^4 + 1/(2 + r^2) + sqrt(1 + s^2) + q*r*s*b + p^-2 + a^b*p</potential>
  <force coordinate="q">u*cos(time) - 0.3*v^3</force>
  <force coordinate="s">max(u, r)*abs(x) + sign(q) - x/(3 + v^2) + min(p, u)</force>
  <force coordinate="p">-y*p^-3 + tanh(u*p) + atan2(p, q) - 5*p*time + log(p)*p^1.5</force>
  <output name="o">der(w)*q + sqrt(p)/b - u*v + time^2</output>
  <work/>
  <solver method="{}"/>
</system>"""
q, r, s, p, v, w, x, y, u, a, b = sp.symbols("q r s p v w x y u a b")
FORCES = [
    sp.Integer(0),
    u * sp.cos(time) - sp.Rational(3, 10) * v**3,
    sp.Max(u, r) * sp.Abs(x) + sp.sign(q) - x / (3 + v**2) + sp.Min(p, u),
    -y * p**-3 + sp.tanh(u * p) + sp.atan2(p, q) - 5 * p * time + sp.log(p) * p ** sp.Rational(3, 2),
]
KINETIC = (
    a * (v**2 + (sp.cos(r) * w) ** 2) / 2 + (2 + sp.cos(q)) * (v - w) ** 2 / 2 + w**2 / 2 + b * (w + x * s) ** 2 / 2 + x**2
    + sp.exp(p / 2) * y**2
)  # fmt: skip
POTENTIAL = a * q**4 + 1 / (2 + r**2) + sp.sqrt(1 + s**2) + q * r * s * b + p**-2 + a**b * p
VELOCITIES = [w, v, x, y]
SYSTEM = System([r, q, s, p], VELOCITIES, KINETIC, POTENTIAL, FORCES, [u], [a, b])
POWER = sum(force * velocity for force, velocity in zip(FORCES, VELOCITIES))
OTHERS = sp.lambdify(SYSTEM.arguments, [POWER, KINETIC, POTENTIAL], modules="mpmath")


def derivatives(values):
    """Rates of coordinates, velocities and work, to 40 digits; values: time, state without the work, input and parameters."""
    mass, terms = SYSTEM.precise(*values)
    accelerations = mpmath.matrix(mass) ** -1 * mpmath.matrix([mpmath.fsum(row) for row in terms])
    return [*values[5:9], *accelerations, OTHERS(*values)[0]]


def output(values):
    t, q_, p_, v_, u_, b_ = (values[i] for i in (0, 2, 4, 6, 9, 11))
    return derivatives(values)[4] * q_ + mpmath.sqrt(p_) / b_ - u_ * v_ + t**2


def program(method, form, folder):
    (folder / "system.xml").write_text(TEXT.format(method))
    result = lagc("system.xml", "-o", "out", "--form", form, cwd=folder)
    assert (result.returncode, result.stderr) == (0, "")
    sources = [ROOT / "tests" / "c" / "evaluate.c", folder / "out" / "system.c"]
    flags = ["-O1", f"-I{ROOT}/include", "-include", "lagrangian.h"]
    name = {"taylor": "taylor", "bdf": "bdf"}[method]
    stub = folder / "solver.c"  # links the functions without a solver
    stub.write_text(f"struct Solver {{ int unused; }};\nextern const struct Solver solver_{name};\nconst struct Solver solver_{name} = {{0}};\n"
                    "struct EventLaws { int unused; };\nextern const struct EventLaws event_laws;\nconst struct EventLaws event_laws = {0};\n")
    subprocess.run(["gcc", *flags, *sources, stub, BUILD / "libsolvers.a", "-lm", "-o", folder / "evaluate"], check=True)
    return folder / "evaluate"


@pytest.mark.parametrize("form", ["statements", "tables"])
@pytest.mark.parametrize("method", ["taylor", "bdf"])
def test_functions(method, form, tmp_path):
    executable, random = program(method, form, tmp_path), np.random.default_rng(7)
    for _ in range(3):
        values, direction = random.uniform(0.4, 1.3, 12), random.uniform(-1, 1, 12)
        numbers = [*values[:9], 0.0, *values[9:], *direction[:9], 0.0, *direction[9:]]  # including the work, on which nothing depends
        text = subprocess.run([executable], input=" ".join(map(repr, map(float, numbers))), capture_output=True, text=True, check=True).stdout
        rows = {}
        for name, *row in map(str.split, text.splitlines()):
            rows.setdefault(name, []).append(np.array(row, float))
        with mpmath.workdps(40):
            at, along = ([mpmath.mpf(float(number)) for number in row] for row in (values, direction))
            moved = lambda step, seed: [one + step * other for one, other in zip(at, seed)]
            slope = lambda function, seed: [
                (plus - minus) / mpmath.mpf("2e-12")
                for plus, minus in zip(function(moved(mpmath.mpf("1e-12"), seed)), function(moved(mpmath.mpf("-1e-12"), seed)))
            ]
            near = lambda ours, exact: np.testing.assert_allclose(ours, np.array(exact, float), rtol=1e-12, atol=1e-12)
            near(rows["derivatives"][0], derivatives(at))
            near(rows["directional"][0], slope(derivatives, along))
            near([rows[name][0][0] for name in ("kineticEnergy", "potentialEnergy")], OTHERS(*at)[1:])
            near(rows["totalEnergy"][0], [sum(OTHERS(*at)[1:])])
            near([rows["o"][0][0], rows["along"][0][0]], [output(at), slope(lambda values: [output(values)], along)[0]])
            if method == "bdf":
                units = [[float(i == j + 1) for i in range(12)] for j in range(8)]
                near(rows["jacobian"], [*(slope(derivatives, unit) for unit in units), [0] * 9])
                continue
            near(rows["start"][0], derivatives(at))
            # The series satisfy the equations up to their order; at a step of 1/100 the residual is of order 11.
            step, series = mpmath.mpf("0.01"), [[mpmath.mpf(float(c)) for c in row] for row in rows["series"]]
            state = [mpmath.fsum(c * step**k for k, c in enumerate(row)) for row in series]
            rate = [mpmath.fsum(k * c * step ** (k - 1) for k, c in enumerate(row) if k > 0) for row in series]
            near(np.array(rate, float), derivatives([at[0] + step, *state[:8], *at[9:]]))
