"""Print a listing as a LaTeX document, which needs amsmath alone, by the rules of the pages' script, modelDescription/page/mathml.js."""

import ast
import re

from .expression import Expression, is_cut, operands, terms, without_sign
from .listing import Equation, DerivationStep

GREEK = "alpha beta gamma delta epsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau phi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega".split()
UPRIGHT = ("sin", "cos", "tan", "sinh", "cosh", "tanh")  # functions of a name without parentheses
OPERATORS = {*UPRIGHT, "log", "exp", "min", "max"}  # functions that LaTeX knows
DOTS = ("%s", r"\dot{%s}", r"\ddot{%s}")
CALLS = {"der": r"\frac{\mathrm{d}}{\mathrm{d} t} %s", "diff": r"\frac{\partial %s}{\partial %s}", "sqrt": r"\sqrt{%s}", "abs": r"\left| %s \right|"}
LINE = 75  # approximate length of a line of an equation, in characters

# Characters of texts that have a special meaning in LaTeX, or none.
SPECIAL = {"\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "_": r"\_", "^": r"\^{}", "&": r"\&", "%": r"\%", "#": r"\#", "$": r"\$", "~": r"\~{}", "<": "$<$", ">": "$>$",
           "λ": r"$\lambda$", "ω": r"$\omega$", "″": "$''$", "′": "$'$", "ᵀ": r"$^{T}$", "°": r"$^{\circ}$"}  # fmt: skip


def plain(text):
    """Return the text with the special characters of LaTeX escaped."""
    return "".join(SPECIAL.get(letter, letter if letter.isascii() else "?") for letter in text)


def upright(text):
    return rf"\mathrm{{{plain(text)}}}"


def symbol(name, dots=0):
    """Return a name as a base and its indices: theta1 and theta[1] with a number, motor.omega with the part of the system, loop.force as F."""
    part, last = re.fullmatch(r"(?:(.*)\.)?([^.]*)", name).groups()
    word, *bracket = re.split(r"[\[\]]", last)[:2]
    stem, digits = (word, "") if bracket or re.search(r"(^|_)\d+$", word) else re.fullmatch(r"(.*?)(\d*)", word).groups()
    split = re.fullmatch(rf"({'|'.join(GREEK)})([A-Z].*)", stem) or re.fullmatch(r"(.[^_]*)_(.+)", stem)
    base, *index = split.groups() if split else [stem]
    if part and last == "force":
        base = "F"
    letter = DOTS[dots] % (f"\\{base}" if base in GREEK else base if len(base) == 1 else upright(base))
    indices = [text if text[0].isdigit() else upright(text) for text in [*index, digits, *bracket, part] if text]
    return letter + (f"_{{{', '.join(indices)}}}" if indices else "")


def number(value):
    """Return a number in LaTeX, as a ratio if its digits are those of one, as in integrals."""
    mantissa, _, exponent = f"{value!r}".partition("e")
    if len(mantissa) >= 14 and not exponent:
        for below in range(3, 46):
            above = round(value * below)
            if above >= 1 and abs(value * below - above) <= 1e-13 * above:
                return rf"\frac{{{above}}}{{{below}}}"
    return mantissa + (rf" \cdot 10^{{{int(exponent)}}}" if exponent else "")


def fence(text):
    """Return the text in parentheses of its height."""
    return rf"\left({text}\right)" if re.search(r"\\frac|\\begin", text) else f"({text})"


def is_operation(node, *operators):
    return isinstance(node, ast.BinOp) and isinstance(node.op, operators)


def is_sum(node):
    """True for what needs parentheses as a factor or a term."""
    return isinstance(node, (ast.UnaryOp, ast.Compare)) or is_operation(node, ast.Add, ast.Sub) or without_sign(node)[0] == "-"


