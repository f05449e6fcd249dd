// Finds an equilibrium of the FMU, and its linearization there; see linearization.py and equilibria.py of the package. Runs in the worker.
"use strict";

const STEP = 2 ** -16; // relative step of the differences that give the derivative of the projection
const INDEPENDENT = 0.3; // length of a row relative to the longest one, above which a state is independent; 0.02 for coordinates
const [NEWTON_STEPS, STEP_HALVINGS, LARGEST_STEP] = [100, 25, 0.5]; // the largest step is relative to a value or its nominal value
const [DOWNHILL, NUDGE] = [40, 0.1]; // moves along accelerations at most, and their relative length
const CONVERGED = 1e-12; // relative step that is negligible
const BALANCED = 1e-9; // a rate below this share of the terms of its linearization counts as 0
const MOST_STATES = 60; // the cost grows with the third power

// An FMU that is restarted repeatedly at a point, with the same settings.
class Point {
  // settings: [index of the variable, value] each; time: of the starts.
  constructor(fmu, description, settings, time) {
    const { variables } = description, indices = [...variables.keys()];
    const rates = indices.filter((index) => variables[index].derivativeOf >= 0 && variables[variables[index].derivativeOf].name !== "nonConservativeWork");
    Object.assign(this, { fmu, settings, time });
    this.indices = rates.map((index) => variables[index].derivativeOf);
    this.nominals = this.indices.map((index) => variables[index].nominal);
    const named = (some) => ({ names: some.map((index) => variables[index].name), references: some.map((index) => variables[index].reference) });
    this.states = named(this.indices);
    this.rates = named(rates);
    this.inputs = named(indices.filter((index) => variables[index].role === "input" && variables[index].type === "Real"));
    this.outputs = named(indices.filter((index) => variables[index].isOutput && variables[index].isMoving && variables[index].type === "Real"));
    if (rates.length > MOST_STATES) throw new FmuError(`${rates.length} states are too many to linearize here; lagrange-fmu linearize has no limit`);
  }

  // Initializes the FMU at these states; returns the states, which initialization projects onto constraints.
  start(states) {
    this.fmu.start([...this.settings, ...states.map((value, i) => [this.indices[i], value])], this.time);
    return [...this.fmu.read(this.states.references)];
  }

  // Returns the derivatives of some variables by others.
  jacobian(unknowns, knowns) {
    return transposed(knowns.references.map((known) => this.fmu.derivative(unknowns.references, known)), unknowns.references.length);
  }

  // Returns the derivative of the projection onto the constraints.
  projection(states) {
    const columns = states.map((value, i) => {
      const step = STEP * Math.max(1, Math.abs(value)), moved = (factor) => this.start(states.map((one, k) => one + (k === i ? factor * step : 0)));
      const [a, b, c, d] = [1, -1, 2, -2].map(moved);
      return a.map((_, k) => (8 * (a[k] - b[k]) - (c[k] - d[k])) / (12 * step));
    });
    return transposed(columns);
  }

  // Returns orthonormal vectors that span the admissible changes of the states.
  tangents(states) {
    const nearby = states.map((value, i) => value + STEP * (0.5 + ((i * 0.618) % 0.5)) * Math.max(1, Math.abs(value)));
    if (this.start(nearby).every((value, i) => value === nearby[i])) return identity(states.length);
    const projection = this.projection(states), twice = product(projection, projection);
    const difference = largestOf(projection.flatMap((row, i) => row.map((value, j) => value - twice[i][j])));
    if (difference > 1e-5 * largestOf(projection.flat())) throw new FmuError("something switches at this point, such as a contact that touches without force; it has no linearization");
    const { lengths, left } = singularValues(projection);
    return left.filter((_, k) => lengths[k] > 0.5);
  }
}

// True for a rate that is a state itself, such as der(x) = v.
const isState = (row) => row.filter((value) => value !== 0).length === 1 && row.includes(1);

// Returns the indices of as many independent rows as there are columns. They are the first whose distance from the span of those before is large enough.
function independentRows(rows, shares) {
  let rest = rows.map((row) => [...row]);
  const chosen = rows[0].map(() => {
    const lengths = rest.map((row) => Math.hypot(...row)), most = Math.max(...lengths), first = lengths.findIndex((length, i) => length >= shares[i] * most);
    const direction = rest[first].map((value) => value / lengths[first]);
    rest = rest.map((row) => row.map((value, k) => value - dot(row, direction) * direction[k]));
    return first;
  });
  return chosen.sort((a, b) => a - b);
}

