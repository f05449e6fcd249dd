// Shows the equations of the system, and saves its file with the present values.
"use strict";

// Returns the element of the file that gives a variable its start value, and the name of its attribute.
function startOf(file, name) {
  const named = (tags, attribute) => [...file.querySelectorAll(tags)].find((element) => element.getAttribute(attribute) === name && !element.closest("for, include"));
  const own = named("parameter, input, coordinate", "name"), rate = own ? null : named("coordinate", "velocity");
  if (own) return [own, "start"];
  return rate && [rate, "velocityStart"];
}

// Returns the file of the system with the present values, and the names of changed variables that the file does not contain.
function systemNow() {
  const file = new DOMParser().parseFromString(data.system, "text/xml"), missing = [];
  for (const [index, control] of settings()) {
    const { name, type } = description.variables[index], found = startOf(file, name);
    if (found) found[0].setAttribute(found[1], type === "Boolean" ? String(control.value !== 0) : String(control.value));
    else missing.push(name);
  }
  return [`${new XMLSerializer().serializeToString(file)}\n`, missing];
}

function addSystem() {
  $("equations").hidden = !data.equations;
  $("equations").addEventListener("click", async () => {
    $("equationsShown").querySelector("iframe").srcdoc ||= await textOf(data.equations);
    $("equationsShown").showModal();
  });
  $("system").hidden = !data.system || !data.system.includes("<system");
  $("system").addEventListener("click", () => {
    const [text, missing] = systemNow();
    if (missing.length > 0) showMessage(`system.xml does not name ${missing.join(", ")}; it is saved without their values.`);
    save(`${description.name}.xml`, text, "text/xml");
  });
}
