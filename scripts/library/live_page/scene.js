// Draws the system with three.js: frames, bodies, particles and points at the positions that the variables give, and their rods and joints.
"use strict";

const AXES = ["x", "y", "z"];
const CORNERS = [-1, 1].flatMap((x) => [-1, 1].flatMap((y) => [-1, 1].map((z) => [x, y, z]))); // signs of the coordinates of a box's corners
const TRAIL_LENGTH = 240; // samples of a trail
const FAR = 4; // times its own size: a system that travels further is followed by the view
const GROWN = 6; // times its size at the start: the view ignores what comes after it, as of an unstable linear system
const PALE = 0.35; // opacity of a ghost
const MOST_TRAILS = 8; // with more moving elements only the last one has a trail

// True for a body in the plane, which has a single moment of inertia.
const isPlanarBody = (element) => element.inertia !== undefined || !["Ixx", "Iyy"].some((name) => name in element);

// Returns the 16-bit numbers in a text of base64.
function numbersOf(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return Array.from({ length: bytes.length / 2 }, (_, i) => bytes[2 * i] + 256 * bytes[2 * i + 1]);
}

// Unpacks a <mesh>, see modelDescription/scene/packed_mesh.h: coordinates of its points, and indices of its triangles' corners.
function surfaceOf(mesh) {
  const least = AXES.map((axis) => Number(mesh[axis] || 0)), step = Number(mesh.step);
  return { points: numbersOf(mesh.points).map((number, i) => least[i % 3] + number * step), corners: numbersOf(mesh.triangles) };
}

// Returns the largest distance of its points from the origin.
function radiusOf({ points }) {
  let most = 0;
  for (let i = 0; i < points.length; i += 3) most = Math.max(most, Math.hypot(points[i], points[i + 1], points[i + 2]));
  return most;
}

class Scene {
  // elements: the elements of <scene>; column(name): index of a variable in a sample, or -1; value(formula): value of a formula of parameters;
  // compiled(formula): a function of a sample and its time.
  constructor(container, elements, column, value, compiled) {
    Object.assign(this, { container, column, value, compiled, labels: [], options: {} });
    this.gravity = elements.find((element) => element.tag === "gravity");
    this.elements = elements.filter((element) => ["frame", "body", "particle", "point"].includes(element.tag));
    const isPlanar = (name) => elements.some((element) => element.name === name && element.inertia !== undefined);
    // A joint between two bodies in the plane is drawn for both.
    const others = elements.filter((element) => element.tag === "joint" && isPlanar(element.with));
    this.connections = elements.filter((element) => ["rod", "joint"].includes(element.tag));
    this.connections.push(...others.map((joint) => ({ tag: "joint", of: joint.with, x: joint.withX, y: joint.withY })));
    this.shapes = elements.filter((element) => element.tag === "shape");
    this.meshes = new Map(elements.filter((element) => element.tag === "mesh").map((mesh) => [mesh.id, surfaceOf(mesh)]));
    this.surfaces = elements.filter((element) => element.tag === "surface");
    this.lineElements = elements.filter((element) => element.tag === "line");
    this.byName = new Map(this.elements.map((element, i) => [element.name, i]));
    this.columns = this.elements.map((element) => AXES.map((axis) => column(`${element.name}.${axis}`)));
    this.angles = this.elements.map((element) => column(`${element.name}.angle`));
    this.rotationColumns = this.elements.map((element) => [1, 2, 3].flatMap((i) => [1, 2, 3].map((j) => column(`${element.name}.R${i}${j}`))));
    this.lines = this.lineElements.map((line) => new DrawnLine(this, line, compiled));
    this.isDescribed = this.lineElements.some((line) => !line.guessed);
    this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
    container.append(this.renderer.domElement);
    this.world = new THREE.Scene();
    this.world.add(new THREE.HemisphereLight(0xffffff, 0x8890a0, 0.75));
    this.light = new THREE.DirectionalLight(0xffffff, 0.55);
    this.world.add(this.light);
  }

  position(sample, i, target = new THREE.Vector3()) {
    if (i === undefined) return target.set(0, 0, 0);
    const [x, y, z] = this.columns[i].map((column) => (column < 0 ? 0 : sample[column]));
    return target.set(x, y, z);
  }

  // Returns the rotation matrix of an element, or of the frame that contains it.
  rotation(sample, i, target = new THREE.Matrix4()) {
    if (i === undefined) return target.identity();
    const angle = this.angles[i], columns = this.rotationColumns[i];
    if (angle >= 0) return target.makeRotationZ(sample[angle]);
    if (columns.every((column) => column < 0)) return this.rotation(sample, this.byName.get(this.elements[i].in), target);
    const r = columns.map((column) => (column < 0 ? 0 : sample[column]));
    return target.set(r[0], r[1], r[2], 0, r[3], r[4], r[5], 0, r[6], r[7], r[8], 0, 0, 0, 0, 1);
  }

