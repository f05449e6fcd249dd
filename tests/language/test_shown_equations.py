"""
Equations as pages and `lagrange-fmu show` display them: textbook forms, and the same values as the computed form.

The forms are from textbooks, by hand. Values are compared with those of FMUs: the residual of each shown equation, relative to the largest of its
terms, and the energies and outputs.
"""

import ast
import functools
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
import typeset
from fmu import LAGC, ROOT
from package import assemble, run

sys.path.insert(0, str(ROOT / "scripts" / "library"))
expressions = importlib.import_module("show_equations.expression")
Expression, terms = expressions.Expression, expressions.terms
listing_of = importlib.import_module("show_equations.listing").listing_of
script_of = importlib.import_module("show_equations.sympy_script").script_of
latex = importlib.import_module("show_equations.latex")
latex_of = latex.latex_of
text_of = importlib.import_module("show_equations.text").text_of


@functools.cache
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


@pytest.mark.parametrize("contact", ["", '<contact name="c" gap="1 - x"/>'])
def test_forces_of_frictions_are_one_symbol(contact, tmp_path):
    """Their shares beside the constraints are left out, without contacts too."""
    file = tmp_path / "system.xml"
    file.write_text(f"""<system name="PlaneAndLine"><coordinate name="x" velocity="vx"/><coordinate name="y" velocity="vy"/><particle mass="2" x="x" y="y"/>{contact}
  <friction name="f" velocity="vx" across="vy" force="5"/><friction name="g" velocity="vx" force="3"/></system>""")
    shown = subprocess.run([LAGC, "--equations", file], capture_output=True, text=True, check=True).stdout
    assert "3*g.sliding" in shown and "share" not in shown and "carried" not in shown


def test_derivation_of_the_double_pendulum():
    """Accelerations by Cramer's rule, and the conserved energy."""
    steps = {entry.left: entry.right for entry in listing(system_of_fmu("DoublePendulum")).sections["Derivation"] if hasattr(entry, "left")}
    assert steps["diff(L, omega2)"] == "m2*l1*l2*omega1*cos(theta1 - theta2) + m2*l2^2*omega2"
    assert steps["M12"] == "m2*l1*l2*cos(theta1 - theta2)" and steps["M11"] == "(m1 + m2)*l1^2"
    assert steps["der(omega1)"].endswith("/(l1*(m2*sin(theta1 - theta2)^2 + m1))")
    assert "E" in steps and not any(left.startswith("p[") for left in steps)


CONSERVED = {"HeavyTop": {"E", "p[phi]", "p[psi]"}, "DampedPendulum": set(), "SimplePendulum": {"E"}, "RotatingPivotPendulum": set(), "KnifeEdge": {"E", "p[phi]"}, "InvertedPendulumCart": set()}


@pytest.mark.parametrize("name", CONSERVED)
def test_conserved_quantities(name):
    shown = listing(system_of_fmu(name)).sections["Derivation"]
    start = next(i for i, entry in enumerate(shown) if getattr(entry, "title", "") == "Conserved quantities")
    assert {entry.left for entry in shown[start:] if hasattr(entry, "left")} == CONSERVED[name]


def test_names_of_the_derivation_are_no_variables(tmp_path):
    """A motor's inductance L, resistance R and modulus E keep their names; words replace the Lagrangian's, the reaction's and the energy's."""
    text = """<system name="Named"><parameter name="L" start="1e-3"/><parameter name="R" start="0.8"/><parameter name="E" start="2"/>
    <coordinate name="q" velocity="i"/><coordinate name="x" velocity="v"/><kinetic>L*i^2/2 + R*v^2/2</kinetic><potential>E*q^2/2</potential>
    <constraint name="c">q - x</constraint></system>"""
    (tmp_path / "system.xml").write_text(text)
    sections = listing(tmp_path / "system.xml").sections
    steps = {entry.left: entry.right for entry in sections["Derivation"] if hasattr(entry, "left")}
    assert "The Lagrangian is K - U." in [getattr(entry, "text", "") for entry in sections["Energies"]]
    assert steps["diff(Lagrangian, i)"] == "L*i" and "L" not in steps
    assert "der(diff(Lagrangian, i)) - diff(Lagrangian, q) + reaction" in steps
    assert "energy" in steps and "E" not in steps


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
    ("13*x/168000", "13*x/168000"),
    ("0.0107142857142*x", "0.0107142857142*x"),
    ("4e-5*x", "4e-05*x"),
    ("cos(x)*cos(x + y) + sin(x)*sin(x + y)", "cos(y)"),
    ("0.1*x + 0.2*x - 0.3*x + y", "y"),
    ("(0.1*x + 0.2*y)*(0.1*x - 0.2*y) - 0.01*x^2", "-0.04*y^2"),
]


