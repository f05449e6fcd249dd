"""Print a listing as a LaTeX document, which needs amsmath alone."""

import ast
import re

from .expression import Expression, is_cut, operands, terms, without_sign
from .listing import Equation, Step

GREEK = "alpha beta gamma delta epsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau phi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega".split()
FUNCTIONS = {"sin", "cos", "tan", "sinh", "cosh", "tanh", "log", "exp", "min", "max"}
LINE = 75  # characters of a line of an equation, about

# Characters of texts that have a special meaning in LaTeX, or none.
SPECIAL = {"\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "_": r"\_", "^": r"\^{}", "&": r"\&", "%": r"\%", "#": r"\#", "$": r"\$", "~": r"\~{}", "<": "$<$", ">": "$>$",
           "λ": r"$\lambda$", "ω": r"$\omega$", "″": "$''$", "′": "$'$", "ᵀ": r"$^{T}$", "°": r"$^{\circ}$"}  # fmt: skip


def plain(text):
    """Return the text with the special characters of LaTeX escaped."""
    return "".join(SPECIAL.get(letter, letter if letter.isascii() else "?") for letter in text)


def letters(word):
    """Return a word as a symbol: a Greek letter, one letter, or upright letters."""
    if word in GREEK:
        return f"\\{word}"
    return plain(word) if len(word) == 1 else rf"\mathrm{{{plain(word)}}}"


def symbol(name, dots=0):
    """Return a name as in print: theta1 and theta[1] with an index, motor.omega with that of its part."""
    *part, last = re.split(r"\.(?![^\[]*\])", name)
    word, bracket = re.fullmatch(r"([^\[]*)((?:\[.*\])?)", last).groups()
    word, number = re.fullmatch(r"(.*?)(\d*)", word).groups() if not bracket else (word, "")
    if not word or word.endswith("_"):
        word, number = word + number, ""
    indices = [number, bracket.strip("[]")]
    camel = re.fullmatch(rf"({'|'.join(sorted(GREEK, key=len, reverse=True))})([A-Z].*)", word)
    base, *index = camel.groups() if camel else word.split("_", 1) if "_" in word[1:-1] else [word]
    indices = [rf"\mathrm{{{plain(text)}}}" if not text.isdigit() else text for text in [*index, *indices, ".".join(part)] if text]
    accent = ("", r"\dot{%s}", r"\ddot{%s}")[dots]
    base = accent % letters(base) if dots else letters(base)
    return base + (f"_{{{', '.join(indices)}}}" if indices else "")


def fence(text):
    """Return the text in parentheses of its height."""
    return rf"\left({text}\right)" if re.search(r"\\frac|\\begin", text) else f"({text})"


