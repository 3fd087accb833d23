// The answer: the report, everything to take along, and the command that gives the same.
import { $, fill, make, save } from "./dom.js";
import { word, words } from "./options.js";
import { zip } from "./zip.js";

const MEANING = {
  "report.html": "this report, one file",
  "diagnosis.json": "every number",
  "repaired.toml": "the repaired simulator, as a nominal one for the next diagnosis",
  "repaired.py": "for SciPy",
  "repaired.mo": "for Modelica",
  "repaired.mjcf.xml": "for MuJoCo",
  "repaired.urdf.xml": "for URDF",
  "equation.txt": "the equation of motion",
  "equation.tex": "the same for LaTeX",
  "nominal.toml": "the simulator as it was",
  "series.csv": "record and simulators, sample by sample",
  "environment.json": "the program that computed it",
};

export const answered = (answer, logs, options) => {
  const files = Object.keys(MEANING).map((name) => answer.files.find((file) => file.name === name)).filter(Boolean);
  const each = files.map(({ name, text }) => make("li", {},
    make("button", { type: "button", class: "link", onclick: () => save(name, [text]) }, name), ` ${MEANING[name]}`));
  const command = ["trainer diagnose", ...logs.map((log) => word(log.name)), "--nominal nominal.toml", ...words(options)].join(" ");
  fill($("take"),
    make("p", { class: "sentence" }, answer.summary),
    make("p", { class: "buttons" },
      taken(files, "repaired.toml", "Save the repaired simulator"),
      taken(files, "report.html", "Save the report"),
      make("button", { type: "button", class: "button", onclick: () => save("diagnosis.zip", [zip(files)], "application/zip") }, "Save all (ZIP)")),
    make("details", {}, make("summary", {}, "Files, one by one"), make("ul", { class: "files" }, ...each)),
    make("details", {}, make("summary", {}, "The same on the command line"),
      make("p", { class: "note" }, "With nominal.toml of “Files, one by one” beside the log:"),
      make("pre", { tabindex: "0", id: "command" }, command)));
  $("answer").hidden = false;
  show(files.find((file) => file.name === "report.html").text);
};

const taken = (files, name, words) => {
  const file = files.find((file) => file.name === name);
  return file && make("button", { type: "button", class: "button", onclick: () => save(name, [file.text]) }, words);
};

// Shows the report as long as it is: one page, one scroll bar.
const show = (html) => {
  const frame = $("report");
  frame.onload = () => {
    const report = frame.contentDocument;
    if (!report?.body) return;
    // The body's own height: that of the document is never less than the frame's, which would then never shrink.
    const fit = () => {
      const below = parseFloat(frame.contentWindow.getComputedStyle(report.body).marginBottom);
      const border = frame.offsetHeight - frame.clientHeight;
      frame.style.height = `${Math.ceil(report.body.getBoundingClientRect().bottom + frame.contentWindow.scrollY + below) + border}px`;
    };
    new frame.contentWindow.ResizeObserver(fit).observe(report.body);
    fit();
    // A place in a report without an address of its own would be looked for in this page.
    report.addEventListener("click", (event) => {
      const place = event.target.closest?.('a[href^="#"]')?.getAttribute("href").slice(1);
      if (place === undefined) return;
      event.preventDefault();
      const target = report.getElementById(decodeURIComponent(place));
      for (let folded = target?.closest("details"); folded; folded = folded.parentElement.closest("details")) folded.open = true;
      target?.scrollIntoView();
    });
  };
  frame.srcdoc = html;
};
