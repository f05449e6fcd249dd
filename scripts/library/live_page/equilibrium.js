// Shows an equilibrium near the present state, and A, B, C, D and eigenvalues there, which the worker computes when the section is opened.
"use strict";

const MOST_COLUMNS = 14; // columns of the largest matrix that is shown; larger ones can be copied

function addLinearization() {
  if (!description.variables.some(({ derivativeOf }) => derivativeOf >= 0)) return;
  const details = section("Equilibrium and linearization", [], false), content = document.createElement("div");
  content.id = "linearization";
  details.append(content);
  details.addEventListener("toggle", () => details.open && send("linearize"));
  $("controls").append(details);
}

function buttonOf(textContent, title, act) {
  const button = Object.assign(document.createElement("button"), { textContent, title });
  button.addEventListener("click", act);
  return button;
}

const paragraphOf = (textContent) => Object.assign(document.createElement("p"), { textContent });

// Returns a complex number as text; of a conjugate pair, both.
function complexText([real, imaginary], size) {
  const parts = [real, imaginary].map((part) => significant(part, size));
  return parts[1] === 0 ? formatted(parts[0]) : `${parts[0] === 0 ? "" : `${formatted(parts[0])} `}± ${formatted(parts[1])} i`;
}

function eigenvaluesText(eigenvalues) {
  const size = Math.max(...eigenvalues.flat().map(Math.abs)), upper = eigenvalues.filter(([, imaginary]) => significant(imaginary, size) >= 0);
  return upper.map((one) => complexText(one, size)).join(", ");
}

// Returns a table of a matrix with names of its rows and columns.
function matrixTable(name, matrix, rows, columns) {
  const table = document.createElement("table"), size = Math.max(...matrix.flat().map(Math.abs));
  const add = (tag, cells) => {
    const row = document.createElement("tr");
    row.append(...cells.map((textContent, i) => Object.assign(document.createElement(i === 0 ? "th" : tag), { textContent })));
    table.append(row);
  };
  add("th", [name, ...columns]);
  matrix.forEach((values, i) => add("td", [rows[i], ...values.map((value) => formatted(significant(value, size)))]));
  return table;
}

// Sets the start values to those of the equilibrium, and restarts.
function startAt(values) {
  for (const [index, value] of values) controls.get(index)?.choose(value, (chosen) => send("set", { index, value: chosen }));
  send("reset");
}

const matrixText = (name, matrix) => `${name} = [${matrix.map((row) => row.join(" ")).join("; ")}];`;

function showLinearization({ problem, model, eigenvalues, stability, indices }) {
  const content = $("linearization"), again = buttonOf("Search again", "from the present state", () => send("linearize"));
  live.linearization = { problem, model, eigenvalues, stability };
  if (problem) {
    content.replaceChildren(Object.assign(paragraphOf(problem), { className: "message" }), again);
    return;
  }
  const { A, B, C, D, states, inputs, outputs, at } = model, variables = indices.map((index) => description.variables[index]);
  const values = variables.map(({ name, unit }, i) => `${name} = ${formatted(significant(at[i], 1))}${unit && unit !== "1" ? ` ${unit}` : ""}`);
  const tables = [["A", A, states.map((name) => `der(${name})`), states], ["B", B, states.map((name) => `der(${name})`), inputs], ["C", C, outputs, states], ["D", D, outputs, inputs]];
  const drawn = tables.filter(([, matrix, , columns]) => matrix.length > 0 && columns.length > 0 && columns.length <= MOST_COLUMNS);
  const copy = buttonOf("Copy", "A, B, C and D as MATLAB and Octave read them", () => navigator.clipboard?.writeText(tables.map(([name, matrix]) => matrixText(name, matrix)).join("\n")).catch(() => {}));
  content.replaceChildren(
    paragraphOf(`At rest near the present state: ${values.join(", ")}.`),
    again, " ", buttonOf("Start there", "with these start values", () => startAt(indices.map((index, i) => [index, at[i]]))), " ", copy,
    paragraphOf(`Eigenvalues in 1/s: ${eigenvaluesText(eigenvalues)}. ${stability === "undecided" ? "The linearization does not decide on stability, since real parts are 0." : `The equilibrium is ${stability}.`}`),
    ...drawn.map((one) => matrixTable(...one)),
  );
}
