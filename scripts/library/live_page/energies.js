// A bar of the energies in the scene: kinetic and potential energy as parts of the largest sum so far.
"use strict";

class EnergyBar {
  // columns: those of the kinetic and of the potential energy among the variables of the history.
  constructor(element, history, columns) {
    Object.assign(this, { element, history, columns, next: 0, low: Infinity, largest: 0 });
    this.parts = ["kinetic", "potential"].map((name) => {
      const part = document.createElement("i");
      part.className = name;
      part.title = `${name} energy`;
      part.textContent = name;
      return part;
    });
    element.replaceChildren(...this.parts);
  }

  // Draws the energies of a sample. The potential energy is measured from its lowest value so far.
  draw(at) {
    const { history, columns: [kinetic, potential] } = this;
    if (history.length < this.next) [this.next, this.low, this.largest] = [0, Infinity, 0]; // another run
    for (; this.next < history.length; this.next++) this.low = Math.min(this.low, history.value(this.next, potential));
    const energies = [history.value(at, kinetic), history.value(at, potential) - this.low];
    this.largest = Math.max(this.largest, energies[0] + energies[1], Number.MIN_VALUE);
    this.parts.forEach((part, i) => (part.style.width = `${Math.max(0, (100 * energies[i]) / this.largest)}%`));
  }
}
