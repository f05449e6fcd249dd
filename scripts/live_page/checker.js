// Derives a system while it is edited, and posts lagc's messages and the results. Runs in its own worker.
"use strict";

let laboratory; // bytes of laboratory.wasm

function answer({ files, file, number }) {
  const made = new Laboratory(laboratory, files), start = performance.now(), isRight = made.derive(file, false);
  const milliseconds = performance.now() - start;
  if (!isRight) return { number, said: made.said };
  const description = made.textOf(made.wasm.model_description()), equations = made.textOf(made.wasm.documentation());
  const pulled = new Laboratory(laboratory, files), canBePulled = pulled.derive(file, true);
  return { number, said: made.said, milliseconds, result: { modelDescription: description, equations, pulled: canBePulled ? pulled.textOf(pulled.wasm.model_description()) : null } };
}

self.onmessage = ({ data }) => {
  if (data.bytes) laboratory = data.bytes;
  else self.postMessage(answer(data));
};
