// Arrows with values: constraint forces along rods and at joints, and velocities of elements.
"use strict";

const MOST_VELOCITIES = 12; // with more elements their velocities have no arrows

class Arrows {
  constructor(scene) {
    Object.assign(this, { scene, labels: [], forces: [], largest: { forces: 0, velocities: 0 } });
    for (const connection of scene.connections) {
      if (connection.tag === "rod" && connection.force) this.addForce([connection.force], { rod: connection });
      if (connection.tag === "joint" && connection.force1) this.addForce([connection.force1, connection.force2], { joint: connection });
    }
    const moving = scene.elements.map((_, i) => i).filter((i) => scene.elements[i].tag !== "frame" && scene.columns[i].some((column) => column >= 0));
    this.velocities = moving.length > MOST_VELOCITIES ? [] : moving.map((i) => ({ i, arrow: this.arrow(0x2ca05a) }));
  }

  arrow(color) {
    const arrow = new THREE.ArrowHelper(new THREE.Vector3(1, 0, 0), new THREE.Vector3(), 1, color);
    this.scene.world.add(arrow);
    return arrow;
  }

  addForce(names, parts) {
    const columns = names.map((name) => this.scene.column(name));
    if (columns.every((column) => column >= 0)) this.forces.push({ columns, arrow: this.arrow(0xd9342b), ...parts });
  }

  // Returns where a force acts, and the force.
  force(sample, { columns, rod, joint }) {
    const { scene } = this, from = new THREE.Vector3(), force = new THREE.Vector3();
    if (joint) {
      const [first, second] = columns.map((column) => sample[column]);
      return [scene.jointPosition(sample, joint, from), force.set(first * joint.x1 + second * joint.x2, first * joint.y1 + second * joint.y2, 0)];
    }
    scene.position(sample, scene.byName.get(rod.to), from);
    force.copy(from).sub(scene.position(sample, scene.byName.get(rod.from))).normalize();
    return [from, force.multiplyScalar(sample[columns[0]] * Number(rod.factor))];
  }

  // Returns where an element is, and its mean velocity since the previous sample.
  velocity(history, at, { i }) {
    const position = this.scene.position(history.samples[at][0], i);
    if (at === 0) return [position, new THREE.Vector3()];
    const step = history.time(at) - history.time(at - 1), previous = this.scene.position(history.samples[at - 1][0], i);
    return [position, position.clone().sub(previous).multiplyScalar(step > 0 ? 1 / step : 0)];
  }

  // Points an arrow; its length is in proportion to the largest vector of its kind so far.
  aim(arrow, kind, unit, [from, vector]) {
    const { scene, largest } = this, size = vector.length();
    largest[kind] = Math.max(largest[kind] * 0.999, size);
    arrow.visible = Boolean(scene.options[kind]) && size > 1e-3 * largest[kind];
    if (!arrow.visible) return;
    const length = ((kind === "forces" ? 0.7 : 0.4) * scene.radius * size) / largest[kind];
    arrow.position.copy(from);
    arrow.setDirection(vector.normalize());
    arrow.setLength(length, Math.min(0.35 * length, 0.08 * scene.radius), Math.min(0.2 * length, 0.05 * scene.radius));
    this.values.push([`${formatted(size, 3)} ${unit}`, from.clone().addScaledVector(vector, length)]);
  }

  update(history, at) {
    this.values = [];
    for (const force of this.forces) this.aim(force.arrow, "forces", "N", this.force(history.samples[at][0], force));
    for (const velocity of this.velocities) this.aim(velocity.arrow, "velocities", "m/s", this.velocity(history, at, velocity));
  }

  // Writes the values at the tips, after the camera has moved.
  placeLabels() {
    const { scene } = this;
    while (this.labels.length < this.values.length) this.labels.push(scene.newLabel(""));
    this.labels.forEach((label, k) => {
      label.style.display = k < this.values.length ? "" : "none";
      if (k >= this.values.length) return;
      const [text, tip] = this.values[k], [x, y] = scene.pixels(tip);
      label.textContent = text;
      label.style.transform = `translate(${x + 6}px, ${y - 8}px)`;
    });
  }
}
