// Unpacks and starts the scripts of the page.
"use strict";

// Returns a text that is given as it is or packed.
async function textOf({ text, packed }) {
  return text ?? new TextDecoder().decode(await unpacked(packed));
}

async function load(text) {
  const script = document.createElement("script");
  script.src = URL.createObjectURL(new Blob([await unpacked(text)], { type: "text/javascript" }));
  await new Promise((done) => {
    script.onload = done;
    document.head.append(script);
  });
}

load(JSON.parse(document.getElementById("data").textContent).script);
