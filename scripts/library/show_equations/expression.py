"""Parse the expressions of a listing into trees of Python's module ast, with the names of the language."""

import ast
import re

# A name, or the derivative of one, which is a variable too.
NAME = r"[A-Za-z_]\w*(?:\[[^\]]*\])*(?:\.\w+(?:\[[^\]]*\])*)*"
WORD = re.compile(rf"(?<![\w.])(?:der\(der\({NAME}\)\)|der\({NAME}\)|{NAME})")


class Expression:
    """A parsed expression: `tree`, in which identifiers stand for the `names`, by which name() finds them."""

    def __init__(self, text):
        self.names = []
        hidden = WORD.sub(self._hide, text)
        self.tree = ast.parse(hidden.replace("^", "**"), mode="eval").body

    def _hide(self, found):
        self.names.append(found[0])
        return f"n{len(self.names) - 1}"

    def name(self, node):
        return self.names[int(node.id[1:])]


LONGEST = 4000  # letters of an expression; parsing recurses for each of its terms


def is_cut(text):
    """True for a text that lagc has cut off, or that is too long to be parsed."""
    return "..." in text or len(text) > LONGEST


def operands(node, operator):
    """Return the operands of a chain of one operator from left to right, such as the factors of a product."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, operator):
        return [*operands(node.left, operator), node.right]
    return [node]


def without_sign(node):
    """Return "-" or "+", and the product without it: -a*b is read as (-a)*b."""
    if isinstance(node, ast.UnaryOp):
        return "-", node.operand
    if isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Mult, ast.Div)):
        sign, left = without_sign(node.left)
        return sign, ast.BinOp(left, node.op, node.right)
    return "+", node


def terms(node):
    """Return the terms of a sum as (sign, node)."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Add, ast.Sub)):
        return [*terms(node.left), ("-" if isinstance(node.op, ast.Sub) else "+", node.right)]
    return [without_sign(node)]
