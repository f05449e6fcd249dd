// lagc and the runtime in one module, see src/laboratory. It accesses files and standard streams by WASI. Runs in workers.
"use strict";

const [SUCCESS, BAD_DESCRIPTOR, INVALID, NO_ENTRY] = [0, 8, 28, 44];
const [DIRECTORY, REGULAR_FILE] = [3, 4];
const ROOT = 3; // descriptor of the folder of all files
const [FROM_START, FROM_CURRENT] = [0, 1];

// An instance of the module, which derives one system, once.
class Laboratory {
  // files: their texts by name.
  constructor(bytes, files) {
    this.files = new Map(Object.entries(files).map(([name, text]) => [name, new TextEncoder().encode(text)]));
    this.opened = new Map(); // { content, at } by descriptor; at: the read position
    this.messages = "";
    this.wasm = new WebAssembly.Instance(new WebAssembly.Module(bytes), { wasi_snapshot_preview1: this.imports() }).exports;
    this.wasm._initialize();
  }

  // Derives the system of a file; true on success. lagc's messages are in `messages`. robot: options for the file of a robot.
  derive(name, isPulled, robot) {
    try {
      return this.wasm.derive(this.textIn(`/${name}`), Number(isPulled), this.textIn(robot.join("\n"))) === 0;
    } catch (problem) {
      this.messages += this.messages ? "" : `${name}: the system is too large to be derived here (${problem.message})\n`;
      return false;
    }
  }

  textOf(pointer) {
    const bytes = new Uint8Array(this.wasm.memory.buffer, pointer);
    return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
  }

  // Returns the address of a copy of the text in the module's memory, which is never freed.
  textIn(text) {
    const bytes = new TextEncoder().encode(`${text}\0`), address = this.wasm.allocate(bytes.length);
    new Uint8Array(this.wasm.memory.buffer).set(bytes, address);
    return address;
  }

  view() {
    return new DataView(this.wasm.memory.buffer);
  }

  // Returns the normalized path at an address, as it is in `files`.
  nameAt(address, length) {
    const parts = [];
    for (const part of new TextDecoder().decode(new Uint8Array(this.wasm.memory.buffer, address, length)).split("/")) {
      if (part === "..") parts.pop();
      else if (part !== "" && part !== ".") parts.push(part);
    }
    return parts.join("/");
  }

  isFolder(name) {
    return name === "" || [...this.files.keys()].some((file) => file.startsWith(`${name}/`));
  }

  // Yields the buffers of a list of iovec.
  *buffers(list, count) {
    const view = this.view();
    for (let i = 0; i < count; i++) yield new Uint8Array(this.wasm.memory.buffer, view.getUint32(list + 8 * i, true), view.getUint32(list + 8 * i + 4, true));
  }

  write(descriptor, list, count, written) {
    let length = 0;
    for (const buffer of this.buffers(list, count)) {
      this.messages += new TextDecoder().decode(buffer);
      length += buffer.length;
    }
    this.view().setUint32(written, length, true);
    return SUCCESS;
  }

  open(folder, lookupFlags, path, length, openFlags, rights, inheritedRights, descriptorFlags, result) {
    const content = this.files.get(this.nameAt(path, length));
    if (!content) return NO_ENTRY;
    let descriptor = ROOT + 1;
    while (this.opened.has(descriptor)) descriptor++;
    this.opened.set(descriptor, { content, at: 0 });
    this.view().setUint32(result, descriptor, true);
    return SUCCESS;
  }

  read(descriptor, list, count, result) {
    const file = this.opened.get(descriptor);
    if (!file) return BAD_DESCRIPTOR;
    const from = file.at;
    for (const buffer of this.buffers(list, count)) {
      const part = file.content.subarray(file.at, file.at + buffer.length);
      buffer.set(part);
      file.at += part.length;
    }
    this.view().setUint32(result, file.at - from, true);
    return SUCCESS;
  }

  seek(descriptor, offset, whence, result) {
    const file = this.opened.get(descriptor);
    if (!file) return BAD_DESCRIPTOR;
    file.at = Number(offset) + (whence === FROM_START ? 0 : whence === FROM_CURRENT ? file.at : file.content.length);
    this.view().setBigUint64(result, BigInt(file.at), true);
    return SUCCESS;
  }

  statDescriptor(descriptor, address) {
    if (descriptor > ROOT && !this.opened.has(descriptor)) return BAD_DESCRIPTOR;
    new Uint8Array(this.wasm.memory.buffer).fill(0, address, address + 24);
    this.view().setUint8(address, descriptor === ROOT ? DIRECTORY : REGULAR_FILE);
    for (const rights of [8, 16]) this.view().setBigUint64(address + rights, (1n << 29n) - 1n, true);
    return SUCCESS;
  }

  statFile(folder, flags, path, length, address) {
    const name = this.nameAt(path, length), content = this.files.get(name);
    if (!content && !this.isFolder(name)) return NO_ENTRY;
    new Uint8Array(this.wasm.memory.buffer).fill(0, address, address + 64);
    this.view().setUint8(address + 16, content ? REGULAR_FILE : DIRECTORY);
    this.view().setBigUint64(address + 32, BigInt(content ? content.length : 0), true);
    return SUCCESS;
  }

  describeFolder(descriptor, address) {
    if (descriptor !== ROOT) return BAD_DESCRIPTOR;
    this.view().setUint8(address, 0);
    this.view().setUint32(address + 4, 1, true); // the length of "/"
    return SUCCESS;
  }

  nameFolder(descriptor, address) {
    new Uint8Array(this.wasm.memory.buffer)[address] = "/".charCodeAt(0);
    return SUCCESS;
  }

  noEnvironment(count, size) {
    this.view().setUint32(count, 0, true);
    this.view().setUint32(size, 0, true);
    return SUCCESS;
  }

  // Returns the functions of WASI that the module imports.
  imports() {
    return {
      clock_time_get: (clock, precision, address) => (this.view().setBigUint64(address, 0n, true), SUCCESS),
      environ_get: () => SUCCESS,
      environ_sizes_get: (...addresses) => this.noEnvironment(...addresses),
      fd_close: (descriptor) => (this.opened.delete(descriptor) ? SUCCESS : BAD_DESCRIPTOR),
      fd_fdstat_get: (...parameters) => this.statDescriptor(...parameters),
      fd_fdstat_set_flags: () => SUCCESS,
      fd_prestat_dir_name: (...parameters) => this.nameFolder(...parameters),
      fd_prestat_get: (...parameters) => this.describeFolder(...parameters),
      fd_read: (...parameters) => this.read(...parameters),
      fd_seek: (...parameters) => this.seek(...parameters),
      fd_write: (...parameters) => this.write(...parameters),
      path_filestat_get: (...parameters) => this.statFile(...parameters),
      path_open: (...parameters) => this.open(...parameters),
      path_readlink: () => INVALID, // no file is a symbolic link
      proc_exit: (status) => {
        throw new Error(`the module ended with status ${status}`);
      },
    };
  }
}

// Derives a system and returns the functions of its module; throws lagc's messages on failure.
function derivedIn({ bytes, files, file, robot }, isPulled) {
  const system = new Laboratory(bytes, files);
  if (!system.derive(file, isPulled, robot)) throw new Error(system.messages);
  return system.wasm;
}
