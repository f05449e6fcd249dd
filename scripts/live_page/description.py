"""What a page has to know of an FMU, from its modelDescription.xml."""

import zipfile
from xml.etree import ElementTree

# The types of FMI 2.0, and what those of FMI 3.0 are called there.
TYPES = {"Real": "Real", "Integer": "Integer", "Boolean": "Boolean", "Float64": "Real", "Int32": "Integer", "Int64": "Integer"}
PULL = "pull."  # with which the names of inputs begin that lagc --pull adds
MANY = 400  # of more continuous variables than that, only what tells of the motion is shown
POSITIONS = ("x", "y", "z", "angle", *(f"R{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)))


def read_tree(fmu):
    with zipfile.ZipFile(fmu) as archive:
        return ElementTree.fromstring(archive.read("modelDescription.xml"))


def variables_in(tree):
    """The attributes of each variable, with its type; FMI 2.0 has them on two elements, FMI 3.0 on one."""
    for variable in tree.find("ModelVariables"):
        for part in (variable, *variable):
            if part.tag in TYPES:
                yield {**variable.attrib, **part.attrib, "type": TYPES[part.tag]}


def _number(text):
    return {"true": 1.0, "false": 0.0}.get(text) if text in ("true", "false") else float(text)


def _role(variable):
    """How the page lets it be set: as an input, a parameter, a start value; None where it is only seen."""
    if variable["causality"] in ("input", "parameter"):
        return variable["causality"]
    is_state = variable["causality"] in ("output", "local") and variable.get("variability") == "continuous" and variable.get("initial") in ("exact", "approx")
    return "start" if is_state and variable["type"] == "Real" else None


def _variable(variable):
    known = {"name": variable["name"], "reference": int(variable["valueReference"]), "type": variable["type"]}
    role = _role(variable)
    if role:
        known |= {"role": role, "start": _number(variable.get("start", "0"))}
    if variable.get("variability") == "fixed":
        known["isFixed"] = True
    for name in ("min", "max"):
        if name in variable:
            known[name] = float(variable[name])
    for name in ("unit", "description"):
        if variable.get(name):
            known[name] = variable[name]
    return known


def description_of(tree):
    """Plain data: names, the experiment, and the variables, each with how it may be set."""
    experiment = tree.find("DefaultExperiment").attrib
    start, stop = float(experiment.get("startTime", "0")), float(experiment.get("stopTime", "10"))
    return {
        "name": tree.get("modelName"),
        "title": tree.get("description") or tree.get("modelName"),
        "guid": tree.get("guid"),
        "startTime": start,
        "duration": stop - start,
        "stepSize": float(experiment.get("stepSize", (stop - start) / 1000)),
        "variables": [_variable(variable) for variable in variables_in(tree)],
    }


def pulls_of(tree, description):
    """Of the FMU whose bodies can be pulled: the references of all variables of the description, and of what pulls; None where nothing moves."""
    references = {variable["name"]: int(variable["valueReference"]) for variable in variables_in(tree)}
    inputs = {name.removeprefix(PULL): reference for name, reference in references.items() if name.startswith(PULL)}
    bodies = {name.removeprefix("of."): reference for name, reference in inputs.items() if name.startswith("of.")}
    if not bodies:
        return None
    return {
        "guid": tree.get("guid"),
        "references": [references[variable["name"]] for variable in description["variables"]],
        "pointer": [inputs[name] for name in ("x", "y", "z", "u", "v", "w", "time")],
        "bodies": bodies,
    }


def scene_of(tree):
    """The elements of <scene>, see modelDescription/scene.h: their attributes, with the tag."""
    places = ("VendorAnnotations/Tool[@name='lagrange-fmu']", "Annotations/Annotation[@type='lagrange-fmu']")
    return [{"tag": element.tag, **element.attrib} for place in places for element in tree.iterfind(f"{place}/scene/*")]


def variables_of_scene(scene):
    """The names of those that may tell where things are, and by what forces they are held; an FMU has some of them."""
    positions = (f"{thing['name']}.{component}" for thing in scene if "name" in thing for component in POSITIONS)
    forces = (thing[name] for thing in scene for name in ("force", "force1", "force2") if name in thing)
    return list(dict.fromkeys([*positions, *forces]))


def shown_variables(tree, description, scene):
    """The places of those that can be plotted, and of those that tell where things are."""
    continuous = {v["name"]: v for v in variables_in(tree) if v.get("variability") == "continuous"}
    continuous = {name: variable for name, variable in continuous.items() if variable["causality"] not in ("independent", "parameter")}
    if len(continuous) > MANY:
        of_scene = set(variables_of_scene(scene))
        continuous = {n: v for n, v in continuous.items() if v["causality"] == "output" or n in of_scene or "Energy" in n or "Work" in n}
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
