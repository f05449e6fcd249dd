// Draws the lines of a scene: rods, springs, belts, ground and so on, from point to point.
"use strict";

const COILS = 8; // coils of a drawn spring
const HATCHES = 14; // least number of hatches of a ground

// Returns the points of a coil from 0 to 1 along y, with straight ends.
function coil(radius) {
  const points = [new THREE.Vector3(0, 0, 0)], steps = 16 * COILS;
  for (let i = 0; i <= steps; i++) {
    const angle = (2 * Math.PI * i * COILS) / steps, fade = Math.min(1, i / 8, (steps - i) / 8);
    points.push(new THREE.Vector3(fade * radius * Math.cos(angle), 0.1 + (0.8 * i) / steps, fade * radius * Math.sin(angle)));
  }
  return [...points, new THREE.Vector3(0, 1, 0)];
}

// A drawn line. Its group has the axis y from the first end to the second, and z along the normal.
class DrawnLine {
  // scene: the Scene; line: its element; compiled(formula): the function of a sample and its time that evaluates it.
  constructor(scene, line, compiled) {
    Object.assign(this, { scene, line, kind: line.kind });
    this.ends = ["from", "to"].map((end, i) => this.end(line[end], AXES.map((axis) => compiled(line[`${axis}${i + 1}`] || "0"))));
  }

  // Returns a function that sets a vector to the position of an end.
  end(name, formulas) {
    const i = name ? this.scene.byName.get(name) : undefined;
    if (name !== undefined) return (sample, time, target) => this.scene.position(sample, i, target);
    return (sample, time, target) => target.set(...formulas.map((formula) => formula(sample, time)));
  }

  get isPoint() {
    return this.kind === "pivot";
  }

  get isRound() {
    return this.kind === "hoop" || this.kind === "wheel";
  }

  // Returns both ends.
  at(sample, time) {
    const from = this.ends[0](sample, time, new THREE.Vector3());
    return [from, this.isPoint ? from : this.ends[1](sample, time, new THREE.Vector3())];
  }

  // Expands a box by the space that the line takes.
  expand(box, sample, time) {
    const [from, to] = this.at(sample, time), round = this.isRound ? from.distanceTo(to) : 0, radius = this.kind === "belt" ? this.scene.value(this.line.radius) : round;
    for (const point of this.isRound ? [from] : [from, to]) {
      if (!AXES.every((axis) => Number.isFinite(point[axis]))) continue;
      const axis = this.scene.normalAxis(this.line), extent = new THREE.Vector3(radius, radius, radius).setComponent(axis, 0);
      box.expandByPoint(point.clone().add(extent)).expandByPoint(point.clone().sub(extent));
    }
  }

  // Builds its parts; length: that at the start.
  build(length, opacity) {
    const { scene, line } = this, size = scene.radius, radius = line.radius ? scene.value(line.radius) : NaN;
    const colors = { pivot: scene.isDark ? 0xe6e9ef : 0x3a4350, ground: scene.isDark ? 0x7a8699 : 0x9aa5b4, arrow: 0xd9342b };
    const own = line.color && line.color.slice(0, 7), opacityOfLine = (line.color && line.color.length > 7 ? parseInt(line.color.slice(7), 16) / 255 : 1) * opacity;
    this.material = scene.material(own || colors[this.kind] || scene.rodMaterial.color.getHex(), { transparent: opacityOfLine < 1, opacity: opacityOfLine });
    this.group = new THREE.Group();
    this.group.matrixAutoUpdate = false;
    this.stretched = []; // parts that are as long as the line
    this.atEnd = []; // parts at its second end
    this.length = length || size;
    const defaultRadius = { rod: 0.014, rope: 0.006, spring: 0.035, damper: 0.03, pivot: 0.06 }[this.kind] * size;
    this[this.kind](radius > 0 ? radius : defaultRadius, size);
    return this.group;
  }

  add(geometry, { isStretched = false, isAtEnd = false, y = 0, x = 0, z = 0, material = this.material } = {}) {
    const mesh = new THREE.Mesh(geometry, material);
    mesh.position.set(x, y, z);
    this.group.add(mesh);
    if (isStretched) this.stretched.push(mesh);
    if (isAtEnd) this.atEnd.push(mesh);
    return mesh;
  }

  bar(radius, more) {
    return this.add(new THREE.CylinderBufferGeometry(radius, radius, 1, 16).translate(0, 0.5, 0), { isStretched: true, ...more });
  }

  rod(radius) {
    this.bar(radius);
    for (const isAtEnd of [false, true]) this.add(new THREE.SphereBufferGeometry(radius, 16, 12), { isAtEnd });
  }

  rope(radius) {
    this.rod(radius);
  }

  spring(radius) {
    const curve = new THREE.CatmullRomCurve3(coil(radius).map((point) => point.setY(point.y * this.length)));
    this.add(new THREE.TubeBufferGeometry(curve, 24 * COILS, 0.13 * radius, 6).scale(1, 1 / this.length, 1), { isStretched: true });
  }

  damper(radius) {
    const housing = this.material.clone();
    Object.assign(housing, { transparent: true, opacity: 0.45 * this.material.opacity });
    this.bar(0.3 * radius);
    this.add(new THREE.CylinderBufferGeometry(radius, radius, 0.5 * this.length, 24), { y: 0.4 * this.length, material: housing });
    this.add(new THREE.CylinderBufferGeometry(0.9 * radius, 0.9 * radius, 0.06 * this.length, 24).translate(0, -0.4 * this.length, 0), { isAtEnd: true });
  }

