// Buttons at each plot: the whole of it again, and files made from what is in the page.
"use strict";
(() => {
  const LEGEND_ROW = 22;
  const save = (name, blob) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
  };
  const entries = (figure) =>
    [...figure.querySelectorAll(".legend li")].map((item) => ({
      swatch: item.querySelector("svg"),
      label: item.textContent.trim(),
      isOff: item.querySelector("button")?.getAttribute("aria-pressed") === "false",
    }));

  // The drawing with its legend beneath it, in the colors of a light page.
  const drawing = (figure) => {
    const plot = figure.querySelector("svg.wide").cloneNode(true);
    const { width, height } = figure.querySelector("svg.wide").viewBox.baseVal;
    const legend = entries(figure);
    const whole = height + LEGEND_ROW * legend.length + 8;
    const make = (name, attributes) => {
      const element = document.createElementNS("http://www.w3.org/2000/svg", name);
      Object.entries(attributes).forEach(([key, value]) => element.setAttribute(key, value));
      return element;
    };
    const ink = plot.getAttribute("fill");
    const file = make("svg", { width, height: whole, viewBox: `0 0 ${width} ${whole}`, "font-family": "sans-serif", fill: ink });
    const title = make("title", {});
    title.textContent = plot.getAttribute("aria-label");
    const style = make("style", {});
    style.textContent = "svg:root { background: #ffffff; }";
    const place = (element, x, y, w, h) => Object.entries({ x, y, width: w, height: h }).forEach(([key, value]) => element.setAttribute(key, value));
    place(plot, 0, 0, width, height);
    file.append(title, style, plot);
    legend.forEach(({ swatch, label }, row) => {
      const top = height + LEGEND_ROW * row;
      const text = make("text", { x: 102, y: top + 16, "font-size": 14 });
      text.textContent = label;
      if (swatch) {
        const own = swatch.cloneNode(true);
        place(own, 64, top + 5, 28, 12);
        file.append(own);
      }
      file.append(text);
    });
    return `${new XMLSerializer().serializeToString(file)}\n`;
  };

  // The plot as it is seen now, on the page's own color, with its legend.
  const view = (figure) => {
    const { u, spec } = figure.plot;
    const source = u.ctx.canvas;
    const ratio = source.width / u.width;
    const style = getComputedStyle(document.body);
    const legend = entries(figure).filter(({ isOff }) => !isOff);
    const canvas = document.createElement("canvas");
    canvas.width = source.width;
    canvas.height = source.height + Math.round(ratio * (LEGEND_ROW * legend.length + 8));
    const ink = canvas.getContext("2d");
    ink.fillStyle = style.backgroundColor;
    ink.fillRect(0, 0, canvas.width, canvas.height);
    ink.drawImage(source, 0, 0);
    ink.scale(ratio, ratio);
    ink.font = `14px ${style.fontFamily}`;
    legend.forEach(({ label, swatch }, row) => {
      const middle = u.height + LEGEND_ROW * row + 12;
      const mark = swatch?.querySelector("[stroke], [fill]");
      ink.strokeStyle = ink.fillStyle = mark ? getComputedStyle(mark)[mark.hasAttribute("stroke") ? "stroke" : "fill"] : style.color;
      if (mark?.localName === "circle") {
        ink.beginPath();
        ink.arc(78, middle, 3.5, 0, 7);
        ink.fill();
      } else {
        ink.lineWidth = 2;
        ink.setLineDash((mark?.getAttribute("stroke-dasharray") ?? "").split(" ").filter(Boolean).map(Number));
        ink.beginPath();
        ink.moveTo(65, middle);
        ink.lineTo(91, middle);
        ink.stroke();
      }
      ink.fillStyle = style.color;
      ink.fillText(label, 102, middle + 5);
    });
    return canvas;
  };
  const painted = (figure) =>
    new Promise((done) => {
      const image = new Image();
      image.onload = () => {
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = [2 * image.width, 2 * image.height];
        const ink = canvas.getContext("2d");
        ink.fillStyle = "#ffffff";
        ink.fillRect(0, 0, canvas.width, canvas.height);
        ink.drawImage(image, 0, 0, canvas.width, canvas.height);
        done(canvas);
      };
      image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(drawing(figure))}`;
    });

  const kinds = {
    SVG: { title: "The whole plot as a drawing", of: (figure) => new Blob([drawing(figure)], { type: "image/svg+xml" }) },
    PNG: {
      title: "The plot as it is seen now, as an image",
      of: async (figure) => {
        const canvas = figure.plot ? view(figure) : await painted(figure);
        return new Promise((done) => canvas.toBlob(done, "image/png"));
      },
    },
    CSV: { title: "The plot’s data as a table", of: (figure) => new Blob([figure.querySelector("pre.csv").textContent], { type: "text/csv" }) },
  };
  const button = (words, title, act) => {
    const element = document.createElement("button");
    element.type = "button";
    element.textContent = words;
    element.title = title;
    element.addEventListener("click", act);
    return element;
  };
  for (const figure of document.querySelectorAll("figure")) {
    const tools = document.createElement("div");
    tools.className = "tools";
    if (figure.plot) {
      const note = document.createElement("span");
      note.textContent = "Drag to zoom, double-click for the whole.";
      tools.append(note, button("Reset zoom", "Show the whole plot again", figure.plot.whole));
    }
    for (const [kind, { title, of }] of Object.entries(kinds)) {
      const saved = button(kind, `Save: ${title}`, async () => save(`${figure.id}.${kind.toLowerCase()}`, await of(figure)));
      saved.dataset.save = kind.toLowerCase();
      tools.append(saved);
    }
    figure.querySelector(".canvas").append(tools);
  }
})();
