// Runs the FMU at the requested speed, and posts its samples. A message to it has a name and calls the function of that name in `orders`.
"use strict";

const TICK = 16; // ms, a frame at 60 Hz
const BUSY = 13; // ms of a tick for steps at most, so that messages are handled in time
const SAMPLES = 16; // of a tick at most
const SAVED = 600; // saved states at most, for steps back
const PREVIEW = 150; // ms for the simulation that determines the size of the view

let description, pulls, wasmOf; // wasmOf(isPulled): returns the functions of a new module
let shipped, pulled = null, side; // the FMU as shipped, the one whose bodies can be pulled, and the one that runs
let values = [new Map(), new Map()]; // settings of each FMU, by the index of the variable
let time = 0, speed = 1, playing = false, debt = 0, before = 0;
let period = 0; // s between points of the section; 0 for none
let ghost = null; // the second FMU while it does not run

const tell = (name, content = {}, transfer = []) => self.postMessage({ name, ...content }, transfer);

function refuse(problem, content = {}) {
  if (!(problem instanceof Refusal)) throw problem;
  tell("refused", { words: problem.message, ...content });
}

// Returns the length of the next step: at most the FMU's step size, at least 30 steps per second of wall-clock time, and ending at a period's end.
function stepLength() {
  const length = description.stepSize / Math.max(1, Math.ceil((description.stepSize * 30) / speed - 1e-9));
  if (!(period > 0)) return length;
  const end = (Math.floor(time / period + 1e-9) + 1) * period;
  return time + 1.000001 * length > end ? end - time : length;
}

const isAtPeriod = () => period > 0 && Math.abs(time / period - Math.round(time / period)) < 1e-9;

function save() {
  if (side.saved.length === SAVED) side.free.push(side.saved.shift()[1]);
  const places = side.free.pop() || [];
  side.saved.push([time, side.fmus.map((fmu, i) => fmu.save(places[i]))]);
}

function goBack() {
  if (side.saved.length === 0) return false;
  const [then, places] = side.saved.pop();
  side.fmus.forEach((fmu, i) => fmu.restore(places[i]));
  side.free.push(places);
  time = then;
  return true;
}

function advance(length) {
  for (const fmu of side.fmus) fmu.step(time, length);
  time += length;
}

const sample = () => side.fmus.map((fmu) => fmu.read(side.references));

// Returns the time, the values, and the number of events so far.
const row = () => [time, sample(), side.fmus[0].events()];

function tellOf(rows, isFresh, name = "samples") {
  const [times, values, events] = [0, 1, 2].map((part) => rows.map((one) => one[part]));
  tell(name, { times, rows: values, events, isFresh });
}

function tellNow(isFresh = false) {
  tellOf([row()], isFresh);
}

function pause() {
  playing = false;
  tell("paused");
}

function tick() {
  if (!playing) return;
  const start = performance.now(), rows = [], section = [];
  let length = stepLength();
  debt += (Math.min(start - before, 100) / 1000) * speed;
  before = start;
  const every = Math.ceil(debt / length / SAMPLES), from = time;
  try {
    if (debt >= length) save();
    for (let steps = 1; debt >= length && performance.now() < start + BUSY; steps++) {
      advance(length);
      debt -= length;
      length = stepLength();
      if (isAtPeriod()) section.push(row());
      if (steps % every === 0 || debt < length) rows.push(row());
    }
  } catch (problem) {
    goBack();
    refuse(problem);
    pause();
    tellNow(true);
    return;
  }
  if (rows.length > 0) tellOf(rows);
  if (section.length > 0) tellOf(section, false, "section");
  tell("pace", { reached: time - from, isBehind: debt >= length });
  debt = Math.min(debt, length);
  setTimeout(tick, Math.max(0, TICK - (performance.now() - start)));
}

// Simulates from the start for PREVIEW, to determine the size of the view.
function preview() {
  const end = performance.now() + PREVIEW, rows = [], times = [], steps = Math.min(1000, Math.ceil(description.duration / description.stepSize));
  try {
    for (let i = 0; i < steps && performance.now() < end; i++) {
      advance(description.stepSize);
      rows.push(sample()[0]);
      times.push(time);
    }
  } catch (problem) {
    if (!(problem instanceof Refusal)) throw problem;
  }
  tell("preview", { rows, times });
}

