// The simulator as it is: guessed, by numbers, or from a file.
import { $, fill, make, number } from "./dom.js";

const box = () => $("nominal");

export const nominal = {
  name: "nominal.toml",
  get text() { return box().value; },
  dropped(name, text) {
    file = { name, text };
    this.name = name;
    box().value = text;
    kinds("file");
  },
};

// The guess with the log that it is from, and the dropped simulator.
let guess = "", source, file;

// Offers the guess of the surest log, or the simulator that was dropped beside.
export const offerNominal = (logs, simulator) => {
  const surest = logs.toSorted((one, other) => one.uncertainty - other.uncertainty)[0];
  guess = surest?.nominal ?? "";
  source = logs.length > 1 ? surest.name : "the log";
  file = undefined;
  if (simulator) return nominal.dropped(simulator.name, simulator.text);
  nominal.name = "nominal.toml";
  box().value = guess;
  kinds("guess");
};

const FORMS = {
  swings: {
    title: "natural frequency and damping ratio",
    fields: [["natural_frequency", "natural frequency, Hz"], ["damping_ratio", "damping ratio"]],
  },
  coefficients: {
    title: "inertia, damping, stiffness",
    fields: [["inertia", "inertia, kg m² (or mass, kg)"], ["damping", "damping, N m s/rad (or N s/m)"],
      ["stiffness", "stiffness, N m/rad (or N/m)"]],
  },
};

const kinds = (kind) => {
  const kindOf = (value, text) => make("label", { class: "choice" },
    make("input", { type: "radio", name: "nominal-kind", value, checked: value === kind, onchange: () => choose(value) }), ` ${text}`);
  fill($("nominal-kinds"),
    make("legend", { class: "unseen" }, "Source of the simulator"),
    kindOf("guess", `guessed from ${source}`),
    ...Object.entries(FORMS).map(([value, form]) => kindOf(value, form.title)),
    file ? kindOf("file", `the file ${file.name}`) : null);
  fill($("nominal-form"));
};

// The numbers of the guess in other words; per unit of inertia if it states none.
const ofGuess = (known) => {
  const inertia = known("inertia") ?? 1, omega = 2 * Math.PI * (known("natural_frequency") ?? 0);
  const damping = known("damping") ?? 2 * (known("damping_ratio") ?? 0) * omega * inertia;
  const stiffness = known("stiffness") ?? omega * omega * inertia;
  const numbers = { inertia, damping, stiffness, natural_frequency: omega / (2 * Math.PI), damping_ratio: known("damping_ratio") ?? 0 };
  return Object.fromEntries(Object.entries(numbers).map(([key, value]) => [key, Number(Number(value).toPrecision(6))]));
};

const choose = (kind) => {
  nominal.name = kind === "file" ? file.name : "nominal.toml";
  if (kind === "guess") box().value = guess;
  if (kind === "file") box().value = file.text;
  const form = FORMS[kind];
  if (!form) return fill($("nominal-form"));
  const known = (key) => guess.match(new RegExp(`^${key} = ([-+.\\deE]+)`, "m"))?.[1];
  const write = () => {
    const coordinate = guess.match(/^coordinate = .*?"\s/m)?.[0].trim() ?? 'coordinate = "angle"';
    const numbers = form.fields.map(([key]) => `${key} = ${number($(`nominal-${key}`).value)}`);
    const kept = ["rest_angle", "input_gain"].filter((key) => known(key)).map((key) => `${key} = ${known(key)}`);
    box().value = [coordinate, ...numbers, ...kept].join("\n") + "\n";
  };
  const usual = ofGuess(known);
  fill($("nominal-form"), make("div", { class: "grid" }, ...form.fields.map(([key, label]) =>
    make("div", { class: "field" }, make("label", { for: `nominal-${key}` }, label),
      make("input", { id: `nominal-${key}`, type: "text", inputmode: "decimal", autocomplete: "off", value: known(key) ?? usual[key], oninput: write })))));
  write();
};
