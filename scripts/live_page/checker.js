// Derives a system while it is written, and tells what it says or what can be shown. Runs in a worker of its own.
"use strict";

let laboratory; // its bytes

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
