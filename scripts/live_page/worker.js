// Runs the FMU at the speed that is wished, and tells of where it is. Messages to it have a name, and go to the function of that name in `orders`.
"use strict";

const TICK = 16; // ms
const BUSY = 13; // ms of a tick that may go into steps
const SAMPLES = 16; // at most, of a tick
const SAVED = 600; // states to go back to
const PREVIEW = 150; // ms, in which what there will be to see is looked at

let fmus = []; // one, or with its ghost beside it
let wasm, description, references;
let values = [new Map(), new Map()]; // what was set, by the place of the variable; of each FMU
let time = 0, speed = 1, playing = false, debt = 0, before = 0;
let kept = []; // a state for each FMU, of before something was set
let saved = [], free = []; // [time, a state for each FMU]; states whose places can be used again

const tell = (name, content = {}, transfer = []) => self.postMessage({ name, ...content }, transfer);

function refuse(problem, about) {
  if (!(problem instanceof Refusal)) throw problem;
  tell("refused", { words: problem.message, about });
}

// No longer than the step that the author gave, and 30 of them a second to see.
function stepLength() {
  return description.stepSize / Math.max(1, Math.ceil((description.stepSize * 30) / speed - 1e-9));
}

function save() {
  if (saved.length === SAVED) free.push(saved.shift()[1]);
  const places = free.pop() || [];
  saved.push([time, fmus.map((fmu, i) => fmu.save(places[i]))]);
}

function forgetSaved() {
  free.push(...saved.splice(0).map((one) => one[1]));
}

function goBack() {
  if (saved.length === 0) return false;
  const [then, places] = saved.pop();
  fmus.forEach((fmu, i) => fmu.restore(places[i]));
  free.push(places);
  time = then;
  return true;
}

function advance(length) {
  for (const fmu of fmus) fmu.step(time, length);
  time += length;
}

const sample = () => fmus.map((fmu) => fmu.read(references));

function tellOf(rows, isFresh) {
  tell("samples", { times: rows.map((row) => row[0]), rows: rows.map((row) => row[1]), isFresh });
}

function tellNow(isFresh = false) {
  tellOf([[time, sample()]], isFresh);
}

function pause() {
  playing = false;
  tell("paused");
}

function tick() {
  if (!playing) return;
  const start = performance.now(), length = stepLength(), rows = [];
  debt += (Math.min(start - before, 100) / 1000) * speed;
  before = start;
  const every = Math.ceil(debt / length / SAMPLES), from = time;
  try {
    if (debt >= length) save();
    for (let steps = 1; debt >= length && performance.now() < start + BUSY; steps++) {
      advance(length);
      debt -= length;
      if (steps % every === 0 || debt < length) rows.push([time, sample()]);
    }
  } catch (problem) {
    goBack();
    refuse(problem);
    pause();
    tellNow(true);
    return;
  }
  if (rows.length > 0) tellOf(rows);
  tell("pace", { reached: time - from, isBehind: debt >= length });
  debt = Math.min(debt, length);
  setTimeout(tick, Math.max(0, TICK - (performance.now() - start)));
}

// From the start for a while: where things go, for a view of all of it.
function preview() {
  const end = performance.now() + PREVIEW, rows = [], steps = Math.min(1000, Math.ceil(description.duration / description.stepSize));
  try {
    for (let i = 0; i < steps && performance.now() < end; i++) {
      advance(description.stepSize);
      rows.push(sample()[0]);
    }
  } catch (problem) {
    if (!(problem instanceof Refusal)) throw problem;
  }
  tell("preview", { rows });
}

function startAnew() {
  forgetSaved();
  debt = 0;
  time = description.startTime;
  fmus.forEach((fmu, i) => fmu.start(values[i]));
}

const orders = {
  async begin(message) {
    description = message.description;
    references = message.references;
    wasm = (await WebAssembly.instantiate(message.wasm, {})).instance.exports;
    wasm._initialize();
    fmus = [new Fmu(wasm, description)];
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
  // A value from now on, and from the start the next time.
  set({ place, value, ghost = 0 }) {
    const variable = description.variables[place], earlier = values[ghost].get(place);
    values[ghost].set(place, value);
    if (variable.role === "start" || variable.isFixed || !fmus[ghost]) return;
    kept[ghost] = fmus[ghost].save(kept[ghost]);
    try {
      fmus[ghost].set(place, value);
      sample(); // which it may refuse only then
      tell("accepted", { about: place });
    } catch (problem) {
      refuse(problem, place);
      values[ghost].set(place, earlier === undefined ? variable.start : earlier);
      fmus[ghost].restore(kept[ghost]);
    }
    if (!playing) tellNow(true);
  },
  // Begins anew, with what was set meanwhile.
  reset({ set = [], about }) {
    for (const [place, value] of set) values[0].set(place, value);
    try {
      startAnew();
      tellNow(true);
      tell("accepted", { about: "start" });
    } catch (problem) {
      pause();
      refuse(problem, "start");
    }
  },
  ghost({ differences }) {
    if (!differences) {
      fmus.length = 1;
      orders.reset({});
      return;
    }
    values[1] = new Map([...values[0], ...differences]);
    if (fmus.length === 1) fmus.push(new Fmu(wasm, description));
    orders.reset({});
  },
  // Without pacing: by steps of the author's length to this time.
  run({ until }) {
    const steps = Math.round((until - time) / description.stepSize), start = performance.now(), from = time;
    for (let i = 0; i < steps; i++) {
      for (const fmu of fmus) fmu.step(from + i * description.stepSize, description.stepSize);
      time = from + (i + 1) * description.stepSize;
    }
    tell("ran", { seconds: (performance.now() - start) / 1000, time, values: sample()[0] });
    tellNow(true);
  },
};

self.onmessage = (event) => orders[event.data.name](event.data);
