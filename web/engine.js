// Control of the worker: requests, stages, and an end to it that does not wait.
let module, source;

// Loads the module and the worker's text. Afterwards the page needs no connection, and none is allowed any more.
export const load = async () => {
  const [text, compiled] = await Promise.all([
    fetch("worker.js").then((answer) => answer.text()),
    compile(fetch("ringdown.wasm")),
  ]);
  module = compiled;
  source = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
  const policy = document.createElement("meta");
  policy.httpEquiv = "Content-Security-Policy";
  policy.content = "connect-src 'none'; img-src data: blob:; frame-src blob:; object-src 'none'; font-src 'none'; media-src 'none'";
  document.head.append(policy);
};

// A file server may not know the type of the module.
const compile = async (asked) => {
  const answer = await asked;
  if (!answer.ok) throw new Error(`ringdown.wasm: ${answer.status} ${answer.statusText}`);
  return WebAssembly.compile(await answer.arrayBuffer());
};

export class Engine {
  #worker = null;
  #files = [];
  #sent = false;
  #waiting = null;

  set files(files) {
    this.#files = files;
    this.#sent = false;
  }

  get busy() {
    return this.#waiting !== null;
  }

  // Answers a request. Another request must wait for the answer or cancel this one.
  ask(request, onStage = () => {}) {
    if (this.#waiting) this.cancel();
    if (!this.#worker) this.#start();
    return new Promise((resolve, reject) => {
      this.#waiting = { resolve, reject, onStage };
      this.#worker.postMessage({ request, files: this.#sent ? null : this.#files });
      this.#sent = true;
    });
  }

  // Ends the work at once: the worker is ended, and the next request starts another.
  cancel() {
    this.#worker?.terminate();
    this.#worker = null;
    this.#finish("reject", new Cancelled());
  }

  #start() {
    this.#worker = new Worker(source);
    this.#sent = false;
    this.#worker.postMessage({ module });
    this.#worker.onmessage = ({ data }) => {
      if (data.stage) return this.#waiting?.onStage(data.stage);
      if (data.failed) {
        this.#worker.terminate();
        this.#worker = null;
        return this.#finish("reject", new Error(data.failed));
      }
      const answer = JSON.parse(data.answer);
      if (answer.error) this.#finish("reject", new Error(answer.error));
      else this.#finish("resolve", answer);
    };
  }

  #finish(how, what) {
    const waiting = this.#waiting;
    this.#waiting = null;
    waiting?.[how](what);
  }
}

export class Cancelled extends Error {}
