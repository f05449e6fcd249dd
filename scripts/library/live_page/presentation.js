// Presentation for a class: the scene beside the equations and the present values, in large type on the whole screen (key F).
"use strict";

const MOST_SHOWN = 10; // values beside the scene

// Returns the columns of the values that are shown: outputs and energies that the system adds, else the first states.
function presentedColumns(variables) {
  const columns = [...variables.keys()], states = columns.filter((k) => variables[k].role === "start"), outputs = columns.filter((k) => variables[k].isOutput && !states.includes(k));
  return [...states, ...outputs].slice(0, MOST_SHOWN);
}

let presentedRows = []; // the rows of the table, with the columns of their variables

function rowOf(column) {
  const row = document.createElement("tr"), { name, unit } = shownVariables[column];
  for (const text of [name, "", unit && unit !== "1" ? unit : ""]) row.append(Object.assign(document.createElement("td"), { textContent: text }));
  return { column, row };
}

// Shows the values of a sample while the page is presented.
function drawPresented(at) {
  if (document.body.classList.contains("presented")) for (const { column, row } of presentedRows) row.children[1].textContent = fixedWidth(history.value(at, column));
}

// Returns a number of a fixed width, so that it does not jump while it changes.
function fixedWidth(value) {
  const text = Math.abs(value) < 1e-12 ? "0.000" : Math.abs(value) >= 1e5 || Math.abs(value) < 1e-3 ? value.toExponential(2) : value.toFixed(Math.max(0, 3 - Math.max(0, Math.floor(Math.log10(Math.abs(value))))));
  return value < 0 ? text.replace("-", "−") : ` ${text}`;
}

async function togglePresentation() {
  const isOn = document.body.classList.toggle("presented");
  if (isOn) await fillPresentation();
  try {
    await (isOn ? document.documentElement.requestFullscreen() : document.fullscreenElement && document.exitFullscreen());
  } catch {
    // In a frame that may not use the whole screen, the presentation fills the frame.
  }
  adaptSize();
}

// Ends the presentation after the browser has left the whole screen, and by Escape in a frame that may not use it.
function endPresentation() {
  if (document.fullscreenElement) return;
  document.body.classList.remove("presented");
  adaptSize();
}

const adaptSize = () => window.dispatchEvent(new Event("resize"));

// Begins the documentation at its equations of motion, in large type and without their sources.
function showEquations(page) {
  page.documentElement.style.setProperty("zoom", "1.5");
  for (const details of page.querySelectorAll("details")) if (/LaTeX/.test(details.firstElementChild.textContent)) details.hidden = true;
  const link = [...page.querySelectorAll('a[href^="#"]')].find(({ textContent }) => /equations of motion/i.test(textContent));
  if (link) page.querySelector(link.hash)?.scrollIntoView();
}

async function fillPresentation() {
  const panel = $("presentation");
  if (panel.childElementCount > 0) return;
  const table = document.createElement("table");
  presentedRows = presentedColumns(shownVariables).map(rowOf);
  table.append(...presentedRows.map(({ row }) => row));
  panel.append(table);
  if (!data.equations) return;
  const frame = Object.assign(document.createElement("iframe"), { title: "equations", srcdoc: await textOf(data.equations) });
  frame.addEventListener("load", () => showEquations(frame.contentDocument));
  panel.append(frame);
}
