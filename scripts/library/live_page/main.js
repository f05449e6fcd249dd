// The page: shows the samples of the FMU, which runs in the worker, and sends it the user's settings; or plays a recording.
"use strict";

const [SHORT, LONG, SHOWN_FOR] = [2, 100, 5]; // s: an experiment outside of these durations begins at a speed at which it is shown for some seconds
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
const shownIndices = indicesToShow(description, sceneParts, recording?.names);
const shownVariables = shownIndices.map((index) => description.variables[index]);
const shownWindow = recording ? recording.duration : Math.min(WINDOW, description.duration);
const columnOf = new Map(shownVariables.map((variable, column) => [variable.name, column]));
const history = new History(shownVariables.length);
const sections = new History(shownVariables.length); // a sample at the end of each period: a Poincaré section
const controls = new Map(); // by the index of the variable
const plots = [];
const live = (window.live = { history, sections, plots, names: shownVariables.map((variable) => variable.name), handlers: {}, ready: null, valueOf, ghostEnd, rangeOf: (name) => ranges().get(name) }); // for tests and the browser's console
let worker, scene = null, energyBar = null, playing = false, viewed = null, pace = [0, 0];
const CLOCK_DIGITS = Math.max(0, Math.min(12, 3 - Math.floor(Math.log10(recording ? recording.duration : description.duration))));

let resetTimer = null; // timer of a delayed reset, which collects several settings