def test_identities(tmp_path):
    outputs = "".join(f'<output name="o{i}">{formula}</output>' for i, (formula, _) in enumerate(IDENTITIES))
    (tmp_path / "system.xml").write_text(f'<system name="Identities"><parameter name="a" start="1"/><parameter name="b" start="1"/><input name="x"/><input name="y"/>{outputs}</system>')
    shown = [entry.right for entry in listing(tmp_path / "system.xml").sections["Outputs"]]
    assert shown == [form for _, form in IDENTITIES]


def test_mass_of_a_beam():
    """The consistent mass of a node between two of Hermite's cubics of the length L/20 (Przemieniecki: Theory of Matrix Structural Analysis, 1968)."""
    motion = next(text for text in equations("HangingCable", "Equations of motion") if "rhoA*der(vx[2])" in text and "der(vx[1])" in text and "der(vx[3])" in text)
    assert motion.split(" = ")[0].count("der(") == 5  # not of its own slope, of which the parts of both elements cancel
    assert all(term in motion for term in ("13*L*rhoA*der(vx[2])/350", "9*L*rhoA*der(vx[1])/1400", "13*L^2*rhoA*der(wx[1])/168000")), motion[:400]


def run_script(text):
    space = {"__name__": "script"}
    exec(text, space)
    return space


def value_of(model, name):
    """Return the value of a variable of any type."""
    kind = next(variable.type for variable in model.description.modelVariables if variable.name == name)
    return float({"Real": model.fmu.getReal, "Integer": model.fmu.getInteger, "Boolean": model.fmu.getBoolean}[kind](model.vr(name))[0])


def put(model, values, time=0.0):
    """Put the model at these values, and let the events happen that they cause."""
    model.put(values, time)
    if model.description.numberOfEventIndicators:
        model.fmu.enterEventMode()
        model.fmu.newDiscreteStates()
        model.fmu.enterContinuousTimeMode()


FUNCTIONS = typeset.FUNCTIONS | {"if": typeset.FUNCTIONS["gate"], "erf": math.erf, "floor": math.floor}


class Shown:
    """Values of shown texts by Python, from the variables of an FMU and the definitions on its page."""

    def __init__(self, model, shown, time):
        self.model, self.time, self.known = model, time, {}
        self.definitions = {entry.left: entry.right for heading in ("Calculated parameters", "Definitions") for entry in shown.sections.get(heading, []) if hasattr(entry, "left")}

    def named(self, name):
        if name in FUNCTIONS:
            return FUNCTIONS[name]
        if name not in self.known:
            self.known[name] = self.value(name)
        return self.known[name]

    def value(self, name):
        if name == "time":
            return self.time
        if name in self.definitions:
            return sum(self.terms(self.definitions[name]))
        velocity, _, suffix = name.rpartition(".")
        return float(value_of(self.model, velocity) != 0) if suffix == "moves" else value_of(self.model, name)

    def terms(self, text):
        """Return the values of the terms of a sum."""
        expression = Expression(text)
        values = {f"n{i}": self.named(name) for i, name in enumerate(expression.names)}
        evaluate = lambda tree: eval(compile(ast.fix_missing_locations(ast.Expression(tree)), "shown", "eval"), {}, values)
        return [float(evaluate(term)) * (-1 if sign == "-" else 1) for sign, term in terms(expression.tree)]