function startAnew() {
  side.forgetSaved();
  side = shipped;
  debt = 0;
  time = description.startTime;
  side.fmus.forEach((fmu, i) => fmu.start(values[i]));
}

// Continues with the FMU whose bodies can be pulled, until the next start. It is slower than the FMU as shipped.
function goOnPulled() {
  if (side !== shipped) return;
  const variables = description.variables.map((variable, place) => ({ ...variable, reference: pulls.references[place] }));
  pulled ||= new Side(wasmOf(true), { ...description, guid: pulls.guid, variables }, shipped.shown);
  while (pulled.fmus.length < shipped.fmus.length) pulled.add();
  pulled.fmus.length = shipped.fmus.length;
  pulled.fmus.forEach((fmu, i) => fmu.start([...values[i], ...shipped.statesOf(shipped.fmus[i])], time));
  shipped.forgetSaved();
  side = pulled;
}

// Returns the functions of an FMU's module.
function instanceOf(bytes) {
  const wasm = new WebAssembly.Instance(new WebAssembly.Module(bytes), {}).exports;
  wasm._initialize();
  return wasm;
}

const orders = {
  begin(message) {
    ({ description, pulls } = message);
    wasmOf = message.laboratory ? (isPulled) => derivedIn(message.laboratory, isPulled) : (isPulled) => instanceOf(message.modules[Number(isPulled)]);
    side = shipped = new Side(wasmOf(false), description, message.shown);
    shipped.add();
    orders.reset(message);
    preview();
    orders.reset({});
    tell("ready");
  },
  play() {
    if (playing) return;
    playing = true;
    before = performance.now();
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
      goBack();
      refuse(problem);
    }
    tellNow();
  },
  back() {
    if (goBack()) tellNow(true);
  },
  // Sets a value, which applies now and after the next start; start values and fixed parameters apply after the next start only.
  set({ place, value }) {
    const variable = description.variables[place], isLater = variable.role === "start" || variable.isFixed;
    const { fmus, kept } = side, earlier = fmus.map((_, i) => values[i].get(place) ?? variable.start);
    fmus.forEach((_, i) => values[i].set(place, value));
    if (isLater) return;
    fmus.forEach((fmu, i) => (kept[i] = fmu.save(kept[i])));
    try {
      for (const fmu of fmus) fmu.set(place, value);
      sample(); // the FMU may reject the value only when it is evaluated
      tell("accepted", { about: place });
    } catch (problem) {
      refuse(problem, { about: place, value, held: earlier[0] });
      fmus.forEach((fmu, i) => {
        values[i].set(place, earlier[i]);
        fmu.restore(kept[i]);
      });
    }
    if (!playing) tellNow(true);
  },
  // Restarts with all settings.
  reset({ set = [] }) {
    for (const [place, value] of set) values[0].set(place, value);
    try {
      startAnew();
      tellNow(true);
      tell("accepted");
    } catch (problem) {
      pause();
      refuse(problem);
    }
  },
  ghost({ differences }) {
    if (!differences) {
      ghost = shipped.fmus.splice(1)[0];
      orders.reset({});
      return;
    }
    values[1] = new Map([...values[0], ...differences]);
    if (shipped.fmus.length === 1 && ghost) shipped.fmus.push(ghost);
    else if (shipped.fmus.length === 1) shipped.add();
    orders.reset({});
  },
  // pointer: its position, the grasped point in the body's frame, and the damping time; a stiffness of 0 releases the body.
  pull({ body, pointer, stiffness }) {
    try {
      if (stiffness > 0) goOnPulled();
      if (side === shipped) return;
      for (const fmu of side.fmus) fmu.setReals([...pulls.pointer, pulls.bodies[body]], [...pointer, stiffness]);
    } catch (problem) {
      refuse(problem);
    }
  },
  // Steps to a time as fast as possible, with the FMU's step size.
  run({ until }) {
    const steps = Math.round((until - time) / description.stepSize), start = performance.now(), from = time;
    for (let i = 0; i < steps; i++) {
      for (const fmu of side.fmus) fmu.step(from + i * description.stepSize, description.stepSize);
      time = from + (i + 1) * description.stepSize;
    }
    tell("ran", { seconds: (performance.now() - start) / 1000, time, values: sample()[0] });
    tellNow(true);
  },
};

self.onmessage = (event) => orders[event.data.name](event.data);
