// The form of reading options, made from the keys that the program declares.
import { $, fill, make, number } from "./dom.js";

let fields = [];

// Takes the declared keys.
export const declare = (declared) => { fields = declared; };

const control = (field, titles, value) => {
  const id = `option-${field.key}`;
  const attributes = { id, name: field.key, "aria-describedby": `${id}-meaning` };
  let input;
  if (field.kind === "flag") {
    input = make("input", { ...attributes, type: "checkbox", checked: value === true });
  } else if (field.choices) {
    input = make("select", attributes, make("option", { value: "" }, "as found"),
      ...field.choices.map((choice) => make("option", { value: choice, selected: choice === value }, choice)));
  } else if (field.kind === "number") {
    input = make("input", { ...attributes, type: "text", inputmode: "decimal", autocomplete: "off", value: value ?? "" });
  } else {
    input = make("input", { ...attributes, type: "text", value: value ?? "", list: field.column ? "titles" : null, autocomplete: "off" });
  }
  return make("div", { class: "field" },
    make("label", { for: id }, field.option.replaceAll("-", " ")), input,
    make("p", { id: `${id}-meaning`, class: "note" }, field.meaning));
};

// Shows the form; what was chosen stays, except for new files.
export const offerOptions = (found) => {
  const kept = found.length ? options() : {};
  const titles = new Set(found.flatMap((log) => log.titles ?? []));
  fill($("options"),
    make("datalist", { id: "titles" }, ...[...titles].map((title) => make("option", { value: title }))),
    ...fields.map((field) => control(field, titles, kept[field.key])));
};

// The options that were chosen, by key.
export const options = () => {
  const chosen = {};
  for (const field of fields) {
    const input = $(`option-${field.key}`);
    if (!input) continue;
    if (field.kind === "flag") { if (input.checked) chosen[field.key] = true; }
    else if (input.value !== "") chosen[field.key] = field.kind === "number" ? number(input.value) : input.value;
  }
  return chosen;
};

// The options as words of a command line.
export const words = (chosen) => fields.filter((field) => field.key in chosen)
  .map((field) => field.kind === "flag" ? `--${field.option}` : `--${field.option} ${word(String(chosen[field.key]))}`);

export const word = (text) => /^[\p{L}\p{N}\-_./=:,+%@]+$/u.test(text) ? text : `'${text.replaceAll("'", String.raw`'\''`)}'`;
