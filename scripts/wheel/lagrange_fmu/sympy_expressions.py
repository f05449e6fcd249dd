"""Print expressions of SymPy in the language of system.xml."""

import re
import unicodedata

import sympy
from sympy.functions.elementary.piecewise import ExprCondPair
from sympy.printing.str import StrPrinter

from .language import words
from .problem import Problem

# Functions of the language by their names in SymPy.
FUNCTIONS = {name: name for name in words()["function"] if isinstance(getattr(sympy, name, None), type)}
FUNCTIONS |= {"Abs": "abs", "Min": "min", "Max": "max", "ceiling": "ceil"}
# Functions that the language lacks, in terms of those that it has.
REWRITTEN = {
    sympy.sec: lambda x: 1 / sympy.cos(x),
    sympy.csc: lambda x: 1 / sympy.sin(x),
    sympy.cot: lambda x: sympy.cos(x) / sympy.sin(x),
    sympy.sech: lambda x: 1 / sympy.cosh(x),
    sympy.csch: lambda x: 1 / sympy.sinh(x),
    sympy.coth: lambda x: sympy.cosh(x) / sympy.sinh(x),
}


CONDITIONS = (sympy.Gt, sympy.Ge, sympy.Lt, sympy.Le, sympy.And, sympy.Or, sympy.Not)


class Names:
    """Valid names of a system, each used once."""

    def __init__(self):
        self.taken = {*words()["function"], *words()["name"]}

    def add(self, text):
        """Return a free name of letters, digits and _ that resembles the text, and reserve it: theta_1 for \\theta_{1}."""
        text = "".join(map(_ascii, str(text).replace("'", "_prime")))
        text = re.sub(r"[^A-Za-z0-9_]", "_", re.sub(r"[\\{}$^]", "", text))[:150]
        name = text if re.match("[A-Za-z_]", text) else f"_{text}"
        while name in self.taken:
            name += "_"
        self.taken.add(name)
        return name


def _ascii(letter):
    """Return the name of a Greek letter, another letter without its accent, or "_"."""
    if letter.isascii():
        return letter
    words = unicodedata.name(letter, "").split()
    if words[:1] == ["GREEK"] and words[2:3] == ["LETTER"]:
        return words[3].capitalize() if words[1] == "CAPITAL" else words[3].lower()
    return unicodedata.normalize("NFKD", letter).encode("ascii", "ignore").decode() or "_"


class _Printer(StrPrinter):
    """Print expressions as Python does, but with the names of the language's functions; text_of() replaces ** by ^."""

    def _print_Float(self, number):
        return repr(float(number))

    def _print_Function(self, function):
        first, *others = (self._print(argument) for argument in function.args)
        return f"{FUNCTIONS[function.func.__name__]}({', '.join([first, *others])})"

    def _print_extremum(self, function):
        """Nest Min and Max, which take any number of arguments in SymPy and two in the language."""
        *others, text = (self._print(argument) for argument in function.args)
        for argument in reversed(others):
            text = f"{FUNCTIONS[function.func.__name__]}({argument}, {text})"
        return text

    def _print_Piecewise(self, function):
        """Print if(condition, value, if(...)); text_of() ensures that the last condition is True."""
        *others, (value, _) = function.args
        text = self._print(value)
        for value, condition in reversed(others):
            text = f"if({self._print(condition)}, {self._print(value)}, {text})"
        return text

    def _print_Relational(self, relation):
        return f"{self._print(relation.lhs)} {relation.rel_op} {self._print(relation.rhs)}"

    def _print_joined(self, condition):
        return f" {str(condition.func).lower()} ".join(f"({self._print(part)})" for part in condition.args)

    def _print_Not(self, condition):
        return f"not ({self._print(condition.args[0])})"

    _print_And = _print_Or = _print_joined
    _print_Abs = _print_Function
    _print_Max = _print_Min = _print_extremum


def normalized(expression):
    """Carry out derivatives, rewrite functions that the language lacks, and replace numbers such as E by floats, except pi."""
    expression = sympy.sympify(expression).doit()
    for function, rewrite in REWRITTEN.items():
        expression = expression.replace(function, rewrite)
    return expression.replace(lambda node: node.is_NumberSymbol and node is not sympy.pi, lambda node: sympy.Float(node))


def text_of(expression, where):
    """
    Return the text of a normalized expression, all of whose symbols have valid names.

    Raise Problem, whose text begins with `where`, if the language has no counterpart.
    """
    for node in sympy.preorder_traversal(expression):
        if isinstance(node, sympy.Piecewise) and node.args[-1].cond is not sympy.true:
            raise Problem(f"{where}: {node} has no value where none of its conditions holds; expected (VALUE, True) as the last of its pairs")
        known = isinstance(node, (sympy.Add, sympy.Mul, sympy.Pow, sympy.Symbol, sympy.Piecewise, ExprCondPair, *CONDITIONS)) or node is sympy.true or node is sympy.pi or node.func.__name__ in FUNCTIONS
        if not known and not (node.is_Number and node.is_finite):
            raise Problem(f"{where}: {node} cannot be expressed; expected real numbers, + - * / **, sqrt, Piecewise, and of functions {', '.join(sorted(FUNCTIONS))}")
    return _Printer().doprint(expression).replace("**", "^")