// Sends a command to the worker; a delayed reset is done before any command but "set".
function send(name, content = {}) {
  if (recording) return;
  if (resetTimer !== null && name !== "set") {
    clearTimeout(resetTimer);
    resetTimer = null;
    if (name !== "reset") worker.postMessage({ name: "reset" });
  }
  if (name === "set" && description.variables[content.index].role === "parameter") energyBar?.forget();
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
    const index = description.variables.findIndex((variable) => variable.name === name);
    return index >= 0 ? `p(${index})` : name === "pi" ? "Math.PI" : "NaN";
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
    const valueAt = (index) => controls.get(index)?.value ?? description.variables[index].start;
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

function showMessage(message) {
  $("message").hidden = !message;
  $("message").textContent = message;
}

const handlers = {
  ready() {
    live.ready();
  },
  preview({ rows, times }) {
    buildScene(...(rows.length ? [rows, times] : [history.samples.map((runs) => runs[0]), history.times]));
  },
  samples({ times, rows, events, isFresh }) {
    if (isFresh) for (const one of [history, sections]) one.truncate(times[0]);
    if (isFresh) lastPull = "";
    if (history.length > 0 && history.runs !== rows[0].length) history.clear();
    times.forEach((time, i) => history.add(time, rows[i], events[i]));
    viewed = null;
    $("timeline").max = Math.max(0, history.length - 1);
    $("timeline").value = $("timeline").max;
    judge(times, rows, isFresh);
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
    controls.get(about)?.showMessage("");
    showMessage("");
  },
  linearized: showLinearization,
  rejected({ message, about, value, previous, hasEndedGhost }) {
    if (hasEndedGhost) $("ghost").value = "none";
    if (controls.has(about)) controls.get(about).reject(message, value, previous);
    else showMessage(message);
  },
  finished(message) {
    live.handlers.finished(message);
  },
};

// Builds the scene so that the view contains all these samples.
function buildScene(samples, times) {
  if (!scene) return;
  scene.build(samples, times);
  energyBar?.expect(samples.slice(0, scene.viewed));
  $("rotation").parentElement.hidden = !scene.plane;
  $("forcesChoice").hidden = scene.arrows.forces.length === 0;
  $("velocitiesChoice").hidden = scene.arrows.velocities.length === 0;
  $("followChoice").hidden = scene.followedAxes.length === 0;
}

function setPlaying(isPlaying) {
  playing = isPlaying;
  $("play").textContent = isPlaying ? "Pause" : "Play";
}

// Steps, steps back, or resets the FMU, or the view of a recording.
function move(name) {
  send(name);
  if (recording) viewFrom({ step: viewed + 1, back: viewed - 1, reset: 0 }[name]);
}

function play() {
  if (!playing) send("play");
  else send("pause");
  setPlaying(!playing);
}

const speedOf = () => Number((10 ** Number($("speed").value)).toPrecision(2)) * (recording ? recording.speed : 1);

function setSpeed() {
  $("speedShown").textContent = `× ${formatted(speedOf(), 2)}`;
  send("speed", { value: speedOf() });
}

function addControls() {
  const kinds = [["input", "Inputs"], ["parameter", "Parameters"], ["start", "Start values"]];
  for (const [role, title] of kinds) {
    const found = description.variables.map((variable, index) => [variable, index]).filter(([variable]) => variable.role === role);
    if (found.length === 0) continue;
    const made = found.map(([variable, index]) => {
      const control = new Control(variable, (value) => set(index, value));
      controls.set(index, control);
      return control;
    });
    $("controls").append(section(title, made, role !== "start" || found.length <= 12));
  }
}

function set(index, value) {
  send("set", { index, value });
  const { role, isFixed } = description.variables[index];
  if (task && role !== "input") endTask("ended, since a value other than an input was changed");
  if ((role !== "start" && !isFixed) || resetTimer !== null) return;
  // Takes effect at the next start; before the first step the FMU is reset at once.
  if (history.length <= 1) resetTimer = setTimeout(() => send("reset"), 50);
}

function addPlots() {
  for (const { columns, abscissa } of firstPlots(shownVariables)) {
    const plot = new Plot(history, sections, shownVariables, columns, abscissa);
    plots.push(plot);
    $("plots").append(plot.element);
  }
}

// The displayed time of the recording in s, and the clock of the frame that showed it in ms.
const player = { time: 0, before: null };

function advancePlayer(now) {
  const [first, last] = [history.time(0), history.time(history.length - 1)];
  if (playing && player.before !== null) {
    player.time += ((now - player.before) / 1000) * speedOf();
    if (player.time > last) player.time = first;
    view(history.indexOf(player.time));
  }
  player.before = now;
}

// Shows an earlier sample, or one of the recording.
function view(index) {
  viewed = Math.max(0, Math.min(history.length - 1, index));
  $("timeline").value = viewed;
}

// Shows a sample, from which the recording continues.
function viewFrom(index) {
  view(index);
  player.time = history.time(viewed);
}

function frame(now) {
  if (recording) advancePlayer(now);
  else readGamePads();
  if (history.length > 0) {
    const at = viewed === null ? history.length - 1 : Math.min(viewed, history.length - 1);
    $("clock").textContent = `${history.time(at).toFixed(CLOCK_DIGITS)} s`;
    $("pace").textContent = playing && pace[0] > 0.5 ? "slower than requested" : "";
    if (scene && scene.objects) {
      if (at === history.length - 1) updatePull();
      scene.draw(history, at);
    }
    energyBar?.draw(at);
    drawPresented(at);
    const first = history.indexOf(history.time(history.length - 1) - shownWindow);
    const end = ghostEnd(first, history.length), reach = ghostReach();
    for (const plot of plots) plot.draw(first, history.length, at, end, reach);
    showGhostText();
  }
  requestAnimationFrame(frame);
}

function save(name, content, type) {
  const link = Object.assign(document.createElement("a"), { download: name, href: URL.createObjectURL(new Blob([content], { type })) });
  link.click();
  URL.revokeObjectURL(link.href);
}

// Returns the controls whose values differ from those of the FMU.
const settings = () => [...controls].filter(([index, control]) => control.value !== description.variables[index].start);

// Copies the address of the page with the settings, and with a ghost that needs no others. The address of a file is of no use to others.
async function share() {
  const parameters = new URLSearchParams(settings().map(([index, control]) => [description.variables[index].name, control.value]));
  if (["near", "linear"].includes(ghostKind())) parameters.append("ghost", ghostKind());
  if (!laboratory) window.history.replaceState(null, "", `#${parameters}`);
  const copied = () => navigator.clipboard.writeText(location.href).then(() => "copied", () => "now in the address bar");
  const advice = laboratory ? "send the file of Save page" : location.protocol === "file:" ? "send the file of this page" : null;
  $("linked").textContent = advice ?? (navigator.clipboard ? await copied() : "now in the address bar");
}

// Starts the ghost that the address names.
function startLinkedGhost() {
  const kind = new URLSearchParams(location.hash.slice(1)).get("ghost");
  if (!["near", "linear"].includes(kind) || !firstStart()) return;
  $("ghost").value = kind;
  chooseGhost();
}

function addActions() {
  $("ghost").addEventListener("change", chooseGhost);
  $("ghostChoice").hidden = !firstStart();
  $("play").addEventListener("click", play);
  for (const name of ["step", "back", "reset"]) $(name).addEventListener("click", () => move(name));
  $("speed").addEventListener("input", setSpeed);
  $("period").addEventListener("change", () => {
    sections.clear();
    send("period", { value: Math.max(0, $("period").valueAsNumber || 0) });
  });
  $("timeline").addEventListener("input", () => viewFrom(Number($("timeline").value)));
  $("fit").addEventListener("click", () => scene && scene.fit());
  $("rotation").addEventListener("change", () => scene && scene.allowRotation((scene.options.rotation = $("rotation").checked)));
  for (const name of ["names", "trails", "forces", "velocities", "follow"]) $(name).addEventListener("change", () => scene && (scene.options[name] = $(name).checked));
  $("csv").addEventListener("click", () => save(`${description.name}.csv`, history.csv(live.names), "text/csv"));
  $("picture").addEventListener("click", () => scene && scene.renderer.domElement.toBlob((picture) => save(`${description.name}.png`, picture, "image/png")));
  $("link").addEventListener("click", share);
  $("licenses").addEventListener("click", () => {
    $("licenseText").querySelector("pre").textContent = data.licenses;
    $("licenseText").showModal();
  });
  $("present").addEventListener("click", togglePresentation);
  document.addEventListener("fullscreenchange", endPresentation);
  document.addEventListener("keydown", ({ key }) => key === "Escape" && endPresentation());
  window.addEventListener("resize", () => scene && scene.objects && scene.resize());
}

// Applies the page's settings, and those of the address after #, name=value&name=value, which have precedence; returns them.
function settingsAtStart() {
  const given = [...Object.entries(data.settings ?? {}), ...new URLSearchParams(location.hash.slice(1))];
  const byName = new Map(description.variables.map((variable, index) => [variable.name, index])), found = [];
  for (const [name, text] of given) {
    const index = byName.get(name), value = Number(text);
    if (!controls.has(index) || !Number.isFinite(value)) continue;
    controls.get(index).choose(value, () => {});
    found.push([index, value]);
  }
  return found;
}

// For tests: steps to a time as fast as possible; resolves to the time, the shown values and the elapsed seconds.
live.run = (until) =>
  new Promise((done) => {
    live.handlers.finished = done;
    send("run", { until });
  });

async function playRecording() {
  const numbers = new Float64Array(await unpacked(recording.rows)), width = 1 + recording.names.length;
  history.capacity = numbers.length / width;
  const columns = live.names.map((name) => 1 + recording.names.indexOf(name));
  const counter = 1 + recording.names.indexOf("events"); // 0 without events
  for (let i = 0; i < numbers.length; i += width) history.add(numbers[i], [Float64Array.from(columns, (column) => numbers[i + column])], counter && numbers[i + counter]);
  buildScene(history.samples.map((runs) => runs[0]), history.times);
  $("timeline").max = history.length - 1;
  viewFrom(0);
  $("timelineLabel").textContent = "Time";
  setSpeed();
  setPlaying(true);
}

// Separates the modules that _interleaved() of page.py has interleaved.
function separated(bytes) {
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
  worker.onmessage = (event) => handlers[event.data.name](event.data);
  setSpeed();
  const modules = laboratory ? { laboratory: { ...laboratory, bytes: window.parent.laboratoryBytes } } : { modules: separated(await unpacked(data.wasm)) };
  worker.postMessage({ name: "begin", ...modules, pulls, description, shown: shownIndices, set: settingsAtStart() });
  await started;
  startLinkedGhost();
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
  energyBar = live.energyBar = new EnergyBar($("energies"), history, columns);
  $("energies").hidden = false;
  $("scene").style.bottom = "2.8em"; // the space of the bar
}

// Chooses the speed at which an experiment that is short or long lasts some seconds, as far as the slider goes.
function setInitialSpeed() {
  const { duration } = description, { min, max } = $("speed");
  if (duration < SHORT || duration > LONG) $("speed").value = Math.max(min, Math.min(max, Math.log10(duration / SHOWN_FOR)));
}

async function begin() {
  if (!recording) setInitialSpeed();
  if (laboratory) showTitle();
  if (!recording) {
    addControls();
    addTasks();
    addPresets();
    addLinearization();
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
    scene.options = { trails: true, names: false, rotation: false, forces: true, velocities: false, follow: true };
  } else $("view").remove();
  document.body.classList.toggle("plain", sceneParts.length === 0);
  document.body.classList.toggle("recorded", Boolean(recording));
  for (const name of ["link", "ghostChoice", "periodChoice"]) $(name).hidden ||= Boolean(recording);
  await (recording ? playRecording() : runFmu());
  requestAnimationFrame(frame);
  document.body.dataset.ready = "true";
  if (data.startsPlaying) play();
}

live.started = begin();
