// The energies below the scene, as a bar: kinetic energy, and potential energy above its least value. Its length is their largest sum so far.
"use strict";

class EnergyBar {
  // columns: those of the kinetic and of the potential energy among the variables of the history.
  constructor(element, history, columns) {
    Object.assign(this, { element, history, columns, length: 0, low: Infinity, largest: 0, stale: null });
    const named = (tag, className, ...content) => {
      const node = Object.assign(document.createElement(tag), { className });
      node.append(...content);
      return node;
    };
    const names = ["kinetic", "potential"];
    this.parts = names.map((name) => named("i", name));
    this.numbers = ["kinetic", "potential", "sum"].map(() => named("b", ""));
    const legend = names.map((name, i) => named("span", "", named("i", name), ` ${name}${i ? " above least" : ""} `, this.numbers[i]));
    element.replaceChildren(named("div", "bar", ...this.parts), ...legend, named("span", "", "full bar ", this.numbers[2]));
    element.title = "kinetic energy, and potential energy above its least value so far; the full bar is their largest sum so far";
  }

  // Learns the least potential energy from samples of the present system.
  expect(samples) {
    for (const sample of samples) this.low = Math.min(this.low, sample[this.columns[1]]);
  }

  // Forgets the energies so far, since a parameter changes; the present sample still has the earlier value.
  forget() {
    Object.assign(this, { low: Infinity, largest: 0, stale: this.history.samples.at(-1) });
  }

  draw(at) {
    const { history } = this, sample = history.samples[at][0], [kinetic, potential] = this.columns.map((column) => sample[column]);
    if (history.samples[at] === this.stale) return;
    if (history.length < this.length) this.largest = 0; // another run
    this.length = history.length;
    this.expect([sample]);
    const energies = [kinetic, potential - this.low], sum = energies[0] + energies[1];
    this.largest = Math.max(this.largest, sum, Number.MIN_VALUE);
    this.parts.forEach((part, i) => (part.style.width = `${Math.max(0, (100 * energies[i]) / this.largest)}%`));
    [...energies, this.largest].forEach((energy, i) => (this.numbers[i].textContent = `${formatted(significant(energy, this.largest), 3)} J`));
  }
}
