// A variant of the FMU: as shipped, or with inputs that pull bodies, which continues from the state of the first. Runs in the worker.
"use strict";

class Variant {
  // wasm: functions of FMI and of driver.c; description: with the references of this variant; shown: indices of the shown variables.
  constructor(wasm, description, shown) {
    this.wasm = wasm;
    this.description = description;
    this.shown = shown;
    this.references = shown.map((index) => description.variables[index].reference);
    this.states = description.variables.flatMap(({ role, type }, index) => (role === "start" && type === "Real" ? [index] : []));
    this.fmus = []; // the FMU, and its ghost if there is one
    this.previous = []; // a state of each FMU before the last setting
    this.savedStates = []; // [time, a state of each FMU], for steps back
    this.freeStates = []; // states whose memory can be reused
  }

  addFmu() {
    this.fmus.push(new Fmu(this.wasm, this.description));
  }

  statesOf(fmu) {
    const values = fmu.read(this.states.map((index) => this.description.variables[index].reference));
    return this.states.map((index, i) => [index, values[i]]);
  }

  forgetSavedStates() {
    this.freeStates.push(...this.savedStates.splice(0).map(([, states]) => states));
  }
}
