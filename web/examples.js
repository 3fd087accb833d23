// Examples ready to click: the shipped record, and records that the simulator makes in the page.
import { $, fill, make, save } from "./dom.js";

const STEP = 0.25, MOST = 3;

export const offerExamples = (examples, engine, take) => {
  const run = async (effect, size, name) => {
    const { record, nominal } = await engine.ask({ do: "simulate", effect, size });
    take([new File([record], `${name}.csv`), new File([nominal], "nominal.toml")]);
    fill($("simulated"), make("button", { type: "button", class: "link", onclick: () => save(`${name}.csv`, [record]) }, `Save ${name}.csv`));
  };
  const chosen = () => examples.find((example) => example.id === $("effect").value);
  const told = () => {
    const example = chosen();
    $("size-told").textContent = example
      ? `${example.parameter} ${Number((example.usual * $("size").value).toPrecision(3))} ${example.unit.replace("^2", "²")}`
      : "nothing";
    $("size").disabled = !example;
  };
  fill($("examples"),
    make("button", { type: "button", class: "button", id: "shipped", onclick: () => run("shipped", 1, "record") }, "The shipped record (simulated)"),
    make("div", {}, make("label", { for: "effect" }, "Simulate a swing with"),
      make("select", { id: "effect", onchange: told }, make("option", { value: "none" }, "no effect"),
        ...examples.map(({ id, title }) => make("option", { value: id, selected: id === "coulomb_friction" }, title)))),
    make("div", {}, make("label", { for: "size" }, "Size: ", make("output", { id: "size-told", for: "size effect" })),
      make("input", { id: "size", type: "range", min: STEP, max: MOST, step: STEP, value: 1, oninput: told })),
    make("button", { type: "button", class: "button", id: "simulate", onclick: () => run($("effect").value, Number($("size").value), $("effect").value.replaceAll("_", "-")) }, "Simulate"),
    make("span", { id: "simulated" }));
  told();
};
