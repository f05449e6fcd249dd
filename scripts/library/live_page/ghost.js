// The ghost: a second run beside the first one, drawn pale.
"use strict";

const GHOST = 1e-9; // difference of the ghost's first start value
const REACH = { linear: 1 }, OTHER_REACH = 3; // widths of a range by which a ghost may exceed it in plots; a linear one ends there

let kept = new Map(); // settings of the ghost that keeps them, by the index of the variable

const ghostKind = () => $("ghost").value;
const firstStart = () => [...controls].find(([index]) => description.variables[index].role === "start");
const ghostReach = () => REACH[ghostKind()] ?? OTHER_REACH;

// Restarts with a second run of the chosen kind, or without one. The first start value of the kind "near" differs slightly.
function chooseGhost() {
  const kind = ghostKind(), [index, control] = firstStart();
  kept = new Map([...controls].map(([index, { value }]) => [index, value]));
  if (scene) scene.options.ghost = kind;
  send("ghost", { kind, differences: kind === "near" ? [[index, control.value + GHOST]] : [] });
}

// Returns the description of the pale run, with the values that it keeps and the first one has no longer.
function ghostText() {
  const kind = ghostKind(), differing = [...kept].filter(([index, value]) => controls.get(index).value !== value && description.variables[index].role !== "input");
  if (kind === "linear") return "pale: linearized";
  if (kind === "near") return `pale: ${firstStart()[1].variable.name} + ${GHOST}`;
  const values = differing.map(([index, value]) => [description.variables[index].name, "=", formatted(value), description.variables[index].unit ?? ""].join(" ").trim());
  return `pale: ${values.length ? `kept, with ${values.join(", ")}` : "kept, with the same values"}`;
}

function showGhostText() {
  const text = history.runs > 1 ? ghostText() : "";
  if ($("pale").textContent !== text) $("pale").textContent = text;
}

// Returns the index of the first sample at which a linear ghost is outside of the range of a state by more than its reach.
function ghostEnd(first, last) {
  if (history.runs < 2 || ghostKind() !== "linear") return last;
  let end = last;
  for (const column of shownVariables.keys()) {
    if (shownVariables[column].role !== "start") continue;
    const [low, high] = spanOf(first, last, (i) => history.value(i, column, 0)), reach = ghostReach() * (high - low), isNear = (value) => value >= low - reach && value <= high + reach;
    for (let i = first; i < end; i++) if (!isNear(history.value(i, column, 1))) end = i;
  }
  return end;
}
