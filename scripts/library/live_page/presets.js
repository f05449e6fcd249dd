// Buttons for the presets of a system: start values with a name.
"use strict";

// Returns the presets of modelDescription.xml: name, label, and values as [index of the variable, number].
function presetsOf(file, description) {
  const indexOf = new Map(description.variables.map((variable, index) => [variable.name, index]));
  return [...file.querySelectorAll("presets > preset")].map((preset) => ({
    name: preset.getAttribute("name"),
    label: preset.getAttribute("description") || preset.getAttribute("name"),
    values: [...preset.querySelectorAll("at")].map((at) => [indexOf.get(at.getAttribute("name")), Number(at.getAttribute("value"))]),
  }));
}

// Sets all controls to the values of a preset, or to their own start values, and restarts.
function applyPreset({ values }) {
  const presetValues = new Map(values);
  for (const [index, control] of controls) {
    const value = (control.idle = presetValues.get(index) ?? control.variable.start);
    if (value !== control.value) control.choose(value, (chosen) => send("set", { index, value: chosen }));
  }
  send("reset");
}

function addPresets() {
  const presets = presetsOf(file, description);
  if (presets.length === 0) return;
  const list = document.createElement("div");
  list.className = "presets";
  list.append(...[...presets, { label: "start values of the file", values: [] }].map((preset) => {
    const button = Object.assign(document.createElement("button"), { textContent: preset.label });
    button.addEventListener("click", () => applyPreset(preset));
    return button;
  }));
  $("controls").prepend(list);
}
