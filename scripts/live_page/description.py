"""What is to be known of an FMU before there is a page, from its modelDescription.xml; description.js reads the rest."""

import zipfile
from xml.etree import ElementTree

POSITIONS = ("x", "y", "z", "angle", *(f"R{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)))


def read_tree(fmu):
    with zipfile.ZipFile(fmu) as archive:
        return ElementTree.fromstring(archive.read("modelDescription.xml"))


def scene_of(tree):
    """The elements of <scene>, see modelDescription/scene.h: their attributes, with the tag."""
    places = ("VendorAnnotations/Tool[@name='lagrange-fmu']", "Annotations/Annotation[@type='lagrange-fmu']")
    return [{"tag": element.tag, **element.attrib} for place in places for element in tree.iterfind(f"{place}/scene/*")]


def variables_of_scene(scene):
    """The names of those that may tell where things are, and by what forces they are held; an FMU has some of them."""
    positions = (f"{thing['name']}.{component}" for thing in scene if "name" in thing for component in POSITIONS)
    forces = (thing[name] for thing in scene for name in ("force", "force1", "force2") if name in thing)
    return list(dict.fromkeys([*positions, *forces]))
