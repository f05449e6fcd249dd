// Where things are at a time, and where they are in the picture. Vectors are [x, y, z], turns unit quaternions [w, x, y, z].
"use strict";

const add = (a, b) => a.map((x, i) => x + b[i]);
const scaled = (a, factor) => a.map((x) => x * factor);
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => scaled(a, 1 / (Math.hypot(...a) || 1));

function product(p, q) {
  const [a, u] = [p[0], p.slice(1)], [b, v] = [q[0], q.slice(1)];
  return [a * b - dot(u, v), ...add(add(scaled(v, a), scaled(u, b)), cross(u, v))];
}

function turned(q, v) {
  const [w, ...u] = q, t = scaled(cross(u, v), 2);
  return add(add(v, scaled(t, w)), cross(u, t));
}

// The place of a time among the frames: 3.5 is half-way between the fourth and the fifth.
function placeOf(times, time) {
  let low = 0, high = times.length - 1;
  if (time <= times[0]) return 0;
  if (time >= times[high]) return high;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle;
  }
  return low + (time - times[low]) / (times[high] - times[low]);
}

// Of a track: a number, or one for each frame.
function sample(track, place) {
  if (typeof track === "number") return track;
  const low = Math.floor(place), high = Math.min(low + 1, track.length - 1);
  return track[low] + (place - low) * (track[high] - track[low]);
}

function turnOf(scene, element, place) {
  if (element.turn) return unit(element.turn.map((track) => sample(track, place)));
  if (element.angle !== undefined) {
    const half = sample(element.angle, place) / 2;
    return [Math.cos(half), 0, 0, Math.sin(half)];
  }
  return element.frame !== undefined ? turnOf(scene, scene.elements[element.frame], place) : [1, 0, 0, 0];
}

const positionOf = (element, place) => element.position.map((track) => sample(track, place));

// A place [element, offset] along the element's own axes; -1 is the base.
function pointOf(scene, [index, offset], place) {
  if (index < 0) return offset;
  const element = scene.elements[index];
  return add(positionOf(element, place), turned(turnOf(scene, element, place), offset));
}

// The six sides of a body's box, each with four corners and the normal outwards.
function boxOf(scene, element, place) {
  const turn = product(turnOf(scene, element, place), element.axes), centre = positionOf(element, place);
  const half = scaled(element.sides, 0.5), faces = [];
  for (let axis = 0; axis < 3; axis++)
    for (const side of [1, -1]) {
      const corners = [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(([first, second]) => {
        const corner = [0, 0, 0];
        corner[axis] = side * half[axis];
        corner[(axis + 1) % 3] = first * half[(axis + 1) % 3];
        corner[(axis + 2) % 3] = second * half[(axis + 2) % 3];
        return add(centre, turned(turn, corner));
      });
      const normal = [0, 0, 0];
      normal[axis] = side;
      faces.push({ corners, normal: turned(turn, normal) });
    }
  return faces;
}

const unitOf = (name) => ["x", "y", "z"].map((axis) => (axis === name ? 1 : 0));

// The whole scene in a picture of this size: planes from the front, what is in space from above and aside.
function startingCamera(scene, width, height) {
  const { low, high, radius, plane } = scene.view;
  const camera = { width, height, centre: scaled(add(low, high), 0.5), azimuth: -1.1, elevation: 0.35 };
  if (plane) {
    camera.plane = plane.map(unitOf);
    const [across, along] = camera.plane.map((axis) => Math.abs(dot(axis, add(high, scaled(low, -1)))) + 0.5 * radius);
    camera.zoom = Math.min(width / across, height / along);
  } else {
    camera.up = scene.view.up;
    camera.distance = 4 * radius;
    camera.zoom = (0.47 * Math.min(width, height)) / radius;
  }
  return camera;
}

// Two axes of the ground, which make a right-handed system with the one upwards.
function groundAxes(up) {
  const axis = up.findIndex((x) => x !== 0), names = ["x", "y", "z"];
  return [unitOf(names[(axis + 1) % 3]), scaled(unitOf(names[(axis + 2) % 3]), up[axis])];
}

// Of the picture: to the right, upwards, away from the eye.
function axesOf(camera) {
  if (camera.plane) return [...camera.plane, cross(camera.plane[1], camera.plane[0])];
  const { azimuth, elevation, up } = camera, [first, second] = groundAxes(up);
  const level = add(scaled(first, Math.cos(azimuth)), scaled(second, Math.sin(azimuth)));
  const outwards = add(scaled(level, Math.cos(elevation)), scaled(up, Math.sin(elevation)));
  const right = unit(cross(up, outwards));
  return [right, cross(outwards, right), scaled(outwards, -1)];
}

// In the picture: [x, y, depth, pixels a metre there]; null behind the eye.
function project(camera, point) {
  const away = add(point, scaled(camera.centre, -1)), [x, y, depth] = axesOf(camera).map((axis) => dot(axis, away));
  if (camera.distance && depth < -0.9 * camera.distance) return null;
  const scale = camera.zoom * (camera.distance ? camera.distance / (camera.distance + depth) : 1);
  return [camera.width / 2 + x * scale, camera.height / 2 - y * scale, depth, scale];
}

// A distance of grid lines, 1, 2 or 5 times a power of ten, at least this much.
function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= least * (1 - 1e-9));
}
