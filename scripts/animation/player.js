// Draws the scene on a canvas, with a slider for time; to turn by the mouse, or to shift where all is in a plane.
const scene = JSON.parse(document.getElementById("scene").textContent);
const $ = (id) => document.getElementById(id);
const canvas = $("picture"), pen = canvas.getContext("2d");
const COLORS = ["#2a6f97", "#c1502e", "#3a7d44", "#7b4ea3", "#b08900", "#0b7a75", "#a4305e", "#5c677d"];
const AXIS_COLORS = ["#d62828", "#2b9348", "#1d5fd1"];
const TRAIL = 0.15; // of the whole time
const first = scene.times[0], last = scene.times[scene.times.length - 1];
const state = { time: first, playing: true, before: null };
let camera = null;

const colorOf = (index) => COLORS[index % COLORS.length];

function shade(color, light) {
  const parts = [1, 3, 5].map((i) => parseInt(color.slice(i, i + 2), 16));
  return `rgb(${parts.map((part) => Math.round(Math.min(255, part * light))).join(",")})`;
}

function line(points, color, width, dash = []) {
  const seen = points.map((point) => project(camera, point));
  if (seen.includes(null)) return;
  pen.beginPath();
  seen.forEach(([x, y], i) => (i ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  pen.strokeStyle = color;
  pen.lineWidth = width;
  pen.setLineDash(dash);
  pen.stroke();
}

let written = []; // where names stand already

function write(text, point, color, beside = 0) {
  const seen = project(camera, point);
  if (!seen) return;
  const x = seen[0] + 5 + beside * seen[3];
  let y = seen[1] - 5 - beside * seen[3];
  while (written.some((other) => Math.abs(other[0] - x) < 30 && Math.abs(other[1] - y) < 12)) y += 12;
  written.push([x, y]);
  pen.fillStyle = color;
  pen.fillText(text, x, y);
}

// In the plane of the motion over the whole picture, or on the ground below it.
function drawGrid() {
  const { low, high, radius, up } = scene.view, planar = camera.plane !== undefined;
  const [across, along] = planar ? camera.plane : groundAxes(up);
  const step = niceStep(planar ? 70 / camera.zoom : radius / 4);
  const reach = planar ? [camera.width, camera.height].map((size) => size / 2 / camera.zoom) : [2 * radius, 2 * radius];
  const ground = planar ? [0, 0, 0] : scaled(up, Math.min(dot(up, low), dot(up, high), 0));
  const ranges = [across, along].map((axis, i) => {
    const middle = dot(axis, planar ? camera.centre : scaled(add(low, high), 0.5));
    return [Math.floor((middle - reach[i]) / step), Math.ceil((middle + reach[i]) / step)];
  });
  const at = (i, j) => add(ground, add(scaled(across, i * step), scaled(along, j * step)));
  const color = (i) => (i === 0 ? "#b8c0cc" : "#e6e9ee");
  for (let i = ranges[0][0]; i <= ranges[0][1]; i++) line([at(i, ranges[1][0]), at(i, ranges[1][1])], color(i), 1);
  for (let j = ranges[1][0]; j <= ranges[1][1]; j++) line([at(ranges[0][0], j), at(ranges[0][1], j)], color(j), 1);
  pen.fillStyle = "#8a94a3";
  pen.fillText(`grid ${Number(step.toPrecision(1))} m`, 10, camera.height - 10);
}

function drawAxes(origin, turn, length, width, named) {
  for (const axis of [0, 1, 2]) {
    const direction = ["x", "y", "z"][axis];
    const end = add(origin, scaled(turned(turn, unitOf(direction)), length));
    line([origin, end], AXIS_COLORS[axis], width);
    if (named && !(camera.plane && !camera.plane.some((one) => one[axis]))) write(direction, end, AXIS_COLORS[axis]);
  }
}

function drawTrail(element, index, place) {
  const start = placeOf(scene.times, state.time - TRAIL * (last - first)), parts = 40, times = [];
  for (let i = 0; i <= parts * 4; i++) times.push(start + ((place - start) * i) / (parts * 4));
  for (let part = 0; part < parts; part++) {
    pen.globalAlpha = (0.7 * (part + 1)) / parts;
    line(times.slice(part * 4, part * 4 + 5).map((at) => positionOf(element, at)), colorOf(index), 1.5);
  }
  pen.globalAlpha = 1;
}

const LIGHT = unit([0.4, -0.5, 0.8]);

function drawFace(face, color) {
  const seen = face.corners.map((corner) => project(camera, corner));
  if (seen.includes(null)) return;
  pen.beginPath();
  seen.forEach(([x, y], i) => (i ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  pen.closePath();
  pen.fillStyle = shade(color, camera.plane ? 1.25 : 1 + 0.35 * dot(face.normal, LIGHT));
  pen.globalAlpha = 0.85;
  pen.fill();
  pen.globalAlpha = 1;
  pen.strokeStyle = shade(color, 0.7);
  pen.lineWidth = 1;
  pen.setLineDash([]);
  pen.stroke();
}

function drawBall(point, radius, color) {
  const seen = project(camera, point);
  if (!seen) return;
  const [x, y, , scale] = seen, size = Math.max(2.5, radius * scale);
  const glow = pen.createRadialGradient(x - size / 3, y - size / 3, size / 10, x, y, size);
  glow.addColorStop(0, shade(color, 1.9));
  glow.addColorStop(1, color);
  pen.beginPath();
  pen.arc(x, y, size, 0, 2 * Math.PI);
  pen.fillStyle = glow;
  pen.fill();
}

function drawMark(point) {
  const seen = project(camera, point);
  if (!seen) return;
  pen.beginPath();
  pen.arc(seen[0], seen[1], Math.max(1.5, 3.5 / (1 + scene.elements.length / 40)), 0, 2 * Math.PI);
  pen.fillStyle = "#fff";
  pen.fill();
  pen.strokeStyle = "#333";
  pen.lineWidth = 1.5;
  pen.setLineDash([]);
  pen.stroke();
}

const middleOf = (points) => scaled(points.reduce(add), 1 / points.length);

// What has a depth, to be drawn from the back to the front; of the same depth, what holds others together first.
function solids(place) {
  const found = [], away = axesOf(camera)[2];
  const put = (middle, draw) => found.push({ depth: dot(away, middle), draw });
  for (const link of scene.links) {
    const ends = [link.from, link.to].map((end) => pointOf(scene, end, place));
    const rod = link.kind === "rod";
    put(middleOf(ends), () => line(ends, rod ? "#66707d" : "#aab2bd", rod ? 3 : 1.5, rod ? [] : [5, 4]));
  }
  scene.elements.forEach((element, index) => {
    const position = positionOf(element, place), color = colorOf(index);
    if (element.sides)
      for (const face of boxOf(scene, element, place)) {
        const towards = camera.plane ? scaled(away, -1) : add(eye(), scaled(middleOf(face.corners), -1));
        if (dot(face.normal, towards) > 1e-9) put(middleOf(face.corners), () => drawFace(face, color));
      }
    else if (element.kind === "frame")
      put(position, () => drawAxes(position, turnOf(scene, element, place), 0.12 * scene.view.radius, 2));
    else put(position, () => drawBall(position, element.radius, color));
    if ($("names").checked) put(add(position, scaled(away, -scene.view.radius)), () => write(element.name, position, "#333", 0.7 * (element.radius || 0)));
  });
  for (const mark of scene.marks) {
    const point = pointOf(scene, mark, place);
    put(add(point, scaled(away, -0.1 * scene.view.radius)), () => drawMark(point));
  }
  return found.sort((a, b) => b.depth - a.depth);
}

const eye = () => add(camera.centre, scaled(axesOf(camera)[2], -camera.distance));

function draw() {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    camera = null;
  }
  camera = camera || startingCamera(scene, width, height);
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  written = [];
  pen.font = "12px system-ui, sans-serif";
  pen.lineCap = pen.lineJoin = "round";
  const place = placeOf(scene.times, state.time);
  drawGrid();
  drawAxes([0, 0, 0], [1, 0, 0, 0], 0.25 * scene.view.radius, 1.5, true);
  if ($("trails").checked) scene.elements.forEach((element, index) => element.trail && drawTrail(element, index, place));
  for (const solid of solids(place)) solid.draw();
  $("clock").textContent = `${Number(state.time.toPrecision(4))} s of ${Number(last.toPrecision(4))} s`;
  $("slider").value = (state.time - first) / (last - first || 1);
}

function step(now) {
  if (state.playing && state.before !== null) {
    state.time += ((now - state.before) / 1000) * Number($("speed").value);
    if (state.time > last) state.time = first;
  }
  state.before = now;
  draw();
  window.requestAnimationFrame(step);
}

function setPlaying(playing) {
  state.playing = playing;
  $("play").textContent = playing ? "Pause" : "Play";
}

for (const factor of [0.1, 0.25, 0.5, 1, 2, 4]) {
  const choice = document.createElement("option");
  choice.value = factor * scene.speed;
  choice.textContent = `× ${Number((factor * scene.speed).toPrecision(3))}`;
  choice.selected = factor === 1;
  $("speed").append(choice);
}
$("play").addEventListener("click", () => setPlaying(!state.playing));
$("slider").addEventListener("input", () => {
  setPlaying(false);
  state.time = first + Number($("slider").value) * (last - first);
});
$("reset").addEventListener("click", () => (camera = null));
document.addEventListener("keydown", (event) => {
  if (event.key !== " " || event.target.tagName === "BUTTON") return;
  event.preventDefault();
  setPlaying(!state.playing);
});

function drag(across, down) {
  if (camera.plane) {
    const [right, up] = camera.plane;
    camera.centre = add(camera.centre, add(scaled(right, -across / camera.zoom), scaled(up, down / camera.zoom)));
  } else {
    camera.azimuth -= across * 0.01;
    camera.elevation = Math.max(-1.5, Math.min(1.5, camera.elevation + down * 0.01));
  }
}

let held = null;
canvas.addEventListener("pointerdown", (event) => {
  canvas.setPointerCapture(event.pointerId);
  held = [event.clientX, event.clientY];
});
canvas.addEventListener("pointermove", (event) => {
  if (!held) return;
  drag(event.clientX - held[0], event.clientY - held[1]);
  held = [event.clientX, event.clientY];
});
canvas.addEventListener("pointerup", () => (held = null));
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  camera.zoom *= Math.exp(-event.deltaY * 0.001);
}, { passive: false });
$("names").checked = scene.elements.length <= 12;
window.requestAnimationFrame(step);
