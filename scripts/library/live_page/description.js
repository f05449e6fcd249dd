// Reads modelDescription.xml of an FMU.
"use strict";

// The types of FMI 2.0, by those of both versions.
const TYPES = { Real: "Real", Integer: "Integer", Boolean: "Boolean", Float64: "Real", Int32: "Integer", Int64: "Integer" };
const PULL = "pull."; // prefix of the inputs that lagc --pull adds
const MANY = 400; // with more continuous variables, only outputs, energies and variables of the scene are shown
const POSITIONS = ["x", "y", "z", "angle", ...[1, 2, 3].flatMap((i) => [1, 2, 3].map((j) => `R${i}${j}`))];
const EXPERIMENT = { startTime: 0, stopTime: 10 }; // s, by default
const WINDOW = 20; // s that plots show; less if the experiment is shorter

const attributesOf = (element) => Object.fromEntries([...element.attributes].map(({ name, value }) => [name, value]));

// Returns the attributes of each variable, with its type; FMI 2.0 has them on two elements, FMI 3.0 on one.
function variablesIn(file) {
  const parts = (variable) => [variable, ...variable.children].filter((part) => part.tagName in TYPES);
  return [...file.querySelector("ModelVariables").children].flatMap((variable) =>
    parts(variable).map((part) => ({ ...attributesOf(variable), ...attributesOf(part), type: TYPES[part.tagName] })),
  );
}

const numberOf = (text) => (text === "true" ? 1 : text === "false" ? 0 : Number(text));

// Returns how the page can set a variable: "input", "parameter" or "start" (a start value); null if it cannot.
function roleOf({ causality, variability, initial, type }) {
  if (causality === "input" || causality === "parameter") return causality;
  const isState = ["output", "local"].includes(causality) && variability === "continuous" && ["exact", "approx"].includes(initial);
  return isState && type === "Real" ? "start" : null;
}

function variableOf(attributes) {
  const known = { name: attributes.name, reference: Number(attributes.valueReference), type: attributes.type };
  const role = roleOf(attributes);
  if (role) Object.assign(known, { role, start: numberOf(attributes.start ?? "0") });
  known.isOutput = attributes.causality === "output";
  known.isMoving = attributes.variability === "continuous" && !["independent", "parameter"].includes(attributes.causality);
  known.derivativeOf = Number(attributes.derivative ?? 0) - 1; // the index of a variable, or -1
  known.nominal = Math.abs(Number(attributes.nominal ?? 1));
  known.isDiscrete = attributes.variability === "discrete";
  known.isFixed = attributes.variability === "fixed";
  for (const name of ["min", "max"]) if (name in attributes) known[name] = Number(attributes[name]);
  for (const name of ["unit", "description"]) if (attributes[name]) known[name] = attributes[name];
  return known;
}

// Returns names, experiment (times in s) and variables with their roles.
function descriptionOf(file) {
  const root = file.documentElement, experiment = file.querySelector("DefaultExperiment");
  const given = (name, otherwise) => (experiment?.hasAttribute(name) ? Number(experiment.getAttribute(name)) : otherwise);
  const startTime = given("startTime", EXPERIMENT.startTime), duration = given("stopTime", EXPERIMENT.stopTime) - startTime;
  return {
    name: root.getAttribute("modelName"),
    guid: root.getAttribute("guid"),
    startTime,
    duration,
    stepSize: given("stepSize", duration / 1000),
    variables: variablesIn(file).map(variableOf),
  };
}

// Returns, for the FMU whose bodies can be pulled, the references of the description's variables, of the pointer's inputs and of the bodies'
// inputs by name; null without bodies.
function pullsOf(file, description) {
  const references = new Map(variablesIn(file).map((variable) => [variable.name, Number(variable.valueReference)]));
  const inputs = new Map([...references].filter(([name]) => name.startsWith(PULL)).map(([name, reference]) => [name.slice(PULL.length), reference]));
  const bodies = Object.fromEntries([...inputs].filter(([name]) => name.startsWith("of.")).map(([name, reference]) => [name.slice("of.".length), reference]));
  if (Object.keys(bodies).length === 0) return null;
  return {
    guid: file.documentElement.getAttribute("guid"),
    references: description.variables.map((variable) => references.get(variable.name)),
    pointer: ["x", "y", "z", "u", "v", "w", "time"].map((name) => inputs.get(name)),
    bodies,
  };
}

// Returns the elements of <scene>, see modelDescription/scene.h: their attributes, and the tag.
function sceneOf(file) {
  const selectors = ["VendorAnnotations > Tool[name='lagrange-fmu'] > scene > *", "Annotations > Annotation[type='lagrange-fmu'] > scene > *"];
  return [...file.querySelectorAll(selectors.join(","))].map((element) => ({ tag: element.tagName, ...attributesOf(element) }));
}

// Returns the names in the formulas of a line's ends.
function namesOfLine(line) {
  const formulas = ["x1", "y1", "z1", "x2", "y2", "z2"].map((name) => line[name] || "");
  return formulas.flatMap((formula) => formula.match(/[a-z_][\w.]*(\[[^\]]*\][\w.]*)*/gi) || []);
}

// Returns the names of the variables that may hold positions, orientations and constraint forces; an FMU has some of them.
function variablesOfScene(scene) {
  const positions = scene.filter((element) => "name" in element).flatMap((element) => POSITIONS.map((component) => `${element.name}.${component}`));
  const ofLines = scene.filter((element) => element.tag === "line").flatMap(namesOfLine);
  return new Set([...positions, ...ofLines, ...scene.flatMap((element) => ["force", "force1", "force2"].filter((name) => name in element).map((name) => element[name]))]);
}

// Returns the indices of the variables that can be plotted or that the scene needs; only those with these names, if names are given.
function indicesToShow(description, scene, names) {
  const ofScene = variablesOfScene(scene);
  const isShown = ({ name, type, isMoving, isDiscrete }) => type === "Real" && (isMoving || (isDiscrete && ofScene.has(name)));
  const indices = [...description.variables.keys()].filter((index) => isShown(description.variables[index]));
  const isImportant = ({ name, isOutput }) => isOutput || ofScene.has(name) || name.includes("Energy") || name.includes("Work");
  const selected = indices.length > MANY ? indices.filter((index) => isImportant(description.variables[index])) : indices;
  return names ? selected.filter((index) => names.includes(description.variables[index].name)) : selected;
}

// Returns the initial plots: coordinates of the first unit, the first velocity against the first coordinate, and energies.
function firstPlots(variables) {
  const columns = [...variables.keys()];
  const states = columns.filter((k) => variables[k].role === "start"), velocities = states.filter((k) => variables[k].unit?.endsWith("/s"));
  const coordinates = states.filter((k) => !velocities.includes(k));
  const outputs = columns.filter((k) => !variables[k].role);
  const first = [coordinates, states, outputs].find((some) => some.length > 0) ?? [];
  const sameUnit = first.filter((k) => variables[k].unit === variables[first[0]].unit).slice(0, 6);
  const energies = ["kineticEnergy", "potentialEnergy", "totalEnergy", "energy"].map((name) => variables.findIndex((variable) => variable.name === name)).filter((k) => k >= 0);
  const plots = [{ columns: sameUnit, abscissa: -1 }];
  if (coordinates.length > 0 && velocities.length > 0) plots.push({ columns: [velocities[0]], abscissa: coordinates[0] });
  if (energies.length > 0) plots.push({ columns: energies, abscissa: -1 });
  return plots;
}