def equations_of(shown):
    """
    Yield (label, left, right) of the shown equations that have a value in the FMU: motion, rates, outputs, accelerations, and energies. A U with
    velocities is left out, as it is not potentialEnergy.
    """
    has_velocities = any("v dU/dv" in getattr(entry, "text", "") for entry in shown.sections.get("Energies", []))
    energies = {"K": "kineticEnergy"} | ({} if has_velocities else {"U": "potentialEnergy"})
    for entry in shown.sections.get("Equations of motion", []):
        if hasattr(entry, "left"):
            yield entry.label, entry.left, entry.right
    for heading in ("States", "Energies", "Outputs", "Derivation"):
        for entry in shown.sections.get(heading, []):
            left = energies.get(entry.left, entry.left) if hasattr(entry, "left") else ""
            if left in energies.values() or re.fullmatch(r"der\([\w\[\]]+\)", left) or heading == "Outputs":
                yield left, left, entry.right


# With redundant constraints the FMU evaluates at the nearest state that fulfils them: these are compared at the start.
REDUNDANT = {"Bricard"}


def compare(name, points=3):
    """Compare the shown equations of a system with its FMU at random times and points, except for those that are cut; return their number."""
    shown, model = listing(system_of_fmu(name)), fmu.Instance(name, FMU2Model)
    generator, rows = random.Random(name), [row for row in equations_of(shown) if not any("..." in text for text in row)]
    starts = {variable.name: variable.start for kind in ("coordinate", "velocity", "state") for variable in shown.variables[kind]}
    spread = 0.0 if name in REDUNDANT else 0.05
    with np.errstate(all="ignore"):
        for _ in range(points):
            time = generator.uniform(0, 2) if model.description.numberOfEventIndicators == 0 else 0.0
            put(model, {state: start + spread * generator.uniform(-1, 1) * max(1.0, abs(start)) for state, start in starts.items()}, time)
            values = Shown(model, shown, time)
            for label, left, right in rows:
                numbers = [*values.terms(left), *(-number for number in values.terms(right))]
                assert abs(sum(numbers)) <= 1e-11 * max(1e-6, *map(abs, numbers)) * len(numbers), (label, left, right, numbers)
    model.free()
    return len(rows)


@pytest.mark.parametrize("name", fmu.all_names())
def test_shown_equations_hold_in_the_fmu(name):
    assert compare(name, points=3 if name in fmu.small_names() else 1) > 0


@pytest.mark.parametrize("name", fmu.all_names())
def test_pages_show_the_listing(name):
    """The texts of the FMU's page, except for steps that are too long, are those of `lagc --equations`."""
    page = (fmu.unpacked(name) / "documentation" / "index.html").read_text()
    shown = [f"{entry.left} = {entry.right}" for section in listing(system_of_fmu(name)).sections.values() for entry in section if hasattr(entry, "left")]
    on_page = [html.unescape(text) for text in re.findall("<code[^>]*>(.*?)</code>", page, re.S)]
    assert on_page == [text for text in shown if text in set(on_page) or not text.endswith("= ...")]


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


