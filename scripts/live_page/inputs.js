// Controls the first two inputs by arrow keys and game pads, and the page by other keys.
"use strict";

const PUSH = 0.5; // share of a slider's range that a key applies
const IDLE = 0.12; // dead zone of a stick, which does not rest at 0

let pushed = []; // [index of the variable, control] of these inputs
const leaning = [false, false]; // true while a stick determines the input

// Sets an input to a share, from -1 to 1, of its slider's range on that side of the start value.
function push(i, share) {
  const [place, control] = pushed[i], { start } = control.variable;
  const value = start + share * (share > 0 ? control.high - start : start - control.low);
  control.choose(value, (chosen) => set(place, chosen));
}

const isTyping = (event) => ["INPUT", "SELECT"].includes(event.target.tagName);

function addKeys() {
  pushed = [...controls].filter(([place]) => description.variables[place].role === "input").slice(0, 2);
  const keys = [["ArrowLeft", "ArrowRight", " keys ← →"], ["ArrowDown", "ArrowUp", " keys ↓ ↑"]];
  pushed.forEach(([, control], i) => control.element.querySelector(".name").append(Object.assign(document.createElement("small"), { textContent: keys[i][2] })));
  const answer = (event, share) => {
    const i = keys.findIndex((pair) => pair.includes(event.key));
    if (isTyping(event) || i < 0 || i >= pushed.length || event.repeat) return;
    event.preventDefault();
    push(i, keys[i][0] === event.key ? -share : share);
  };
  document.addEventListener("keydown", (event) => answer(event, PUSH));
  document.addEventListener("keyup", (event) => answer(event, 0));
  const actions = { " ": play, ".": () => move("step"), ",": () => move("back"), r: () => move("reset"), f: togglePresentation };
  document.addEventListener("keydown", (event) => {
    const presses = event.target.tagName === "BUTTON" && event.key === " "; // the space bar presses the button itself
    if (isTyping(event) || presses || event.ctrlKey || event.metaKey || !actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
  });
}

// Reads the axes of the first stick, once a frame; up is positive, as with the keys.
function readGamePads() {
  const pad = pushed.length > 0 && [...navigator.getGamepads()].find(Boolean);
  if (!pad) return;
  pushed.forEach((_, i) => {
    const share = (i === 0 ? 1 : -1) * (pad.axes[i] || 0), isLeaning = Math.abs(share) > IDLE;
    if (isLeaning) push(i, share);
    else if (leaning[i]) push(i, 0);
    leaning[i] = isLeaning;
  });
}
