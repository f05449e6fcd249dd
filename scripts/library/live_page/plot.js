// A plot of variables against time, or against another variable, on a canvas.
"use strict";

const ROUNDING = 1e-13; // smaller values are shown as 0

const COLORS = ["#2f7ed8", "#d9622b", "#2ca05a", "#8e5bd0", "#c23b6e", "#8a7a1f", "#17a2b8", "#7f7f7f"];

// Returns about this many ticks in steps of 1, 2 or 5 times a power of ten.
function ticksOf(low, high, count) {
  const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough * (1 - 1e-9)), ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) ticks.push(i * step);
  return ticks;
}

// Returns a value, or 0 if it is a rounding error relative to the magnitude, or in any unit.
const significant = (value, magnitude) => (Math.abs(value) <= Math.max(1e-9 * magnitude, ROUNDING) ? 0 : value);

function formatted(value, digits = 4) {
  if (value !== 0 && (Math.abs(value) >= 1e5 || Math.abs(value) < 1e-3)) return value.toExponential(Math.max(0, digits - 2)).replace("e+", "e");
  return String(Number(value.toPrecision(digits)));
}

// Returns the range of values, with a margin.
function spanOf(first, last, valueAt) {
  let low = Infinity, high = -Infinity;
  for (let i = first; i < last; i++) {
    const value = valueAt(i);
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (!(high >= low)) return [0, 1];
  const magnitude = Math.max(Math.abs(low), Math.abs(high));
  if (magnitude <= ROUNDING) return [-1, 1];
  const margin = high - low > 1e-12 * magnitude ? (high - low) * 0.06 : 0.1 * magnitude;
  return [low - margin, high + margin];
}

// Returns a range, enlarged to that of a ghost by at most `reach` times its width on each side.
const enlarged = ([low, high], [from, to], reach) => [Math.max(low - reach * (high - low), Math.min(low, from)), Math.min(high + reach * (high - low), Math.max(high, to))];

class Plot {
  // history: a History. section: a History that is drawn as points, if it has any and the plot is not against time. choices: names and units of
  // the variables; columns: indices of the drawn ones; abscissa: index of the horizontal variable, or -1 for the time.
  constructor(history, section, choices, columns, abscissa = -1) {
    Object.assign(this, { history, section, choices, columns, abscissa, cursor: null });
    this.element = document.createElement("div");
    this.element.className = "plot";
    this.canvas = document.createElement("canvas");
    this.legend = document.createElement("div");
    this.legend.className = "legend";
    this.element.append(this.legend, this.canvas);
    this.canvas.addEventListener("pointermove", (event) => (this.cursor = [event.offsetX, event.offsetY]));
    this.canvas.addEventListener("pointerleave", () => (this.cursor = null));
    this.writeLegend();
  }

  selection(title, first, chosen, onChange) {
    const select = document.createElement("select");
    select.title = title;
    select.append(new Option(first, ""));
    this.choices.forEach((choice, column) => select.append(new Option(choice.name, column, false, column === chosen)));
    select.addEventListener("change", () => {
      onChange(select.value === "" ? -1 : Number(select.value));
      this.writeLegend();
    });
    return select;
  }

  writeLegend() {
    const items = this.columns.map((column, i) => {
      const item = document.createElement("span"), mark = document.createElement("i"), value = document.createElement("b"), pale = document.createElement("small");
      mark.style.background = COLORS[i % COLORS.length];
      item.append(mark, `${this.choices[column].name}${this.choices[column].unit ? ` [${this.choices[column].unit}]` : ""} `, value, pale);
      item.title = "click to remove";
      item.addEventListener("click", () => {
        this.columns.splice(i, 1);
        this.writeLegend();
      });
      return item;
    });
    const adding = this.selection("add a variable", "+ variable", -1, (column) => column >= 0 && !this.columns.includes(column) && this.columns.push(column));
    const abscissa = this.selection("horizontal axis", "against time", this.abscissa, (column) => (this.abscissa = column));
    this.values = items.map((item) => [...item.querySelectorAll("b, small")]);
    this.legend.replaceChildren(...items, adding, abscissa);
  }

  // Returns the largest magnitude of all curves that have the unit of this column.
  magnitudeOf(column, ranges) {
    const sameUnit = ranges.filter((_, i) => this.choices[this.columns[i]].unit === this.choices[column].unit);
    return Math.max(...sameUnit.flat().map(Math.abs));
  }

  // Draws the samples from first to last with a mark at one of them, or all points of the section. The ghost ends at the sample `end`, and enlarges
  // the axes by at most `reach` times their ranges.
  draw(first, last, marked, end, reach) {
    const isSection = this.abscissa >= 0 && this.section.length > 0;
    if (isSection) this.drawSamples(this.section, 0, this.section.length, null, this.section.length, 0);
    else this.drawSamples(this.history, first, last, marked, end, reach);
  }

  drawSamples(history, first, last, marked, end, reach) {
    const ratio = window.devicePixelRatio || 1, width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    const pen = this.canvas.getContext("2d"), style = getComputedStyle(document.documentElement);
    const [ink, grid] = ["--faint", "--grid"].map((name) => style.getPropertyValue(name));
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = "11px system-ui, sans-serif";
    const { abscissa } = this, draw = history === this.section ? this.drawPoints : this.drawLine, values = (column, run) => (i) => history.value(i, column, run);
    const horizontal = abscissa < 0 ? (i) => history.time(i) : values(abscissa, 0), hasGhost = history.runs > 1 && end > first;
    const withGhost = (range, column) => (hasGhost ? enlarged(range, spanOf(first, end, values(column, 1)), reach) : range);
    const span = abscissa < 0 && last > first ? [history.time(first), Math.max(history.time(last - 1), history.time(first) + (last - first > 1 ? 1e-9 : description.stepSize))] : withGhost(spanOf(first, last, horizontal), abscissa);
    const ranges = this.columns.map((column) => spanOf(first, last, values(column, 0)));
    const union = (some) => [Math.min(...some.map((one) => one[0])), Math.max(...some.map((one) => one[1]))], own = ranges.length ? union(ranges) : [0, 1];
    const range = (this.range = ranges.length && hasGhost ? enlarged(own, union(this.columns.map((column) => spanOf(first, end, values(column, 1)))), reach) : own);
    const ticks = ticksOf(...range, Math.max(2, height / 35)), labels = ticks.map((tick) => formatted(tick));
    const left = 8 + Math.max(20, ...labels.map((label) => pen.measureText(label).width)), bottom = height - 18;
    const x = (value) => left + ((value - span[0]) / (span[1] - span[0])) * (width - left - 8);
    const y = (value) => bottom - ((value - range[0]) / (range[1] - range[0])) * (bottom - 6);
    this.drawGrid(pen, { ticks, labels, columnTicks: ticksOf(...span, Math.max(2, width / 80)), x, y, left, bottom, width, ink, grid });
    pen.save();
    pen.beginPath();
    pen.rect(left, 0, width - left, bottom);
    pen.clip();
    for (let run = history.runs - 1; run >= 0; run--)
      this.columns.forEach((column, i) => {
        const abscissaAt = abscissa < 0 ? horizontal : values(abscissa, run);
        draw.call(this, pen, first, run === 0 ? last : end, (k) => x(abscissaAt(k)), ((value) => (k) => y(value(k)))(values(column, run)), COLORS[i % COLORS.length], run);
      });
    pen.restore();
    const at = this.cursor && abscissa < 0 ? history.indexOf(span[0] + ((this.cursor[0] - left) / (width - left - 8)) * (span[1] - span[0]), first, last) : marked;
    if (at !== null && at < last) this.drawMarks(pen, at, x(horizontal(at)), y, bottom, ink);
    const textOfRun = (i, run) => (at !== null && at < last && run < history.runs ? formatted(significant(history.value(at, this.columns[i], run), this.magnitudeOf(this.columns[i], ranges)), 5) : "");
    this.values.forEach((parts, i) => parts.forEach((part, run) => (part.textContent = textOfRun(i, run))));
  }

  drawGrid(pen, { ticks, labels, columnTicks, x, y, left, bottom, width, ink, grid }) {
    pen.lineWidth = 1;
    pen.strokeStyle = grid;
    pen.fillStyle = ink;
    pen.beginPath();
    for (const tick of ticks) pen.moveTo(left, y(tick)), pen.lineTo(width, y(tick));
    for (const tick of columnTicks) pen.moveTo(x(tick), 0), pen.lineTo(x(tick), bottom);
    pen.stroke();
    pen.textAlign = "right";
    ticks.forEach((tick, i) => pen.fillText(labels[i], left - 4, y(tick) + 4));
    pen.textAlign = "center";
    for (const tick of columnTicks) if (x(tick) > left + 8 && x(tick) < width - 12) pen.fillText(formatted(tick), x(tick), bottom + 14);
  }

  // True if a curve jumps between two samples: an event is between them, and the curve changes by much more than beside them.
  isJump(before, after, first, last, every, y) {
    if (this.history.events[before] === this.history.events[after]) return false;
    const change = (i, j) => (i >= first && j < last ? Math.abs(y(j) - y(i)) : 0);
    return change(before, after) > 2 + 3 * Math.max(change(before - every, before), change(after, after + every));
  }

  drawLine(pen, first, last, x, y, color, run) {
    pen.beginPath();
    const every = Math.max(1, Math.floor((last - first) / 3000));
    for (let i = first; i < last; i += every) {
      if (i > first && this.isJump(i - every, i, first, last, every, y)) pen.moveTo(x(i), y(i));
      else pen.lineTo(x(i), y(i));
    }
    if (last > first) pen.lineTo(x(last - 1), y(last - 1));
    pen.strokeStyle = color;
    pen.globalAlpha = run === 0 ? 1 : 0.4;
    pen.lineWidth = run === 0 ? 1.6 : 3;
    pen.stroke();
    pen.globalAlpha = 1;
  }

  drawPoints(pen, first, last, x, y, color) {
    pen.fillStyle = color;
    for (let i = first; i < last; i++) pen.fillRect(x(i) - 1, y(i) - 1, 2, 2);
  }

  drawMarks(pen, at, x, y, bottom, ink) {
    pen.strokeStyle = ink;
    pen.beginPath();
    pen.moveTo(x, 0);
    pen.lineTo(x, bottom);
    pen.stroke();
    this.columns.forEach((column, i) => {
      pen.beginPath();
      pen.arc(x, y(this.history.value(at, column, 0)), 3, 0, 7);
      pen.fillStyle = COLORS[i % COLORS.length];
      pen.fill();
    });
  }
}
