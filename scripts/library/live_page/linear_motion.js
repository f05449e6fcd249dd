// The motion of the FMU's linearization about an equilibrium, with the functions of an Fmu that a run needs. Runs in the worker.
"use strict";

class LinearMotion {
  // fmu: an instance of its own, which computes positions and outputs at the states of the linear motion.
  constructor(fmu, description) {
    Object.assign(this, { fmu, description });
  }

  // Starts at the FMU's start with these settings, [index of the variable, value] each, and linearizes about an equilibrium near it.
  start(settings, time = this.description.startTime) {
    this.settings = new Map(settings);
    this.fmu.start(settings, time);
    this.time = time;
    this.linearize(this.fmu.read(new Point(this.fmu, this.description, [], time).states.references));
  }

  linearize(states) {
    this.point = new Point(this.fmu, this.description, [...this.settings], this.time);
    this.model = linearizationAt(this.point, equilibriumNear(this.point, states));
    this.inputs = this.point.inputs.names.map(() => 0); // differences from those of the equilibrium
    this.offset = this.model.chosen.map((i) => states[i] - this.model.at[i]);
    this.isChanged = false;
    this.stepLength = NaN;
    this.goToStates();
  }

  states() {
    return this.model.at.map((value, i) => value + dot(this.model.basis[i], this.offset));
  }

  goToStates() {
    this.point.time = this.time;
    this.point.start(this.states());
    this.isBehind = false;
  }

  // Sets an input, or a parameter, from which on the linearization is another one.
  set(index, value) {
    const { name, role } = this.description.variables[index], input = this.point.inputs.names.indexOf(name);
    if (role !== "input" || input < 0) this.isChanged = true;
    else this.inputs[input] = value - (this.settings.get(index) ?? this.description.variables[index].start);
    if (this.isChanged) this.settings.set(index, value);
    this.stepLength = NaN;
  }

  // Multiplies the offset from the equilibrium by the exponential of A and of the inputs' effect.
  step(time, length) {
    if (this.isChanged) this.linearize(this.states());
    if (length !== this.stepLength) {
      const forced = applied(this.model.B, this.inputs), rows = this.model.A.map((row, i) => [...row, forced[i]].map((value) => value * length));
      this.transition = exponential([...rows, Array(rows.length + 1).fill(0)]).slice(0, -1);
      this.stepLength = length;
    }
    this.offset = applied(this.transition, [...this.offset, 1]);
    this.time = time + length;
    this.isBehind = true;
  }

  read(references) {
    if (this.isBehind) this.goToStates();
    return this.fmu.read(references);
  }

  events() {
    return 0;
  }

  save() {
    return { ...this, settings: new Map(this.settings), inputs: [...this.inputs] };
  }

  restore(saved) {
    Object.assign(this, saved, { settings: new Map(saved.settings), inputs: [...saved.inputs], isBehind: true });
  }
}
