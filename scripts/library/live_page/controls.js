// Sliders of parameters, inputs and start values.
"use strict";

// Returns the size of an input in this unit, from the weights of masses and the longest length among the parameters; 1 where these are missing.
function naturalSize(unit) {
  const startsIn = (wanted) => description.variables.filter(({ role, unit }) => role === "parameter" && unit === wanted).map(({ start }) => Math.abs(start));
  const weight = 10 * startsIn("kg").reduce((sum, mass) => sum + mass, 0), length = Math.max(...startsIn("m"), 0) || 1;
  return Number({ N: weight, "N.m": weight * length }[unit]?.toPrecision(1)) || 1;
}

// Returns the range of a slider: [low, high, true for a logarithmic scale]. Inputs have 0 in the middle.
function rangeOf({ role, start, min, max, unit }) {
  const low = min ?? -Infinity, high = max ?? Infinity;
  if (isFinite(low) && isFinite(high)) return [low, high, low > 0 && high / low >= 100];
  if (unit === "rad") return [Math.max(low, Math.min(-Math.PI, start)), Math.min(high, Math.max(Math.PI, start)), false];
  if (start > 0 && role !== "input") return [Math.max(low, start / 10), Math.min(high, start * 10), low >= 0 || !isFinite(low)];
  const size = 2 * Math.abs(start) || naturalSize(unit);
  return [Math.max(low, -size), Math.min(high, size), false];
}

class Control {
  // variable: name, unit, description, start, min, max, type; onChange(value) is called for each new value.
  constructor(variable, onChange) {
    this.variable = variable;
    this.value = this.idle = variable.start; // idle: the value of the file or of the preset, which an input has while no key is pressed
    [this.low, this.high, this.isLogarithmic] = rangeOf(variable);
    this.element = document.createElement("div");
    this.element.className = "control";
    this.element.title = variable.description || "";
    const name = document.createElement("span"), unit = document.createElement("small");
    name.className = "name";
    unit.textContent = variable.unit && variable.unit !== "1" ? ` ${variable.unit}` : "";
    name.append(variable.name, unit);
    this.number = Object.assign(document.createElement("input"), { type: "number", step: "any", value: String(variable.start) });
    this.number.setAttribute("aria-label", variable.name);
    this.slider = Object.assign(document.createElement("input"), { type: "range", min: 0, max: 1000, step: 1 });
    this.slider.setAttribute("aria-label", variable.name);
    this.message = document.createElement("div");
    this.message.className = "message";
    const description = Object.assign(document.createElement("span"), { className: "description", textContent: variable.description ?? "" });
    this.element.append(name, this.number, description, this.slider, this.message);
    this.show();
    this.slider.addEventListener("input", () => this.choose(this.valueAt(this.slider.value / 1000), onChange));
    this.number.addEventListener("change", () => Number.isFinite(this.number.valueAsNumber) && this.choose(this.number.valueAsNumber, onChange));
    this.slider.addEventListener("dblclick", () => this.choose(this.idle, onChange));
  }

  valueAt(share) {
    const { low, high } = this, value = this.isLogarithmic ? low * (high / low) ** share : low + share * (high - low);
    if (this.variable.type !== "Real") return Math.round(value);
    return Number(value.toPrecision(3));
  }

  choose(value, onChange) {
    this.value = value;
    this.show();
    onChange(value);
  }

  show() {
    const { low, high, value } = this;
    this.number.value = Math.abs(value) >= 1e7 ? value.toExponential() : String(value);
    const share = this.isLogarithmic ? Math.log(Math.max(value, low) / low) / Math.log(high / low) : (value - low) / (high - low);
    this.slider.value = String(1000 * Math.min(1, Math.max(0, share)));
  }

  // Shows that a value was rejected, and the value in effect, unless another was chosen in the meantime.
  reject(message, value, previous) {
    if (this.value === value) this.value = previous;
    this.show();
    this.showMessage(message);
  }

  // Shows a message until the next value is accepted.
  showMessage(message) {
    this.message.textContent = message;
  }
}

function section(title, controls, isOpen) {
  const details = document.createElement("details"), summary = document.createElement("summary");
  summary.textContent = title;
  details.open = isOpen;
  details.append(summary, ...controls.map((control) => control.element));
  return details;
}
