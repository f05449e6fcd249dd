// Reverses packed() of page.py.
"use strict";

// Decodes base 85: five letters are four bytes in big endian.
function bytesOf(text) {
  const letters = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#$%&()*+-;,=>?@^_`{|}~", values = {};
  [...letters].forEach((letter, value) => (values[letter] = value));
  const groups = Math.ceil(text.length / 5), whole = text.padEnd(5 * groups, "~"), view = new DataView(new ArrayBuffer(4 * groups));
  for (let i = 0; i < groups; i++) {
    let number = 0;
    for (let k = 0; k < 5; k++) number = 85 * number + values[whole[5 * i + k]];
    view.setUint32(4 * i, number);
  }
  return new Uint8Array(view.buffer, 0, 4 * groups - (whole.length - text.length));
}

async function unpacked(text) {
  return new Response(new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}
