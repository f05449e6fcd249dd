// Samples of all shown variables, of which the oldest are dropped first.
"use strict";

const NUMBERS = 4e6; // in all samples at most, 32 MB

class History {
  constructor(width) {
    this.width = width;
    this.capacity = Math.max(200, Math.min(20000, Math.floor(NUMBERS / (width + 1))));
    this.clear();
  }

  clear() {
    this.times = [];
    this.samples = []; // each has an array of values for each run
    this.events = []; // numbers of events so far
    this.runs = 1;
  }

  add(time, runs, events = 0) {
    this.runs = runs.length;
    this.times.push(time);
    this.samples.push(runs);
    this.events.push(events);
    if (this.times.length > 1.2 * this.capacity) {
      this.times.splice(0, this.times.length - this.capacity);
      this.samples.splice(0, this.samples.length - this.capacity);
      this.events.splice(0, this.events.length - this.capacity);
    }
  }

  // Removes the samples from this time on.
  truncate(time) {
    let length = this.times.length;
    while (length > 0 && this.times[length - 1] >= time - 1e-12 * Math.abs(time)) length--;
    this.times.length = this.samples.length = this.events.length = length;
  }

  get length() {
    return this.times.length;
  }

  time(i) {
    return this.times[i];
  }

  value(i, column, run) {
    const runs = this.samples[i];
    return (runs[run] || runs[0])[column];
  }

  // Returns the index of the last sample that is not after a time.
  indexOf(time, first = 0, last = this.length) {
    let low = first, high = last - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.times[middle] <= time) low = middle;
      else high = middle - 1;
    }
    return Math.max(first, low);
  }

  csv(names) {
    const rows = this.times.map((time, i) => [time, ...this.samples[i].flatMap((run) => [...run])].join(","));
    const columns = Array.from({ length: this.runs }, (_, run) => names.map((name) => (run === 0 ? name : `ghost ${name}`))).flat();
    return `${["time", ...columns].map((name) => (/[",]/.test(name) ? `"${name}"` : name)).join(",")}\n${rows.join("\n")}\n`;
  }
}