  // Returns the position of a joint on its body.
  jointPosition(sample, joint, target) {
    const i = this.byName.get(joint.of);
    target.set(joint.position[0], joint.position[1], 0).applyMatrix4(this.rotation(sample, i));
    return target.add(this.position(sample, i));
  }

  // Evaluates the positions of joints for the present parameters.
  evaluate() {
    for (const connection of this.connections) if (connection.tag === "joint") connection.position = [connection.x, connection.y].map((formula) => this.value(formula));
  }

  // Adapts joints and sizes of bodies to changed parameters.
  adapt() {
    if (!this.objects) return;
    this.evaluate();
    this.solids = this.elements.map((element) => this.solidOf(element));
    this.elements.forEach((element, i) => {
      this.objects[i].remove(...this.objects[i].children);
      this.addParts(this.objects[i], element, i);
    });
  }

  upDirection() {
    const opposite = this.gravity ? AXES.map((axis) => -this.value(this.gravity[axis] || "0")) : [0, 0, 0];
    const largest = Math.max(...opposite.map(Math.abs));
    if (largest > 0) return opposite.map((a) => (Math.abs(a) === largest ? Math.sign(a) : 0));
    return this.plane ? (this.plane.includes(1) ? [0, 1, 0] : [0, 0, 1]) : [0, 0, 1];
  }

  // The index of the axis that is normal to the plane of a planar system.
  get planeNormal() {
    return [0, 1, 2].find((axis) => !this.plane.includes(axis));
  }

  // Returns the index of the axis that is normal to a round line.
  normalAxis(line) {
    return line.axis ? AXES.indexOf(line.axis) : this.plane ? this.planeNormal : 2;
  }

  // Returns the two axes of the plane in which all elements move in these samples; null if there is no such plane.
  findPlane(samples, times) {
    const ends = samples.flatMap((sample, k) => this.lines.flatMap((line) => line.at(sample, times[k])));
    const normal = [2, 1, 0].find((axis) => {
      if (ends.some((end) => Math.abs(end.getComponent(axis)) > 1e-9)) return false;
      const isFlat = samples.every((sample) => this.columns.every((columns) => columns[axis] < 0 || Math.abs(sample[columns[axis]]) < 1e-9));
      const rotatesAbout = (sample, columns) => columns[0] < 0 || Math.abs(sample[columns[4 * axis]] - 1) < 1e-9;
      return isFlat && this.surfaces.every((surface) => !Number(surface[`n${AXES[axis]}`])) &&
        this.rotationColumns.every((columns) => samples.every((sample) => rotatesAbout(sample, columns)));
    });
    return normal === undefined ? null : [0, 1, 2].filter((axis) => axis !== normal);
  }

  // Builds all objects, with a size of the view for all these samples and their times.
  build(samples, times) {
    this.evaluate();
    this.plane = this.findPlane(samples, times);
    this.up = this.upDirection();
    this.shapeCorners = this.shapes.filter((shape) => shape.type !== "plane").map((shape) => ({ shape, corners: this.cornersOf(shape) }));
    const point = new THREE.Vector3();
    this.box = this.viewOf(samples, times);
    const size = this.box.getSize(point).length();
    const isFixedToBase = this.connections.some((connection) => connection.tag === "rod" && !connection.from);
    const isNear = !this.isDescribed && (isFixedToBase || this.box.distanceToPoint(point.set(0, 0, 0)) < 1.5 * size);
    if (isNear) this.box.expandByPoint(point.set(0, 0, 0));
    this.span = this.box.getSize(point).length() || 1;
    this.solids = this.elements.map((element) => this.solidOf(element));
    for (const surface of this.surfaces) if (surface.stop) this.box.expandByPoint(point.set(...AXES.map((axis) => Number(surface[axis]))));
    const largest = Math.max(0, ...this.solids.filter(Boolean).map(sizeOf));
    this.radius = 0.5 * this.box.getSize(point).length() + largest || 1;
    const margin = Math.max(largest, 0.09 * this.radius);
    this.frameBox = this.box.clone().expandByScalar(margin);
    if (largest > 0) this.box.expandByScalar(largest);
    this.makeColors();
    this.addGround();
    this.objects = this.elements.map((element, i) => this.addElement(element, i));
    const isGuessed = !this.isDescribed;
    this.rods = isGuessed ? this.connections.map((connection) => this.addRod(connection)) : [];
    this.addFixedShapes();
    if (isGuessed) this.addSurfaces();
    this.addLines(samples[0], times[0]);
    this.arrows = new Arrows(this);
    this.addTrails();
    this.makeCamera();
    this.resize();
  }

