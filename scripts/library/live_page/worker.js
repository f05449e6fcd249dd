// Runs the FMU at the requested speed, and posts its samples. A message to it has a name and calls the function of that name in `commands`.
"use strict";

const TICK = 16; // ms, a frame at 60 Hz
const LONGEST_WORK = 13; // ms of steps in a tick at most, so that messages are handled in time
const MOST_SAMPLES = 16; // largest number of samples in a tick
const MOST_SAVED = 600; // saved states at most, for steps back
const PREVIEW = 150; // ms for the simulation that determines the size of the view
const MOST_PREVIEWED = 1000; // steps of this simulation

let description, pulls, wasmOf; // wasmOf(isPulled): returns the functions of a new module
let shipped, pulled = null, active; // variants: as shipped, with inputs that pull bodies, and the one that runs
let values = [new Map(), new Map()]; // settings of each FMU, by the index of the variable
let time = 0, speed = 1, playing = false, due = 0, lastTick = 0; // due: s that are still to be simulated; lastTick: in ms
let period = 0; // s between points of the section; 0 for none
let ghostKind = "none", exactGhost = null, linearGhost = null; // the second run; exact and linear ones are created once, and kept
let linearizer = null; // the FMU with which equilibria are found

const post = (name, content = {}, transfer = []) => self.postMessage({ name, ...content }, transfer);

function reportError(problem, content = {}) {
  if (!(problem instanceof FmuError)) throw problem;
  post("rejected", { message: problem.message, ...content });
}

// Returns the length of the next step. It is at most the FMU's step size, gives at least 30 steps per second of wall-clock time, and ends at a period's end.
function stepLength() {
  const length = description.stepSize / Math.max(1, Math.ceil((description.stepSize * 30) / speed - 1e-9));
  if (!(period > 0)) return length;
  const end = (Math.floor(time / period + 1e-9) + 1) * period;
  return time + 1.000001 * length > end ? end - time : length;
}

const isAtPeriod = () => period > 0 && Math.abs(time / period - Math.round(time / period)) < 1e-9;

function save() {
  if (active.savedStates.length === MOST_SAVED) active.freeStates.push(active.savedStates.shift()[1]);
  const states = active.freeStates.pop() || [];
  active.savedStates.push([time, active.fmus.map((fmu, i) => fmu.save(states[i]))]);
}

function stepBack() {
  if (active.savedStates.length === 0) return false;
  const [earlier, states] = active.savedStates.pop();
  active.fmus.forEach((fmu, i) => fmu.restore(states[i]));
  active.freeStates.push(states);
  time = earlier;
  return true;
}

function advance(length) {
  for (const fmu of active.fmus) fmu.step(time, length);
  time += length;
}

const sample = () => active.fmus.map((fmu) => fmu.read(active.references));

// Returns the time, the values, and the number of events so far.
const row = () => [time, sample(), active.fmus[0].events()];

function postRows(rows, isFresh, name = "samples") {
  const [times, values, events] = [0, 1, 2].map((part) => rows.map((entries) => entries[part]));
  post(name, { times, rows: values, events, isFresh });
}

function postPresent(isFresh = false) {
  postRows([row()], isFresh);
}

function pause() {
  playing = false;
  post("paused");
}

function tick() {
  if (!playing) return;
  const start = performance.now(), rows = [], section = [];
  let length = stepLength();
  due += (Math.min(start - lastTick, 100) / 1000) * speed;
  lastTick = start;
  const every = Math.ceil(due / length / MOST_SAMPLES), from = time;
  try {
    if (due >= length) save();
    for (let steps = 1; due >= length && performance.now() < start + LONGEST_WORK; steps++) {
      advance(length);
      due -= length;
      length = stepLength();
      if (isAtPeriod()) section.push(row());
      if (steps % every === 0 || due < length) rows.push(row());
    }
  } catch (problem) {
    stepBack();
    reportError(problem);
    pause();
    postPresent(true);
    return;
  }
  if (rows.length > 0) postRows(rows);
  if (section.length > 0) postRows(section, false, "section");
  post("pace", { reached: time - from, isBehind: due >= length });
  due = Math.min(due, length);
  setTimeout(tick, Math.max(0, TICK - (performance.now() - start)));
}

// Simulates from the start, for at most PREVIEW and with at most MOST_PREVIEWED steps, to determine the size of the view.
function preview() {
  const { duration, stepSize } = description, length = Math.max(stepSize, duration / MOST_PREVIEWED), steps = Math.ceil(duration / length);
  const end = performance.now() + PREVIEW, rows = [], times = [];
  try {
    for (let i = 0; i < steps && performance.now() < end; i++) {
      advance(length);
      rows.push(sample()[0]);
      times.push(time);
    }
  } catch (problem) {
    if (!(problem instanceof FmuError)) throw problem;
  }
  post("preview", { rows, times });
}

function restart() {
  active.forgetSavedStates();
  active = shipped;
  due = 0;
  time = description.startTime;
  const [fmu, ghost] = active.fmus;
  fmu.start(values[0]);
  if (ghost) startGhost(ghost);
}

// Starts the second run; ends it if that fails, as where there is no equilibrium to linearize about.
function startGhost(ghost) {
  try {
    ghost.start(values[1]);
  } catch (problem) {
    shipped.fmus.length = 1;
    ghostKind = "none";
    reportError(problem, { hasEndedGhost: true });
  }
}

