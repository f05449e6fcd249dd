// The system behind the page: its equations, and its file with the present values.
"use strict";

// The attribute of an element of the file that gives a variable its start value.
function startOf(file, name) {
  const named = (tags, attribute) => [...file.querySelectorAll(tags)].find((element) => element.getAttribute(attribute) === name && !element.closest("for, include"));
  const own = named("parameter, input, coordinate", "name"), rate = own ? null : named("coordinate", "velocity");
  if (own) return [own, "start"];
  return rate && [rate, "velocityStart"];
}

// The file of the system with what was set; told beside it is what the file does not name.
function systemNow() {
  const file = new DOMParser().parseFromString(data.system, "text/xml"), missing = [];
  for (const [place, control] of settings()) {
    const { name, type } = description.variables[place], found = startOf(file, name);
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
    if (missing.length > 0) say(`The file of the system does not name ${missing.join(", ")}: their values are not in it.`);
    save("system.xml", text, "text/xml");
  });
}
