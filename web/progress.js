// Stages of a diagnosis, with the time left by the usual shares of the stages.
import { $ } from "./dom.js";

// Part of the time that has passed when a stage begins, on usual records.
const PASSED = {
  "measuring the record": 0,
  "recalibrating the simulator": 0.02,
  "searching for sets of effects": 0.08,
  "fitting the best sets on every sample": 0.5,
  "predicting held-out parts": 0.75,
  "testing the residual for further effects": 0.85,
  "describing the result": 0.93,
};

export class Progress {
  #start = performance.now();
  #stage = "starting";
  #passed = 0;
  #timer = setInterval(() => this.#show(), 250);

  constructor() {
    $("progress").hidden = false;
    this.#show();
  }

  begin(stage) {
    this.#stage = stage;
    this.#passed = Math.max(this.#passed, PASSED[stage] ?? 0);
    this.#since = this.#seconds();
    this.#show();
  }

  #since = 0;
  #shown = 0;

  #seconds() {
    return (performance.now() - this.#start) / 1000;
  }

  #show() {
    const seconds = this.#seconds();
    const known = this.#passed > 0.05 && this.#since > 0.5;
    // A stage that takes longer than usual says nothing about the ones after it.
    const next = Math.min(...Object.values(PASSED).filter((part) => part > this.#passed), 1);
    const part = known ? Math.min(next, (this.#passed * seconds) / this.#since) : this.#passed;
    const left = known && part < next ? this.#since / this.#passed - seconds : null;
    const told = left !== null ? `, about ${Math.ceil(left)} s left` : known ? ", longer than usual" : "";
    this.#shown = Math.max(this.#shown, part);
    $("bar").value = this.#shown;
    $("stage").textContent = `${this.#stage}, ${seconds.toFixed(0)} s${told}`;
  }

  end() {
    clearInterval(this.#timer);
    $("progress").hidden = true;
  }
}
