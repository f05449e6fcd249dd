// A bar of the energies in the scene: kinetic and potential energy as parts of the largest sum so far.
"use strict";

class EnergyBar {
  // columns: those of the kinetic and of the potential energy among the variables of the history.
  constructor(element, history, columns) {
    Object.assign(this, { element, history, columns, from: 0, low: Infinity, most: 0 });
    this.parts = ["kinetic", "potential"].map((name) => {
      const part = document.createElement("i");
      part.className = name;
      part.title = `${name} energy`;
      part.textContent = name;
      return part;
    });
    element.replaceChildren(...this.parts);
  }

  // Draws the energies of a sample. The potential energy counts from its lowest value so far.
  draw(at) {
    const { history, columns: [kinetic, potential] } = this;
    if (history.length < this.from) [this.from, this.low, this.most] = [0, Infinity, 0]; // another run
    for (; this.from < history.length; this.from++) this.low = Math.min(this.low, history.value(this.from, potential));
    const energies = [history.value(at, kinetic), history.value(at, potential) - this.low];
    this.most = Math.max(this.most, energies[0] + energies[1], Number.MIN_VALUE);
    this.parts.forEach((part, i) => (part.style.width = `${Math.max(0, (100 * energies[i]) / this.most)}%`));
  }
}