class Printer:
    def __init__(self, expression, multipliers):
        self.expression = expression
        self.multipliers = multipliers
        self.bare = True

    def name(self, node):
        name = self.expression.name(node)
        dots = 0
        while name.startswith("der("):
            name, dots = name[4:-1], dots + 1
        if name in self.multipliers:
            return rf"\lambda_{{\mathrm{{{plain(self.multipliers[name])}}}}}"
        return symbol(name, dots)

    def number(self, value):
        mantissa, _, exponent = f"{value!r}".partition("e")
        return mantissa + (rf"\cdot 10^{{{int(exponent)}}}" if exponent else "")

    def fenced(self, node, needed):
        return fence(self.print(node)) if needed else self.print(node)

    def is_sum(self, node):
        if isinstance(node, ast.BinOp) and without_sign(node)[0] == "-":
            return True
        return isinstance(node, ast.UnaryOp) or isinstance(node, ast.Compare) or (isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Add, ast.Sub)))

    def is_call(self, node):
        """True for a function, and for a power of one."""
        return isinstance(node, ast.Call) or (isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow) and self.is_call(node.left))

    def product(self, node):
        parts, factors = [], operands(node, ast.Mult)
        for i, factor in enumerate(factors):
            first = factor
            while isinstance(first, ast.BinOp):
                first = first.left
            self.bare = all(map(self.is_call, factors[i:]))  # sin x only where nothing but functions follows
            text = self.fenced(factor, self.is_sum(factor))
            self.bare = True
            parts.append((r" \cdot " if parts and isinstance(first, ast.Constant) else r" \, " if parts else "") + text)
        return "".join(parts)

    def argument(self, node):
        """Return the argument of a function, in parentheses unless it is a name."""
        return f" {self.print(node)}" if isinstance(node, ast.Name) and self.bare else fence(self.print(node))

    def power(self, node):
        exponent = self.print(node.right)
        if isinstance(node.left, ast.Call) and self.expression.name(node.left.func) in FUNCTIONS - {"min", "max", "exp"}:
            return self.call(node.left, f"^{{{exponent}}}")
        return f"{self.fenced(node.left, not isinstance(node.left, (ast.Name, ast.Constant)))}^{{{exponent}}}"

    def cases(self, node):
        condition, value, other = node.args
        rows = [rf"{self.print(value)} & \text{{if }} {self.print(condition)}"]
        while isinstance(other, ast.Call) and self.expression.name(other.func) == "if":
            condition, value, other = other.args
            rows.append(rf"{self.print(value)} & \text{{if }} {self.print(condition)}")
        return r"\begin{cases} " + r" \\ ".join([*rows, rf"{self.print(other)} & \text{{else}}"]) + r" \end{cases}"

    def call(self, node, power=""):
        function, arguments = self.expression.name(node.func), node.args
        if function == "if":
            return self.cases(node)
        if function == "diff":
            return r"\frac{\partial %s}{\partial %s}" % tuple(map(self.print, arguments))
        if function == "der":
            return rf"\frac{{\mathrm{{d}}}}{{\mathrm{{d}} t}} {self.print(arguments[0])}"
        if function == "sqrt":
            return rf"\sqrt{{{self.print(arguments[0])}}}"
        if function == "abs":
            return rf"\left| {self.print(arguments[0])} \right|"
        name = f"\\{function}" if function in FUNCTIONS else rf"\operatorname{{{plain(function)}}}"
        if len(arguments) == 1 and function in FUNCTIONS:
            return f"{name}{power}{self.argument(arguments[0])}"
        return f"{name}{power}{fence(', '.join(map(self.print, arguments)))}"

    def print(self, node):
        if isinstance(node, ast.Name):
            return self.name(node)
        if isinstance(node, ast.Constant):
            return self.number(node.value)
        if isinstance(node, ast.Call):
            return self.call(node)
        if isinstance(node, ast.Compare):
            return f"{self.print(node.left)} > {self.print(node.comparators[0])}"
        if self.is_sum(node):
            return " ".join(self.terms(node))
        if isinstance(node.op, ast.Pow):
            return self.power(node)
        if isinstance(node.op, ast.Div):
            return rf"\frac{{{self.print(node.left)}}}{{{self.print(node.right)}}}"
        return self.product(node)

    def terms(self, node):
        """Return the terms with their signs."""
        found = []
        for sign, term in terms(node):
            text = self.fenced(term, self.is_sum(term))
            found.append(f"{sign} {text}" if found else text if sign == "+" else f"-{text}")
        return found


def formula(text, multipliers=()):
    """Return the terms of an expression as LaTeX."""
    expression = Expression(text)
    return Printer(expression, multipliers).terms(expression.tree)


def length(part):
    """Return about how many letters of a formula are visible."""
    return len(re.sub(r"\\(left|right|frac|mathrm|operatorname|dot|,)|[{}\\ ]", "", part))


def rows(parts):
    """Join terms to lines of about LINE letters."""
    lines, room = [], 0
    for part in parts:
        if length(part) > room:
            lines.append([])
            room = LINE
        lines[-1].append(part)
        room -= length(part)
    return [" ".join(line) for line in lines]


def equation(entry, multipliers):
    left, right = rows(formula(entry.left, multipliers)), rows(formula(entry.right, multipliers))
    if len(left) == 1 and length(left[0]) + length(right[0]) <= LINE:
        lines = [f"{left[0]} & = {right[0]}"]
    else:
        lines = [f"& {left[0]}", *(rf"& \quad {line}" for line in left[1:]), f"& \\qquad = {right[0]}"]
    lines += [rf"& \qquad {line}" for line in right[1:]]
    return [r"\begin{align*}", *(f"  {line} \\\\" for line in lines[:-1]), f"  {lines[-1]}", r"\end{align*}"]


def latex_of(listing):
    lines = [r"\documentclass{article}", r"\usepackage{amsmath}", r"\allowdisplaybreaks", r"\begin{document}", rf"\section*{{{plain(listing.name)}}}", plain(listing.description)]
    for heading, entries in listing.sections.items():
        lines += ["", rf"\subsection*{{{plain(heading)}}}"]
        for entry in entries:
            if isinstance(entry, Step):
                lines += ["", rf"\subsubsection*{{{plain(entry.title)}}}"]
            elif not isinstance(entry, Equation):
                lines += ["", plain(entry.text)]
            elif is_cut(entry.left) or is_cut(entry.right):
                lines += ["", plain(f"{entry.label or entry.left[:60]}: an equation that is too long to be shown.")]
            else:
                lines += ["", rf"\noindent {plain(entry.label)}"] if entry.label else [""]
                lines += equation(entry, listing.multipliers)
    return "\n".join([*lines, "", rf"\medskip\noindent Derived by lagrange-fmu {listing.version}.", r"\end{document}"])
