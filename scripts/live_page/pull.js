// Bodies are pulled with the pointer: a spring from the point that was grasped to the pointer, which lies in the plane of the picture there.
"use strict";

const REACH = 14; // pixels from a body's place, where nothing of it was hit
const LIFT = 0.1; // of the size of all: so far its weight stretches the spring
const SWINGS = 10; // in the experiment's time where there is no gravity, of all on the spring
const DAMPING = 0.5;

let held = null; // { i, body, local, plane, target } while something is pulled
let sent = ""; // what the worker knows of that
let thread = null; // that shows it

const rayAt = (event) => {
  const box = scene.renderer.domElement.getBoundingClientRect(), ray = new THREE.Raycaster();
  const place = new THREE.Vector2((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height);
  ray.setFromCamera(place, scene.camera);
  return ray;
};

// [place among the things, point in space] of what can be pulled there.
function hitAt(event, sample) {
  const canBe = (i) => i !== undefined && pulls.bodies[scene.things[i].name] !== undefined, found = [];
  const ray = rayAt(event), look = (object, i) => canBe(i) && ray.intersectObject(object, true).slice(0, 1).forEach(({ distance, point }) => found.push([distance, i, point]));
  scene.objects.forEach((object, i) => look(object, i));
  for (const { holder, mesh } of scene.rods) look(mesh, scene.byName.get(holder.of ?? holder.to));
  if (found.length > 0) return found.sort((a, b) => a[0] - b[0])[0].slice(1);
  const box = scene.renderer.domElement.getBoundingClientRect();
  const near = scene.things.map((_, i) => {
    const point = scene.position(sample, i), seen = point.clone().project(scene.camera);
    return [Math.hypot(box.left + ((seen.x + 1) * box.width) / 2 - event.clientX, box.top + ((1 - seen.y) * box.height) / 2 - event.clientY), i, point];
  });
  return near.filter(([distance, i]) => distance < REACH && canBe(i)).sort((a, b) => a[0] - b[0])[0]?.slice(1);
}

// What has no direction is held at its place.
function localOf(point, i, sample) {
  const { tag, inertia } = scene.things[i], local = point.clone().sub(scene.position(sample, i));
  if (tag !== "body") return new THREE.Vector3();
  if (scene.angles[i] < 0 && inertia !== undefined) return new THREE.Vector3();
  return local.applyMatrix4(new THREE.Matrix4().getInverse(scene.turn(sample, i)));
}

const heldPoint = (sample) => held.local.clone().applyMatrix4(scene.turn(sample, held.i)).add(scene.position(sample, held.i));

// A spring that the weight of all stretches visibly, or on which all swings slowly; [stiffness in N/m, time of damping in s].
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

// Once a frame, since things move under a pointer that rests.
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
  canvas.title = "bodies can be pulled";
  canvas.addEventListener("pointerdown", grasp, true);
  canvas.addEventListener("pointermove", (event) => held && rayAt(event).ray.intersectPlane(held.plane, held.target));
  for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) canvas.addEventListener(name, letGo);
}
