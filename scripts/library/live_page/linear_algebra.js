// Matrices as arrays of rows: singular values, least squares, eigenvalues and the exponential function. Runs in the worker.
"use strict";

const SWEEPS = 60; // limit for Jacobi's method, and for QR steps for each eigenvalue; about ten suffice
const TINY = 2 ** -52; // relative rounding error

const identity = (n) => Array.from({ length: n }, (_, i) => Array.from({ length: n }, (_, j) => Number(i === j)));
const transposed = (matrix, columns = matrix[0]?.length ?? 0) => Array.from({ length: columns }, (_, j) => matrix.map((row) => row[j]));
const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);
const applied = (matrix, vector) => matrix.map((row) => dot(row, vector));
const largestOf = (vector) => vector.reduce((most, value) => Math.max(most, Math.abs(value)), 0);

function product(a, b) {
  const columns = transposed(b);
  return a.map((row) => columns.map((column) => dot(row, column)));
}

// Returns the singular values, and the left and right singular vectors, by Jacobi's one-sided method: rotations make the columns orthogonal.
function singularValues(matrix) {
  const columns = transposed(matrix), right = identity(columns.length);
  let isDone = false;
  for (let sweep = 0; sweep < SWEEPS && !isDone; sweep++) {
    isDone = true;
    for (let p = 0; p < columns.length; p++)
      for (let q = p + 1; q < columns.length; q++) {
        const [a, b, c] = [dot(columns[p], columns[p]), dot(columns[q], columns[q]), dot(columns[p], columns[q])];
        if (Math.abs(c) <= TINY * Math.sqrt(a * b)) continue;
        isDone = false;
        const zeta = (b - a) / (2 * c), t = (zeta < 0 ? -1 : 1) / (Math.abs(zeta) + Math.hypot(1, zeta)), cosine = 1 / Math.hypot(1, t);
        for (const pairs of [columns, right]) {
          const [first, second] = [pairs[p], pairs[q]];
          pairs[p] = first.map((value, i) => cosine * (value - t * second[i]));
          pairs[q] = second.map((value, i) => cosine * (value + t * first[i]));
        }
      }
  }
  const lengths = columns.map((column) => Math.hypot(...column));
  return { lengths, left: columns.map((column, k) => column.map((value) => value / (lengths[k] || 1))), right };
}

// Returns the shortest vector that minimizes |matrix x - wanted|; singular values below this share of the largest one count as 0.
function leastSquares(matrix, wanted, share = 1e-10) {
  const { lengths, left, right } = singularValues(matrix), solution = right.map(() => 0), limit = share * largestOf(lengths);
  lengths.forEach((length, k) => {
    if (length <= limit) return;
    const factor = dot(left[k], wanted) / length;
    right[k].forEach((value, i) => (solution[i] += factor * value));
  });
  return solution;
}

// Reduces a copy of a square matrix to Hessenberg form by elimination with pivots.
function hessenberg(matrix) {
  const h = matrix.map((row) => [...row]), n = h.length;
  for (let m = 1; m < n - 1; m++) {
    let pivot = m;
    for (let i = m + 1; i < n; i++) if (Math.abs(h[i][m - 1]) > Math.abs(h[pivot][m - 1])) pivot = i;
    if (h[pivot][m - 1] === 0) continue;
    [h[m], h[pivot]] = [h[pivot], h[m]];
    for (const row of h) [row[m], row[pivot]] = [row[pivot], row[m]];
    for (let i = m + 1; i < n; i++) {
      const factor = h[i][m - 1] / h[m][m - 1];
      h[i] = h[i].map((value, j) => value - factor * h[m][j]);
      for (const row of h) row[m] += factor * row[i];
    }
  }
  return h;
}

