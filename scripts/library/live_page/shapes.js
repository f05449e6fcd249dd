// Finds the uniform solid that has the mass and the moments of inertia of a body.
"use strict";

// Returns eigenvalues, and eigenvectors as columns, of a symmetric 3 x 3 matrix, by Jacobi's method (Golub and Van Loan: Matrix computations, 8.5).
function eigen(matrix) {
  const a = matrix.map((row) => [...row]), v = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  for (let sweep = 0; sweep < 30; sweep++)
    for (const [p, q] of [[0, 1], [0, 2], [1, 2]]) {
      if (Math.abs(a[p][q]) <= 1e-15 * (Math.abs(a[p][p]) + Math.abs(a[q][q]))) continue;
      const angle = 0.5 * Math.atan2(2 * a[p][q], a[q][q] - a[p][p]), c = Math.cos(angle), s = Math.sin(angle);
      for (let k = 0; k < 3; k++) [a[k][p], a[k][q]] = [c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]];
      for (let k = 0; k < 3; k++) [a[p][k], a[q][k]] = [c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]];
      for (let k = 0; k < 3; k++) [v[k][p], v[k][q]] = [c * v[k][p] - s * v[k][q], s * v[k][p] + c * v[k][q]];
    }
  return [[a[0][0], a[1][1], a[2][2]], v];
}

const isNear = (a, b, scale) => Math.abs(a - b) <= 1e-3 * scale;

// Returns a ball { radius }, a cylinder { radius, length } about its third axis, or a box { sides }, in m, with its axes, each a unit vector.
function solidOf(mass, inertia) {
  const [moments, vectors] = eigen(inertia), largest = Math.max(...moments);
  const column = (k) => vectors.map((row) => row[k]);
  if (!(largest > 0) || !(mass > 0)) return null;
  for (let k = 0; k < 3; k++) {
    const [first, second] = [(k + 1) % 3, (k + 2) % 3];
    if (!isNear(moments[first], moments[second], largest)) continue;
    const axes = [column(first), column(second), column(k)];
    if (isNear(moments[k], moments[first], largest)) return { kind: "ball", radius: Math.sqrt((2.5 * moments[k]) / mass), axes };
    const radius = Math.sqrt((2 * Math.max(0, moments[k])) / mass);
    const length = Math.sqrt(Math.max(0, (12 * moments[first]) / mass - 3 * radius ** 2));
    return { kind: "cylinder", radius, length, axes };
  }
  const sum = moments[0] + moments[1] + moments[2];
  const sides = moments.map((moment) => Math.sqrt(Math.max(0, (6 * (sum - 2 * moment)) / mass)));
  return { kind: "box", sides, axes: [column(0), column(1), column(2)] };
}

// Returns the radius of the circumscribed ball.
const sizeOf = (solid) => (solid.kind === "box" ? Math.hypot(...solid.sides) / 2 : Math.hypot(solid.radius, (solid.length || 0) / 2));
