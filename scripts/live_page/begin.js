// The scripts of the page are packed in it.
"use strict";

// Of the text itself, or of one that was packed.
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