// True if a setting applies to a run. The settings of a ghost that keeps them do not change, but both runs share inputs.
const isFor = (i, { role }) => i === 0 || ghostKind !== "kept" || role === "input";

// Continues with the FMU whose bodies can be pulled, until the next start. It is slower than the FMU as shipped.
function switchToPulled() {
  if (active !== shipped) return;
  const variables = description.variables.map((variable, index) => ({ ...variable, reference: pulls.references[index] }));
  pulled ||= new Variant(wasmOf(true), { ...description, guid: pulls.guid, variables }, shipped.shown);
  const count = ghostKind === "linear" ? 1 : shipped.fmus.length;
  while (pulled.fmus.length < count) pulled.addFmu();
  pulled.fmus.length = count;
  pulled.fmus.forEach((fmu, i) => fmu.start([...values[i], ...shipped.statesOf(shipped.fmus[i])], time));
  shipped.forgetSavedStates();
  active = pulled;
}

// Returns the functions of an FMU's module.
function instanceOf(bytes) {
  const wasm = new WebAssembly.Instance(new WebAssembly.Module(bytes), {}).exports;
  wasm._initialize();
  return wasm;
}

const commands = {
  begin(message) {
    ({ description, pulls } = message);
    wasmOf = message.laboratory ? (isPulled) => derivedIn(message.laboratory, isPulled) : (isPulled) => instanceOf(message.modules[Number(isPulled)]);
    active = shipped = new Variant(wasmOf(false), description, message.shown);
    shipped.addFmu();
    commands.reset(message);
    preview();
    commands.reset({});
    post("ready");
  },
  play() {
    if (playing) return;
    playing = true;
    lastTick = performance.now();
    tick();
  },
  pause,
  speed(message) {
    speed = message.value;
  },
  period(message) {
    period = message.value;
  },
  step() {
    save();
    try {
      advance(stepLength());
    } catch (problem) {
      stepBack();
      reportError(problem);
    }
    postPresent();
  },
  back() {
    if (stepBack()) postPresent(true);
  },
  // Sets a value, which applies now and after the next start; start values and fixed parameters apply after the next start only.
  set({ index, value }) {
    const variable = description.variables[index], isLater = variable.role === "start" || variable.isFixed;
    const { fmus, previous } = active, earlier = fmus.map((_, i) => values[i].get(index) ?? variable.start);
    const running = fmus.filter((_, i) => isFor(i, variable));
    running.forEach((fmu) => values[fmus.indexOf(fmu)].set(index, value));
    if (isLater) return;
    fmus.forEach((fmu, i) => (previous[i] = fmu.save(previous[i])));
    try {
      for (const fmu of running) fmu.set(index, value);
      sample(); // the FMU may reject the value only when it is evaluated
      post("accepted", { about: index });
    } catch (problem) {
      reportError(problem, { about: index, value, previous: earlier[0] });
      fmus.forEach((fmu, i) => {
        values[i].set(index, earlier[i]);
        fmu.restore(previous[i]);
      });
    }
    if (!playing) postPresent(true);
  },
  // Restarts with all settings.
  reset({ set = [] }) {
    for (const [index, value] of set) values[0].set(index, value);
    try {
      post("accepted");
      restart();
      postPresent(true);
    } catch (problem) {
      pause();
      reportError(problem);
    }
  },
  // Restarts with a second run of a kind: "none", "near" with different settings, "kept" with the present settings, or "linear".
  ghost({ kind, differences }) {
    ghostKind = kind;
    values[1] = new Map([...values[0], ...differences]);
    shipped.fmus.length = 1;
    if (kind === "linear") shipped.fmus.push((linearGhost ??= new LinearMotion(new Fmu(shipped.wasm, description), description)));
    else if (kind !== "none") shipped.fmus.push((exactGhost ??= new Fmu(shipped.wasm, description)));
    commands.reset({});
  },
  // Finds an equilibrium near the present state, and the linearization there.
  linearize() {
    try {
      linearizer ??= new Fmu(shipped.wasm, description);
      const point = new Point(linearizer, description, [...values[0]], time), { variables } = active.description;
      const states = active.fmus[0].read(point.indices.map((index) => variables[index].reference));
      const model = linearizationAt(point, equilibriumNear(point, states)), eigenvalues = eigenvaluesOf(model.A);
      post("linearized", { model, eigenvalues, stability: stabilityOf(model.A, eigenvalues), indices: point.indices });
    } catch (problem) {
      if (!(problem instanceof FmuError)) throw problem;
      post("linearized", { problem: problem.message });
    }
  },
  // pointer: its position, the grasped point in the body's frame, and the damping time; a stiffness of 0 releases the body.
  pull({ body, pointer, stiffness }) {
    try {
      if (stiffness > 0) switchToPulled();
      if (active === shipped) return;
      for (const fmu of active.fmus) fmu.setReals([...pulls.pointer, pulls.bodies[body]], [...pointer, stiffness]);
    } catch (problem) {
      reportError(problem);
    }
  },
  // Steps to a time as fast as possible, with the FMU's step size.
  run({ until }) {
    const steps = Math.round((until - time) / description.stepSize), start = performance.now(), from = time;
    for (let i = 0; i < steps; i++) {
      for (const fmu of active.fmus) fmu.step(from + i * description.stepSize, description.stepSize);
      time = from + (i + 1) * description.stepSize;
    }
    post("finished", { seconds: (performance.now() - start) / 1000, time, values: sample()[0] });
    postPresent(true);
  },
};

self.onmessage = (event) => commands[event.data.name](event.data);
