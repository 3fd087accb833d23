// The decay by least squares and other methods without a network, with both pipelines and clocks.
import { $, fill, make, table } from "./dom.js";

const number = (value, digits = 6) => value == null ? "–" : Number(value).toPrecision(digits);

const shown = (log) => {
  if (log.error) return make("article", {}, make("h3", {}, log.name), make("p", { class: "warning" }, log.error));
  const pipelines = log.pipelines.map((row) => [
    `${row.pipeline}, ${row.clock}${row.in_force ? " (in force)" : ""}`,
    ...(row.error ? [row.error, "", "", "", ""]
      : [row.peaks, number(row.omega_rad_s), number(row.decay_rate), number(row.zeta), number(row.zeta_std_error, 2)])]);
  const methods = log.methods.map((row) => [row.title, ...(row.error ? [row.error, ""] : [number(row.decay_rate, 10), number(row.zeta, 10)])]);
  return make("article", {}, make("h3", {}, log.name),
    log.because ? make("p", { class: "note" }, `This pipeline, because ${log.because}.`) : null,
    log.remarks.length ? make("ul", { class: "findings" }, ...log.remarks.map((remark) => make("li", {}, remark))) : null,
    table("Least squares on the logarithms of the peaks, by pipeline and clock",
      ["pipeline, clock", "peaks", "ω, rad/s", "λ, 1/s", "ζ", "its standard error"], pipelines, log.name),
    table("Methods on the peaks in force", ["method", "λ, 1/s", "ζ"], methods, log.name));
};

export const estimatesShown = (logs) => fill($("estimates"), ...logs.map(shown));
