// Controls the first two inputs by arrow keys and game pads, and the page by other keys.
"use strict";

const KEY_SHARE = 0.5; // share of a slider's range that a key applies
const DEAD_ZONE = 0.12; // deflection of a stick that counts as 0, since sticks do not rest at 0 exactly

let keyInputs = []; // [index of the variable, control] of the inputs that keys and sticks set
const stickMoves = [false, false]; // true while a stick determines the input

// Sets an input to a share, from -1 to 1, of its slider's range on that side of the start value, or of the preset's value.
function applyShare(i, share) {
  const [index, control] = keyInputs[i], { idle } = control;
  const value = idle + share * (share > 0 ? control.high - idle : idle - control.low);
  control.choose(value, (chosen) => set(index, chosen));
}

const isTyping = (event) => ["INPUT", "SELECT"].includes(event.target.tagName);

function addKeys() {
  keyInputs = [...controls].filter(([index]) => description.variables[index].role === "input").slice(0, 2);
  const keys = [["ArrowLeft", "ArrowRight", " keys ←\u00a0→"], ["ArrowDown", "ArrowUp", " keys ↓\u00a0↑"]];
  keyInputs.forEach(([, control], i) => control.element.querySelector(".name").append(Object.assign(document.createElement("small"), { className: "keys", textContent: keys[i][2] })));
  const apply = (event, share) => {
    const i = keys.findIndex((pair) => pair.includes(event.key));
    if (isTyping(event) || i < 0 || i >= keyInputs.length || event.repeat) return;
    event.preventDefault();
    applyShare(i, keys[i][0] === event.key ? -share : share);
  };
  document.addEventListener("keydown", (event) => apply(event, KEY_SHARE));
  document.addEventListener("keyup", (event) => apply(event, 0));
  const actions = { " ": play, ".": () => move("step"), ",": () => move("back"), r: () => move("reset"), f: togglePresentation };
  document.addEventListener("keydown", (event) => {
    const pressesButton = event.target.tagName === "BUTTON" && event.key === " "; // the space bar presses the button itself
    if (isTyping(event) || pressesButton || event.ctrlKey || event.metaKey || !actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
  });
}

// Reads the axes of the first stick, once a frame; up is positive, as with the keys.
function readGamePads() {
  const pad = keyInputs.length > 0 && [...navigator.getGamepads()].find(Boolean);
  if (!pad) return;
  keyInputs.forEach((_, i) => {
    const share = (i === 0 ? 1 : -1) * (pad.axes[i] || 0), isMoved = Math.abs(share) > DEAD_ZONE;
    if (isMoved) applyShare(i, share);
    else if (stickMoves[i]) applyShare(i, 0);
    stickMoves[i] = isMoved;
  });
}
