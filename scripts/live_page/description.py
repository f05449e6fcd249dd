"""What a page has to know of an FMU, from its modelDescription.xml."""

import zipfile
from xml.etree import ElementTree

TYPES = ("Real", "Integer", "Boolean")
MANY = 400  # of more continuous variables than that, only what tells of the motion is shown
POSITIONS = ("x", "y", "z", "angle", *(f"R{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)))


def read_tree(fmu):
    with zipfile.ZipFile(fmu) as archive:
        return ElementTree.fromstring(archive.read("modelDescription.xml"))


def _number(text):
    return {"true": 1.0, "false": 0.0}.get(text) if text in ("true", "false") else float(text)


def _role(variable, type_name):
    """How the page lets it be set: as an input, a parameter, a start value; None where it is only seen."""
    causality, variability, initial = (variable.get(name) for name in ("causality", "variability", "initial"))
    if causality in ("input", "parameter"):
        return causality
    is_state = causality in ("output", "local") and variability == "continuous" and initial in ("exact", "approx")
    return "start" if is_state and type_name == "Real" else None


def _variable(variable):
    content = next(child for child in variable if child.tag in TYPES)
    known = {"name": variable.get("name"), "reference": int(variable.get("valueReference")), "type": content.tag}
    role = _role(variable, content.tag)
    if role:
        known |= {"role": role, "start": _number(content.get("start", "0"))}
    if variable.get("variability") == "fixed":
        known["isFixed"] = True
    for name in ("min", "max"):
        if content.get(name) is not None:
            known[name] = float(content.get(name))
    for name, text in (("unit", content.get("unit")), ("description", variable.get("description"))):
        if text:
            known[name] = text
    return known


def description_of(tree):
    """Plain data: names, the experiment, and the variables, each with how it may be set."""
    experiment = tree.find("DefaultExperiment").attrib
    variables = [v for v in tree.iterfind("ModelVariables/ScalarVariable") if any(child.tag in TYPES for child in v)]
    start, stop = float(experiment.get("startTime", "0")), float(experiment.get("stopTime", "10"))
    return {
        "name": tree.get("modelName"),
        "title": tree.get("description") or tree.get("modelName"),
        "guid": tree.get("guid"),
        "startTime": start,
        "duration": stop - start,
        "stepSize": float(experiment.get("stepSize", (stop - start) / 1000)),
        "variables": [_variable(variable) for variable in variables],
    }


def scene_of(tree):
    """The elements of <scene>, see modelDescription/scene.h: their attributes, with the tag."""
    return [{"tag": element.tag, **element.attrib} for element in tree.iterfind("VendorAnnotations/Tool[@name='lagrange-fmu']/scene/*")]


def shown_variables(tree, description, scene):
    """The places of those that can be plotted, and of those that tell where things are."""
    of_scene = {f"{thing.get('name')}.{component}" for thing in scene for component in POSITIONS}
    forces = {thing.get(name) for thing in scene for name in ("force", "force1", "force2")}
    continuous = {v.get("name"): v for v in tree.iterfind("ModelVariables/ScalarVariable") if v.get("variability") == "continuous"}
    continuous = {name: variable for name, variable in continuous.items() if variable.get("causality") not in ("independent", "parameter")}
    if len(continuous) > MANY:
        continuous = {n: v for n, v in continuous.items() if v.get("causality") == "output" or n in of_scene | forces or "Energy" in n or "Work" in n}
    return [place for place, one in enumerate(description["variables"]) if one["name"] in continuous and one["type"] == "Real"]


def first_plots(description, shown):
    """What is drawn at first: coordinates by their units, their velocities, energies, and the first coordinate against its velocity."""
    names = {description["variables"][place]["name"]: k for k, place in enumerate(shown)}
    variables = [description["variables"][place] for place in shown]
    states = [k for k, variable in enumerate(variables) if variable.get("role") == "start"]
    velocities = {k for k in states if variables[k].get("unit", "").endswith("/s")}
    coordinates = [k for k in states if k not in velocities]
    outputs = [k for k, variable in enumerate(variables) if k not in states and variable.get("role") is None]
    first = coordinates or states or outputs
    same_unit = [k for k in first if variables[k].get("unit") == variables[first[0]].get("unit")][:6] if first else []
    plots = [{"places": same_unit, "across": -1}]
    energies = [names[name] for name in ("kineticEnergy", "potentialEnergy", "totalEnergy", "energy") if name in names]
    if coordinates and velocities:
        plots.append({"places": [min(velocities)], "across": coordinates[0]})
    if energies:
        plots.append({"places": energies, "across": -1})
    return plots