  // Returns the bounding box of all objects at a time.
  boxAt(sample, time) {
    const box = new THREE.Box3(), point = new THREE.Vector3();
    this.elements.forEach((_, i) => box.expandByPoint(this.position(sample, i, point)));
    for (const line of this.lines) line.expand(box, sample, time);
    this.expandByShapes(box, sample);
    for (const connection of this.connections) if (connection.tag === "joint") box.expandByPoint(this.jointPosition(sample, connection, point));
    return box;
  }

  // Returns the box that all samples fill. Along axes on which the system travels far beyond its own size, the view follows it.
  viewOf(samples, times) {
    const whole = samples.map((sample, k) => this.boxAt(sample, times[k])), all = new THREE.Box3(), point = new THREE.Vector3();
    const sizes = whole.map((box) => box.getSize(point).length()), grown = sizes.findIndex((size) => sizes[0] > 0 && size > GROWN * sizes[0]);
    const boxes = grown > 0 ? whole.slice(0, grown) : whole;
    for (const box of boxes) all.union(box);
    const own = Math.max(...sizes.slice(0, boxes.length)), extent = all.getSize(new THREE.Vector3());
    this.viewed = boxes.length;
    this.followedAxes = [0, 1, 2].filter((axis) => own > 0 && extent.getComponent(axis) > FAR * own);
    this.start = boxes[0].getCenter(new THREE.Vector3());
    this.travelled = new THREE.Vector3();
    if (this.followedAxes.length === 0) return all;
    const view = new THREE.Box3();
    for (const box of boxes) view.union(box.translate(this.travelOf(box).negate()));
    return view;
  }

  // Returns how far the centre of a box is from that at the start, along the axes that the view follows.
  travelOf(box) {
    const travel = new THREE.Vector3();
    for (const axis of this.followedAxes) travel.setComponent(axis, (box.min.getComponent(axis) + box.max.getComponent(axis)) / 2 - this.start.getComponent(axis));
    return travel;
  }

  // Moves the camera with the system.
  follow(sample, time) {
    if (this.followedAxes.length === 0 || !this.options.follow) return;
    const travel = this.travelOf(this.boxAt(sample, time)), step = travel.clone().sub(this.travelled);
    for (const moved of [this.camera.position, this.controls.target, this.grid.position, this.centre]) moved.add(step);
    for (const { mesh, normal } of this.plates) mesh.position.add(step.clone().setComponent(normal, 0));
    this.frameBox.translate(step);
    this.travelled = travel;
  }

  makeColors() {
    this.isDark = matchMedia("(prefers-color-scheme: dark)").matches;
    this.material = (color, more = {}) => new THREE.MeshStandardMaterial({ color, roughness: 0.6, metalness: 0.1, ...more });
    this.rodMaterial = this.material(this.isDark ? 0xa9b4c4 : 0x6d7786);
  }

  colorOf(i) {
    return COLORS[i % COLORS.length];
  }

  // True if an element is drawn by its shapes or by those of its frame.
  hasShape(element) {
    return this.shapes.some((shape) => shape.in === element.name || (element.in && shape.in === element.in));
  }

