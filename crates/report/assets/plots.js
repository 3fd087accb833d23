// Turns the drawings of a report into instruments: zoom, values under the pointer, series to switch off. What a page
// shows without this script stays in it, for print and for saving.
"use strict";
(() => {
  const MOST_DIGITS = 5;
  const hue = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  const power = (n) => [...String(n)].map((c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c])).join("");
  const minus = (text) => text.replace("-", "−");

  // A number to so many digits, with a power of ten where it is very small or large.
  const say = (value, digits = MOST_DIGITS) => {
    if (value == null || !Number.isFinite(value)) return "–";
    const size = Math.abs(value);
    if (size === 0 || (size >= 1e-4 && size < 1e6)) return minus(String(Number(value.toPrecision(digits))));
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
    return `${minus(String(Number(mantissa)))} × 10${power(Number(exponent))}`;
  };
  const shown = (axis, value, digits) => say(axis.log && value != null ? 10 ** value : value, digits);

  // Ticks with as many digits as their spacing asks for.
  const ticks = (axis) => (u, splits, at, space, step) => {
    if (axis.log) return splits.map((v) => (Number.isInteger(v) ? (v === 0 ? "1" : v === 1 ? "10" : `10${power(v)}`) : say(10 ** v, 3)));
    const largest = Math.max(...splits.map(Math.abs));
    const lowest = Math.floor(Math.log10(step) + 1e-9);
    const half = Math.abs(step / 10 ** lowest - Math.round(step / 10 ** lowest)) > 1e-6 ? 1 : 0; // of 2.5, 0.25, …
    const digits = Math.max(1, 1 + Math.floor(Math.log10(largest || 1) + 1e-9) - lowest + half);
    return splits.map((v) => say(Math.abs(v) < step * 1e-6 ? 0 : v, Math.min(digits, 15)));
  };
  // On a logarithmic axis: whole decades, of few decades 1, 2 and 5 in each, of a part of one even steps.
  const LOG_STEPS = [0.0001, 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];
  const logSplits = (u, at, min, max, step) => {
    const decades = max - min;
    const from = Math.floor(min);
    const all = [];
    if (decades > 2.5) {
      const every = Math.max(1, Math.round(step));
      for (let power = Math.ceil(min / every) * every; power <= max; power += every) all.push(power);
    } else if (decades > 0.5) {
      for (let power = from; power <= max; power++) all.push(...[1, 2, 5].map((digit) => power + Math.log10(digit)));
    } else {
      for (let k = Math.ceil(min / step); k * step <= max; k++) all.push(k * step);
    }
    return all.filter((place) => place >= min && place <= max);
  };

  const decode = ({ from, step, deltas }) => {
    let at = 0;
    return deltas.map((delta) => (delta === null ? null : from + step * (at += delta)));
  };
  const data = (spec) => {
    const tables = spec.tables.map((table) => [decode(table.x), ...table.columns.map(decode)]);
    const joined = uPlot.join(tables, tables.map((table) => table.map(() => 2)));
    const starts = [];
    tables.reduce((start, table) => (starts.push(start), start + table.length - 1), 1);
    return [joined[0], ...spec.series.map((series) => joined[starts[series.table] + series.column])];
  };

  const font = () => `13px ${getComputedStyle(document.body).fontFamily}`;
  const isLevel = (series) => series.mark.endsWith("level");
  const DASHES = { dashes: [8, 8], level: [8, 8], "dotted-line": [2, 3], "dotted-level": [2, 3] };
  // A single point of a line is seen as a dot.
  const drawn = (series, values) => {
    const isSingle = values.filter((value) => value != null).length === 1;
    const color = () => hue(series.hue);
    const points = { show: isSingle, size: 6, width: 0, stroke: color, fill: color };
    if (series.mark === "dots") return { stroke: color, paths: () => null, points: { ...points, show: true } };
    return { stroke: color, width: 1.75, dash: DASHES[series.mark], points };
  };

  const axis = (spec, side) => ({
    label: spec.label,
    labelFont: font(),
    labelSize: 24,
    font: font(),
    stroke: () => hue("plot-ink"),
    grid: { stroke: () => hue("plot-grid"), width: 1 },
    ticks: { stroke: () => hue("plot-axis"), width: 1, size: 5 },
    incrs: spec.log ? LOG_STEPS : undefined,
    splits: spec.log ? logSplits : undefined,
    values: ticks(spec),
    space: side === "x" ? (u) => (u.width < 500 ? 60 : 90) : 40,
    size:
      side === "x"
        ? 34
        : (u, values, at, cycle) => {
            if (cycle > 1) return u.axes[at]._size;
            u.ctx.save();
            u.ctx.font = u.axes[at].font[0];
            const widths = (values ?? []).map((value) => (value == null ? 0 : u.ctx.measureText(value).width));
            u.ctx.restore();
            return Math.ceil(Math.max(20, ...widths) / devicePixelRatio) + 14;
          },
  });

  // For each series its nearest point; none where that lies more than a twentieth of the view away.
  const nearest = (spec) => (u, at, index, x) => {
    const [xs, ys] = [u.data[0], u.data[at]];
    if (at === 0 || ys[index] != null) return index;
    let [low, high] = [index, index];
    while (low >= 0 && ys[low] == null) low--;
    while (high < ys.length && ys[high] == null) high++;
    const found = low < 0 ? high : high >= ys.length ? low : x - xs[low] <= xs[high] - x ? low : high;
    const far = (u.scales.x.max - u.scales.x.min) / 20;
    return ys[found] != null && (isLevel(spec.series[at - 1]) || Math.abs(xs[found] - x) <= far) ? found : null;
  };

  const quantity = (label) => {
    const [, name, unit] = /^(.*?)(?: \(([^()]*)\))?$/.exec(label);
    return { name, unit: unit ? ` ${unit}` : "" };
  };
  const box = (spec, u) => {
    const element = document.createElement("div");
    element.className = "values";
    element.hidden = true;
    u.over.append(element);
    const [across, along] = [quantity(spec.x.label), quantity(spec.y.label)];
    const row = (color, words, value) => {
      const line = document.createElement("div");
      const key = document.createElement("span");
      key.className = "key";
      key.style.background = color ?? "none";
      const name = document.createElement("span");
      name.textContent = words;
      const number = document.createElement("b");
      number.textContent = value;
      line.append(key, name, number);
      return line;
    };
    return () => {
      const { left, top, idxs } = u.cursor;
      const found = spec.series.map((series, at) => (u.series[at + 1].show ? idxs?.[at + 1] : null));
      const isOver = left >= 0 && found.some((index) => index != null);
      element.hidden = !isOver;
      if (!isOver) return;
      const lead = found.findIndex((index, at) => index != null && !isLevel(spec.series[at]));
      const x = lead < 0 ? u.posToVal(left, "x") : u.data[0][found[lead]];
      const rows = [row(null, across.name, shown(spec.x, x, 7) + across.unit)];
      found.forEach((index, at) => {
        if (index == null) return;
        rows.push(row(hue(spec.series[at].hue), spec.series[at].label, shown(spec.y, u.data[at + 1][index]) + along.unit));
      });
      element.replaceChildren(...rows);
      const isRight = left > u.over.clientWidth / 2;
      element.style.left = isRight ? "auto" : `${Math.min(left + 14, u.over.clientWidth - element.offsetWidth)}px`;
      element.style.right = isRight ? `${Math.min(u.over.clientWidth - left + 14, u.over.clientWidth - element.offsetWidth)}px` : "auto";
      element.style.top = top > u.over.clientHeight / 2 ? "4px" : "auto";
      element.style.bottom = top > u.over.clientHeight / 2 ? "auto" : "4px";
    };
  };

  const shade = (spec) => (u) => {
    u.ctx.save();
    u.ctx.fillStyle = hue("plot-shade");
    u.ctx.globalAlpha = 0.14;
    for (const ends of spec.shaded) {
      const [from, to] = ends.map((x) => u.valToPos(Math.min(Math.max(x, u.scales.x.min), u.scales.x.max), "x", true));
      u.ctx.fillRect(from, u.bbox.top, to - from, u.bbox.height);
    }
    u.ctx.restore();
  };

  // A finger that moves sideways is a mouse that drags; up and down it scrolls the page.
  const touch = (u) => {
    const as = (kind, target, event) =>
      target.dispatchEvent(new MouseEvent(kind, { bubbles: true, clientX: event.clientX, clientY: event.clientY, button: 0 }));
    const kinds = { pointerdown: "mousedown", pointermove: "mousemove", pointerup: "mouseup", pointercancel: "mouseup" };
    for (const [own, kind] of Object.entries(kinds)) {
      u.over.addEventListener(own, (event) => {
        if (event.pointerType !== "touch") return;
        if (own === "pointercancel") u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
        as(kind, kind === "mouseup" ? document : u.over, event);
      });
    }
  };
  const keys = (u) => {
    u.over.addEventListener("keydown", (event) => {
      const { min, max } = u.scales.x;
      const span = max - min;
      const by = { ArrowLeft: [-0.1, -0.1], ArrowRight: [0.1, 0.1], "+": [0.2, -0.2], "=": [0.2, -0.2], "-": [-0.3, 0.3] }[event.key];
      if (by) u.setScale("x", { min: min + by[0] * span, max: max + by[1] * span });
      else if (event.key === "0" || event.key === "Escape") whole(u);
      else return;
      event.preventDefault();
    });
  };
  const whole = (u) => u.setData(u.data);

  const toggles = (figure, spec, u) => {
    figure.querySelectorAll(".legend li").forEach((item, entry) => {
      const own = spec.series.flatMap((series, at) => (series.legend === entry ? [at + 1] : []));
      if (own.length === 0) return;
      const button = document.createElement("button");
      button.type = "button";
      button.title = "Show or hide";
      button.setAttribute("aria-pressed", "true");
      button.append(...item.childNodes);
      button.addEventListener("click", () => {
        const show = button.getAttribute("aria-pressed") === "false";
        button.setAttribute("aria-pressed", String(show));
        own.forEach((at) => u.setSeries(at, { show }));
      });
      item.append(button);
    });
  };

  const start = (figure) => {
    const text = figure.querySelector("script.live");
    if (!text) return;
    const spec = JSON.parse(text.textContent);
    const place = document.createElement("div");
    place.className = "stage";
    const canvas = figure.querySelector(".canvas");
    canvas.append(place);
    figure.classList.add("live");
    // The plot at the top leaves room on the first screen for what is below it.
    const tall = figure.closest(".lead") ? 290 : 400;
    const size = () => ({ width: Math.max(200, place.clientWidth), height: place.clientWidth < 560 ? 290 : tall });
    const values = data(spec);
    const [low, high] = [values[0][0], values[0][values[0].length - 1]];
    let hover = () => {};
    const u = new uPlot(
      {
        ...size(),
        legend: { show: false },
        padding: [10, 14, 0, 0],
        scales: {
          x: {
            time: false,
            range: (u, min, max) => {
              if (min > low || max < high) return [min, max];
              const room = high > low ? 0.015 * (high - low) : 0.5;
              return [low - room, high + room];
            },
          },
          y: { range: (u, min, max) => (min == null ? [0, 1] : uPlot.rangeNum(min, max, 0.08, false)) },
        },
        axes: [axis(spec.x, "x"), axis(spec.y, "y")],
        series: [{}, ...spec.series.map((series, at) => drawn(series, values[at + 1]))],
        cursor: {
          dataIdx: nearest(spec),
          drag: { x: true, y: true, uni: 40, dist: 6 },
          points: { size: 8, width: 0, fill: (u, at) => hue(spec.series[at - 1]?.hue ?? "plot-ink") },
        },
        hooks: { drawAxes: [shade(spec)], setCursor: [() => hover()] },
      },
      values,
      place,
    );
    hover = box(spec, u);
    touch(u);
    keys(u);
    u.over.tabIndex = 0;
    u.over.setAttribute("role", "group");
    const words = canvas.querySelector("svg.plot").getAttribute("aria-label");
    u.over.setAttribute("aria-label", `${words} Plus and minus zoom, arrows move, 0 shows the whole.`);
    toggles(figure, spec, u);
    new ResizeObserver(() => u.setSize(size())).observe(place);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => u.redraw(false));
    figure.plot = { u, spec, whole: () => whole(u) };
  };
  document.querySelectorAll("figure").forEach(start);
})();
