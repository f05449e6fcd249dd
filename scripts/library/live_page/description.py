"""Read the parts of modelDescription.xml that are needed to write a page; description.js reads the rest in the page."""

import re
import zipfile
from xml.etree import ElementTree

ENDS = ("x1", "y1", "z1", "x2", "y2", "z2")  # attributes of a <line> with formulas
NAME = r"[A-Za-z_][\w.]*(?:\[[^\]]*\][\w.]*)*"
POSITIONS = ("x", "y", "z", "angle", *(f"R{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)))


def read_tree(fmu):
    """Return the root of the FMU's modelDescription.xml."""
    with zipfile.ZipFile(fmu) as archive:
        return ElementTree.fromstring(archive.read("modelDescription.xml"))


def scene_of(tree):
    """Return the elements of <scene>, see modelDescription/scene.h, as dicts of their attributes and their "tag"."""
    places = ("VendorAnnotations/Tool[@name='lagrange-fmu']", "Annotations/Annotation[@type='lagrange-fmu']")
    return [{"tag": element.tag, **element.attrib} for place in places for element in tree.iterfind(f"{place}/scene/*")]


def variables_of_scene(scene):
    """Return the names of the variables that may hold positions, orientations and constraint forces, and of functions; an FMU has some of them."""
    positions = (f"{thing['name']}.{component}" for thing in scene if "name" in thing for component in POSITIONS)
    of_lines = (name for thing in scene if thing["tag"] == "line" for end in ENDS for name in re.findall(NAME, thing.get(end, "")))
    forces = (thing[name] for thing in scene for name in ("force", "force1", "force2") if name in thing)
    return list(dict.fromkeys([*positions, *of_lines, *forces]))
