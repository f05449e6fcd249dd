// In place of a browser: a page with its elements by id, and a canvas that notes what is drawn on it.
"use strict";

const drawn = []; // [what, ...numbers], in pixels
const elements = {};
let pending = null; // the next frame's function

function makeElement(id) {
  return {
    id, value: "", textContent: "", checked: true, listeners: {}, children: [],
    addEventListener(event, listener) { this.listeners[event] = listener; },
    append(child) {
      this.children.push(child);
      if (child.selected) this.value = child.value;
    },
    setPointerCapture() {},
    clientWidth: 800, clientHeight: 600,
    getContext: () => pen2d,
  };
}

const pen2d = {
  setTransform() {}, setLineDash() {}, beginPath() { this.path = []; }, closePath() {},
  clearRect() { drawn.length = 0; },
  moveTo(x, y) { this.path.push([x, y]); },
  lineTo(x, y) { this.path.push([x, y]); },
  arc(x, y, radius) { this.circle = [x, y, radius]; },
  createRadialGradient: () => ({ stops: [], addColorStop(at, color) { this.stops.push(color); } }),
  note(kind) {
    const style = kind === "stroke" ? this.strokeStyle : this.fillStyle;
    const color = style && style.stops ? style.stops[style.stops.length - 1] : style;
    drawn.push({ kind, color, width: this.lineWidth, alpha: this.globalAlpha ?? 1, path: this.path, circle: this.circle });
  },
  stroke() { this.note("stroke"); this.circle = null; },
  fill() { this.note("fill"); },
  fillText(text, x, y) { drawn.push({ kind: "text", color: this.fillStyle, text, path: [[x, y]] }); },
};
// A filled circle is noted once, and the path after it is none.
const beginPath = pen2d.beginPath;
pen2d.beginPath = function () { beginPath.call(this); this.circle = null; };

const window = { devicePixelRatio: 2, requestAnimationFrame(next) { pending = next; } };
const document = {
  listeners: {},
  getElementById(id) { return elements[id] || (elements[id] = makeElement(id)); },
  createElement: makeElement,
  addEventListener(event, listener) { this.listeners[event] = listener; },
};

// Lets the page draw its next frame, at this many milliseconds.
function frame(now) {
  const next = pending;
  pending = null;
  next(now);
}