  belt(radius, size) {
    const pulley = Object.assign(this.material.clone(), { transparent: true, opacity: 0.4 * this.material.opacity });
    for (const isAtEnd of [false, true]) this.add(new THREE.CylinderBufferGeometry(0.96 * radius, 0.96 * radius, 0.06 * size, 32).rotateX(Math.PI / 2), { isAtEnd, material: pulley });
    const dark = this.scene.material(this.scene.isDark ? 0xe6e9ef : 0x3a4350);
    for (const side of [-1, 1]) this.bar(0.007 * size, { x: side * radius, material: dark });
    for (const isAtEnd of [false, true]) {
      const angle = isAtEnd ? 0 : Math.PI;
      this.add(new THREE.TorusBufferGeometry(radius, 0.007 * size, 8, 32, Math.PI).rotateZ(angle), { isAtEnd, material: dark });
    }
  }

  hoop() {
    this.add(new THREE.TorusBufferGeometry(1, 0.02, 8, 64));
  }

  wheel() {
    this.add(new THREE.TorusBufferGeometry(1, 0.07, 10, 48));
    for (const angle of [0, Math.PI / 2]) this.add(new THREE.CylinderBufferGeometry(0.04, 0.04, 2, 8).rotateZ(angle));
    this.add(new THREE.SphereBufferGeometry(0.14, 16, 12));
  }

  // Hatched on the right-hand side, seen from its first end to the second.
  ground(_, size) {
    const depth = 0.05 * size, count = Math.max(HATCHES, Math.min(60, Math.round(this.length / depth)));
    this.add(new THREE.BoxBufferGeometry(0.012 * size, 1, this.scene.plane ? 0.012 * size : 0.5 * size).translate(0.006 * size, 0.5, 0), { isStretched: true });
    const ends = Array.from({ length: count }, (_, i) => (i + 0.5) / count).flatMap((y) => [new THREE.Vector3(0, y, 0), new THREE.Vector3(depth, y - depth / this.length, 0)]);
    const hatches = new THREE.LineSegments(new THREE.BufferGeometry().setFromPoints(ends), new THREE.LineBasicMaterial({ color: this.material.color }));
    this.group.add(hatches);
    this.stretched.push(hatches);
  }

  // A cone below a ball; its axis y points upwards.
  pivot(radius, size) {
    this.add(new THREE.CylinderBufferGeometry(0, 0.8 * radius, 1.3 * radius, 24), { y: -0.65 * radius });
    this.add(new THREE.BoxBufferGeometry(2.2 * radius, 0.16 * radius, this.scene.plane ? 0.2 * radius : 2.2 * radius), { y: -1.36 * radius });
    this.add(new THREE.SphereBufferGeometry(0.32 * radius, 16, 12));
  }

  arrow(_, size) {
    const head = 0.07 * size;
    this.shaft = this.add(new THREE.CylinderBufferGeometry(0.009 * size, 0.009 * size, 1, 10).translate(0, 0.5, 0));
    this.head = this.add(new THREE.CylinderBufferGeometry(0, 0.4 * head, head, 16).translate(0, -head / 2, 0));
    this.headLength = head;
  }

  // Returns the axis x of the group, at a right angle to its axis y; that of a ground in space points downwards.
  sideAxis(y) {
    const { scene } = this, up = new THREE.Vector3(...scene.up);
    if (this.kind === "ground" && !scene.plane) return y.clone().multiplyScalar(y.dot(up)).sub(up).normalize();
    const isFacing = !this.line.axis && scene.plane && scene.outwards; // towards the camera
    const normal = isFacing ? scene.outwards : new THREE.Vector3().setComponent(scene.normalAxis(this.line), 1);
    for (const other of [normal, new THREE.Vector3(1, 0, 0)]) {
      const x = new THREE.Vector3().crossVectors(y, other);
      if (x.length() >= 1e-6) return x.normalize();
    }
    return new THREE.Vector3(0, 0, 1);
  }

  update(sample, time) {
    const [from, to] = this.at(sample, time), { scene, group } = this;
    const direction = this.isPoint ? new THREE.Vector3(...scene.up) : to.clone().sub(from), length = this.isPoint ? 1 : direction.length();
    group.visible = Number.isFinite(length) && Number.isFinite(from.length()) && length > 1e-9 * scene.radius;
    if (!group.visible) return;
    const y = direction.normalize(), x = this.sideAxis(y);
    group.matrix.makeBasis(x, y, new THREE.Vector3().crossVectors(x, y));
    if (this.isRound) group.matrix.scale(new THREE.Vector3(length, length, length));
    group.matrix.setPosition(from);
    group.matrixWorldNeedsUpdate = true;
    for (const part of this.stretched) part.scale.y = length;
    for (const part of this.atEnd) part.position.y = length;
    if (this.kind === "arrow") this.updateArrow(length);
  }

  updateArrow(length) {
    const scale = Math.min(1, (0.5 * length) / this.headLength);
    this.head.scale.set(scale, scale, scale);
    this.head.position.y = length;
    this.shaft.scale.y = length - scale * this.headLength;
  }
}
