// Tasks that users try to reach by the inputs: all goals of a task at once, for some time. The page measures the time and keeps the best one.
"use strict";

let task = null; // the task that runs

// Returns the tasks of modelDescription.xml. Goals have formulas, and limits that may be infinite.
function tasksOf(file) {
  const numberIn = (element, name, otherwise) => (element.hasAttribute(name) ? Number(element.getAttribute(name)) : otherwise);
  return [...file.querySelectorAll("tasks > task")].map((element) => ({
    name: element.getAttribute("name"),
    label: element.getAttribute("description") || element.getAttribute("name"),
    preset: element.getAttribute("preset"),
    hold: numberIn(element, "hold", 0),
    limit: numberIn(element, "limit", Infinity),
    goals: [...element.querySelectorAll("goal")].map((goal) => ({ formula: goal.getAttribute("formula"), min: numberIn(goal, "min", -Infinity), max: numberIn(goal, "max", Infinity) })),
  }));
}

const isMet = ({ formula, min, max }, sample, time) => {
  const value = compiled(formula)(sample, time);
  return value >= min && value <= max;
};

const seconds = (value) => `${value.toFixed(2)} s`;
const keyOf = ({ name }) => `lagrange-fmu: ${description.name}, ${name}`;

// Returns the best time so far in s; NaN for none. Some browsers offer no storage to files.
function bestOf(one) {
  try {
    return Number(localStorage.getItem(keyOf(one)) ?? NaN);
  } catch {
    return one.best ?? NaN;
  }
}

function keepBest(one, time) {
  if (bestOf(one) <= time) return;
  one.best = time;
  try {
    localStorage.setItem(keyOf(one), String(time));
  } catch {
    // kept while the page is open
  }
}

function showState(one, text) {
  const best = bestOf(one);
  one.state.textContent = [text, best >= 0 ? `best ${seconds(best)}` : ""].filter(Boolean).join("; ");
}

// Starts a task from its preset, or from the start values of the file, in real time or as fast as the speed is set.
function startTask(one) {
  if (task) endTask("");
  applyPreset(presetsOf(file, description).find(({ name }) => name === one.preset) ?? { values: [] });
  task = Object.assign(one, { isRunning: false, metSince: null, last: 0 });
  showState(one, matchMedia("(hover: none)").matches ? "use the sliders of the inputs" : "use the inputs, by sliders or keys");
  if (!playing) play();
}

function endTask(text) {
  const ended = task;
  task = null;
  showState(ended, text);
}

// Follows the running task by new samples.
function judge(times, rows, isFresh) {
  if (!task) return;
  if (isFresh && times[0] <= description.startTime) Object.assign(task, { isRunning: true, metSince: null, last: times[0] });
  if (!task.isRunning) return;
  if (times[0] < task.last) return endTask("ended by a step back");
  if (live.pulled) return endTask("ended by a pull");
  for (let i = 0; i < times.length; i++) {
    const time = times[i], passed = time - description.startTime, areMet = task.goals.every((goal) => isMet(goal, rows[i][0], time));
    task.metSince = areMet ? (task.metSince ?? time) : null;
    const metFor = areMet ? time - task.metSince : 0;
    if (areMet && metFor >= task.hold * (1 - 1e-9)) return finishTask(passed);
    if (passed > task.limit) return endTask(`not done within ${seconds(task.limit)}`);
    task.last = time;
    showState(task, `${seconds(passed)}${task.hold > 0 ? `, reached for ${seconds(metFor)} of ${seconds(task.hold)}` : ""}`);
  }
}

function finishTask(passed) {
  keepBest(task, passed);
  endTask(`done in ${seconds(passed)}`);
  if (playing) play();
}

function addTasks() {
  const tasks = tasksOf(file);
  if (tasks.length === 0) return;
  const element = document.createElement("div");
  element.className = "tasks";
  for (const one of tasks) {
    const button = Object.assign(document.createElement("button"), { textContent: one.label, title: "start this task" });
    one.state = document.createElement("div");
    button.addEventListener("click", () => {
      startTask(one);
      button.blur(); // keys go to the inputs
    });
    showState(one, "");
    element.append(button, one.state);
  }
  $("controls").prepend(section("Tasks", [{ element }], true));
}
