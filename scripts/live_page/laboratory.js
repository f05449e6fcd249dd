// lagc and the runtime in one module, see src/laboratory. It accesses files and standard streams by WASI. Runs in workers.
"use strict";

const [SUCCESS, BAD_DESCRIPTOR, INVALID, NO_ENTRY] = [0, 8, 28, 44];
const [DIRECTORY, REGULAR_FILE] = [3, 4];
const ROOT = 3; // descriptor of the folder of all files
const [FROM_START, FROM_PRESENT] = [0, 1];

// An instance of the module, which derives one system, once.
class Laboratory {
  // files: their texts by name.
  constructor(bytes, files) {
    this.files = new Map(Object.entries(files).map(([name, text]) => [name, new TextEncoder().encode(text)]));
    this.opened = new Map(); // { content, at } by descriptor; at: the read position
    this.said = "";
    this.wasm = new WebAssembly.Instance(new WebAssembly.Module(bytes), { wasi_snapshot_preview1: this.system() }).exports;
    this.wasm._initialize();
  }

  // Derives the system of a file; true on success. lagc's messages are in `said`.
  derive(name, isPulled) {
    try {
      return this.wasm.derive(this.textIn(`/${name}`), Number(isPulled)) === 0;
    } catch (problem) {
      this.said += this.said ? "" : `${name}: the system is too large to be derived here (${problem.message})\n`;
      return false;
    }
  }

  textOf(pointer) {
    const bytes = new Uint8Array(this.wasm.memory.buffer, pointer);
    return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
  }

  // Returns the address of a copy of the text in the module's memory, which is never freed.
  textIn(text) {
    const bytes = new TextEncoder().encode(`${text}\0`), place = this.wasm.allocate(bytes.length);
    new Uint8Array(this.wasm.memory.buffer).set(bytes, place);
    return place;
  }

  view() {
    return new DataView(this.wasm.memory.buffer);
  }

  // Returns the normalized path at an address, as it is in `files`.
  nameAt(place, length) {
    const parts = [];
    for (const part of new TextDecoder().decode(new Uint8Array(this.wasm.memory.buffer, place, length)).split("/")) {
      if (part === "..") parts.pop();
      else if (part !== "" && part !== ".") parts.push(part);
    }
    return parts.join("/");
  }

  isFolder(name) {
    return name === "" || [...this.files.keys()].some((file) => file.startsWith(`${name}/`));
  }

  // Yields the buffers of a list of iovec.
  *pieces(list, count) {
    const view = this.view();
    for (let i = 0; i < count; i++) yield new Uint8Array(this.wasm.memory.buffer, view.getUint32(list + 8 * i, true), view.getUint32(list + 8 * i + 4, true));
  }

  write(descriptor, list, count, written) {
    let length = 0;
    for (const piece of this.pieces(list, count)) {
      this.said += new TextDecoder().decode(piece);
      length += piece.length;
    }
    this.view().setUint32(written, length, true);
    return SUCCESS;
  }

  open(folder, flags, place, length, further, rights, inherited, how, result) {
    const content = this.files.get(this.nameAt(place, length));
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
    for (const piece of this.pieces(list, count)) {
      const part = file.content.subarray(file.at, file.at + piece.length);
      piece.set(part);
      file.at += part.length;
    }
    this.view().setUint32(result, file.at - from, true);
    return SUCCESS;
  }

  seek(descriptor, offset, whence, result) {
    const file = this.opened.get(descriptor);
    if (!file) return BAD_DESCRIPTOR;
    file.at = Number(offset) + (whence === FROM_START ? 0 : whence === FROM_PRESENT ? file.at : file.content.length);
    this.view().setBigUint64(result, BigInt(file.at), true);
    return SUCCESS;
  }

  tellOfDescriptor(descriptor, place) {
    if (descriptor > ROOT && !this.opened.has(descriptor)) return BAD_DESCRIPTOR;
    new Uint8Array(this.wasm.memory.buffer).fill(0, place, place + 24);
    this.view().setUint8(place, descriptor === ROOT ? DIRECTORY : REGULAR_FILE);
    for (const rights of [8, 16]) this.view().setBigUint64(place + rights, (1n << 29n) - 1n, true);
    return SUCCESS;
  }

  tellOfFile(folder, flags, path, length, place) {
    const name = this.nameAt(path, length), content = this.files.get(name);
    if (!content && !this.isFolder(name)) return NO_ENTRY;
    new Uint8Array(this.wasm.memory.buffer).fill(0, place, place + 64);
    this.view().setUint8(place + 16, content ? REGULAR_FILE : DIRECTORY);
    this.view().setBigUint64(place + 32, BigInt(content ? content.length : 0), true);
    return SUCCESS;
  }

  tellOfFolder(descriptor, place) {
    if (descriptor !== ROOT) return BAD_DESCRIPTOR;
    this.view().setUint8(place, 0);
    this.view().setUint32(place + 4, 1, true); // the length of "/"
    return SUCCESS;
  }

  nameFolder(descriptor, place) {
    new Uint8Array(this.wasm.memory.buffer)[place] = "/".charCodeAt(0);
    return SUCCESS;
  }

  noEnvironment(count, size) {
    this.view().setUint32(count, 0, true);
    this.view().setUint32(size, 0, true);
    return SUCCESS;
  }

  // Returns the functions of WASI that the module imports.
  system() {
    return {
      clock_time_get: (clock, precision, place) => (this.view().setBigUint64(place, 0n, true), SUCCESS),
      environ_get: () => SUCCESS,
      environ_sizes_get: (...places) => this.noEnvironment(...places),
      fd_close: (descriptor) => (this.opened.delete(descriptor) ? SUCCESS : BAD_DESCRIPTOR),
      fd_fdstat_get: (...about) => this.tellOfDescriptor(...about),
      fd_fdstat_set_flags: () => SUCCESS,
      fd_prestat_dir_name: (...about) => this.nameFolder(...about),
      fd_prestat_get: (...about) => this.tellOfFolder(...about),
      fd_read: (...about) => this.read(...about),
      fd_seek: (...about) => this.seek(...about),
      fd_write: (...about) => this.write(...about),
      path_filestat_get: (...about) => this.tellOfFile(...about),
      path_open: (...about) => this.open(...about),
      path_readlink: () => INVALID, // no file is a symbolic link
      proc_exit: (status) => {
        throw new Error(`it ended with ${status}`);
      },
    };
  }
}

// Derives a system and returns the functions of its module; throws lagc's messages on failure.
function derivedIn({ bytes, files, file }, isPulled) {
  const made = new Laboratory(bytes, files);
  if (!made.derive(file, isPulled)) throw new Error(made.said);
  return made.wasm;
}
