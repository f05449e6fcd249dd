// Instances of the FMU as shipped, or of the one whose bodies can be pulled, which continues from the other's state. Runs in the worker.
"use strict";

class Side {
  // wasm: functions of FMI and of driver.c; description: with the references of this FMU; shown: indices of the shown variables.
  constructor(wasm, description, shown) {
    this.wasm = wasm;
    this.description = description;
    this.shown = shown;
    this.references = shown.map((place) => description.variables[place].reference);
    this.states = description.variables.flatMap(({ role, type }, place) => (role === "start" && type === "Real" ? [place] : []));
    this.fmus = []; // the FMU, and its ghost if there is one
    this.kept = []; // a state of each FMU before the last setting
    this.saved = []; // [time, a state of each FMU], to step back
    this.free = []; // states whose memory can be reused
  }

  add() {
    this.fmus.push(new Fmu(this.wasm, this.description));
  }

  statesOf(fmu) {
    const found = fmu.read(this.states.map((place) => this.description.variables[place].reference));
    return this.states.map((place, i) => [place, found[i]]);
  }

  forgetSaved() {
    this.free.push(...this.saved.splice(0).map((one) => one[1]));
  }
}
