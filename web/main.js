// The way through the page: logs, what they were taken for, the simulator, the diagnosis.
import { $, fill, make } from "./dom.js";
import { Cancelled, Engine, load } from "./engine.js";
import { answered } from "./answer.js";
import { offerExamples } from "./examples.js";
import { estimatesShown } from "./estimate.js";
import { logsShown } from "./logs.js";
import { declare, offerOptions, options } from "./options.js";
import { Progress } from "./progress.js";
import { nominal, offerNominal } from "./nominal.js";

// Beyond this, the samples need more memory than a browser gives.
const LARGEST_MB = 100;

const engine = new Engine();
let logs = [];
// The simulator that was dropped beside the logs, and what else is to be said of the drop.
let simulator, notice = "";

const say = (text) => { $("status").textContent = text; };

const refuse = (text) => {
  $("refusal").textContent = text;
  $("refusal").hidden = !text;
};

const hide = (...ids) => ids.forEach((id) => { $(id).hidden = true; });

// Takes dropped files: simulators and robots by their endings, everything else as logs.
const take = async (files) => {
  const given = [...files];
  const nominalFile = given.find((file) => /\.toml$/i.test(file.name));
  const robot = given.find((file) => /\.(urdf|xacro|mjcf|xml)$/i.test(file.name));
  const dropped = given.filter((file) => file !== nominalFile && file !== robot);
  notice = robot ? `${robot.name} is taken for a robot of several joints, which the page does not diagnose. The program does: ` +
    `trainer diagnose LOG --nominal ${robot.name}` : "";
  if (robot && !dropped.length) return say(notice);
  const large = dropped.find((file) => file.size > LARGEST_MB * 2 ** 20);
  if (large) {
    hide("log", "simulator", "answer");
    return say(`${large.name} has ${Math.round(large.size / 2 ** 20)} MB; the page reads files of up to ${LARGEST_MB} MB. ` +
      "Cut it or thin it out, or use the program: trainer init FILE.");
  }
  const taken = nominalFile && { name: nominalFile.name, text: await nominalFile.text() };
  if (dropped.length) {
    logs = dropped;
    simulator = taken;
    engine.files = logs;
    offerOptions([]);
    await look();
  } else if (taken && logs.length) {
    simulator = taken;
    nominal.dropped(taken.name, taken.text);
    hide("answer");
    say(`${taken.name} is the simulator now.`);
  } else {
    say("Drop a log beside the simulator.");
  }
};

const leaveOut = (at) => {
  logs = logs.filter((_, own) => own !== at);
  engine.files = logs;
  look().then(() => $("log-title").focus());
};

// Says what the logs were taken for.
const told = (found) => {
  if (found.some((log) => log.error)) return "Not every log could be read: see below.";
  const names = found.map((log) => log.name).join(", ");
  if (found.length === 1) return `Read: ${names}.`;
  const doubt = found.some((log) => log.apart) ? " Not all of them look like it: see below." : "";
  return `Read as recordings of one system: ${names}.${doubt}`;
};

// Reads the logs and shows what they were taken for.
const look = async () => {
  hide("answer");
  refuse("");
  fill($("estimates"));
  say(logs.length === 1 ? `Reading ${logs[0].name} …` : `Reading ${logs.length} logs …`);
  try {
    const { logs: found } = await engine.ask({ do: "look", reading: options() });
    logsShown(found, leaveOut);
    offerOptions(found);
    $("log").hidden = false;
    const readable = found.filter((log) => !log.error);
    // What was set stays in sight.
    $("reading").open = readable.length < found.length || Object.keys(options()).length > 0;
    // Only a free decay has an envelope.
    $("estimate").hidden = readable.every((log) => log.found.oscillator.input_gain_per_inertia);
    $("simulator").hidden = readable.length < found.length;
    offerNominal(readable, simulator);
    estimate();
    say(`${told(found)} ${notice}`.trim());
  } catch (error) {
    hide("log", "simulator");
    if (!(error instanceof Cancelled)) say(error.message);
  }
};

// Estimates the damping once somebody asks for it.
const estimate = async () => {
  if (!$("estimate").open || $("estimates").childElementCount || engine.busy) return;
  try {
    estimatesShown((await engine.ask({ do: "estimate", reading: options() })).logs);
  } catch (error) {
    if (!(error instanceof Cancelled)) say(error.message);
  }
};

const diagnose = async () => {
  hide("answer");
  refuse("");
  const progress = new Progress();
  $("cancel").hidden = false;
  $("diagnose").disabled = true;
  try {
    const request = { do: "diagnose", reading: options(), nominal_name: nominal.name, nominal: nominal.text, name: logs[0].name };
    answered(await engine.ask(request, (stage) => progress.begin(stage)), logs, options());
    say("The diagnosis is below.");
    $("answer-title").scrollIntoView();
  } catch (error) {
    if (error instanceof Cancelled) say("Cancelled.");
    refuse(error instanceof Cancelled ? "Cancelled." : error.message);
  } finally {
    progress.end();
    $("cancel").hidden = true;
    $("diagnose").disabled = false;
    $("diagnose").focus({ preventScroll: true });
  }
};

const listen = () => {
  const drop = $("drop");
  const held = (event) => event.dataTransfer?.types.includes("Files");
  addEventListener("dragover", (event) => { if (held(event)) { event.preventDefault(); drop.classList.add("over"); } });
  addEventListener("dragleave", () => drop.classList.remove("over"));
  addEventListener("drop", (event) => {
    drop.classList.remove("over");
    if (!held(event)) return;
    event.preventDefault();
    take(event.dataTransfer.files);
  });
  $("files").addEventListener("change", ({ target }) => { take(target.files); target.value = ""; });
  $("diagnose").addEventListener("click", diagnose);
  $("estimate").addEventListener("toggle", estimate);
  $("cancel").addEventListener("click", () => engine.cancel());
  // An answer is about the simulator that was asked about.
  for (const [place, event] of [["nominal", "input"], ["nominal-form", "input"], ["nominal-kinds", "change"]]) {
    $(place).addEventListener(event, () => hide("answer"));
  }
  $("options").addEventListener("submit", (event) => { event.preventDefault(); look(); });
};

try {
  await load();
  listen();
  const offer = await engine.ask({ do: "offer" });
  declare(offer.options);
  offerExamples(offer.examples, engine, take);
  say("Ready.");
  document.documentElement.dataset.ready = "true";
} catch (error) {
  fill($("status"), make("span", { class: "warning" }, `The page could not be loaded: ${error.message}`));
}
