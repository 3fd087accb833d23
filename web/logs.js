// What each log was taken for, with its plot.
import { $, fill, make, picture, table } from "./dom.js";

// Shows the logs; `leaveOut` takes the number of one that is not to be read.
export const logsShown = (logs, leaveOut) => fill($("logs"), ...logs.map((log, at) => {
  const leave = logs.length > 1
    ? make("button", { type: "button", class: "link", onclick: () => leaveOut(at) }, `Leave out ${log.name}`)
    : null;
  return log.error ? refused(log, leave) : read(log, leave);
}));

const refused = (log, leave) => make("article", { class: "card" },
  make("h3", {}, log.name), leave,
  make("p", { class: "warning" }, make("strong", {}, "It cannot be read so. "), log.error));

const plot = ({ what, wide, narrow }) => make("div", { class: "canvas", "data-what": what }, picture(wide), picture(narrow));

const row = (name, value) => make("div", {}, make("dt", {}, name), make("dd", {}, value));

const read = (log, leave) => {
  const { record, oscillator } = log.found;
  const facts = [
    row("read as", record.reading.sentence.replace(/^read as: /, "")),
    row("samples", `${record.samples} in ${record.duration_s.toFixed(3)} s, ${record.sample_rate_hz.toFixed(2)} Hz`),
    row("clock", `${record.clock}: ${record.clock_reason}`),
  ];
  const key = make("dl", { class: "key" },
    row("natural frequency", log.frequency ? `${log.frequency} Hz` : "none: nothing pulls it back"),
    row("damping ratio", log.ratio ?? "none"),
    log.swings && oscillator.quality_factor ? row("quality factor", oscillator.quality_factor.value.toPrecision(4)) : null);
  return make("article", {},
    make("h3", {}, log.name), leave,
    log.apart ? make("p", { class: "warning" }, make("strong", {}, "Another system? "), log.apart) : null,
    key,
    make("p", { class: "note" }, `${oscillator.basis}; ± the standard error`),
    ...log.pictures.filter(({ what }) => what !== "spectrum").map(plot),
    make("dl", { class: "facts" }, ...facts),
    ...log.pictures.filter(({ what }) => what === "spectrum").map((spectrum) => make("details", { open: log.modes.length > 0 },
      make("summary", {}, "Spectrum, with a dot at each mode"), plot(spectrum))),
    log.modes.length ? table("Modes of the free decay", ["mode", "natural frequency, Hz", "damping ratio", "share of the power"],
      log.modes.map((mode, at) => [String(at + 1), ...mode]), log.name) : null,
    record.findings.length ? make("ul", { class: "findings" }, ...record.findings.map((finding) => make("li", {}, finding))) : null);
};