// Complex numbers are pairs of a real and an imaginary part.
const plus = ([a, b], [c, d]) => [a + c, b + d];
const minus = ([a, b], [c, d]) => [a - c, b - d];
const times = ([a, b], [c, d]) => [a * c - b * d, a * d + b * c];
const conjugate = ([a, b]) => [a, -b];
const over = ([a, b], length) => [a / length, b / length];
const size = ([a, b]) => Math.hypot(a, b);

function complexRoot([a, b]) {
  const length = Math.hypot(a, b), real = Math.sqrt((length + Math.abs(a)) / 2);
  if (length === 0) return [0, 0];
  return a >= 0 ? [real, b / (2 * real)] : [Math.abs(b) / (2 * real), b < 0 ? -real : real];
}

// Returns the eigenvalue of the last two rows up to n that is closer to the last element: Wilkinson's shift.
function shiftOf(h, n) {
  const half = over(minus(h[n - 1][n - 1], h[n][n]), 2), root = complexRoot(plus(times(half, half), times(h[n - 1][n], h[n][n - 1])));
  const ends = [plus(half, root), minus(half, root)].map((offset) => plus(h[n][n], offset));
  return size(minus(ends[0], h[n][n])) < size(minus(ends[1], h[n][n])) ? ends[0] : ends[1];
}

// One step of the QR algorithm on the rows from `first` to `last`, by Givens' rotations.
function qrStep(h, first, last, shift) {
  for (let i = first; i <= last; i++) h[i][i] = minus(h[i][i], shift);
  const rotations = [];
  for (let i = first; i < last; i++) {
    const length = Math.hypot(...h[i][i], ...h[i + 1][i]) || 1, c = over(h[i][i], length), s = over(h[i + 1][i], length);
    for (let j = i; j <= last; j++) {
      const [upper, lower] = [h[i][j], h[i + 1][j]];
      h[i][j] = plus(times(conjugate(c), upper), times(conjugate(s), lower));
      h[i + 1][j] = minus(times(c, lower), times(s, upper));
    }
    rotations.push([c, s]);
  }
  rotations.forEach(([c, s], k) => {
    for (let i = first, j = first + k; i <= Math.min(j + 1, last); i++) {
      const [before, after] = [h[i][j], h[i][j + 1]];
      h[i][j] = plus(times(c, before), times(s, after));
      h[i][j + 1] = minus(times(conjugate(c), after), times(conjugate(s), before));
    }
  });
  for (let i = first; i <= last; i++) h[i][i] = plus(h[i][i], shift);
}

// Returns the eigenvalues as complex numbers, by the QR algorithm with shifts.
function eigenvaluesOf(matrix) {
  const h = hessenberg(matrix).map((row) => row.map((value) => [value, 0])), norm = largestOf(matrix.map(largestOf));
  let last = h.length - 1;
  for (let step = 1; last > 0 && step < SWEEPS * h.length; step++) {
    const isSmall = (i) => size(h[i][i - 1]) <= TINY * (size(h[i][i]) + size(h[i - 1][i - 1]) || norm);
    let first = last;
    while (first > 0 && !isSmall(first)) first--;
    if (first === last) last--;
    else qrStep(h, first, last, step % 11 === 0 ? plus(h[last][last], [size(h[last][last - 1]), 0]) : shiftOf(h, last)); // an exceptional shift ends cycles
  }
  return h.map((row, i) => row[i]);
}

// Returns the exponential of a matrix, by its series after scaling, and squarings.
function exponential(matrix) {
  const n = matrix.length, halvings = Math.max(0, Math.ceil(Math.log2(n * largestOf(matrix.map(largestOf)) || 1)) + 3);
  const scaled = matrix.map((row) => row.map((value) => value / 2 ** halvings));
  let sum = identity(n), term = sum;
  for (let k = 1; k <= 12; k++) {
    term = product(term, scaled).map((row) => row.map((value) => value / k));
    sum = sum.map((row, i) => row.map((value, j) => value + term[i][j]));
  }
  for (let k = 0; k < halvings; k++) sum = product(sum, sum);
  return sum;
}
