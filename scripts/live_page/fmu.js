// Calls an FMU in WebAssembly, by the functions of FMI 2.0 and of driver.c. Runs in the worker.
"use strict";

const [OK, WARNING] = [0, 1];

class Memory {
  constructor(wasm) {
    this.wasm = wasm;
    this.room = 0;
  }

  // Returns the address of a buffer of at least this many bytes, which the next call reuses.
  place(bytes) {
    if (bytes > this.room) {
      this.room = 2 * bytes;
      this.at = this.wasm.allocate(this.room);
    }
    return this.at;
  }

  text(pointer) {
    const bytes = new Uint8Array(this.wasm.memory.buffer, pointer);
    return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
  }
}

// An error that the FMU reports, with its message.
class Refusal extends Error {}

class Fmu {
  // description: guid, startTime and variables, each with type, reference.
  constructor(wasm, description) {
    this.wasm = wasm;
    this.memory = new Memory(wasm);
    this.description = description;
    const guid = new TextEncoder().encode(`${description.guid}\0`), place = this.memory.place(guid.length);
    new Uint8Array(wasm.memory.buffer).set(guid, place);
    this.instance = wasm.instantiate(place);
    if (!this.instance) throw new Refusal(this.said());
    this.isNew = true;
  }

  // Returns and clears the FMU's messages, without the names of FMI functions, which mean nothing to readers of the page.
  said() {
    const words = this.memory.text(this.wasm.messages()).trim().replace(/^fmi2\w+: /gm, "");
    this.wasm.forgetMessages();
    return words;
  }

  check(status) {
    const words = this.said();
    if (status > WARNING) throw new Refusal(words || `the FMU answered with the status ${status}`);
  }

  // Resets and initializes with values, [index of the variable, value] each.
  start(values, time = this.description.startTime) {
    if (!this.isNew) this.check(this.wasm.fmi2Reset(this.instance));
    this.isNew = false;
    this.check(this.wasm.fmi2SetupExperiment(this.instance, 0, 0, time, 0, 0));
    for (const [place, value] of values) this.set(place, value);
    this.check(this.wasm.fmi2EnterInitializationMode(this.instance));
    this.check(this.wasm.fmi2ExitInitializationMode(this.instance));
  }

  set(place, value) {
    const variable = this.description.variables[place], at = this.memory.place(16), buffer = this.wasm.memory.buffer;
    new Uint32Array(buffer, at, 1)[0] = variable.reference;
    if (variable.type === "Real") new Float64Array(buffer, at + 8, 1)[0] = value;
    else new Int32Array(buffer, at + 8, 1)[0] = Math.round(value);
    this.check(this.wasm[`fmi2Set${variable.type}`](this.instance, at, 1, at + 8));
  }

  setReals(references, values) {
    const count = references.length, offset = 8 * Math.ceil(count / 2), at = this.memory.place(offset + 8 * count);
    new Uint32Array(this.wasm.memory.buffer, at, count).set(references);
    new Float64Array(this.wasm.memory.buffer, at + offset, count).set(values);
    this.check(this.wasm.fmi2SetReal(this.instance, at, count, at + offset));
  }

  // Returns the values of the Reals with these references.
  read(references) {
    const count = references.length, offset = 8 * Math.ceil(count / 2), at = this.memory.place(offset + 8 * count);
    new Uint32Array(this.wasm.memory.buffer, at, count).set(references);
    this.check(this.wasm.fmi2GetReal(this.instance, at, count, at + offset));
    return new Float64Array(this.wasm.memory.buffer, at + offset, count).slice();
  }

  // Returns the number of events so far; 0 if the system has none.
  events() {
    this.counter ??= this.description.variables.find(({ name, type }) => name === "events" && type === "Integer") ?? 0;
    if (!this.counter) return 0;
    const at = this.memory.place(16);
    new Uint32Array(this.wasm.memory.buffer, at, 1)[0] = this.counter.reference;
    this.check(this.wasm.fmi2GetInteger(this.instance, at, 1, at + 8));
    return new Int32Array(this.wasm.memory.buffer, at + 8, 1)[0];
  }

  step(time, length) {
    this.check(this.wasm.fmi2DoStep(this.instance, time, length, 0));
  }

  // Saves the FMU state and returns its address; reuses the memory of the state `place`, if it is given.
  save(place = 0) {
    const at = this.memory.place(8);
    new Uint32Array(this.wasm.memory.buffer, at, 1)[0] = place;
    this.check(this.wasm.fmi2GetFMUstate(this.instance, at));
    return new Uint32Array(this.wasm.memory.buffer, at, 1)[0];
  }

  restore(place) {
    this.check(this.wasm.fmi2SetFMUstate(this.instance, place));
  }
}
