"""Comparison of the formulas that a documentation page's script typesets (MathML) with their text."""

import random
import re
import xml.etree.ElementTree as ElementTree

import numpy as np

from chromium import look_at

XHTML = "{http://www.w3.org/1999/xhtml}"
MATHML = "{http://www.w3.org/1998/Math/MathML}"
GREEK = dict(zip("αβγδεζηθκλμνξπρστφχψωΓΔΘΛΞΠΣΦΨΩ",
                 "alpha beta gamma delta epsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau phi chi psi omega "
                 "Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega".split()))  # fmt: skip
FUNCTIONS = {name: getattr(np, name) for name in "sin cos tan sinh cosh tanh exp log sqrt abs sign".split()}
FUNCTIONS |= dict(pow=pow, asin=np.arcsin, acos=np.arccos, atan=np.arctan, asinh=np.arcsinh, acosh=np.arccosh, atanh=np.arctanh,
                  atan2=np.arctan2, min=min, max=max, erf=lambda x: x, gate=lambda condition, value, other: value if condition else other)  # fmt: skip


def infix(element):
    """Convert a MathML element to an expression in Python."""
    tag, parts = element.tag.removeprefix(MATHML), [infix(child) for child in element]
    if tag == "mfrac":
        return f"(({parts[0]})/({parts[1]}))"
    if tag == "msup":
        return f")**({parts[1]})" if parts[0] == ")" else f"(({parts[0]})**({parts[1]}))"
    if tag in ("msub", "msubsup"):
        indexed = parts[0] + "_" + re.sub(r"\W", "_", parts[1])
        return f"(({indexed})**({parts[2]}))" if parts[2:] else indexed
    if tag == "msqrt":
        return f"sqrt({''.join(parts)})"
    if tag == "mtable":  # cases with a brace before them
        *rows, last = ([infix(cell) for cell in row] for row in element)
        return "".join(f"gate({condition[3:]}, {value}, " for value, condition in rows) + last[0] + ")" * len(rows)
    if tag == "mover":
        return {"˙": "der_", "¨": "der_der_"}[parts[1]] + parts[0]
    if tag == "mrow" and parts and parts[0] == parts[-1] == "|":
        return f"abs({''.join(parts[1:-1])})"
    if tag == "mrow" and parts[1:2] == ["apply"]:  # sin x, sin² x, sin²(x - y)
        power, content = re.fullmatch(r"\(\((\w+)\)\*\*\((\d+)\)\)", parts[0]), "".join(parts[2:])
        argument = content if content.startswith("(") else f"({content})"
        return f"({power[1]}{argument}**{power[2]})" if power else parts[0] + argument
    parts = [part for part in parts if part not in ("apply", "{")]
    return {"⋅": "*", "\u2062": "*", "−": "-", "\u2061": "apply"}.get(element.text, GREEK.get(element.text, element.text or "")) + "".join(parts)


def symbol(name):
    """Letter and indices of a name, joined by _."""
    *part, last = name.rsplit(".", 1)
    word, number, bracket = re.fullmatch(r"(.*?\D|)(\d*)(?:\[(.*)\])?", last).groups() if "[" not in last else (last[: last.index("[")], "", last[last.index("[") + 1 : -1])
    if word.endswith("_") or not word:
        word, number = word + number, ""
    greek = re.match(r"(%s)(?=[A-Z])" % "|".join(sorted(GREEK.values(), key=len, reverse=True)), word)
    if part and last == "force":
        word = "F"
    elif greek:
        word = f"{greek[1]}_{word[greek.end():]}"
    return re.sub(r"\W", "_", "_".join(filter(None, [word, number, bracket, *part])))


def plain(text, symbols):
    """Rewrite the text with the names that infix() gives. symbols: those of names that other names decide on."""
    symbol_of = lambda found: symbols.get(found[1]) or symbol(found[1])
    text = re.sub(r"\bder\(", "der ", re.sub(r"der\(der\(([\w.\[\]]+)\)\)", r"der_der_<\1>", text))
    text = re.sub(r"der ([\w.\[\]]+)\)", r"der_<\1>", text)
    text = re.sub(r"(?<![\w.<])([A-Za-z_][\w.]*(?:\[[\w,]+\])?(?:\.[A-Za-z_]\w*)*)(?![\w(<.\[])", symbol_of, text)
    text = re.sub(r"<(.*?)>", symbol_of, text)
    return text.replace("^", "**")


def value(side, values):
    with np.errstate(all="ignore"):
        return eval(side, {}, {**values, **FUNCTIONS})


def shown(files, folder):
    """Return the pages as browsers show them, once their scripts have run, as XML."""
    return list(look_at(files, folder, [1200], "view => new XMLSerializer().serializeToString(view.document)").values())


def special_symbols(root):
    """Return the symbols of time, and of velocities such as vx of x, by the table of variables."""
    rows = list(root.find(f".//{XHTML}table[@id='variables']").iter(f"{XHTML}tr"))
    names, velocities = {row[1].text for row in rows}, [row[1].text for row in rows if row[5].text == f"velocity of {row[1].text[1:]}"]
    special = {} if "t" in names else {"time": "t"}
    return special | {name: f"{name[0]}_{symbol(name[1:])}" for name in velocities}


def check(page):
    """Compare every formula of a shown page with its text at random values; return their number."""
    root, count = ElementTree.fromstring(page), 0
    symbols = special_symbols(root)
    generator = random.Random(1)
    for equation in root.iter(f"{XHTML}div"):
        if equation.get("class") != "equation":
            continue
        conditions = lambda side: re.sub(r"\bif\(", "gate(", side)
        typeset = conditions("".join(infix(math) for math in equation.find(f"{XHTML}p") if math.tag != f"{XHTML}wbr")).split("=")
        text = [plain(conditions(side), symbols) for side in equation.find(f"{XHTML}details/{XHTML}code").text.split(" = ")]
        # The force of a constraint is typeset as a multiplier.
        typeset = [re.sub(r"\blambda_(\w+)", lambda found: f"F_{found[1]}" if f"F_{found[1]}" in " ".join(text) else found[0], side) for side in typeset]
        names = {name: generator.uniform(0.1, 0.9) for name in sorted(set(re.findall(r"[A-Za-z_]\w*", " ".join(text))))}
        for ours, theirs in zip(typeset, text, strict=True):
            assert np.isclose(value(ours, names), value(theirs, names), rtol=1e-9, equal_nan=True), (ours, theirs)
        count += 1
    return count
