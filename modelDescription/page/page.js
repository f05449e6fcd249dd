// Typesets the equations of the page, which are texts until then, and lets a reader search the variables.

const multipliers = new Set(document.querySelector("main").dataset.multipliers.split(" "));

// Returns the text with the forces of constraints as multipliers: ground.lambda for ground.force.
const withMultipliers = text => text.replace(NAME, name => (multipliers.has(name) ? name.replace(/force$/, "lambda") : name));

function element(name, attributes, ...children) {
  const created = Object.assign(document.createElement(name), attributes);
  created.append(...children);
  return created;
}

// Shows the equation that an element contains as text before that text, which is folded. An equation that is too long stays a text.
function typesetEquation(code) {
  const equation = code.parentElement, text = code.textContent, math = mathmlOf(withMultipliers(text));
  const left = text.split(" = ", 1)[0], long = left.length > 40 ? "a long equation; click to see it" : `${left} = ..., a long equation; click to see it`;
  if (math) equation.append(element("p", { className: "formula", innerHTML: math }));
  else equation.classList.add("long");
  equation.append(element("details", {}, element("summary", {}, math ? "as text" : long), code));
}

// Replaces the text of an equation of the derivation.
function typesetStep(code) {
  const math = mathmlOf(withMultipliers(code.textContent));
  if (math) code.replaceWith(element("p", { className: "formula", innerHTML: math }));
}

document.querySelectorAll(".equation > code").forEach(typesetEquation);
document.querySelectorAll(".step").forEach(typesetStep);

const rows = [...document.querySelectorAll("#variables tr")].slice(1);
for (const { cells } of rows) cells[0].innerHTML = mathmlOf(withMultipliers(cells[1].textContent));

const search = document.getElementById("search");
search.addEventListener("input", () => {
  const words = search.value.toLowerCase().split(" ");
  for (const row of rows) row.hidden = !words.every(word => row.textContent.toLowerCase().includes(word));
});