class Printer:
    def __init__(self, expression, multipliers):
        self.name_of = expression.name
        self.multipliers = multipliers

    def name(self, node):
        name, dots = self.name_of(node), 0
        while name.startswith("der("):
            name, dots = name[4:-1], dots + 1
        return symbol(re.sub("force$", "lambda", name) if name in self.multipliers else name, dots)

    def function(self, node):
        """Return the name of a function, or of a power of a trigonometric one, and its arguments; None for other formulas."""
        is_power = is_operation(node, ast.Pow) and isinstance(node.right, ast.Constant) and isinstance(node.left, ast.Call)
        call = node.left if is_power else node
        word = self.name_of(call.func) if isinstance(call, ast.Call) else ""
        if not word or word in (*CALLS, "if") or (is_power and word not in UPRIGHT):
            return None
        return (f"\\{word}" if word in OPERATORS else rf"\operatorname{{{plain(word)}}}") + (f"^{{{number(node.right.value)}}}" if is_power else ""), call.args

    def is_bare(self, node):
        """True for sin x and its powers, whose argument is a name."""
        function = self.function(node)
        return function is not None and function[0][1:].split("^")[0] in UPRIGHT and isinstance(function[1][0], ast.Name)

    def factor(self, node, is_bare=False):
        """Return a factor or a term, with the parentheses that it needs."""
        function = self.function(node)
        if function is None:
            return fence(self.print(node)) if is_sum(node) else self.print(node)
        arguments = ", ".join(map(self.print, function[1]))
        return function[0] + (f" {arguments}" if is_bare else fence(arguments))

    def product(self, node):
        """Return a product, in which functions stand without parentheses only where no other factor follows."""
        text, factors = "", operands(node, ast.Mult)
        for i, factor in enumerate(factors):
            first = factor
            while is_operation(first, ast.Mult, ast.Div, ast.Pow):
                first = first.left
            times = r" \cdot " if isinstance(first, ast.Constant) else r" \, "
            text += (times if i > 0 else "") + self.factor(factor, all(map(self.is_bare, factors[i:])))
        return text

    def cases(self, node):
        rows = []
        while isinstance(node, ast.Call) and self.name_of(node.func) == "if":
            condition, value, node = node.args
            rows.append(rf"{self.print(value)} & \text{{if }} {self.print(condition)}")
        return r"\begin{cases} " + r" \\ ".join([*rows, rf"{self.print(node)} & \text{{else}}"]) + r" \end{cases}"

    def call(self, node):
        word = self.name_of(node.func)
        return self.cases(node) if word == "if" else CALLS[word] % tuple(map(self.factor if word == "der" else self.print, node.args))

    def print(self, node):
        if isinstance(node, ast.Name):
            return self.name(node)
        if isinstance(node, ast.Constant):
            return number(node.value)
        if isinstance(node, ast.Compare):
            return f"{self.print(node.left)} > {self.print(node.comparators[0])}"
        if is_sum(node):
            return " ".join(self.terms(node))
        if self.function(node):
            return self.factor(node, self.is_bare(node))
        if isinstance(node, ast.Call):
            return self.call(node)
        if isinstance(node.op, ast.Pow):
            base = self.print(node.left)
            return f"{base if isinstance(node.left, (ast.Name, ast.Constant)) or self.function(node.left) else fence(base)}^{{{self.print(node.right)}}}"
        return rf"\frac{{{self.print(node.left)}}}{{{self.print(node.right)}}}" if isinstance(node.op, ast.Div) else self.product(node)

    def terms(self, node):
        """Return the terms with their signs."""
        found = [(sign, self.factor(term, self.is_bare(term))) for sign, term in terms(node)]
        return [("" if sign == "+" else "-") + text if i == 0 else f"{sign} {text}" for i, (sign, text) in enumerate(found)]


def formula(text, multipliers=()):
    """Return the terms of an expression as LaTeX."""
    expression = Expression(text)
    return Printer(expression, multipliers).terms(expression.tree)


def length(part):
    """Return about how many letters of a formula are visible."""
    return len(re.sub(r"\\(left|right|frac|mathrm|operatorname|dot|,)|[{}\\ ]", "", part))


def equation(entry, multipliers):
    """Return an equation, with line breaks between terms."""
    right = formula(entry.right, multipliers)
    lines, room = [], 0
    for part in [*formula(entry.left, multipliers), f"= {right[0]}", *right[1:]]:
        if lines and length(part) <= room:
            lines[-1] += f" {part}"
        else:
            lines.append((r"& \quad " if lines else "& ") + part)
            room = LINE
        room -= length(part)
    return [r"\begin{align*}", " \\\\\n".join(lines), r"\end{align*}"]


def latex_of(listing):
    lines = [r"\documentclass{article}", r"\usepackage{amsmath}", r"\allowdisplaybreaks", r"\begin{document}", rf"\section*{{{plain(listing.name)}}}", plain(listing.description)]
    for heading, entries in listing.sections.items():
        lines += ["", rf"\subsection*{{{plain(heading)}}}"]
        for entry in entries:
            if isinstance(entry, DerivationStep):
                lines += ["", rf"\subsubsection*{{{plain(entry.title)}}}"]
            elif not isinstance(entry, Equation):
                lines += ["", plain(entry.text)]
            elif is_cut(entry.left) or is_cut(entry.right):
                lines += ["", plain(f"{entry.label or entry.left[:60]}: an equation that is too long to be shown.")]
            else:
                lines += ["", rf"\noindent {plain(entry.label)}"] if entry.label else [""]
                lines += equation(entry, listing.multipliers)
    return "\n".join([*lines, "", rf"\medskip\noindent Derived by lagrange-fmu {listing.version}.", r"\end{document}"])
