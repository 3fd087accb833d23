// The simulator as it is: guessed, by numbers, or from a file.
import { $, fill, make } from "./dom.js";

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
    fields: [["natural_frequency", "natural frequency, Hz", "3.5"], ["damping_ratio", "damping ratio", "0.01"]],
  },
  coefficients: {
    title: "inertia, damping, stiffness",
    fields: [["inertia", "inertia, kg m² (or mass, kg)", "0.001"], ["damping", "damping, N m s/rad (or N s/m)", "0.0002"],
      ["stiffness", "stiffness, N m/rad (or N/m)", "0.2"]],
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

const choose = (kind) => {
  nominal.name = kind === "file" ? file.name : "nominal.toml";
  if (kind === "guess") box().value = guess;
  if (kind === "file") box().value = file.text;
  const form = FORMS[kind];
  if (!form) return fill($("nominal-form"));
  const known = (key) => guess.match(new RegExp(`^${key} = ([-+.\\deE]+)`, "m"))?.[1];
  const write = () => {
    const coordinate = guess.match(/^coordinate = .*?"\s/m)?.[0].trim() ?? 'coordinate = "angle"';
    const numbers = form.fields.map(([key]) => `${key} = ${Number($(`nominal-${key}`).value)}`);
    box().value = [coordinate, ...numbers, `rest_angle = ${known("rest_angle") ?? 0}`].join("\n") + "\n";
  };
  fill($("nominal-form"), make("div", { class: "grid" }, ...form.fields.map(([key, label, usual]) =>
    make("div", { class: "field" }, make("label", { for: `nominal-${key}` }, label),
      make("input", { id: `nominal-${key}`, type: "number", step: "any", value: known(key) ?? usual, oninput: write })))));
  write();
};