  solidOf(element) {
    if (this.hasShape(element)) return null;
    if (element.tag !== "body" || (isPlanarBody(element) && (this.isDescribed || this.isLink(element)))) return null;
    const mass = this.value(element.mass || "0"), entry = (name) => this.value(element[name] || "0");
    if (element.inertia !== undefined) {
      const moment = entry("inertia");
      return mass > 0 && moment > 0 ? { kind: "cylinder", radius: Math.sqrt((2 * moment) / mass), length: 0, axes: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] } : null;
    }
    const [xx, xy, xz, yy, yz, zz] = ["Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz"].map(entry);
    const tensor = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    if (mass > 0) return solidOf(mass, tensor);
    // Without mass only the proportions are known; the size is chosen to be visible.
    const solid = solidOf(1, tensor);
    return solid && solidOf((sizeOf(solid) / (0.1 * this.span)) ** 2, tensor);
  }

  // True for a body that rods represent: from joint to joint, or from the origin of its frame to its own position.
  isLink(element) {
    return this.isJointed(element.name) || this.connections.some(({ tag, from, to }) => tag === "rod" && from === element.in && to === element.name);
  }

  isJointed(name) {
    return this.connections.some((connection) => connection.tag === "joint" && connection.of === name);
  }

  // Returns the radius of a particle's ball, by its mass relative to the heaviest; 0 for elements that are drawn otherwise.
  ballRadius(i) {
    const element = this.elements[i], isLoose = element.tag === "body" && !this.isJointed(element.name) && !(this.isDescribed && isPlanarBody(element));
    if (this.solids[i] || this.hasShape(element) || !(element.tag === "particle" || isLoose)) return 0;
    const massOf = (other) => this.value(other.mass || "0"), mass = massOf(element);
    const heaviest = Math.max(...this.elements.map(massOf).filter(Number.isFinite)) || 1;
    const share = Number.isFinite(mass) ? Math.cbrt(Math.max(0, mass) / heaviest) : 0.5;
    return (0.07 * this.radius * (0.35 + 0.65 * share)) / (1 + Math.min(this.elements.length, 60) / 12);
  }

  addElement(element, i) {
    const group = new THREE.Group();
    this.addParts(group, element, i);
    group.matrixAutoUpdate = false;
    this.world.add(group);
    this.labels.push(this.newLabel(element.name));
    return group;
  }

  addParts(group, element, i) {
    const solid = this.solids[i];
    for (const shape of this.shapes) if (shape.in === element.name) group.add(this.meshOfShape(shape, i));
    if (solid) group.add(this.meshOf(solid, i));
    else if (this.ballRadius(i) > 0) {
      group.add(new THREE.Mesh(new THREE.SphereBufferGeometry(this.ballRadius(i), 24, 16), this.material(this.colorOf(i))));
    } else if (element.tag === "point") group.add(new THREE.Mesh(new THREE.SphereBufferGeometry(0.018 * this.radius, 12, 8), this.material(this.colorOf(i))));
    else if (element.tag === "frame" && !this.isDescribed && this.shapes.length === 0) {
      group.add(new THREE.Mesh(new THREE.SphereBufferGeometry(0.022 * this.radius, 12, 8), this.rodMaterial));
      if (!this.plane) group.add(new THREE.AxesHelper(0.12 * this.radius));
    }
  }

  meshOf(solid, i) {
    const thin = 0.03 * this.radius, mesh = new THREE.Group(), material = this.material(this.colorOf(i), { transparent: true, opacity: 0.92 });
    const marked = this.material(this.isDark ? 0x14171c : 0xffffff);
    if (solid.kind === "ball") mesh.add(new THREE.Mesh(new THREE.SphereBufferGeometry(solid.radius, 32, 24), material));
    else if (solid.kind === "box") mesh.add(new THREE.Mesh(new THREE.BoxBufferGeometry(...solid.sides.map((side) => Math.max(side, thin))), material));
    else {
      const radius = Math.max(solid.radius, thin / 3), length = Math.max(solid.length, thin);
      const cylinder = new THREE.Mesh(new THREE.CylinderBufferGeometry(radius, radius, length, 48), material);
      cylinder.rotation.x = Math.PI / 2; // from axis y, that of cylinders in three.js, to the third axis
      mesh.add(cylinder);
      const stripe = new THREE.Mesh(new THREE.BoxBufferGeometry(0.9 * radius, 0.07 * radius, 1.02 * length), marked); // makes rotation visible
      stripe.position.x = 0.5 * radius;
      if (solid.length < 3 * solid.radius) mesh.add(stripe);
    }
    mesh.applyMatrix(new THREE.Matrix4().makeBasis(...properAxes(solid.axes).map((axis) => new THREE.Vector3(...axis))));
    return mesh;
  }

  // Returns a material in the shape's own colour, or in that of its body.
  materialOfShape(shape, i) {
    if (shape.color) {
      const opacity = shape.color.length > 7 ? parseInt(shape.color.slice(7), 16) / 255 : 1;
      return this.material(shape.color.slice(0, 7), { transparent: opacity < 1, opacity });
    }
    return this.material(i === undefined ? (this.isDark ? 0x7a8699 : 0x9aa5b4) : this.colorOf(i), { transparent: true, opacity: 0.92 });
  }

  // Draws each triangle in one shade and from both sides: files do not define smooth edges, and some have inverted triangles.
  addSurface(mesh, { points, corners }, material) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
    geometry.setIndex(corners);
    material.flatShading = true;
    material.side = THREE.DoubleSide;
    mesh.add(new THREE.Mesh(geometry, material));
  }

  meshOfShape(shape, i) {
    const measure = (name) => this.value(shape[name] || "0"), material = this.materialOfShape(shape, i);
    const mesh = new THREE.Group(), axis = AXES.indexOf(shape.axis), add = (geometry) => mesh.children[mesh.add(new THREE.Mesh(geometry, material)).children.length - 1];
    const [radius, length] = [measure("radius"), measure("length")], part = new THREE.Group();
    if (shape.type === "box") add(new THREE.BoxBufferGeometry(...["sizeX", "sizeY", "sizeZ"].map((name) => measure(name) || 0.02 * this.radius)));
    else if (shape.type === "ellipsoid") add(new THREE.SphereBufferGeometry(0.5, 48, 32)).scale.set(...["sizeX", "sizeY", "sizeZ"].map(measure));
    else if (shape.type === "mesh") this.addSurface(mesh, this.meshes.get(shape.mesh), material);
    else if (shape.type === "sphere") {
      add(new THREE.SphereBufferGeometry(radius, 32, 24));
      add(new THREE.TorusBufferGeometry(radius, 0.03 * radius, 8, 48)).material = this.material(this.isDark ? 0x14171c : 0xffffff); // makes rotation visible
    } else if (shape.type === "plane") {
      add(new THREE.BoxBufferGeometry(2.4 * this.radius, 0.02 * this.radius, 2.4 * this.radius)).position.y = -0.01 * this.radius;
      if (!shape.color) material.color.set(this.isDark ? 0x39424f : 0xdfe4ea);
    } else {
      add(new THREE.CylinderBufferGeometry(radius, radius, length, 48));
      if (shape.type === "capsule") for (const end of [-1, 1]) add(new THREE.SphereBufferGeometry(radius, 32, 16)).position.y = (end * length) / 2;
    }
    // Cylinders of three.js have the axis y.
    if (!["box", "sphere", "mesh", "ellipsoid"].includes(shape.type)) mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), new THREE.Vector3().setComponent(axis, 1));
    part.add(mesh);
    part.position.set(...AXES.map(measure));
    part.rotation.set(...["roll", "pitch", "yaw"].map(measure), "ZYX");
    return part;
  }

  // Returns the corners of a box around a shape, in its object's frame.
  cornersOf(shape) {
    const measure = (name) => this.value(shape[name] || "0"), radius = shape.type === "mesh" ? radiusOf(this.meshes.get(shape.mesh)) : measure("radius");
    const along = measure("length") / 2 + (shape.type === "capsule" ? radius : 0), half = AXES.map((axis) => (shape.axis === axis && along > 0 ? along : radius || measure(`size${axis.toUpperCase()}`) / 2));
    const place = new THREE.Matrix4().makeRotationFromEuler(new THREE.Euler(...["roll", "pitch", "yaw"].map(measure), "ZYX")).setPosition(...AXES.map(measure));
    return CORNERS.map((signs) => new THREE.Vector3(...signs.map((sign, k) => sign * half[k])).applyMatrix4(place));
  }

  // Expands a box by the shapes.
  expandByShapes(box, sample) {
    const point = new THREE.Vector3(), origin = new THREE.Vector3(), rotation = new THREE.Matrix4();
    for (const { shape, corners } of this.shapeCorners) {
      const i = this.byName.get(shape.in);
      this.position(sample, i, origin);
      this.rotation(sample, i, rotation);
      for (const corner of corners) {
        point.copy(corner).applyMatrix4(rotation).add(origin);
        if (this.plane) point.setComponent(this.planeNormal, origin.getComponent(this.planeNormal));
        box.expandByPoint(point);
      }
    }
  }

  // Adds the shapes that are fixed to the base. Planes are drawn as plates below the system; unless they are inclined they move with the view.
  addFixedShapes() {
    const centre = this.box.getCenter(new THREE.Vector3());
    this.plates = [];
    for (const shape of this.shapes.filter((one) => !one.in)) {
      const mesh = this.meshOfShape(shape);
      this.world.add(mesh);
      const normal = AXES.indexOf(shape.axis);
      if (shape.type !== "plane" || ["roll", "pitch", "yaw"].some((name) => name in shape)) continue;
      mesh.position.copy(centre.clone().setComponent(normal, mesh.position.getComponent(normal)));
      this.plates.push({ mesh, normal });
    }
  }

  addLines(sample, time) {
    for (const line of this.lines) {
      const [from, to] = line.at(sample, time);
      this.world.add(line.build(from.distanceTo(to), 1));
    }
  }

  // Adds a rod between two elements, or from the centre of a planar body to its joint.
  addRod(connection, opacity = 1) {
    const thickness = 0.014 * this.radius / (1 + this.elements.length / 60), group = new THREE.Group(), look = { transparent: opacity < 1, opacity };
    const mesh = new THREE.Mesh(new THREE.CylinderBufferGeometry(thickness, thickness, 1, 10), this.material(this.rodMaterial.color, look));
    const size = connection.tag === "joint" ? 1.6 : connection.from ? 0 : 2;
    const ball = size && new THREE.Mesh(new THREE.SphereBufferGeometry(size * thickness, 12, 8), this.material(this.isDark ? 0xe6e9ef : 0x3a4350, look));
    group.add(mesh);
    if (ball) group.add(ball);
    this.world.add(group);
    return { connection, mesh, ball, group };
  }

  placeRods(rods, sample) {
    const from = new THREE.Vector3(), to = new THREE.Vector3(), direction = new THREE.Vector3(), y = new THREE.Vector3(0, 1, 0);
    for (const { connection, mesh, ball } of rods) {
      if (connection.tag === "joint") {
        this.position(sample, this.byName.get(connection.of), from);
        this.jointPosition(sample, connection, to);
        ball.position.copy(to);
      } else {
        this.position(sample, this.byName.get(connection.from), from);
        this.position(sample, this.byName.get(connection.to), to);
        if (ball) ball.position.copy(from);
      }
      const length = direction.subVectors(to, from).length();
      mesh.visible = length > 1e-9 * this.radius;
      if (!mesh.visible) continue;
      mesh.position.addVectors(from, to).multiplyScalar(0.5);
      mesh.quaternion.setFromUnitVectors(y, direction.normalize());
      mesh.scale.set(1, length, 1);
    }
  }

  // Adds surfaces of contacts and stops, moved back by the radius of an element that is drawn as a ball.
  addSurfaces() {
    const vector = (element, names) => new THREE.Vector3(...names.map((name) => Number(element[name])));
    for (const surface of this.surfaces) {
      const normal = vector(surface, ["nx", "ny", "nz"]), point = vector(surface, AXES), isStop = surface.stop === "true";
      const centre = this.box.getCenter(new THREE.Vector3()), extent = (isStop ? 0.3 : 2.4) * this.radius, thickness = 0.04 * this.radius;
      if (!isStop) point.addScaledVector(centre.clone().sub(point).projectOnPlane(normal), 1);
      const plate = new THREE.Mesh(new THREE.BoxBufferGeometry(extent, thickness, this.plane ? 0.4 * this.radius : extent), this.material(this.isDark ? 0x7a8699 : 0x9aa5b4));
      plate.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), normal);
      plate.position.copy(point).addScaledVector(normal, -thickness / 2 - this.ballRadius(this.byName.get(surface.of)));
      this.world.add(plate);
    }
  }

  // Adds the paths of elements, and of the last ends of lines that have a trail.
  addTrails() {
    const moving = this.elements.map((element, i) => i).filter((i) => !["frame"].includes(this.elements[i].tag) && !this.isJointed(this.elements[i].name) && this.columns[i].some((c) => c >= 0));
    const chosen = moving.length <= MOST_TRAILS ? moving : moving.slice(-1);
    const paths = chosen.map((i) => ({ color: this.colorOf(i), where: (sample, time, target) => this.position(sample, i, target) }));
    this.lines.filter(({ line }) => line.trail).forEach((line, k) => paths.push({ color: this.colorOf(this.elements.length + k), where: line.ends[line.isPoint ? 0 : 1] }));
    this.trails = paths.map((path) => {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * TRAIL_LENGTH), 3));
      const line = new THREE.Line(geometry, new THREE.LineBasicMaterial({ color: path.color, transparent: true, opacity: 0.7 }));
      line.frustumCulled = false;
      this.world.add(line);
      return { ...path, line };
    });
  }

  placeTrails(history, at) {
    const point = new THREE.Vector3(), count = Math.min(TRAIL_LENGTH, at + 1);
    for (const { where, line } of this.trails) {
      line.visible = Boolean(this.options.trails);
      if (!line.visible) continue;
      const attribute = line.geometry.attributes.position;
      for (let k = 0; k < count; k++) {
        const sample = at - count + 1 + k;
        where(history.samples[sample][0], history.time(sample), point);
        attribute.setXYZ(k, point.x, point.y, point.z);
      }
      attribute.needsUpdate = true;
      line.geometry.setDrawRange(0, count);
    }
  }

  addGround() {
    const size = 2 ** Math.ceil(Math.log2(2.4 * this.radius)), color = this.isDark ? [0x4b5565, 0x2b313b] : [0xb9c2ce, 0xe2e6ec];
    const grid = new THREE.GridHelper(2 * size, 20, ...color), up = new THREE.Vector3(...this.up);
    const centre = this.box.getCenter(new THREE.Vector3());
    if (this.plane) {
      const axis = this.planeNormal, normal = new THREE.Vector3().setComponent(axis, 1);
      grid.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), normal);
      grid.position.setComponent(axis, (axis === 1 ? 1 : -1) * 0.5 * this.radius);
    } else {
      grid.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), up);
      const lowest = Math.min(up.dot(this.box.min), up.dot(this.box.max));
      grid.position.copy(centre).addScaledVector(up, lowest - up.dot(centre));
    }
    this.grid = grid;
    this.world.add(grid);
  }

  makeCamera() {
    if (this.controls) this.controls.dispose();
    const up = new THREE.Vector3(...this.up), centre = this.box.getCenter(new THREE.Vector3()).add(this.travelled);
    let outwards;
    if (this.plane) outwards = new THREE.Vector3().crossVectors(new THREE.Vector3().setComponent(this.plane.find((axis) => !this.up[axis]), 1), up);
    else {
      const [first, second] = [new THREE.Vector3(), new THREE.Vector3()], axis = this.up.findIndex((x) => x !== 0);
      first.setComponent((axis + 1) % 3, 1);
      second.setComponent((axis + 2) % 3, 1);
      outwards = first.multiplyScalar(0.55).addScaledVector(second, -0.75).addScaledVector(up, 0.4).normalize();
    }
    this.camera = this.plane ? new THREE.OrthographicCamera(-1, 1, 1, -1, 0, 40 * this.radius) : new THREE.PerspectiveCamera(35, 1, 0.01 * this.radius, 100 * this.radius);
    this.camera.up.copy(up);
    this.camera.position.copy(centre).addScaledVector(outwards, this.plane ? 10 * this.radius : 4 * this.radius);
    this.controls = new THREE.OrbitControls(this.camera, this.renderer.domElement);
    this.controls.target.copy(centre);
    this.controls.enableKeys = false;
    this.controls.screenSpacePanning = true;
    this.allowRotation(!this.plane || this.options.rotation);
    this.centre = centre;
    this.light.position.copy(outwards).addScaledVector(up, 0.8).add(new THREE.Vector3(0.3, 0.2, 0.1));
    this.outwards = outwards;
    this.controls.update();
  }

  allowRotation(isAllowed) {
    this.controls.enableRotate = isAllowed;
    this.controls.mouseButtons.LEFT = isAllowed ? THREE.MOUSE.ROTATE : THREE.MOUSE.PAN;
    this.controls.touches.ONE = isAllowed ? THREE.TOUCH.ROTATE : THREE.TOUCH.PAN;
  }

  resize() {
    const width = this.container.clientWidth || 1, height = this.container.clientHeight || 1;
    this.renderer.setPixelRatio(window.devicePixelRatio || 1);
    this.renderer.setSize(width, height);
    const { offsetTop, offsetHeight } = this.container.parentElement.querySelector(".tools") || { offsetTop: 0, offsetHeight: 0 };
    const lower = Math.max(height - offsetTop - offsetHeight, height / 2), aspect = width / lower; // below the controls
    if (this.plane) {
      const upAxis = this.up.findIndex((x) => x !== 0), across = this.plane.find((axis) => axis !== upAxis);
      const extent = (axis) => Math.max(this.frameBox.max.getComponent(axis) - this.centre.getComponent(axis), this.centre.getComponent(axis) - this.frameBox.min.getComponent(axis));
      const half = Math.max(extent(upAxis), extent(across) / aspect) + 0.06 * this.radius;
      Object.assign(this.camera, { left: -half * aspect, right: half * aspect, top: half, bottom: -half });
    } else {
      this.camera.aspect = aspect;
      const distance = this.distanceFor(Math.tan((35 * Math.PI) / 360), aspect);
      if (!this.sized) this.camera.position.copy(this.controls.target).addScaledVector(this.outwards, distance);
      this.sized = true;
    }
    this.camera.setViewOffset(width, lower, 0, lower - height, width, height); // which also updates the projection
  }

  // Returns the distance of a camera that sees all corners of the frame. slope: the tangent of half its vertical angle.
  distanceFor(slope, aspect) {
    const across = new THREE.Vector3().crossVectors(new THREE.Vector3(...this.up), this.outwards).normalize(), upwards = new THREE.Vector3().crossVectors(this.outwards, across);
    const centre = this.frameBox.getCenter(new THREE.Vector3()), half = this.frameBox.getSize(new THREE.Vector3()).multiplyScalar(0.5);
    return Math.max(...CORNERS.map((signs) => {
      const corner = new THREE.Vector3(...signs).multiply(half).add(centre).sub(this.centre);
      return corner.dot(this.outwards) + Math.max(Math.abs(corner.dot(upwards)), Math.abs(corner.dot(across)) / aspect) / slope;
    }));
  }

  fit() {
    this.sized = false;
    this.makeCamera();
    this.resize();
  }

  newLabel(text) {
    const label = document.createElement("span");
    label.className = "label";
    label.textContent = text;
    this.container.append(label);
    return label;
  }

  // Returns the position of a point on the screen, in pixels to the right and down.
  pixels(point) {
    const { x, y } = point.clone().project(this.camera);
    return [((x + 1) * this.container.clientWidth) / 2, ((1 - y) * this.container.clientHeight) / 2];
  }

  placeLabels(sample) {
    const point = new THREE.Vector3(), taken = [];
    this.labels.forEach((label, i) => {
      label.style.display = this.options.names ? "" : "none";
      if (!this.options.names) return;
      const [right, down] = this.pixels(this.position(sample, i, point)), x = right + 8;
      let y = down - 18;
      while (taken.some((other) => Math.abs(other[0] - x) < 50 && Math.abs(other[1] - y) < 13)) y += 13;
      taken.push([x, y]);
      label.style.transform = `translate(${x}px, ${y}px)`;
    });
  }

  placeElements(objects, sample) {
    const rotation = new THREE.Matrix4(), point = new THREE.Vector3();
    objects.forEach((object, i) => {
      this.rotation(sample, i, rotation);
      object.matrix.copy(rotation).setPosition(this.position(sample, i, point));
      object.matrixWorldNeedsUpdate = true;
    });
  }

  // Places the pale second run, or hides it without a sample.
  placeGhost(sample, time) {
    if (!sample && !this.ghosts) return;
    this.ghosts ??= this.elements.map((_, i) => this.ghostOf(i));
    this.ghostLines ??= this.lines.filter(({ kind }) => !["ground", "pivot"].includes(kind)).map(({ line }) => this.ghostOfLine(line, sample, time));
    this.ghostRods ??= this.rods.map(({ connection }) => this.addRod(connection, PALE));
    for (const ghost of this.ghosts) ghost.visible = Boolean(sample);
    // The positions of joints are formulas, too.
    for (const { group, connection } of this.ghostRods) group.visible = Boolean(sample) && (connection.tag === "rod" || this.options.ghost !== "kept");
    if (sample) {
      this.placeElements(this.ghosts, sample);
      this.placeRods(this.ghostRods, sample);
    }
    for (const ghost of this.ghostLines) {
      if (sample && this.isKnown(ghost.line)) ghost.update(sample, time);
      else ghost.group.visible = false;
    }
  }

  // True if the ends of a ghost's line are known. Formulas have the parameters of the first run; a ghost that keeps its own may have others.
  isKnown(line) {
    return this.options.ghost !== "kept" || (line.from !== undefined && line.to !== undefined);
  }

  ghostOfLine(line, sample, time) {
    const ghost = new DrawnLine(this, line, this.compiled), [from, to] = ghost.at(sample, time);
    this.world.add(ghost.build(from.distanceTo(to), PALE));
    return ghost;
  }

  ghostOf(i) {
    const ghost = this.objects[i].clone();
    ghost.traverse((part) => part.isMesh && (part.material = this.material(this.colorOf(i), { transparent: true, opacity: PALE })));
    ghost.matrixAutoUpdate = false;
    this.world.add(ghost);
    return ghost;
  }

  // Enlarges the view of a plane, if an element has left it.
  enlargeView(sample, time) {
    const point = new THREE.Vector3(), before = this.frameBox.clone();
    for (const line of this.lines) line.expand(this.frameBox, sample, time);
    this.elements.forEach((_, i) => this.frameBox.expandByPoint(this.position(sample, i, point)));
    if (!before.equals(this.frameBox)) this.resize();
  }

  // Draws the sample of a history with the index `at`.
  draw(history, at) {
    const runs = history.samples[at], time = history.time(at);
    this.follow(runs[0], time);
    if (this.plane) this.enlargeView(runs[0], time);
    this.placeElements(this.objects, runs[0]);
    this.placeGhost(runs[1], time);
    this.placeRods(this.rods, runs[0]);
    for (const line of this.lines) line.update(runs[0], time);
    this.arrows.update(history, at);
    this.placeTrails(history, at);
    this.controls.update();
    this.renderer.render(this.world, this.camera);
    this.placeLabels(runs[0]);
    this.arrows.placeLabels();
  }
}

// Returns the axes, with the second one reversed if they are left-handed.
function properAxes([first, second, third]) {
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const sign = cross(first, second).reduce((sum, x, k) => sum + x * third[k], 0);
  return sign < 0 ? [first, second.map((x) => -x), third] : [first, second, third];
}
