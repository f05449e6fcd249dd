// Typesets the equations of the page, which are texts until then, draws its scene, and lets a reader search the variables.

function element(name, attributes, ...children) {
  const created = Object.assign(document.createElement(name), attributes);
  created.append(...children);
  return created;
}

const formulaOf = latex => element("p", { className: "formula", innerHTML: mathmlOf(latex) });

// Shows the equation that an element contains as text before that text, which is folded. An equation that is too long stays a text.
function typesetEquation(code) {
  const equation = code.parentElement, text = code.textContent, { latex } = code.dataset;
  const left = text.split(" = ", 1)[0], long = left.length > 40 ? "a long equation; click to see it" : `${left} = ..., a long equation; click to see it`;
  if (latex) equation.append(formulaOf(latex));
  else equation.classList.add("long");
  equation.append(element("details", {}, element("summary", {}, latex ? "as text and LaTeX" : long), code, ...(latex ? [element("code", {}, latex)] : [])));
}

// Replaces the text of an equation of the derivation.
function typesetStep(code) {
  if (code.dataset.latex) code.replaceWith(formulaOf(code.dataset.latex));
}

document.querySelectorAll(".equation > code").forEach(typesetEquation);
document.querySelectorAll(".step").forEach(typesetStep);

const rows = [...document.querySelectorAll("#variables tr")].slice(1);
for (const { cells } of rows) cells[0].innerHTML = mathmlOf(cells[0].dataset.latex);

// Typesets a label, which is a name or a product of names and powers, by the LaTeX in the table. A label with other names stays a text.
const latexOfNames = new Map(rows.map(({ cells }) => [cells[1].textContent, cells[0].dataset.latex]));
const NAME = /[A-Za-z_][\w.[\]]*/g;
const isKnown = name => latexOfNames.has(name) || name.length === 1;
const typesetLabel = text => (text.match(NAME).every(isKnown) ? mathmlOf(text.replace(NAME, name => latexOfNames.get(name) ?? name).replace(/\*/g, "\\,")) : text);

const scene = document.querySelector(".scene"), folded = element("details", {}, element("summary", {}, "as text"));
drawScene(scene, typesetLabel);
scene.replaceWith(folded);
folded.append(scene);

const search = document.getElementById("search");
search.addEventListener("input", () => {
  const words = search.value.toLowerCase().split(" ");
  for (const row of rows) row.hidden = !words.every(word => row.textContent.toLowerCase().includes(word));
});
