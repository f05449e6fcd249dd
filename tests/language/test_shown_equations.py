"""
Equations as pages and `lagrange-fmu show` display them: textbook forms, and the same values as the computed form.

The forms are from textbooks, by hand. Values are compared with those of FMUs: the residual of each shown equation, relative to the largest of its
terms, and the energies and outputs.
"""

import html
import importlib
import math
import random
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest
import sympy as sp
from fmpy.fmi2 import FMU2Model

import fmu
from fmu import LAGC, ROOT
from package import assemble, run

sys.path.insert(0, str(ROOT / "scripts"))
listing_of = importlib.import_module("show_equations.listing").listing_of
script_of = importlib.import_module("show_equations.sympy_script").script_of
latex_of = importlib.import_module("show_equations.latex").latex_of
text_of = importlib.import_module("show_equations.text").text_of


def listing(file):
    result = subprocess.run([LAGC, "--equations", file], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    return listing_of(result.stdout)


def system_of_fmu(name):
    return ROOT / "fmu" / name / "system.xml"


def equations(name, heading):
    return [f"{entry.left} = {entry.right}" for entry in listing(system_of_fmu(name)).sections[heading] if hasattr(entry, "left")]


def test_textbook_forms():
    """Goldstein's double pendulum, the pendulum on a cart, the heavy top, and a four-bar linkage."""
    assert equations("DoublePendulum", "Equations of motion") == [
        "(m1 + m2)*l1^2*der(omega1) + m2*l1*l2*cos(theta1 - theta2)*der(omega2) = -m2*l1*l2*omega2^2*sin(theta1 - theta2) - (m1 + m2)*l1*g*sin(theta1)",
        "m2*l1*l2*cos(theta1 - theta2)*der(omega1) + m2*l2^2*der(omega2) = m2*l1*l2*omega1^2*sin(theta1 - theta2) - m2*l2*g*sin(theta2)",
    ]
    assert equations("InvertedPendulumCart", "Equations of motion")[0] == "(M + m)*der(v) + m*l*cos(theta)*der(omega) = m*l*omega^2*sin(theta) + F"
    assert equations("HeavyTop", "Equations of motion")[1] == "(I1 + m*l^2)*der(vtheta) = (I1 - I3 + m*l^2)*vphi^2*sin(theta)*cos(theta) - I3*vphi*vpsi*sin(theta) + m*l*g*sin(theta)"
    assert equations("FourBar", "Constraints") == ["a*cos(theta) + b*cos(phi) - c*cos(psi) - d = 0", "a*sin(theta) + b*sin(phi) - c*sin(psi) = 0"]
    assert equations("BouncingBall", "Equations of motion") == ["m*der(v) - ground.force = -m*g"]


def test_derivation_of_the_double_pendulum():
    """Accelerations by Cramer's rule, and the conserved energy."""
    steps = {entry.left: entry.right for entry in listing(system_of_fmu("DoublePendulum")).sections["Derivation"] if hasattr(entry, "left")}
    assert steps["diff(L, omega2)"] == "m2*l1*l2*omega1*cos(theta1 - theta2) + m2*l2^2*omega2"
    assert steps["M12"] == "m2*l1*l2*cos(theta1 - theta2)" and steps["M11"] == "(m1 + m2)*l1^2"
    assert steps["der(omega1)"].endswith("/(l1*(m2*sin(theta1 - theta2)^2 + m1))")
    assert "E" in steps and not any(left.startswith("p.") for left in steps)


CONSERVED = {"HeavyTop": {"E", "p.phi", "p.psi"}, "DampedPendulum": set(), "SimplePendulum": {"E"}, "RotatingPivotPendulum": set(), "KnifeEdge": {"E", "p.phi"}, "InvertedPendulumCart": set()}


@pytest.mark.parametrize("name", CONSERVED)
def test_conserved_quantities(name):
    shown = listing(system_of_fmu(name)).sections["Derivation"]
    start = next(i for i, entry in enumerate(shown) if getattr(entry, "title", "") == "Conserved quantities")
    assert {entry.left for entry in shown[start:] if hasattr(entry, "left")} == CONSERVED[name]


FREEDOM = {"FourBar": "Degrees of freedom: 1.", "DoublePendulum": "Degrees of freedom: 2.", "PendulumCartesian": "Degrees of freedom: 1.", "RollingDisk": "Degrees of freedom: 3."}


@pytest.mark.parametrize("name", FREEDOM)
def test_degrees_of_freedom(name):
    (text,) = (entry.text for entry in listing(system_of_fmu(name)).sections["Derivation"] if "Degrees of freedom" in getattr(entry, "text", ""))
    assert FREEDOM[name] in text


def random_expression(generator, depth):
    """A random expression of sums, products, powers, and functions of sums of angles."""
    if depth == 0:
        return generator.choice(["a", "b", "x", "y", "v", "w", "2", "3", "0.5"])
    one, other = (random_expression(generator, depth - 1) for _ in range(2))
    angle = generator.choice(["x", "y", "x + y", "x - 2*y", "a*time"])
    return generator.choice([f"({one} + {other})", f"({one} - {other})", f"{one}*{other}", f"({one})*({other})", f"({one})^2", f"{one}/(2 + ({other})^2)", f"sin({angle})*({one})", f"cos({angle})*({one})",
                             f"sqrt(1 + ({one})^2)", f"if({one} > {other}, {one}, {other})", f"abs({one})", f"exp(-({one})^2)"])  # fmt: skip


def evaluated(text, values):
    functions = {name: getattr(math, name) for name in ("sin", "cos", "sqrt", "exp")} | {"abs": abs, "gate": lambda condition, value, other: value if condition else other}
    return eval(re.sub(r"\bif\(", "gate(", text).replace("^", "**"), functions, values)


@pytest.mark.parametrize("seed", range(6))
def test_random_expressions_keep_their_values(seed, tmp_path):
    generator = random.Random(seed)
    formulas = [random_expression(generator, 4) for _ in range(25)]
    outputs = "".join(f'<output name="o{i}">{html.escape(formula)}</output>' for i, formula in enumerate(formulas))
    (tmp_path / "system.xml").write_text(f'<system name="Random"><parameter name="a" start="1"/><parameter name="b" start="1"/><coordinate name="x" velocity="v"/><coordinate name="y" velocity="w"/><kinetic>v^2/2 + w^2/2</kinetic>{outputs}</system>')
    shown = {entry.left: entry.right for entry in listing(tmp_path / "system.xml").sections["Outputs"]}
    for i, formula in enumerate(formulas):
        for _ in range(5):
            values = {name: generator.uniform(-2, 2) for name in ("a", "b", "x", "y", "v", "w", "time")}
            size = max(1.0, *(abs(evaluated(part, values)) for part in (formula, formula.replace(" - ", " + "))))
            assert abs(evaluated(formula, values) - evaluated(shown[f"o{i}"], values)) <= 1e-11 * size, (formula, shown[f"o{i}"])


IDENTITIES = [
    ("cos(x)*cos(y) + sin(x)*sin(y)", "cos(x - y)"),
    ("sin(x)*cos(y) - cos(x)*sin(y)", "sin(x - y)"),
    ("a*cos(x)*cos(y) - a*sin(x)*sin(y)", "a*cos(x + y)"),
    ("b - b*cos(x)^2", "b*sin(x)^2"),
    ("(a*cos(x) + b*cos(y))^2 + (a*sin(x) + b*sin(y))^2", "a^2 + b^2 + 2*a*b*cos(x - y)"),
    ("a*x + b*x", "(a + b)*x"),
    ("b*(x - a)^2", "b*(x - a)^2"),
    ("2*x/3", "2*x/3"),
]


def test_identities(tmp_path):
    outputs = "".join(f'<output name="o{i}">{formula}</output>' for i, (formula, _) in enumerate(IDENTITIES))
    (tmp_path / "system.xml").write_text(f'<system name="Identities"><parameter name="a" start="1"/><parameter name="b" start="1"/><input name="x"/><input name="y"/>{outputs}</system>')
    shown = [entry.right for entry in listing(tmp_path / "system.xml").sections["Outputs"]]
    assert shown == [form for _, form in IDENTITIES]


def terms_of(expression):
    return [sp.sympify(term) for term in sp.Add.make_args(sp.sympify(expression))]


def run_script(text):
    space = {"__name__": "script"}
    exec(text, space)
    return space


def value_of(model, name):
    """Return the value of a variable of any type."""
    kind = next(variable.type for variable in model.description.modelVariables if variable.name == name)
    return float({"Real": model.fmu.getReal, "Integer": model.fmu.getInteger, "Boolean": model.fmu.getBoolean}[kind](model.vr(name))[0])


def put(model, values):
    """Put the model at these values, and let the events happen that they cause."""
    model.put(values)
    if model.description.numberOfEventIndicators:
        model.fmu.enterEventMode()
        model.fmu.newDiscreteStates()
        model.fmu.enterContinuousTimeMode()


def compare(name, file, points=3):
    """Compare the shown equations of a system with its FMU at random points; return the number of comparisons."""
    shown = listing(file)
    script = run_script(script_of(shown))
    model = fmu.Instance(name, FMU2Model)
    known = set(model.references)
    symbols = {str(symbol): symbol for symbol in [*script["values"], *script["accelerations"], *script["multipliers"]]}
    readable = [symbol for symbol in symbols if symbol in known or symbol == "time"]
    pairs = [(f"equation {i}", left, right) for i, (left, right) in enumerate(script["equations"])]
    pairs += [(f"der({state})", sp.Symbol(f"der({state})"), rate) for state, rate in zip(script["states"], script["rates"])]
    pairs += [(variable, sp.Symbol(variable), script[value]) for variable, value in (("kineticEnergy", "kinetic_energy"),) if variable in known]
    pairs += [(entry.left, sp.Symbol(entry.left), script[f"output_{re.sub(chr(92) + 'W+', '_', entry.left).strip('_')}"]) for entry in shown.sections.get("Outputs", []) if hasattr(entry, "left") and entry.left in known]
    generator, count = random.Random(name), 0
    starts = {str(symbol): value for symbol, value in script["values"].items()}
    states = [*script["coordinates"], *script["velocities"], *script["states"]]
    for _ in range(points):
        put(model, {str(state): starts[str(state)] + generator.uniform(-0.05, 0.05) * max(1.0, abs(starts[str(state)])) for state in states})
        for label, left, right in pairs:
            terms = [*terms_of(left), *terms_of(-sp.sympify(right))]
            names = sorted({str(symbol) for term in terms for symbol in term.free_symbols})
            if not set(names) <= {*readable, *known} or any(term.has(sp.core.function.AppliedUndef) for term in terms):
                continue
            values = [0.0 if symbol == "time" else value_of(model, symbol) for symbol in names]
            numbers = sp.lambdify([sp.Symbol(symbol) for symbol in names], terms, "numpy")(*values)
            assert abs(sum(numbers)) <= 1e-12 * max(1e-6, *map(abs, numbers)) * len(numbers), (label, left, right, numbers)
            count += 1
    model.free()
    return count


@pytest.mark.parametrize("name", fmu.small_names())
def test_shown_equations_hold_in_the_fmu(name):
    assert compare(name, system_of_fmu(name)) > 0


@pytest.mark.parametrize("name", ["DoublePendulum", "FourBar", "GantryCrane", "HeavyTop", "ElasticPendulum", "BouncingBall", "PendulumCartesian"])
def test_script_derives_the_accelerations(name):
    """The script for SymPy solves its equations for the accelerations of the FMU at the start."""
    script = run_script(script_of(listing(system_of_fmu(name))))
    model = fmu.Instance(name, FMU2Model)
    put(model, {})
    symbols = [str(symbol) for symbol in script["values"] if str(symbol) in model.references]
    at = script["values"] | {symbol: value_of(model, str(symbol)) for symbol in script["values"] if str(symbol) in symbols}
    found = script["solve"](at)
    for symbol in script["accelerations"]:
        assert float(found[symbol]) == pytest.approx(model.get(str(symbol)), rel=1e-9, abs=1e-9)
    model.free()


def test_scripts_and_texts_of_every_system():
    """Each system has a text of lines that fit, and a script that Python reads."""
    for name in fmu.all_names():
        shown = listing(system_of_fmu(name))
        compile(script_of(shown), name, "exec")
        assert shown.name in text_of(shown)


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="there is no LaTeX")
@pytest.mark.parametrize("name", ["DoublePendulum", "StickSlip", "PidController", "FourBar", "HalfCar"])
def test_latex_is_typeset(name, tmp_path):
    (tmp_path / "shown.tex").write_text(latex_of(listing(system_of_fmu(name))))
    result = subprocess.run(["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "shown.tex"], cwd=tmp_path, capture_output=True, text=True, errors="replace")
    assert result.returncode == 0 and (tmp_path / "shown.pdf").exists(), result.stdout[-2000:]


@pytest.mark.parametrize("name", fmu.small_names())
def test_formulas_of_latex_are_read_by_mathtext(name):
    """Matplotlib, in place of LaTeX, reads each line except for cases, which it does not know."""
    from matplotlib.mathtext import MathTextParser

    parser = MathTextParser("path")
    for block in re.findall(r"\\begin\{align\*\}(.*?)\\end\{align\*\}", latex_of(listing(system_of_fmu(name))), re.S):
        if "cases" not in block:
            for line in block.replace("&", "").split("\\\\\n"):
                parser.parse(f"${line.strip()}$")


def test_the_command(tmp_path):
    """From the package and from the clone; mistakes are lagc's messages."""
    package = assemble(tmp_path / "package")
    file = system_of_fmu("DoublePendulum")
    shown = {words: run(package, "show", file, *words, cwd=tmp_path) for words in ((), ("--latex",), ("--python",))}
    assert all(result.returncode == 0 for result in shown.values())
    assert "cos(theta1 - theta2)*der(omega2)" in shown[()].stdout and r"\cos(\theta_{1} - \theta_{2})" in shown["--latex",].stdout
    assert run_script(shown["--python",].stdout)["accelerations"]
    assert all(len(line) <= 120 for line in shown[()].stdout.splitlines())
    clone = subprocess.run([ROOT / "scripts" / "show", "DoublePendulum"], capture_output=True, text=True)
    assert clone.stdout == shown[()].stdout
    (tmp_path / "wrong.xml").write_text('<system name="wrong"><output name="y">x</output></system>')
    wrong = run(package, "show", tmp_path / "wrong.xml", cwd=tmp_path)
    assert wrong.returncode == 1 and "'x'" in wrong.stderr and "Traceback" not in wrong.stderr
    assert "--linear goes with plain text" in run(package, "show", file, "--latex", "--linear", cwd=tmp_path).stderr