// Returns the direction of coordinates along their accelerations, and of other states along their rates, as steps of relative length 1.
function downhill(point, rates, slopes) {
  const move = [...rates];
  slopes.forEach((row, i) => {
    if (isState(row)) [move[i], move[row.indexOf(1)]] = [rates[row.indexOf(1)], 0];
  });
  const longest = largestOf(move.map((value, i) => value / point.nominals[i])) || 1;
  return move.map((value) => value / longest);
}

// Returns the states of an equilibrium near these states, by a damped Newton method from velocities 0; rejects if it finds none. Where its steps
// are too long, as for a horizontal pendulum, coordinates first move along their accelerations, towards a stable equilibrium.
function equilibriumNear(point, guess) {
  const relative = (vector, states) => largestOf(vector.map((value, i) => value / Math.max(point.nominals[i], Math.abs(states[i]))));
  const weighted = (rates) => rates.map((value, i) => value / point.nominals[i]), ratesNow = () => [...point.fmu.read(point.rates.references)];
  const moved = (states, move, factor) => point.start(states.map((value, i) => value + factor * move[i]));
  let states = point.start([...guess]), slopes = point.jacobian(point.rates, point.states), moves = 0;
  for (const row of slopes.filter(isState)) states[row.indexOf(1)] = 0;
  states = point.start(states);
  for (let count = 0; count < NEWTON_STEPS; count++) {
    const basis = point.tangents(states);
    states = point.start(states);
    const rates = ratesNow();
    slopes = point.jacobian(point.rates, point.states);
    const matrix = slopes.map((row, i) => basis.map((direction) => dot(row, direction) / point.nominals[i]));
    const change = leastSquares(matrix, weighted(rates).map((value) => -value));
    const step = states.map((_, i) => basis.reduce((sum, direction, k) => sum + change[k] * direction[i], 0)), length = relative(step, states);
    const isEnd = length <= CONVERGED, isDecreasing = (reached) => Math.hypot(...weighted(ratesNow())) < Math.hypot(...weighted(rates)) && reached;
    const next = isEnd || (length > LARGEST_STEP && moves < DOWNHILL) ? null : shortened((factor) => isDecreasing(moved(states, step, factor)), Math.min(1, LARGEST_STEP / length));
    if (!next && isBalanced(point, states, rates, slopes)) return states;
    if (!next && moves++ === DOWNHILL) break;
    states = next ?? moved(states, downhill(point, rates, slopes), NUDGE);
  }
  throw new FmuError(NO_EQUILIBRIUM);
}

// Returns the first success of `attempt(factor)`, with factors that are halved; null without one.
function shortened(attempt, factor) {
  for (let halving = 0; halving < STEP_HALVINGS; halving++) {
    try {
      const reached = attempt(factor / 2 ** halving);
      if (reached) return reached;
    } catch (problem) {
      if (!(problem instanceof FmuError)) throw problem; // there is no such position
    }
  }
  return null;
}

const NO_EQUILIBRIUM = "the search from the present state finds no equilibrium; move the system closer to one, or set its inputs to 0";

// True if all rates are 0 up to rounding.
function isBalanced(point, states, rates, slopes) {
  const sizes = states.map((value, i) => Math.max(point.nominals[i], Math.abs(value)));
  return rates.every((rate, i) => Math.abs(rate) <= BALANCED * Math.max(dot(slopes[i].map(Math.abs), sizes), 1e-3));
}

// Returns the linearization of the FMU at these states: A, B, C, D in independent states; `basis` has the changes of all states by these.
function linearizationAt(point, states) {
  const directions = point.tangents(states), at = point.start(states);
  const slopes = point.jacobian(point.rates, point.states), columns = transposed(directions, states.length);
  const chosen = directions.length ? independentRows(columns, slopes.map((row) => (isState(row) ? 0.02 : INDEPENDENT))) : [];
  const inverse = transposed(identity(chosen.length).map((unit) => leastSquares(chosen.map((i) => columns[i]), unit)));
  const basis = columns.map((row) => applied(transposed(inverse), row));
  const some = (named) => ({ names: chosen.map((i) => named.names[i]), references: chosen.map((i) => named.references[i]) });
  return {
    A: product(chosen.map((i) => slopes[i]), basis),
    B: point.jacobian(some(point.rates), point.inputs),
    C: product(point.jacobian(point.outputs, point.states), basis),
    D: point.jacobian(point.outputs, point.inputs),
    states: some(point.states).names,
    inputs: point.inputs.names,
    outputs: point.outputs.names,
    at,
    chosen,
    basis,
  };
}

// Returns "stable", "unstable", or "undecided" where a real part is 0 up to rounding.
function stabilityOf(matrix, eigenvalues) {
  const error = 1e-8 * largestOf(matrix.map(largestOf));
  if (eigenvalues.some(([real]) => real > error)) return "unstable";
  return eigenvalues.every(([real]) => real < -error) ? "stable" : "undecided";
}
