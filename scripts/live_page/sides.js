// The FMU as it was shipped, and the one whose bodies can be pulled, which goes on from its state. Runs in the worker.
"use strict";

class Side {
  // wasm: the functions of FMI and of driver.c; description: of the variables with their references there; shown: the places of those that are told of.
  constructor(wasm, description, shown) {
    this.wasm = wasm;
    this.description = description;
    this.shown = shown;
    this.references = shown.map((place) => description.variables[place].reference);
    this.states = description.variables.flatMap(({ role, type }, place) => (role === "start" && type === "Real" ? [place] : []));
    this.fmus = []; // one, or with its ghost beside it
    this.kept = []; // a state for each FMU, of before something was set
    this.saved = []; // [time, a state for each FMU]
    this.free = []; // states whose places can be used again
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
