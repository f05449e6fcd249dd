// Derives a system while it is edited, and posts lagc's messages and the results. Runs in its own worker.
"use strict";

let laboratory; // bytes of laboratory.wasm

function answerTo({ files, file, robot, number }) {
  const system = new Laboratory(laboratory, files), start = performance.now(), isValid = system.derive(file, false, robot);
  const milliseconds = performance.now() - start;
  if (!isValid) return { number, messages: system.messages };
  const description = system.textOf(system.wasm.model_description()), equations = system.textOf(system.wasm.documentation());
  const pulled = new Laboratory(laboratory, files), isPullable = pulled.derive(file, true, robot);
  return { number, messages: system.messages, milliseconds, result: { modelDescription: description, equations, pulled: isPullable ? pulled.textOf(pulled.wasm.model_description()) : null } };
}

self.onmessage = ({ data }) => {
  if (data.bytes) laboratory = data.bytes;
  else self.postMessage(answerTo(data));
};
