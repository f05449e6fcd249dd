"""What there is to see of an FMU: its particles, bodies, frames and points, and where they are by its variables."""

import math
import re
import zipfile
from dataclasses import dataclass, field
from xml.etree import ElementTree

import numpy as np

AXES = "xyz"
TURN = [f"R{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)]  # of a frame, row by row
# The language's own have these names too.
FUNCTIONS = {name: function for name, function in vars(math).items() if callable(function)}
FUNCTIONS |= {"abs": abs, "min": min, "max": max, "sign": lambda x: math.copysign(bool(x), x)}
NAME = re.compile(r"(?<![\w.])[A-Za-z_][\w.]*(?:\[[^]]*\])*(?!\()")


KINDS = ("particle", "body", "frame", "point")


@dataclass
class Element:
    kind: str  # one of KINDS
    name: str
    position: np.ndarray  # m along the base axes, a row for each time
    mass: float = 0.0  # kg; NaN where it is not known
    angle: np.ndarray | None = None  # rad, of a body in the plane
    rotation: np.ndarray | None = None  # of a frame: a matrix for each time, from its axes to those of the base
    frame: int | None = None  # the place of the frame that it is in; None in the base
    inertia: np.ndarray = field(default_factory=lambda: np.zeros((3, 3)))  # kg.m2, along the axes of the frame


def value_of(formula, values):
    """The value of a formula in the language of system.xml, of parameters; NaN where it holds more than that."""
    text = NAME.sub(lambda name: f"({values[name[0]]!r})" if name[0] in values else name[0], formula)
    try:
        return float(eval(text.replace("^", "**"), {"__builtins__": {}}, FUNCTIONS))
    except (ArithmeticError, NameError, SyntaxError, TypeError, ValueError):
        return math.nan


def read_scene(fmu):
    """The elements of <scene> in its modelDescription.xml: see modelDescription/scene.h."""
    with zipfile.ZipFile(fmu) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    return list(root.iterfind("VendorAnnotations/Tool[@name='lagrange-fmu']/scene/*"))


def variables_of(scene, known):
    """The names of the variables that tell where the elements are."""
    names = (f"{element.get('name')}.{component}" for element in scene for component in [*AXES, "angle", *TURN])
    return [name for name in names if name in known]


def _columns(result, name, components):
    zero = np.zeros(len(result))
    return np.stack([result[f"{name}.{c}"] if f"{name}.{c}" in result.dtype.names else zero for c in components], axis=1)


def _inertia(element, values):
    """About the centre of mass; that of a body in the plane is Izz."""
    of = lambda name: value_of(element.get(name, "0"), values)  # noqa: E731
    if element.get("inertia") is not None:
        return np.diag([0.0, 0.0, of("inertia")])
    return np.array([[of("I" + "".join(sorted(a + b))) for b in AXES] for a in AXES])


def upwards(scene, values):
    """The axis, with its sign, that is nearest to the opposite of gravity; z where the scene does not tell."""
    gravity = np.array([value_of(element.get(axis, "0"), values) for element in scene if element.tag == "gravity" for axis in AXES])
    if not np.isfinite(gravity).all() or not gravity.any():
        return np.array([0.0, 0.0, 1.0])
    return np.where(abs(gravity) == abs(gravity).max(), -np.sign(gravity), 0.0)


def elements_of(scene, result, values):
    """Of a simulation's result, a structured array, with these values of the parameters."""
    scene = [element for element in scene if element.tag in KINDS]
    frames = {element.get("name"): place for place, element in enumerate(scene) if element.tag in ("frame", "body")}
    elements = []
    for element in scene:
        name = element.get("name")
        known = Element(element.tag, name, _columns(result, name, AXES), frame=frames.get(element.get("in")))
        known.mass = value_of(element.get("mass", "0"), values)
        if element.tag == "frame":
            known.rotation = _columns(result, name, TURN).reshape(-1, 3, 3)
        if element.tag == "body":
            known.inertia = _inertia(element, values)
        if f"{name}.angle" in result.dtype.names:
            known.angle = result[f"{name}.angle"]
        elements.append(known)
    return elements
