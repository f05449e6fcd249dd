"""
Small changes of C functions, each of which a test should detect: mutations, as Offutt's operators make them.

tree-sitter parses the source, so that strings, comments and declarations outside of functions stay as they are.
"""

import functools
import re
import subprocess
from typing import NamedTuple

import tree_sitter
import tree_sitter_c

OPERATORS = {
    "+": "-", "-": "+", "*": "/", "/": "*", "%": "*", "<<": ">>", ">>": "<<", "&": "|", "|": "&", "&&": "||", "||": "&&",
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=", "|=": "&=", "&=": "|=",
}  # fmt: skip
KINDS = {"&&": "logical", "||": "logical", **dict.fromkeys(("<", "<=", ">", ">="), "bound"), **dict.fromkeys(("==", "!="), "equality")}


class Mutant(NamedTuple):
    kind: str
    start: int  # offsets in the bytes of the source
    end: int
    wrong: bytes
    body: tuple  # offsets of the function's body


@functools.cache
def parser():
    return tree_sitter.Parser(tree_sitter.Language(tree_sitter_c.language()))


def is_last(statement):
    """True if a statement ends the body of its function, whose value would be missing without it."""
    statements = [node for node in statement.parent.named_children if node.type != "comment"]
    return statement.parent.parent.type == "function_definition" and statements[-1] == statement


def larger(literal):
    """Return another number than a literal: an integer plus 1, or ten times a floating-point number."""
    if re.fullmatch(r"\d+[uUlL]*", literal):
        return str(int(literal.rstrip("uUlL")) + 1) + literal.lstrip("0123456789")
    if re.fullmatch(r"0x[0-9a-fA-F]+[uUlL]*", literal):
        return f"({literal} + 1)"
    return "1.0" if float(literal.rstrip("fFlL")) == 0.0 else f"(10 * {literal})"


def changes_of(node):
    """Yield (kind, node to replace, new text) for the changes of one node of the syntax tree."""
    if node.type in ("binary_expression", "assignment_expression"):
        operator = node.child_by_field_name("operator")
        if operator.type in OPERATORS:
            yield KINDS.get(operator.type, "arithmetic"), operator, OPERATORS[operator.type]
    elif node.type == "unary_expression" and node.child(0).type in "-!":
        yield "sign" if node.child(0).type == "-" else "logical", node.child(0), ""
    elif node.type == "number_literal":
        yield "constant", node, larger(node.text.decode())
    elif node.type in ("if_statement", "conditional_expression"):
        condition = node.child_by_field_name("condition")
        yield from (("condition", condition, f"({value})") for value in (0, 1))
    elif node.type == "while_statement":  # a condition that is always true would only make endless loops
        yield "condition", node.child_by_field_name("condition"), "(0)"
    elif node.type in ("expression_statement", "break_statement", "continue_statement"):
        yield "dropped", node, ";"
    elif node.type == "return_statement" and not is_last(node):
        yield "dropped", node, ";"


def nodes_below(node):
    for child in node.named_children:
        yield child
        yield from nodes_below(child)


def functions_of(source):
    """Yield the bodies of the functions of a C source that can be parsed, as nodes, in the order of the text."""
    for node in nodes_below(parser().parse(source).root_node):
        if node.type == "function_definition" and not node.has_error:
            yield node.child_by_field_name("body")


@functools.cache
def bodies_of(source):
    """Offsets of the bodies of the functions of a C source, in the order of the text."""
    return [(body.start_byte, body.end_byte) for body in functions_of(source)]


def mutants_of(source):
    """Return the mutants of a C source, given as bytes, in the order of the text."""
    found = []
    for body in functions_of(source):
        for node in nodes_below(body):
            for kind, replaced, wrong in changes_of(node):
                found.append(Mutant(kind, replaced.start_byte, replaced.end_byte, wrong.encode(), (body.start_byte, body.end_byte)))
    return found


def line_of(source, mutant):
    """Number of the line on which a mutant begins."""
    return source.count(b"\n", 0, mutant.start) + 1


def body_of(source, mutant):
    """Body of the mutant's function, with its change."""
    return source[mutant.body[0] : mutant.start] + mutant.wrong + source[mutant.end : mutant.body[1]]


def mutated(source, mutant):
    return source[: mutant.body[0]] + body_of(source, mutant) + source[mutant.body[1] :]


def changed_lines(difference):
    """Numbers of the lines that a unified difference without context adds, by file."""
    lines, file = {}, None
    for row in difference.splitlines():
        if row.startswith("+++ "):
            file = row[4:].removeprefix("b/")
        elif hunk := re.match(r"@@ -\S+ \+(\d+)(?:,(\d+))? @@", row):
            first, count = int(hunk[1]), int(hunk[2] or 1)
            lines.setdefault(file, set()).update(range(first, first + count))
    return lines


def changed_since(base, root):
    """Lines of the working tree that differ from a commit, by file."""
    return changed_lines(subprocess.run(["git", "diff", "-U0", base], cwd=root, capture_output=True, text=True, check=True).stdout)
