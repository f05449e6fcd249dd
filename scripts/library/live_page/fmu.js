// Calls an FMU in WebAssembly, by the functions of FMI 2.0 and of driver.c. Runs in the worker.
"use strict";

const [OK, WARNING] = [0, 1];

class Memory {
  constructor(wasm) {
    this.wasm = wasm;
    this.size = 0;
  }

  // Returns the address of a buffer of at least this many bytes, which the next call reuses.
  reserve(bytes) {
    if (bytes > this.size) {
      this.size = 2 * bytes;
      this.address = this.wasm.allocate(this.size);
    }
    return this.address;
  }

  text(pointer) {
    const bytes = new Uint8Array(this.wasm.memory.buffer, pointer);
    return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
  }
}

// An error that the FMU reports, with its message.
class FmuError extends Error {}

class Fmu {
  // description: guid, startTime and variables, each with type, reference.
  constructor(wasm, description) {
    this.wasm = wasm;
    this.memory = new Memory(wasm);
    this.description = description;
    const guid = new TextEncoder().encode(`${description.guid}\0`), address = this.memory.reserve(guid.length);
    new Uint8Array(wasm.memory.buffer).set(guid, address);
    this.instance = wasm.instantiate(address);
    if (!this.instance) throw new FmuError(this.takeMessages());
    this.isNew = true;
  }

  // Returns and clears the FMU's messages, without the names of FMI functions, which mean nothing to readers of the page.
  takeMessages() {
    const text = this.memory.text(this.wasm.messages()).trim().replace(/^fmi2\w+: /gm, "");
    this.wasm.forgetMessages();
    return text;
  }

  check(status) {
    const text = this.takeMessages();
    if (status > WARNING) throw new FmuError(text || `the FMU returned the status ${status}`);
  }

  // Resets and initializes with values, [index of the variable, value] each.
  start(values, time = this.description.startTime) {
    if (!this.isNew) this.check(this.wasm.fmi2Reset(this.instance));
    this.isNew = false;
    this.check(this.wasm.fmi2SetupExperiment(this.instance, 0, 0, time, 0, 0));
    for (const [index, value] of values) this.set(index, value);
    this.check(this.wasm.fmi2EnterInitializationMode(this.instance));
    this.check(this.wasm.fmi2ExitInitializationMode(this.instance));
  }

  set(index, value) {
    const variable = this.description.variables[index], address = this.memory.reserve(16), buffer = this.wasm.memory.buffer;
    new Uint32Array(buffer, address, 1)[0] = variable.reference;
    if (variable.type === "Real") new Float64Array(buffer, address + 8, 1)[0] = value;
    else new Int32Array(buffer, address + 8, 1)[0] = Math.round(value);
    this.check(this.wasm[`fmi2Set${variable.type}`](this.instance, address, 1, address + 8));
  }

  setReals(references, values) {
    const count = references.length, offset = 8 * Math.ceil(count / 2), address = this.memory.reserve(offset + 8 * count);
    new Uint32Array(this.wasm.memory.buffer, address, count).set(references);
    new Float64Array(this.wasm.memory.buffer, address + offset, count).set(values);
    this.check(this.wasm.fmi2SetReal(this.instance, address, count, address + offset));
  }

  // Returns the values of the Reals with these references.
  read(references) {
    const count = references.length, offset = 8 * Math.ceil(count / 2), address = this.memory.reserve(offset + 8 * count);
    new Uint32Array(this.wasm.memory.buffer, address, count).set(references);
    this.check(this.wasm.fmi2GetReal(this.instance, address, count, address + offset));
    return new Float64Array(this.wasm.memory.buffer, address + offset, count).slice();
  }

  // Returns the derivatives of the variables with these references by one with the reference `known`.
  derivative(references, known) {
    const count = references.length, offset = 8 * Math.ceil((count + 1) / 2), address = this.memory.reserve(offset + 8 * (count + 1)), { buffer } = this.wasm.memory;
    new Uint32Array(buffer, address, count + 1).set([known, ...references]);
    new Float64Array(buffer, address + offset, 1)[0] = 1;
    this.check(this.wasm.fmi2GetDirectionalDerivative(this.instance, address + 4, count, address, 1, address + offset, address + offset + 8));
    return [...new Float64Array(this.wasm.memory.buffer, address + offset + 8, count)];
  }

  // Returns the number of events so far; 0 if the system has none.
  events() {
    this.counter ??= this.description.variables.find(({ name, type }) => name === "events" && type === "Integer") ?? 0;
    if (!this.counter) return 0;
    const address = this.memory.reserve(16);
    new Uint32Array(this.wasm.memory.buffer, address, 1)[0] = this.counter.reference;
    this.check(this.wasm.fmi2GetInteger(this.instance, address, 1, address + 8));
    return new Int32Array(this.wasm.memory.buffer, address + 8, 1)[0];
  }

  step(time, length) {
    this.check(this.wasm.fmi2DoStep(this.instance, time, length, 0));
  }

  // Saves the FMU state and returns its address; reuses the memory of `state`, if it is given.
  save(state = 0) {
    const address = this.memory.reserve(8);
    new Uint32Array(this.wasm.memory.buffer, address, 1)[0] = state;
    this.check(this.wasm.fmi2GetFMUstate(this.instance, address));
    return new Uint32Array(this.wasm.memory.buffer, address, 1)[0];
  }

  restore(state) {
    this.check(this.wasm.fmi2SetFMUstate(this.instance, state));
  }
}
