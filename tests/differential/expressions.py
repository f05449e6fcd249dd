"""Expressions of the language of system.xml as trees, which are written as text for lagc and converted to SymPy for the reference."""

from dataclasses import dataclass

import sympy as sp

CONSTANT_DIGITS = 40  # of the decimal numbers in SymPy


class Kinked(sp.Function):
    """Functions whose derivatives SymPy would write with DiracDelta; away from the kink these derivatives are right."""

    is_extended_real = True


class Sign(Kinked):
    nargs = 1

    @classmethod
    def eval(cls, x):
        return sp.sign(x) if x.is_number else None

    def fdiff(self, argindex=1):
        return sp.Integer(0)


class Absolute(Kinked):
    nargs = 1

    @classmethod
    def eval(cls, x):
        return sp.Abs(x) if x.is_number else None

    def fdiff(self, argindex=1):
        return Sign(self.args[0])


class Less(Kinked):
    """1 if the first argument is less than the second, else 0."""

    nargs = 2

    def fdiff(self, argindex=1):
        return sp.Integer(0)


class Minimum(Kinked):
    nargs = 2

    @classmethod
    def eval(cls, a, b):
        return sp.Min(a, b) if a.is_number and b.is_number else None

    def fdiff(self, argindex=1):
        return Less(*self.args) if argindex == 1 else 1 - Less(*self.args)


class Maximum(Kinked):
    nargs = 2

    @classmethod
    def eval(cls, a, b):
        return sp.Max(a, b) if a.is_number and b.is_number else None

    def fdiff(self, argindex=1):
        return 1 - Less(*self.args) if argindex == 1 else Less(*self.args)


class Raised(sp.Function):
    """A power with a nonconstant exponent: SymPy's own derivative divides by the base, which may be 0."""

    nargs = 2
    is_extended_real = True

    def fdiff(self, argindex=1):
        base, exponent = self.args
        return exponent * raised(base, exponent - 1) if argindex == 1 else sp.log(base) * self


def raised(base, exponent):
    return base ** exponent if exponent.is_number else Raised(base, exponent)


FUNCTIONS = {
    name: getattr(sp, name)
    for name in "sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp log sqrt".split()
} | {"pow": raised, "^": raised, "abs": Absolute, "sign": Sign, "min": Minimum, "max": Maximum}  # fmt: skip

CONDITIONS = {
    ">": lambda a, b: Less(b, a), "<": lambda a, b: Less(a, b), "and": lambda a, b: a * b, "or": lambda a, b: a + b - a * b,
    "not": lambda a: 1 - a, "if": lambda c, a, b: c * a + (1 - c) * b,
}  # fmt: skip
FUNCTIONS |= CONDITIONS

PRECEDENCE = {"+": 1, "-": 1, "*": 2, "/": 2, "negative": 3, "^": 4}


@dataclass(frozen=True)
class Node:
    """Expression tree. operation: number, name, negative, + - * / ^, der, or a function's name; leaves have text."""

    operation: str
    operands: tuple = ()
    text: str = ""

    def __add__(self, other):
        return Node("+", (self, node(other)))

    def __radd__(self, other):
        return node(other) + self

    def __sub__(self, other):
        return Node("-", (self, node(other)))

    def __rsub__(self, other):
        return node(other) - self

    def __mul__(self, other):
        return Node("*", (self, node(other)))

    def __rmul__(self, other):
        return node(other) * self

    def __truediv__(self, other):
        return Node("/", (self, node(other)))

    def __rtruediv__(self, other):
        return node(other) / self

    def __pow__(self, other):
        return Node("^", (self, node(other)))

    def __rpow__(self, other):
        return node(other) ** self

    def __neg__(self):
        return Node("negative", (self,))

    def __str__(self):
        """Text with as few parentheses as the README's grammar allows."""
        if self.operation in ("number", "name"):
            return self.text
        if self.operation in CONDITIONS and self.operation != "if":
            return self._condition()
        if self.operation not in PRECEDENCE:
            return f"{self.operation}({', '.join(map(str, self.operands))})"
        if self.operation == "negative":
            return f"-{self._operand(0, 4)}"
        level = PRECEDENCE[self.operation]
        if self.operation == "^":
            # -2^x is -(2^x), and 2^-x needs no parentheses.
            return f"{self._operand(0, 5)}^{self._operand(1, 3)}"
        blank = " " if level == 1 else ""
        return f"{self._operand(0, level)}{blank}{self.operation}{blank}{self._operand(1, level + 1)}"

    def _condition(self):
        if self.operation in "<>":
            return f"{self.operands[0]} {self.operation} {self.operands[1]}"
        parts = [f"({operand})" for operand in self.operands]
        return f"not {parts[0]}" if self.operation == "not" else f" {self.operation} ".join(parts)

    def _operand(self, index, level):
        operand = self.operands[index]
        own = PRECEDENCE.get(operand.operation, 5)
        return f"({operand})" if own < level else str(operand)

    def nodes(self):
        """This node and all below it, but none in an integrand, which contains the variable of the integral."""
        yield self
        for operand in self.operands[1:3] if self.operation == "integral" else self.operands:
            yield from operand.nodes()


def node(value):
    """Node of a number, written so that lagc and SymPy read the same decimal."""
    if isinstance(value, Node):
        return value
    text = value if isinstance(value, str) else f"{value:.10g}"
    return -Node("number", text=text[1:]) if text.startswith("-") else Node("number", text=text)


def name(text):
    return Node("name", text=text)


def function(operation, *operands):
    return Node(operation, tuple(node(operand) for operand in operands))


def number_in_sympy(text):
    """Integers and halves exactly, since SymPy treats such exponents specially; others with many digits."""
    value = sp.Rational(text)
    return value if value.q <= 2 else sp.Float(text, CONSTANT_DIGITS)


def in_sympy(tree, symbols, rate):
    """
    Convert a tree to SymPy. symbols: SymPy's expressions by name, and functions of tables; rate: the total time derivative, for der(...).
    """
    convert = lambda operand: in_sympy(operand, symbols, rate)
    if tree.operation == "number":
        return number_in_sympy(tree.text)
    if tree.operation == "name":
        return symbols[tree.text]
    operands = [convert(operand) for operand in tree.operands]
    match tree.operation:
        case "negative":
            return -operands[0]
        case "+":
            return operands[0] + operands[1]
        case "-":
            return operands[0] - operands[1]
        case "*":
            return operands[0] * operands[1]
        case "/":
            return operands[0] / operands[1]
        case "der":
            return rate(operands[0])
    return (FUNCTIONS.get(tree.operation) or symbols[tree.operation])(*operands)
