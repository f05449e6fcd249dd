// The page: shows the samples of the FMU, which runs in the worker, and sends it the user's settings; or plays a recording.
"use strict";

const GHOST = 1e-9; // difference of the ghost's first start value
// Functions of formulas that Math of JavaScript has, too.
const FUNCTIONS = ["sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "exp", "log", "sqrt", "pow", "abs", "sign", "min", "max", "floor", "ceil"];
const $ = (id) => document.getElementById(id);
const data = JSON.parse($("data").textContent);
const { recording, laboratory } = data;
const parsed = async (content) => new DOMParser().parseFromString(await textOf(content), "text/xml");
const file = await parsed(data.modelDescription);
const description = descriptionOf(file), sceneParts = sceneOf(file);
for (const variable of description.variables) if (variable.name in (data.start ?? {})) variable.start = data.start[variable.name];
const pulls = data.pulled && sceneParts.length > 0 ? pullsOf(await parsed(data.pulled), description) : null;
const shownOnes = shownPlaces(description, sceneParts, recording?.names);
const shownVariables = shownOnes.map((place) => description.variables[place]);
const shownWindow = recording ? recording.duration : Math.min(WINDOW, description.duration);
const columnOf = new Map(shownVariables.map((variable, column) => [variable.name, column]));
const history = new History(shownVariables.length);
const sections = new History(shownVariables.length); // a sample at the end of each period: a Poincaré section
const controls = new Map(); // by the index of the variable
const plots = [];
const live = (window.live = { history, sections, plots, names: shownVariables.map((variable) => variable.name), answers: {}, ready: null, valueOf, rangeOf: (name) => ranges().get(name) }); // for tests and the browser's console
let worker, scene = null, energyBar = null, playing = false, viewed = null, pace = [0, 0];
const CLOCK_DIGITS = Math.max(0, Math.min(12, 3 - Math.floor(Math.log10(recording ? recording.duration : description.duration))));

let resetDue = null; // timer of a delayed reset, which collects several settings

// Sends an order to the worker; a delayed reset is done before any order but "set".
function order(name, content = {}) {
  if (recording) return;
  if (resetDue !== null && name !== "set") {
    clearTimeout(resetDue);
    resetDue = null;
    if (name !== "reset") worker.postMessage({ name: "reset" });
  }
  worker.postMessage({ name, ...content });
}

const formulas = new Map(); // functions of formulas that were compiled

// Returns a formula in JavaScript. A variable is an element of the sample `s`, the time `t`, or the value `p(i)` that the user can set; without
// samples always the latter.
function inJavaScript(formula, hasSamples) {
  const text = formula.replace(/\d[\d.]*(e[+-]?\d+)?|[a-z_][\w.]*(\[[^\]]*\][\w.]*)*(?![\w.]*\()/gi, (name) => {
    if (/^\d/.test(name)) return name;
    if (name === "time") return "t";
    if (hasSamples && columnOf.has(name)) return `s[${columnOf.get(name)}]`;
    const place = description.variables.findIndex((variable) => variable.name === name);
    return place >= 0 ? `p(${place})` : name === "pi" ? "Math.PI" : "NaN";
  });
  // JavaScript rejects a sign before a power, and `if` as the name of a function.
  return text.replace(/(^|[(,*/+-])\s*-/g, "$1-1*").replace(/\^/g, "**").replace(/\bif\(/g, "choose(");
}

// Returns the function of a sample and its time that evaluates a formula; its value is NaN if it cannot be evaluated.
function compiled(formula, hasSamples = true) {
  const key = `${hasSamples} ${formula}`;
  if (formulas.has(key)) return formulas.get(key);
  let evaluate = () => NaN;
  try {
    const called = new Function("s", "t", "p", "choose", ...FUNCTIONS, `return ${inJavaScript(formula, hasSamples)}`);
    const valueAt = (place) => controls.get(place)?.value ?? description.variables[place].start;
    const choose = (condition, first, second) => (condition ? first : second), maths = FUNCTIONS.map((name) => Math[name]);
    evaluate = (sample, time) => {
      try {
        return Number(called(sample, time, valueAt, choose, ...maths));
      } catch {
        return NaN;
      }
    };
  } catch {
    // a formula of functions that JavaScript lacks
  }
  formulas.set(key, evaluate);
  return evaluate;
}

// Returns the value of a formula of parameters and inputs, as the user has set them; NaN if it contains unknown names.
function valueOf(formula) {
  return compiled(formula, false)([], NaN);
}

// Returns the ranges of the sliders by name.
const ranges = () => new Map([...controls.values()].map(({ variable, low, high }) => [variable.name, [low, high]]));

function say(words) {
  $("words").hidden = !words;
  $("words").textContent = words;
}

const answers = {
  ready() {
    live.ready();
  },
  preview({ rows, times }) {
    buildScene(...(rows.length ? [rows, times] : [history.samples.map((runs) => runs[0]), history.times]));
  },
  samples({ times, rows, events, isFresh }) {
    if (isFresh) for (const one of [history, sections]) one.cut(times[0]);
    if (isFresh) sent = "";
    if (history.length > 0 && history.runs !== rows[0].length) history.clear();
    times.forEach((time, i) => history.add(time, rows[i], events[i]));
    viewed = null;
    $("past").max = Math.max(0, history.length - 1);
    $("past").value = $("past").max;
  },
  section({ times, rows }) {
    times.forEach((time, i) => sections.add(time, rows[i]));
  },
  pace({ reached, isBehind }) {
    pace = [0.95 * pace[0] + 0.05 * Number(isBehind), 0.95 * pace[1] + reached];
  },
  paused() {
    setPlaying(false);
  },
  accepted({ about }) {
    if (scene) scene.adapt();
    controls.get(about)?.say("");
    say("");
  },
  refused({ words, about, value, held }) {
    if (controls.has(about)) controls.get(about).refuse(words, value, held);
    else say(words);
  },
  ran(message) {
    live.answers.ran(message);
  },
};

// Builds the scene so that the view contains all these samples.
function buildScene(samples, times) {
  if (!scene) return;
  scene.build(samples, times);
  $("turning").parentElement.hidden = !scene.plane;
  $("forcesChoice").hidden = scene.arrows.forces.length === 0;
  $("velocitiesChoice").hidden = scene.arrows.velocities.length === 0;
  $("followChoice").hidden = scene.followed.length === 0;
}

function setPlaying(isPlaying) {
  playing = isPlaying;
  $("play").textContent = isPlaying ? "Pause" : "Play";
}

// Steps, steps back, or resets the FMU, or the view of a recording.
function move(name) {
  order(name);
  if (recording) viewFrom({ step: viewed + 1, back: viewed - 1, reset: 0 }[name]);
}

function play() {
  if (!playing) order("play");
  else order("pause");
  setPlaying(!playing);
}

const speedOf = () => Number((10 ** Number($("speed").value)).toPrecision(2)) * (recording ? recording.speed : 1);

function setSpeed() {
  $("speedShown").textContent = `× ${shown(speedOf(), 2)}`;
  order("speed", { value: speedOf() });
}

function addControls() {
  const kinds = [["input", "Inputs"], ["parameter", "Parameters"], ["start", "Start values"]];
  for (const [role, title] of kinds) {
    const found = description.variables.map((variable, place) => [variable, place]).filter(([variable]) => variable.role === role);
    if (found.length === 0) continue;
    const made = found.map(([variable, place]) => {
      const control = new Control(variable, (value) => set(place, value));
      controls.set(place, control);
      return control;
    });
    $("controls").append(section(title, made, role !== "start" || found.length <= 12));
  }
}

function set(place, value) {
  order("set", { place, value });
  const { role, isFixed } = description.variables[place];
  if ((role !== "start" && !isFixed) || resetDue !== null) return;
  // Takes effect at the next start; before the first step the FMU is reset at once.
  if (history.length <= 1) resetDue = setTimeout(() => order("reset"), 50);
}

function addPlots() {
  for (const { places, across } of firstPlots(shownVariables)) {
    const plot = new Plot(history, sections, shownVariables, places, across);
    plots.push(plot);
    $("plots").append(plot.element);
  }
}

// The shown time of the recording in s, and the clock of the frame that showed it in ms.
const player = { time: 0, before: null };

function playOn(now) {
  const [first, last] = [history.time(0), history.time(history.length - 1)];
  if (playing && player.before !== null) {
    player.time += ((now - player.before) / 1000) * speedOf();
    if (player.time > last) player.time = first;
    view(history.placeOf(player.time));
  }
  player.before = now;
}

// Shows an earlier sample, or one of the recording.
function view(place) {
  viewed = Math.max(0, Math.min(history.length - 1, place));
  $("past").value = viewed;
}

// Shows a sample, from which the recording continues.
function viewFrom(place) {
  view(place);
  player.time = history.time(viewed);
}

function frame(now) {
  if (recording) playOn(now);
  else readGamePads();
  if (history.length > 0) {
    const at = viewed === null ? history.length - 1 : Math.min(viewed, history.length - 1);
    $("clock").textContent = `${history.time(at).toFixed(CLOCK_DIGITS)} s`;
    $("pace").textContent = playing && pace[0] > 0.5 ? "slower than requested" : "";
    if (scene && scene.objects) {
      if (at === history.length - 1) pullOn();
      scene.draw(history, at);
    }
    energyBar?.draw(at);
    drawPresented(at);
    const first = history.placeOf(history.time(history.length - 1) - shownWindow);
    for (const plot of plots) plot.draw(first, history.length, at);
  }
  requestAnimationFrame(frame);
}

function save(name, content, type) {
  const link = Object.assign(document.createElement("a"), { download: name, href: URL.createObjectURL(new Blob([content], { type })) });
  link.click();
  URL.revokeObjectURL(link.href);
}

// Returns the controls whose values differ from those of the FMU.
const settings = () => [...controls].filter(([place, control]) => control.value !== description.variables[place].start);

// Starts or ends a second run, whose first start value differs slightly.
function toggleGhost() {
  const start = [...controls].find(([place]) => description.variables[place].role === "start");
  const differences = history.runs > 1 || !start ? null : [...settings(), start].map(([place, control]) => [place, control.value + (place === start[0] ? GHOST : 0)]);
  order("ghost", { differences });
}

function addActions() {
  $("ghost").addEventListener("click", toggleGhost);
  $("ghost").hidden = ![...controls].some(([place]) => description.variables[place].role === "start");
  $("play").addEventListener("click", play);
  for (const name of ["step", "back", "reset"]) $(name).addEventListener("click", () => move(name));
  $("speed").addEventListener("input", setSpeed);
  $("period").addEventListener("change", () => {
    sections.clear();
    order("period", { value: Math.max(0, $("period").valueAsNumber || 0) });
  });
  $("past").addEventListener("input", () => viewFrom(Number($("past").value)));
  $("fit").addEventListener("click", () => scene && scene.fit());
  $("turning").addEventListener("change", () => scene && scene.allowTurning((scene.wished.turning = $("turning").checked)));
  for (const name of ["names", "trails", "forces", "velocities", "follow"]) $(name).addEventListener("change", () => scene && (scene.wished[name] = $(name).checked));
  $("csv").addEventListener("click", () => save(`${description.name}.csv`, history.csv(live.names), "text/csv"));
  $("picture").addEventListener("click", () => scene && scene.renderer.domElement.toBlob((picture) => save(`${description.name}.png`, picture, "image/png")));
  $("link").addEventListener("click", () => {
    const words = new URLSearchParams(settings().map(([place, control]) => [description.variables[place].name, control.value]));
    window.history.replaceState(null, "", `#${words}`);
    if (navigator.clipboard) navigator.clipboard.writeText(location.href).catch(() => {});
  });
  $("licenses").addEventListener("click", () => {
    $("licenseWords").querySelector("pre").textContent = data.licenses;
    $("licenseWords").showModal();
  });
  $("present").addEventListener("click", togglePresentation);
  document.addEventListener("fullscreenchange", endPresentation);
  window.addEventListener("resize", () => scene && scene.objects && scene.resize());
}

// Applies the page's settings, and those of the address after #, name=value&name=value, which have precedence; returns them.
function settingsAtStart() {
  const given = [...Object.entries(data.settings ?? {}), ...new URLSearchParams(location.hash.slice(1))];
  const byName = new Map(description.variables.map((variable, place) => [variable.name, place])), found = [];
  for (const [name, text] of given) {
    const place = byName.get(name), value = Number(text);
    if (!controls.has(place) || !Number.isFinite(value)) continue;
    controls.get(place).choose(value, () => {});
    found.push([place, value]);
  }
  return found;
}

// For tests: steps to a time as fast as possible; resolves to the time, the shown values and the seconds it took.
live.run = (until) =>
  new Promise((done) => {
    live.answers.ran = done;
    order("run", { until });
  });

async function playRecording() {
  const numbers = new Float64Array(await unpacked(recording.rows)), width = 1 + recording.names.length;
  history.most = numbers.length / width;
  const columns = live.names.map((name) => 1 + recording.names.indexOf(name));
  const counter = 1 + recording.names.indexOf("events"); // 0 without events
  for (let i = 0; i < numbers.length; i += width) history.add(numbers[i], [Float64Array.from(columns, (column) => numbers[i + column])], counter && numbers[i + counter]);
  buildScene(history.samples.map((runs) => runs[0]), history.times);
  $("past").max = history.length - 1;
  viewFrom(0);
  $("pastName").textContent = "Time";
  setSpeed();
  setPlaying(true);
}

// Separates the modules that _interleaved() of page.py has interleaved.
function apart(bytes) {
  const modules = data.lengths.map((length) => new Uint8Array(length));
  let at = 0;
  for (let i = 0; i < data.pieces; i++) {
    for (const module of modules) {
      const [from, to] = [i, i + 1].map((k) => Math.floor((module.length * k) / data.pieces));
      module.set(new Uint8Array(bytes, at, to - from), from);
      at += to - from;
    }
  }
  return modules;
}

async function runFmu() {
  const started = new Promise((done) => (live.ready = done));
  worker = new Worker(URL.createObjectURL(new Blob([await unpacked(data.worker)], { type: "text/javascript" })));
  worker.onmessage = (event) => answers[event.data.name](event.data);
  setSpeed();
  const modules = laboratory ? { laboratory: { ...laboratory, bytes: window.parent.laboratoryBytes } } : { modules: apart(await unpacked(data.wasm)) };
  worker.postMessage({ name: "begin", ...modules, pulls, description, shown: shownOnes, set: settingsAtStart() });
  await started;
}

// Shows the title of a system that was derived in the browser.
function showTitle() {
  const title = file.documentElement.getAttribute("description") || description.name;
  document.title = title;
  document.querySelector("h1").textContent = title;
  $("scene").setAttribute("aria-label", `${title}, as it moves`);
}

function addEnergyBar() {
  const columns = ["kineticEnergy", "potentialEnergy"].map((name) => columnOf.get(name));
  if (columns.includes(undefined)) return;
  energyBar = new EnergyBar($("energies"), history, columns);
  $("energies").hidden = false;
}

async function begin() {
  if (laboratory) showTitle();
  if (!recording) {
    addControls();
    addPresets();
  }
  addPlots();
  addActions();
  addKeys();
  addVideo();
  addSystem();
  if (sceneParts.length > 0) {
    await load(data.renderer);
    scene = live.scene = new Scene($("scene"), sceneParts, (name) => columnOf.get(name) ?? -1, valueOf, compiled);
    addPulling();
    addEnergyBar();
    scene.wished = { trails: true, names: false, turning: false, forces: true, velocities: false, follow: true };
  } else $("view").remove();
  document.body.classList.toggle("plain", sceneParts.length === 0);
  document.body.classList.toggle("recorded", Boolean(recording));
  for (const name of ["link", "ghost", "periodChoice"]) $(name).hidden ||= Boolean(recording);
  await (recording ? playRecording() : runFmu());
  requestAnimationFrame(frame);
  document.body.dataset.ready = "true";
  if (data.plays) play();
}

live.started = begin();