FORMS = [
    ("x[1]^2*b_end^(-a)", r"x_{1}^{2} \, b_{\mathrm{end}}^{-a}"),
    ("sin(a)^2", r"\sin^{2} a"),
    ("sin(a)^b_end", r"\sin(a)^{b_{\mathrm{end}}}"),
    ("sin(a)^3*cos(a)", r"\sin^{3} a \, \cos a"),
    ("time*sin(a - b_end)^2*cos(a)", r"t \, \sin^{2}(a - b_{\mathrm{end}}) \, \cos a"),
    ("sin(b_end)*cos(a)/2", r"\frac{\sin b_{\mathrm{end}} \, \cos a}{2}"),
    ("a*sin(b_end)*exp(time)", r"a \, \sin(b_{\mathrm{end}}) \, \exp(t)"),
    ("omegaCoupler*XiTop/Pi2 - x[1]", r"\frac{\omega_{\mathrm{Coupler}} \, \Xi_{\mathrm{Top}}}{\Pi_{2}} - x_{1}"),
    ("v_max_1 + thetaArm2 + w_2", r"v_{\mathrm{max\_1}} + \theta_{\mathrm{Arm}, 2} + w_{2}"),
    ("atan2(a, -b_end)", r"\operatorname{atan2}(a, -b_{\mathrm{end}})"),
    ("max(a, 1/b_end)", r"\max\left(a, \frac{1}{b_{\mathrm{end}}}\right)"),
    ("-(1 + a)^2/(b_end*(a - 2))", r"-\frac{(1 + a)^{2}}{b_{\mathrm{end}} \, (a - 2)}"),
    ("(1 + a - b_end)^(1 + a)", r"(1 + a - b_{\mathrm{end}})^{1 + a}"),
    ("a^(1/b_end)", r"a^{\frac{1}{b_{\mathrm{end}}}}"),
    ("-3e-07*a", r"-3 \cdot 10^{-7} \, a"),
    ("3*2^a", r"3 \cdot 2^{a}"),
    ("2*XiTop/21", r"\frac{2 \, \Xi_{\mathrm{Top}}}{21}"),
    ("sqrt(abs(a))/3", r"\frac{\sqrt{\left|a\right|}}{3}"),
    ("a*if(b_end > 0, a, if(time > 0, a/2, -b_end))",
     r"a \, \begin{cases} a & \text{if } b_{\mathrm{end}} > 0 \\ \frac{a}{2} & \text{if } t > 0 \\ -b_{\mathrm{end}} & \text{else} \end{cases}"),
]  # fmt: skip


def test_forms_of_latex(tmp_path):
    """Names with indices, ratios, powers, signs, parentheses, functions and cases, as a textbook prints them."""
    names = ("a", "b_end", "omegaCoupler", "XiTop", "Pi2", "x[1]", "v_max_1", "thetaArm2", "w_2")
    inputs = "".join(f'<input name="{name}"/>' for name in names)
    outputs = "".join(f'<output name="y_{i}">{html.escape(formula)}</output>' for i, (formula, _) in enumerate(FORMS))
    (tmp_path / "system.xml").write_text(f'<system name="Forms">{inputs}{outputs}</system>')
    shown = listing(tmp_path / "system.xml").sections["Outputs"]
    assert [(entry.right, entry.latex) for entry in shown] == [(formula, f"y_{{{i}}} = {form}") for i, (formula, form) in enumerate(FORMS)]


def test_latex_of_motion(tmp_path):
    """Derivatives have dots, and the force of a constraint is a multiplier with its name."""
    shown = listing(system_of_fmu("BouncingBall")).sections
    assert shown["Equations of motion"][0].latex == r"m \, \dot{v} - \lambda_{\mathrm{ground}} = -m \, g"
    steps = {entry.left: entry.latex for entry in listing(system_of_fmu("SimplePendulum")).sections["Derivation"] if hasattr(entry, "left")}
    assert steps["diff(L, omega)"] == r"\frac{\partial L}{\partial \omega} = m \, l^{2} \, \omega"
    assert steps["der(diff(L, omega))"] == r"\frac{\mathrm{d}}{\mathrm{d} t} \frac{\partial L}{\partial \omega} = m \, l^{2} \, \dot{\omega}"


def test_equations_of_latex_break_between_terms():
    assert latex.equation(r"\dot{v} = -a \, (b + c) - \frac{b - a}{c}") == [r"\begin{align*}", r"& \dot{v} = -a \, (b + c) - \frac{b - a}{c}", r"\end{align*}"]
    terms = [rf"{i} \, \sin({letter * 9} - 1)" for i, letter in enumerate("abcdef")]
    lines = latex.equation("y = " + " + ".join(terms))[1].split(" \\\\\n")
    assert lines == ["& y = " + " + ".join(terms[:4]), r"& \quad + " + " + ".join(terms[4:])]


def test_the_command(tmp_path):
    """The command works from the package and from the clone. Mistakes give lagc's messages."""
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
