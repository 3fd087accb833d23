// What each log was taken for, with its plot.
import { $, fill, make, picture } from "./dom.js";

export const logsShown = (logs) => fill($("logs"), ...logs.map((log) => log.error ? refused(log) : read(log)));

const refused = (log) => make("article", { class: "card" },
  make("h3", {}, log.name),
  make("p", { class: "warning" }, make("strong", {}, "It cannot be read so. "), log.error));

const row = (name, value) => make("div", {}, make("dt", {}, name), make("dd", {}, value));

const read = (log) => {
  const { record, oscillator, modes } = log.found;
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
    make("h3", {}, log.name),
    key,
    make("p", { class: "note" }, `${oscillator.basis}; ± the standard error`),
    ...log.pictures.map(({ what, wide, narrow }) => make("div", { class: "canvas", "data-what": what }, picture(wide), picture(narrow))),
    make("dl", { class: "facts" }, ...facts, ...modes.map(mode)),
    record.findings.length ? make("ul", { class: "findings" }, ...record.findings.map((finding) => make("li", {}, finding))) : null);
};

const mode = (mode, at) => row(`mode ${at + 1}`,
  `${mode.frequency_hz.value.toPrecision(6)} Hz, damping ratio ${mode.damping_ratio.value.toPrecision(3)}, ${(100 * mode.share).toPrecision(3)} % of the power`);
