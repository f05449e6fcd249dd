// Pulls bodies with the pointer, by a spring from the grasped point to the pointer in the plane through that point, parallel to the screen.
"use strict";

const GRASP_RADIUS = 14; // pixels between the pointer and a body's position within which the body is grasped
const ELONGATION = 0.1; // elongation of the spring under the system's weight, relative to its size
const OSCILLATIONS = 10; // oscillations of the system's mass on the spring during the experiment, without gravity
const DAMPING = 0.5; // damping time of the spring, times its angular frequency

let grasped = null; // { i, body, local, plane, target } while a body is pulled
let lastPull = ""; // the last command to the worker, as JSON
let springLine = null; // line that shows the spring

const rayAt = (event) => {
  const box = scene.renderer.domElement.getBoundingClientRect(), ray = new THREE.Raycaster();
  const position = new THREE.Vector2((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height);
  ray.setFromCamera(position, scene.camera);
  return ray;
};

// Returns the index of the element nearest to the middle of a line: that of a bar, or of the bob on a rod.
function nearestTo(line, sample, canBePulled) {
  const [from, to] = line.at(sample, history.time(history.length - 1)), middle = from.add(to).multiplyScalar(0.5);
  const candidates = [...scene.elements.keys()].filter(canBePulled), distance = (i) => scene.position(sample, i).distanceTo(middle);
  return candidates.reduce((best, i) => (best === undefined || distance(i) < distance(best) ? i : best), undefined);
}

// Returns [index of the element, point in space] of an element at the pointer that can be pulled.
function hitAt(event, sample) {
  const canBePulled = (i) => i !== undefined && pulls.bodies[scene.elements[i].name] !== undefined, found = [];
  const ray = rayAt(event), test = (object, i) => canBePulled(i) && ray.intersectObject(object, true).slice(0, 1).forEach(({ distance, point }) => found.push([distance, i, point]));
  scene.objects.forEach((object, i) => test(object, i));
  for (const { connection, mesh } of scene.rods) test(mesh, scene.byName.get(connection.of ?? connection.to));
  for (const line of scene.lines) test(line.group, nearestTo(line, sample, canBePulled));
  if (found.length > 0) return found.sort((a, b) => a[0] - b[0])[0].slice(1);
  const box = scene.renderer.domElement.getBoundingClientRect();
  const nearby = scene.elements.map((_, i) => {
    const point = scene.position(sample, i), onScreen = point.clone().project(scene.camera);
    return [Math.hypot(box.left + ((onScreen.x + 1) * box.width) / 2 - event.clientX, box.top + ((1 - onScreen.y) * box.height) / 2 - event.clientY), i, point];
  });
  return nearby.filter(([distance, i]) => distance < GRASP_RADIUS && canBePulled(i)).sort((a, b) => a[0] - b[0])[0]?.slice(1);
}

// Returns the grasped point in the body's frame; an element without orientation is grasped at its origin.
function localOf(point, i, sample) {
  const { tag, inertia } = scene.elements[i], local = point.clone().sub(scene.position(sample, i));
  if (tag !== "body") return new THREE.Vector3();
  if (scene.angles[i] < 0 && inertia !== undefined) return new THREE.Vector3();
  return local.applyMatrix4(new THREE.Matrix4().getInverse(scene.rotation(sample, i)));
}

const graspedPoint = (sample) => grasped.local.clone().applyMatrix4(scene.rotation(sample, grasped.i)).add(scene.position(sample, grasped.i));

// Returns the spring, [stiffness in N/m, damping time in s]: the system's weight stretches it by ELONGATION, or OSCILLATIONS defines its frequency.
function springOf() {
  const mass = scene.elements.map((element) => valueOf(element.mass || "0")).filter((one) => one > 0).reduce((sum, one) => sum + one, 0) || 1;
  const gravity = scene.gravity ? Math.hypot(...["x", "y", "z"].map((axis) => valueOf(scene.gravity[axis] || "0"))) : 0;
  const angularFrequency = gravity > 0 ? Math.sqrt(gravity / (ELONGATION * scene.span)) : (2 * Math.PI * OSCILLATIONS) / description.duration;
  return [mass * angularFrequency * angularFrequency, DAMPING / angularFrequency];
}

function grasp(event) {
  if (event.button !== 0 || !scene.objects || viewed !== null) return;
  const sample = history.samples[history.length - 1][0], hit = hitAt(event, sample);
  if (!hit) return;
  const [i, point] = hit, normal = scene.camera.getWorldDirection(new THREE.Vector3());
  grasped = { i, body: scene.elements[i].name, local: localOf(point, i, sample), plane: new THREE.Plane().setFromNormalAndCoplanarPoint(normal, point), target: point };
  scene.controls.enabled = false;
  scene.renderer.domElement.setPointerCapture(event.pointerId);
  if (!playing) play();
}

function release() {
  if (!grasped) return;
  send("pull", { body: grasped.body, pointer: [0, 0, 0, 0, 0, 0, 0], stiffness: 0 });
  grasped = null;
  lastPull = "";
  live.pulled = null;
  springLine.visible = false;
  scene.controls.enabled = true;
}

// Updates the pull once a frame, since bodies move while the pointer rests.
function updatePull() {
  if (!grasped) return;
  const [stiffness, time] = springOf(), pointer = [...grasped.target.toArray(), ...grasped.local.toArray(), time];
  live.pulled = { body: grasped.body, pointer, stiffness };
  const text = JSON.stringify(live.pulled);
  if (text !== lastPull) send("pull", live.pulled);
  lastPull = text;
  const sample = history.samples[history.length - 1][0];
  springLine.geometry.setFromPoints([graspedPoint(sample), grasped.target]);
  springLine.visible = true;
}

function addPulling() {
  if (!pulls) return;
  const canvas = scene.renderer.domElement;
  springLine = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0xd9342b }));
  springLine.frustumCulled = false;
  scene.world.add(springLine);
  canvas.title = "drag a body to pull it";
  canvas.addEventListener("pointerdown", grasp, true);
  canvas.addEventListener("pointermove", (event) => grasped && rayAt(event).ray.intersectPlane(grasped.plane, grasped.target));
  for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) canvas.addEventListener(name, release);
}
