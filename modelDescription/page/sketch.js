// Draws the start scene of a system, see modelDescription/scene.h, as SVG with labels: masses, lengths, coordinates, axes and a scale. Parts
// are drawn from the back to the front (painter's algorithm). Lengths on the picture are in pixels. The script is short, as each FMU has it.

const WIDTH = 360, HEIGHT = 300, MARGIN = 40, FOOT = 62; // of a picture; FOOT: for the axes and the scale below it
const MOST_LABELS = 8; // bodies up to which each has a label
const FAR = 1e3; // sizes of the system, to bring a part to the front or to the back
const BESIDE = [[1, 0], [-1, 0]], ABOVE = [[0, -1], [0, 1]], DIAGONAL = [[0.7, -0.7], [-0.7, 0.7], [-0.7, -0.7], [0.7, 0.7]]; // directions of labels
const LABEL_HEIGHT = 15, DISTANCES = [2, 8, 16, 26]; // of a label from what it names
const AXES = ["x", "y", "z"];

const numbersOf = text => text.split(" ").map(Number);
const range = (count, of) => Array.from({ length: count }, (_, i) => of(i));
const dot = (a, b) => a.reduce((total, x, k) => total + x * b[k], 0);
const add = (a, b, factor = 1) => a.map((x, k) => x + factor * b[k]);
const minus = (a, b) => add(a, b, -1);
const middleOf = (a, b) => add(a, minus(b, a), 0.5);
const cross = (a, b) => a.map((_, k) => a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
const unitAlong = k => range(3, i => Number(i === k));

// Rotates a vector about a unit axis by an angle (Rodrigues' formula).
function rotated(vector, axis, angle) {
  const across = add(vector, axis, -dot(vector, axis));
  return add(add(vector, across, Math.cos(angle) - 1), cross(axis, vector), Math.sin(angle));
}

// Returns the convex hull of points of the picture: the outermost point in each of many directions.
const outlineOf = points => range(72, i => {
  const way = [Math.cos((i * Math.PI) / 36), Math.sin((i * Math.PI) / 36)];
  return points.reduce((most, point) => (dot(point, way) > dot(most, way) ? point : most));
});

// Returns the point at a share of a line in the picture, and at a distance to its left.
function onLine([from, to], share, aside = 0) {
  const [x, y] = minus(to, from), length = Math.hypot(x, y) || 1;
  return add(add(from, [x, y], share), [y, -x], aside / length);
}

// --- Geometry ----------------------------------------------------------------------------------------------------------------------------

// Returns a solid: its corners in rings about one of its axes, and flat faces as lists of corners.
function solidAt(kind, middle, axes, half, axis = 2) {
  const isRound = kind === "ellipsoid", isBox = kind === "box", rings = isRound ? 19 : 2, count = isBox ? 4 : 36;
  const points = range(rings * count, i => {
    const share = Math.floor(i / count) / (rings - 1) - 0.5, angle = (2 * Math.PI * (i + 0.5)) / count;
    const out = isRound ? Math.cos(Math.PI * share) : isBox ? Math.SQRT2 : 1, lengths = [];
    lengths[axis] = isRound ? Math.sin(Math.PI * share) : 2 * share;
    lengths[(axis + 1) % 3] = out * Math.cos(angle);
    lengths[(axis + 2) % 3] = out * Math.sin(angle);
    return axes.reduce((point, direction, k) => add(point, direction, lengths[k] * half[k]), middle);
  });
  const ends = isRound ? [] : [range(count, k => count - 1 - k), range(count, k => k + count)];
  return { middle, points, faces: isBox ? [...ends, ...range(4, k => [k, (k + 1) % 4, ((k + 1) % 4) + 4, k + 4])] : ends };
}

class Geometry {
  constructor(root) {
    this.elements = [...root.children].map(({ tagName, attributes }) => Object.fromEntries([["tag", tagName], ...[...attributes].map(({ name, value }) => [name, value])]));
    this.objects = this.elements.filter(({ tag }) => ["frame", "particle", "body", "point"].includes(tag));
    this.isDescribed = this.of("line").some(({ guessed }) => !guessed);
  }

  of(tag) {
    return this.elements.filter(element => element.tag === tag);
  }

  object(name) {
    return this.objects.find(object => object.name === name) ?? {};
  }

  vector(element, names = AXES) {
    return names.map(name => Number(element[name] ?? 0));
  }

  position(name) {
    return this.vector(this.object(name));
  }

  // Returns the axes of an object, or of the base, as unit vectors.
  axes(name) {
    const { rotation, angle = 0 } = this.object(name), rows = rotation && numbersOf(rotation);
    return range(3, k => (rows ? [rows[k], rows[k + 3], rows[k + 6]] : rotated(unitAlong(k), unitAlong(2), angle)));
  }

  // Returns the point with these components along the axes of an object.
  pointOf(name, components) {
    return this.axes(name).reduce((point, axis, k) => add(point, axis, components[k]), this.position(name));
  }

  ends(line) {
    const end = (name, k) => (name === undefined ? this.vector(line, AXES.map(axis => axis + k)) : this.position(name)), from = end(line.from, 1);
    return [from, line.kind === "pivot" ? from : end(line.to, 2)];
  }

  joint({ of, x, y }) {
    return this.pointOf(of, [x, y, 0]);
  }

  solidOfShape(shape, size = 0) {
    const { type } = shape, axis = AXES.indexOf(shape.axis), isLong = ["cylinder", "capsule"].includes(type);
    const [roll, pitch, yaw, radius, length] = this.vector(shape, ["roll", "pitch", "yaw", "radius", "length"]), origin = this.position(shape.in);
    const axes = range(3, k => minus(this.pointOf(shape.in, rotated(rotated(rotated(unitAlong(k), unitAlong(0), roll), unitAlong(1), pitch), unitAlong(2), yaw)), origin));
    const half = this.vector(shape, ["sizeX", "sizeY", "sizeZ"]).map(side => radius || (side || size) / 2);
    if (isLong) half[axis] = length / 2 + (type === "capsule" ? radius : 0);
    if (type === "plane") half[axis] = 0;
    return solidAt({ sphere: "ellipsoid", capsule: "cylinder", plane: "box" }[type] ?? type, this.pointOf(shape.in, this.vector(shape)), axes, half, axis);
  }

  // Returns the uniform ball, cylinder or box with the mass and the moments of inertia of a body in space; undefined for other objects.
  solidOfBody(body) {
    const moments = this.vector(body, ["Ixx", "Iyy", "Izz"]), most = Math.max(...moments), mass = Number(body.mass);
    const isEqual = k => Math.abs(moments[(k + 1) % 3] - moments[(k + 2) % 3]) < 1e-3 * most, axis = Math.max(0, range(3, isEqual).indexOf(true));
    if (!(mass > 0 && most > 0) || this.hasShape(body)) return undefined;
    const solid = (kind, squares) => solidAt(kind, this.position(body.name), this.axes(body.name), squares.map(square => Math.sqrt(Math.max(0, square) / mass)), axis);
    if (!isEqual(axis)) return solid("box", moments.map(moment => 1.5 * (dot(moments, [1, 1, 1]) - 2 * moment)));
    if (isEqual((axis + 1) % 3)) return solid("ellipsoid", moments.map(moment => 2.5 * moment));
    return solid("cylinder", moments.map((moment, k) => (k === axis ? 3 * moments[(axis + 1) % 3] - 1.5 * moment : 2 * moments[axis])));
  }

  hasShape({ name, in: frame }) {
    return this.of("shape").some(shape => shape.type !== "plane" && shape.in && [name, frame].includes(shape.in));
  }

  // Returns the points that the picture shows. out: the direction in which round lines are widest.
  points(out) {
    const ofLine = line => this.ends(line).flatMap((end, k, [from, to]) => {
      const radius = ["hoop", "wheel"].includes(line.kind) ? Math.hypot(...minus(to, from)) * (1 - k) : (line.radius ?? 0);
      return [-1, 1].map(sign => add(end, out, sign * radius));
    });
    const solids = [...this.of("shape").filter(({ type }) => type !== "plane").map(shape => this.solidOfShape(shape)), ...this.of("body").flatMap(body => this.solidOfBody(body) ?? [])];
    const marks = this.of("coordinate").filter(({ axis }) => axis).map(({ from }) => numbersOf(from));
    const stops = this.isDescribed ? [] : [[0, 0, 0], ...this.of("surface").filter(({ stop }) => stop).map(stop => this.vector(stop))];
    const all = [...this.objects.map(object => this.vector(object)), ...this.of("line").flatMap(ofLine), ...solids.flatMap(({ points }) => points), ...marks, ...this.of("joint").map(joint => this.joint(joint)), ...stops];
    return all.filter(point => point.every(Number.isFinite));
  }
}

// --- The picture -------------------------------------------------------------------------------------------------------------------------

const svgElement = name => document.createElementNS("http://www.w3.org/2000/svg", name);

class Sketch extends Geometry {
  constructor(root, container, typeset) {
    super(root);
    [this.right, this.up] = ["right", "up"].map(name => numbersOf(root.getAttribute(name)));
    const hasLabels = typeset !== undefined;
    Object.assign(this, { container, typeset, labels: [], drawn: [], arcs: 0, svg: svgElement("svg"), outwards: cross(this.right, this.up), isInSpace: [...this.right, ...this.up].filter(Boolean).length > 2 });
    const points = this.points(add(this.right, this.up)), limits = [this.right, this.up].map(way => [Math.min, Math.max].map(limit => limit(...points.map(point => dot(point, way)))));
    const [wide, high] = limits.map(([least, most]) => most - least), isBlock = this.elements.every(({ tag }) => ["input", "output"].includes(tag));
    this.centre = limits.map(limit => (limit[0] + limit[1]) / 2);
    this.size = Math.max(wide, high) || 1;
    this.scale = Math.min((WIDTH - 2 * MARGIN) / Math.max(wide, 0.3 * this.size), (HEIGHT - 2 * MARGIN) / Math.max(high, 0.3 * this.size));
    this.height = isBlock ? 150 : Math.max(130, high * this.scale + 2 * MARGIN);
    this.whole = this.height + (hasLabels && !isBlock ? FOOT : 0);
    this.svg.setAttribute("viewBox", `0 0 ${WIDTH} ${this.whole}`);
    this.svg.setAttribute("role", "img");
    this.svg.setAttribute("aria-label", "the system at its start values");
    container.append(this.svg);
    if (isBlock) this.drawBlock();
    else for (const { draw } of this.parts().sort((a, b) => a.depth - b.depth)) draw();
    if (hasLabels && !isBlock) this.drawLabels();
  }

  // Returns the point of the picture, in pixels to the right and down.
  seen = point => [WIDTH / 2 + this.scale * (dot(point, this.right) - this.centre[0]), this.height / 2 - this.scale * (dot(point, this.up) - this.centre[1])];

  add(name, look, attributes) {
    const created = svgElement(name);
    for (const [key, value] of Object.entries({ class: look, ...attributes })) created.setAttribute(key, value);
    if (!/NaN|Infinity/.test(created.outerHTML)) this.svg.append(created);
  }

  path(look, points, color) {
    points.slice(1).forEach((to, k) => this.drawn.push(...range(25, i => onLine([points[k], to], i / 25))));
    this.add("polyline", look, { points: points.map(point => point.map(x => x.toFixed(1))).join(" "), style: color ? `color: ${color}` : "" });
  }

  area(look, points, color) {
    this.path(`${look} area`, [...points, points[0]], color);
  }

  disk(look, [cx, cy], r) {
    this.add("circle", look, { cx, cy, r });
  }

  arrow(look, points) {
    const last = points.slice(-2), share = 1 - 7 / (Math.hypot(...minus(...last)) || 1);
    this.path(look, points);
    this.path(look, [onLine(last, share, 4), last[1], onLine(last, share, -4)]);
  }

  // Writes a label beside a point, where it covers least. directions: those to prefer.
  label(name, at, directions, distances = DISTANCES) {
    if (!this.typeset) return;
    const span = document.createElement("span"), half = [0, LABEL_HEIGHT / 2];
    span.innerHTML = /^\d/.test(name) ? name : this.typeset(name);
    this.container.append(span);
    half[0] = (span.offsetWidth || 8 * name.length) / 2;
    const overlap = (a, b, reach) => a.every((x, k) => Math.abs(x - b[k]) < reach[k]), isInside = ([x, y]) => x > half[0] && x + half[0] < WIDTH && y > 0 && y < this.whole;
    const places = distances.flatMap(distance => [...directions, ...DIAGONAL, ...BESIDE, ...ABOVE].map(way => at.map((x, k) => x + way[k] * (half[k] + distance))));
    const isFree = place => isInside(place) && !this.labels.some(other => overlap(place, other.place, add(add(half, other.half), [8, 0])));
    const costs = places.map((place, i) => (isFree(place) ? this.drawn.filter(point => overlap(place, point, half)).length + 0.3 * i : Infinity)), place = places[costs.indexOf(Math.min(...costs))];
    if (!isFree(place)) return span.remove();
    span.style.cssText = `left:${(100 * (place[0] - half[0])) / WIDTH}%;top:${(100 * (place[1] - half[1])) / this.whole}%`;
    this.labels.push({ place, half });
  }

  // Draws the outline of a solid, and the faces towards the viewer.
  drawSolid({ points, faces }, look, color) {
    const seen = points.map(this.seen);
    this.area(look, outlineOf(seen), color);
    for (const face of faces) {
      const [a, b, c] = face.map(k => points[k]);
      if (dot(cross(minus(b, a), minus(c, a)), this.outwards) > 1e-9 * this.size ** 2) this.area(`${look} face`, face.map(k => seen[k]), color);
    }
  }

  drawLine(line) {
    const { kind, color } = line, ends = this.ends(line).map(this.seen), length = Math.hypot(...minus(...ends)) || 1e-9, radius = this.scale * (line.radius ?? 0), wide = radius || 8;
    const draw = (look, ...places) => this.path(look, places.map(([share, aside]) => onLine(ends, share, aside)), color), thin = "link thin";
    if (kind === "spring") draw(thin, [0], [0.12], ...range(14, i => [0.12 + (0.76 * (i + 0.5)) / 14, i % 2 ? -wide : wide]), [0.88], [1]);
    else if (kind === "damper") {
      for (const side of [wide, -wide]) draw(thin, [0], [0.2], [0.2, side], [0.65, side]);
      draw("link", [0.5, 0.8 * wide], [0.5, -0.8 * wide]);
      draw(thin, [0.5], [1]);
    } else if (kind === "belt") {
      const half = (end, sign) => range(13, i => [end + (sign * radius * Math.sin((i * Math.PI) / 12)) / length, -sign * radius * Math.cos((i * Math.PI) / 12)]);
      draw("link", ...half(1, 1), ...half(0, -1), [1, -radius]);
    } else if (kind === "ground") {
      const count = Math.max(3, Math.round(length / 11));
      draw("ground", [0], [1]);
      for (let i = 1; i <= count; i++) draw("ground", [i / count], [i / count - Math.min(8 / length, 1 / count), -8]);
    } else if (kind === "pivot") {
      this.area("ground", [ends[0], add(ends[0], [-9, 14]), add(ends[0], [9, 14])]);
      this.disk("base", ends[0], 3);
    } else if (kind === "arrow") this.arrow("link", ends);
    else if (kind === "hoop" || kind === "wheel") this.drawCircle(line);
    else if (radius > 1.5) this.area("solid", [[0, radius], [1, radius], [1, -radius], [0, -radius]].map(place => onLine(ends, ...place)), color);
    else draw(kind === "rope" ? thin : "link", [0], [1]);
  }

  drawCircle({ kind, color, axis = "z", ...line }) {
    const [from, to] = this.ends(line), points = range(37, i => this.seen(add(from, rotated(minus(to, from), unitAlong(AXES.indexOf(axis)), (i * Math.PI) / 18))));
    this.path("link", points, color);
    if (kind === "wheel") for (const k of [0, 9]) this.path("link thin", [points[k], points[k + 18]], color);
  }

  // Returns all parts: their depths, and functions that draw them.
  parts() {
    const parts = [], part = (at, draw, layer = 0) => parts.push({ depth: dot(at, this.outwards) + layer * FAR * this.size, draw });
    const masses = this.objects.filter(({ mass }) => mass > 0), heaviest = Math.max(...masses.map(({ mass }) => mass));
    for (const line of this.of("line")) part(middleOf(...this.ends(line)), () => this.drawLine(line), this.isInSpace ? 0 : -1);
    for (const shape of this.of("shape")) {
      const isPlane = shape.type === "plane", solid = this.solidOfShape(shape, isPlane ? this.size : 0);
      part(solid.middle, () => this.drawSolid(solid, isPlane ? "ground" : "solid", shape.color), isPlane ? -2 : 0);
    }
    for (const object of this.objects.filter(one => !this.hasShape(one))) {
      const at = this.vector(object), solid = this.solidOfBody(object), half = [Math.sqrt((3 * object.inertia) / object.mass), 0, 0];
      if (solid) part(at, () => this.drawSolid(solid, "solid"));
      else if (object.inertia && !this.isDescribed) part(at, () => this.path("body", [-1, 1].map(sign => this.seen(this.pointOf(object.name, half.map(x => sign * x))))));
      else if (object.mass > 0 && !object.inertia) part(at, () => this.disk("particle", this.seen(at), (4 + 5 * Math.cbrt(object.mass / heaviest)) / (1 + masses.length / 40)));
      else if (object.tag === "point" || !this.isDescribed) part(at, () => this.disk("base", this.seen(at), 2));
    }
    if (!this.isDescribed) this.addGuesses(part);
    return parts;
  }

  // Adds the rods, joints and surfaces that lagc found. A surface is hatched in the plane of the picture, else a plate.
  addGuesses(part) {
    const link = (...ends) => part(middleOf(...ends), () => this.path("link", ends.map(this.seen)));
    for (const { from, to } of this.of("rod")) link(this.position(from), this.position(to));
    for (const joint of this.of("joint")) link(this.position(joint.of), this.joint(joint));
    for (const pivot of [[0, 0, 0], ...this.of("joint").map(joint => this.joint(joint))]) part(pivot, () => this.disk("base", this.seen(pivot), 3), 1);
    for (const surface of this.of("surface")) {
      const normal = this.vector(surface, ["nx", "ny", "nz"]), at = this.vector(surface), half = (surface.stop ? 0.12 : 0.5) * this.size;
      const foot = surface.stop ? at : add(this.position(surface.of), normal, dot(minus(at, this.position(surface.of)), normal));
      const other = Math.abs(dot(normal, this.outwards)) < 0.9 ? this.outwards : this.up, across = cross(normal, other), sides = [across, cross(normal, across)].map(side => side.map(x => (x * half) / Math.hypot(...across)));
      const [to, from] = [1, -1].map(sign => add(foot, sides[0], sign)), line = Object.fromEntries(AXES.flatMap((axis, k) => [[`${axis}1`, from[k]], [`${axis}2`, to[k]]]));
      const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([a, b]) => this.seen(add(add(foot, sides[0], a), sides[1], b)));
      part(foot, () => (this.isInSpace ? this.area("ground", corners) : this.drawLine({ kind: "ground", ...line })), -2);
    }
  }

  // --- Labels ----------------------------------------------------------------------------------------------------------------------------

  drawLabels() {
    const masses = this.objects.filter(({ mass }) => mass > 0);
    const coordinates = this.of("coordinate").flatMap(coordinate => this.drawCoordinate(coordinate) ?? []);
    this.drawScale();
    for (const [name, at, directions] of coordinates) this.label(name, at, directions);
    if (masses.length <= MOST_LABELS)
      for (const { name, label } of masses) this.label(/^[A-Za-z_][\w.[\]*^]{0,13}$/.test(label) ? label : name, this.seen(this.position(name)), DIAGONAL, DISTANCES.slice(1));
    for (const line of this.of("line").filter(({ label }) => label)) {
      const ends = this.ends(line).map(this.seen), across = minus(onLine(ends, 0, 1), ends[0]);
      this.label(line.label, onLine(ends, 0.5), [across, across.map(x => -x)]);
    }
  }

  // Draws a coordinate as an arrow from 0 to its value, or in its positive direction if that is short. Returns the label that belongs to it.
  drawCoordinate({ name, start, from, to, axis, along }) {
    const ends = [from, to].map(numbersOf), points = (axis ? this.arc(...ends, numbersOf(axis), start) : this.shift(ends, numbersOf(along))).map(this.seen);
    const [x, y] = minus(points.at(-1), points[0]), middle = points[points.length >> 1], out = minus(middle, this.seen(ends[0])), length = Math.hypot(...out);
    if (Math.hypot(x, y) < 5) return undefined;
    this.arrow("mark", points);
    return [[name, middle, axis && length > 1 ? [out.map(part => part / length)] : Math.abs(x) > Math.abs(y) ? ABOVE : BESIDE]];
  }

  shift([from, to], along) {
    const isShort = Math.hypot(...minus(to, from)) * this.scale < 16, ends = isShort ? [to, add(to, along, 30 / this.scale)] : [from, to];
    return [ends[0], middleOf(...ends), ends[1]];
  }

  // Returns the points of an arc. Arcs have different radii, so that several about one centre are distinct.
  arc(centre, tip, axis, angle) {
    const arm = minus(tip, centre), length = Math.hypot(...arm), isShort = Math.abs(angle) < 0.12 || Math.abs(angle) > 6.2, [first, last] = isShort ? [0, 0.5] : [-angle, 0];
    const share = Math.min(0.45, (46 + 6 * (this.arcs++ % 3)) / this.scale / length), at = (turn, part) => add(centre, rotated(arm, axis, turn), part);
    if (!isShort) this.path("mark dashed", [centre, at(first, 1.25 * share)].map(this.seen));
    return range(25, i => at(first + ((last - first) * i) / 24, share));
  }

  // Draws the axes, the direction of gravity, and a length of 1, 2 or 5 times a power of ten.
  drawScale() {
    const limit = 90 / this.scale, power = 10 ** Math.floor(Math.log10(limit)), length = [5, 2, 1].find(factor => factor * power <= limit) * power;
    const origin = [40, this.height + 46], end = [WIDTH - 14, this.height + 46], begin = add(end, [-length * this.scale, 0]), [gravity] = this.of("gravity");
    const direction = (at, way, name) => {
      const [x, y] = [dot(way, this.right), -dot(way, this.up)].map(part => (24 * part) / (Math.hypot(...way) || 1));
      if (Math.hypot(x, y) < 4) return;
      this.arrow("axis", [at, add(at, [x, y])]);
      this.label(name, add(at, [1.4 * x, 1.4 * y]), [[0, 0]], [0]);
    };
    AXES.forEach((axis, k) => direction(origin, unitAlong(k), axis));
    if (gravity) direction(add(origin, [56, -26]), this.vector(gravity), "g");
    this.path("axis", [add(begin, [0, -3]), begin, end, add(end, [0, -3])]);
    this.label(`${Number(length.toPrecision(1))} m`, middleOf(begin, end), ABOVE, [1]);
  }

  // Draws a system without objects as a block with its inputs and outputs.
  drawBlock() {
    this.area("body", [[120, 10], [240, 10], [240, 140], [120, 140]]);
    for (const [tag, from, sign] of [["input", 80, -1], ["output", 240, 1]])
      this.of(tag).slice(0, 7).forEach(({ name }, i, { length }) => {
        const ends = [from, from + 40].map(right => [right, 10 + (130 * (i + 0.5)) / length]);
        this.arrow("link", ends);
        this.label(name, ends[sign > 0 ? 1 : 0], [[sign, 0]], [3]);
      });
  }
}

// Adds the picture of a scene before its text. typeset: returns a label as HTML; without it there are neither labels, nor axes and a scale.
function drawScene(text, typeset) {
  const container = document.createElement("div");
  container.className = "sketch";
  text.before(container);
  new Sketch(new DOMParser().parseFromString(text.textContent, "application/xml").documentElement, container, typeset);
}
