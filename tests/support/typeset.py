"""What typeset formulas of a documentation page say, against their text."""

import random
import re
import xml.etree.ElementTree as ElementTree

import numpy as np

MATHML = "{http://www.w3.org/1998/Math/MathML}"
GREEK = dict(zip("αβγδεζηθκλμνξπρστφχψωΔΘΦΨΩ",
                 "alpha beta gamma delta epsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau phi chi psi omega "
                 "Delta Theta Phi Psi Omega".split()))  # fmt: skip
FUNCTIONS = {name: getattr(np, name) for name in "sin cos tan sinh cosh tanh exp log sqrt abs sign".split()}
FUNCTIONS |= dict(asin=np.arcsin, acos=np.arccos, atan=np.arctan, asinh=np.arcsinh, acosh=np.arccosh, atanh=np.arctanh,
                  atan2=np.arctan2, min=min, max=max, erf=lambda x: x, gate=lambda opener, value, other: value if opener > 0 else other)  # fmt: skip


def infix(element):
    """What the element means, as an expression in Python."""
    tag, parts = element.tag.removeprefix(MATHML), [infix(child) for child in element]
    if tag == "mfrac":
        return f"(({parts[0]})/({parts[1]}))"
    if tag == "msup":
        return f"(({parts[0]})**({parts[1]}))"
    if tag == "msub":
        return f"{parts[0]}_{parts[1]}"
    if tag == "msqrt":
        return f"sqrt({''.join(parts)})"
    if tag == "mover":
        return f"der_{parts[0]}"
    if tag == "mrow" and parts and parts[0] == parts[-1] == "|":
        return f"abs({''.join(parts[1:-1])})"
    return {"⋅": "*", "−": "-", "\u2061": ""}.get(element.text, GREEK.get(element.text, element.text or "")) + "".join(parts)


def plain(text):
    """The text in the names that infix() gives."""
    text = re.sub(r"\b([A-Za-z_]+?)\[?(\d+)\]?(?![\w.(\[]|\.\d)", lambda m: m[0] if re.fullmatch("e|E", m[1]) else f"{m[1]}_{m[2]}", text)
    for _ in range(2):  # der(der(zb))
        text = re.sub(r"der\(([\w.]+)\)", r"der_\1", text)
    return text.replace("^", "**")


def check(page):
    root, count = ElementTree.fromstring(page), 0
    generator = random.Random(1)
    for parent in root.iter():
        for paragraph, details in zip(list(parent), list(parent)[1:]):
            if paragraph.get("class") != "formula":
                continue
            indexed = lambda side: re.sub(r"\[(\d+)\]\.", r"_\1.", side)  # loop[1].force, which stays a word
            typeset = indexed("".join(infix(math) for math in paragraph)).split("=")
            text = plain(indexed(details.find("code").text)).split(" = ")
            names = {name: generator.uniform(0.1, 0.9) for name in set(re.findall(r"[A-Za-z_][\w.]*", " ".join(text)))}
            text = [re.sub(r"\bif\((.*?) > 0, ", r"gate(\1, ", side) for side in text]
            typeset = [re.sub(r"\bif\((.*?)>0,", r"gate(\1,", side) for side in typeset]
            dots = lambda side: re.sub(r"(?<=[A-Za-z_])(\w*)\.(?=[A-Za-z])", r"\1__", side)
            values = {dots(name): value for name, value in names.items()}
            for ours, theirs in zip(typeset, text, strict=True):
                with np.errstate(all="ignore"):
                    both = [eval(dots(side), {}, {**values, **FUNCTIONS}) for side in (ours, theirs)]
                assert np.isclose(*both, rtol=1e-9, equal_nan=True), (ours, theirs)
            count += 1
    return count
