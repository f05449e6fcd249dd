// Pulls bodies with the pointer, by a spring from the grasped point to the pointer in the plane through that point, parallel to the screen.
"use strict";

const REACH = 14; // pixels between the pointer and a body's position within which the body is grasped
const LIFT = 0.1; // elongation of the spring under the system's weight, relative to its size
const SWINGS = 10; // oscillations of the system's mass on the spring during the experiment, without gravity
const DAMPING = 0.5; // damping time of the spring, times its angular frequency

let held = null; // { i, body, local, plane, target } while a body is pulled
let sent = ""; // the last order to the worker
let thread = null; // line that shows the spring

const rayAt = (event) => {
  const box = scene.renderer.domElement.getBoundingClientRect(), ray = new THREE.Raycaster();
  const place = new THREE.Vector2((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height);
  ray.setFromCamera(place, scene.camera);
  return ray;
};

// Returns the index of the thing nearest to the middle of a line: that of a bar, or of the bob on a rod.
function nearestTo(line, sample, canBe) {
  const [from, to] = line.at(sample, history.time(history.length - 1)), middle = from.add(to).multiplyScalar(0.5);
  const able = [...scene.things.keys()].filter(canBe), distance = (i) => scene.position(sample, i).distanceTo(middle);
  return able.reduce((best, i) => (best === undefined || distance(i) < distance(best) ? i : best), undefined);
}

// Returns [index of the thing, point in space] of a thing at the pointer that can be pulled.
function hitAt(event, sample) {
  const canBe = (i) => i !== undefined && pulls.bodies[scene.things[i].name] !== undefined, found = [];
  const ray = rayAt(event), look = (object, i) => canBe(i) && ray.intersectObject(object, true).slice(0, 1).forEach(({ distance, point }) => found.push([distance, i, point]));
  scene.objects.forEach((object, i) => look(object, i));
  for (const { holder, mesh } of scene.rods) look(mesh, scene.byName.get(holder.of ?? holder.to));
  for (const line of scene.lines) look(line.group, nearestTo(line, sample, canBe));
  if (found.length > 0) return found.sort((a, b) => a[0] - b[0])[0].slice(1);
  const box = scene.renderer.domElement.getBoundingClientRect();
  const near = scene.things.map((_, i) => {
    const point = scene.position(sample, i), seen = point.clone().project(scene.camera);
    return [Math.hypot(box.left + ((seen.x + 1) * box.width) / 2 - event.clientX, box.top + ((1 - seen.y) * box.height) / 2 - event.clientY), i, point];
  });
  return near.filter(([distance, i]) => distance < REACH && canBe(i)).sort((a, b) => a[0] - b[0])[0]?.slice(1);
}

// Returns the grasped point in the body's frame; a thing without orientation is grasped at its origin.
function localOf(point, i, sample) {
  const { tag, inertia } = scene.things[i], local = point.clone().sub(scene.position(sample, i));
  if (tag !== "body") return new THREE.Vector3();
  if (scene.angles[i] < 0 && inertia !== undefined) return new THREE.Vector3();
  return local.applyMatrix4(new THREE.Matrix4().getInverse(scene.turn(sample, i)));
}

const heldPoint = (sample) => held.local.clone().applyMatrix4(scene.turn(sample, held.i)).add(scene.position(sample, held.i));

// Returns the spring, [stiffness in N/m, damping time in s]: the system's weight stretches it by LIFT, or SWINGS defines its frequency.
function springOf() {
  const mass = scene.things.map((thing) => valueOf(thing.mass || "0")).filter((one) => one > 0).reduce((sum, one) => sum + one, 0) || 1;
  const gravity = scene.gravity ? Math.hypot(...["x", "y", "z"].map((axis) => valueOf(scene.gravity[axis] || "0"))) : 0;
  const rate = gravity > 0 ? Math.sqrt(gravity / (LIFT * scene.span)) : (2 * Math.PI * SWINGS) / description.duration;
  return [mass * rate * rate, DAMPING / rate];
}

function grasp(event) {
  if (event.button !== 0 || !scene.objects || viewed !== null) return;
  const sample = history.samples[history.length - 1][0], hit = hitAt(event, sample);
  if (!hit) return;
  const [i, point] = hit, normal = scene.camera.getWorldDirection(new THREE.Vector3());
  held = { i, body: scene.things[i].name, local: localOf(point, i, sample), plane: new THREE.Plane().setFromNormalAndCoplanarPoint(normal, point), target: point };
  scene.controls.enabled = false;
  scene.renderer.domElement.setPointerCapture(event.pointerId);
  if (!playing) play();
}

function letGo() {
  if (!held) return;
  order("pull", { body: held.body, pointer: [0, 0, 0, 0, 0, 0, 0], stiffness: 0 });
  held = null;
  sent = "";
  live.pulled = null;
  thread.visible = false;
  scene.controls.enabled = true;
}

// Updates the pull once a frame, since bodies move while the pointer rests.
function pullOn() {
  if (!held) return;
  const [stiffness, time] = springOf(), pointer = [...held.target.toArray(), ...held.local.toArray(), time];
  live.pulled = { body: held.body, pointer, stiffness };
  const words = JSON.stringify(live.pulled);
  if (words !== sent) order("pull", live.pulled);
  sent = words;
  const sample = history.samples[history.length - 1][0];
  thread.geometry.setFromPoints([heldPoint(sample), held.target]);
  thread.visible = true;
}

function addPulling() {
  if (!pulls) return;
  const canvas = scene.renderer.domElement;
  thread = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0xd9342b }));
  thread.frustumCulled = false;
  scene.world.add(thread);
  canvas.title = "drag a body to pull it";
  canvas.addEventListener("pointerdown", grasp, true);
  canvas.addEventListener("pointermove", (event) => held && rayAt(event).ray.intersectPlane(held.plane, held.target));
  for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) canvas.addEventListener(name, letGo);
}
