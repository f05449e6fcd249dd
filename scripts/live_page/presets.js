// Buttons for the presets of a system: start values with a name.
"use strict";

// Returns the presets of modelDescription.xml: name, words, and values as [index of the variable, number].
function presetsOf(file, description) {
  const placeOf = new Map(description.variables.map((variable, place) => [variable.name, place]));
  return [...file.querySelectorAll("presets > preset")].map((preset) => ({
    name: preset.getAttribute("name"),
    words: preset.getAttribute("description") || preset.getAttribute("name"),
    values: [...preset.querySelectorAll("at")].map((at) => [placeOf.get(at.getAttribute("name")), Number(at.getAttribute("value"))]),
  }));
}

// Sets all controls to the values of a preset, or to their own start values, and restarts.
function applyPreset({ values }) {
  const wished = new Map(values);
  for (const [place, control] of controls) {
    const value = wished.get(place) ?? control.variable.start;
    if (value !== control.value) control.choose(value, (chosen) => order("set", { place, value: chosen }));
  }
  order("reset");
}

function addPresets() {
  const presets = presetsOf(file, description);
  if (presets.length === 0) return;
  const list = document.createElement("div");
  list.className = "presets";
  list.append(...[...presets, { words: "start values of the file", values: [] }].map((preset) => {
    const button = Object.assign(document.createElement("button"), { textContent: preset.words });
    button.addEventListener("click", () => applyPreset(preset));
    return button;
  }));
  $("controls").prepend(list);
}
