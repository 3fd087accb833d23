// The worker: the module with its memory, and one request at a time. It is started from a blob, so the policy of the page,
// which forbids every connection, holds in it too.
"use strict";
let module, exports, broken;

const text = (address, length) => new TextDecoder().decode(new Uint8Array(exports.memory.buffer, address, length));

const start = async () => {
  const page = {
    now: () => performance.now(),
    stage: (address, length) => postMessage({ stage: text(address, length) }),
    failed: (address, length) => { broken = text(address, length); },
  };
  exports = (await WebAssembly.instantiate(module, { page })).exports;
  exports.begin();
};

const give = (...parts) => {
  const length = parts.reduce((sum, part) => sum + part.length, 0);
  const address = exports.room(length); // May give the memory another buffer.
  const room = new Uint8Array(exports.memory.buffer, address, length);
  let at = 0;
  for (const part of parts) { room.set(part, at); at += part.length; }
};

const addFile = async (file) => {
  const name = new TextEncoder().encode(file.name);
  give(new Uint8Array(await file.arrayBuffer()), name);
  exports.add_file(name.length);
};

const ask = (request) => {
  give(new TextEncoder().encode(JSON.stringify(request)));
  const length = exports.ask();
  return text(exports.answer(), length);
};

const handle = async ({ module: given, files, request }) => {
  if (given) { module = given; await start(); return; }
  if (files) {
    ask({ do: "clear" });
    for (const file of files) await addFile(file);
  }
  postMessage({ answer: ask(request) });
};

let last = Promise.resolve();
onmessage = ({ data }) => {
  last = last.then(() => handle(data)).catch((error) => {
    const memory = /memory|allocation|grow/i.test(`${broken} ${error}`);
    postMessage({ failed: memory ? "there is not enough memory for this log in a browser" : String(broken || error) });
  });
};
