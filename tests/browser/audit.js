// What is wrong with the page as it is displayed now, a sentence each. Runs in the page, given by the test:
// `view.width` in CSS pixels, `view.scripts`, whether the page runs its own, and `view.decoration`, the colors that a plot reads without.
(async (view) => {
  const LEAST_TEXT_CONTRAST = 4.5; // WCAG 2.2, 1.4.3
  const LEAST_LARGE_TEXT_CONTRAST = 3;
  const LEAST_MARK_CONTRAST = 3; // WCAG 2.2, 1.4.11
  const LEAST_TEXT_SIZE = 10;
  const LEAST_LINE_WIDTH = 0.75;
  const MARKS = "line, path, polyline, polygon, circle, ellipse, rect";

  document.querySelectorAll("details").forEach((details) => (details.open = true));
  if (view.scripts) await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));

  const found = new Set();
  const shown = (element) => {
    const name = element.id ? `#${element.id}` : [element.localName, ...element.classList].join(".");
    const words = element.textContent.trim().replace(/\s+/g, " ").slice(0, 40);
    return `${element.closest("figure[id]")?.id ?? ""} ${name} "${words}"`.trim();
  };

  // Colors of every notation, by painting with them.
  const context = new OffscreenCanvas(1, 1).getContext("2d", { willReadFrequently: true });
  const known = new Map();
  const rgba = (color) => {
    if (!known.has(color)) {
      context.clearRect(0, 0, 1, 1);
      context.fillStyle = color;
      context.fillRect(0, 0, 1, 1);
      const [r, g, b, a] = context.getImageData(0, 0, 1, 1).data;
      known.set(color, [r, g, b, a / 255]);
    }
    return known.get(color);
  };
  const over = ([r, g, b, a], back) => [r, g, b].map((channel, at) => a * channel + (1 - a) * back[at]);
  // What an element has of its own and of all that it lies in, worked out once for each.
  const handedDown = (outermost, own) => {
    const known = new Map();
    const of = (element) => {
      if (!element) return outermost;
      if (!known.has(element)) known.set(element, own(element, () => of(element.parentElement)));
      return known.get(element);
    };
    return of;
  };
  const canvas = matchMedia("(prefers-color-scheme: dark)").matches ? "#121212" : "#ffffff";
  const background = handedDown(rgba(canvas).slice(0, 3), (element, outer) => {
    const layer = rgba(getComputedStyle(element).backgroundColor);
    return layer[3] === 1 ? layer.slice(0, 3) : over(layer, outer());
  });
  const luminance = (color) => {
    const linear = color.map((value) => value / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
  };
  const contrast = (color, opacity, element) => {
    const back = background(element);
    const [r, g, b, a] = rgba(color);
    const [one, other] = [luminance(over([r, g, b, a * opacity], back)), luminance(back)];
    return (Math.max(one, other) + 0.05) / (Math.min(one, other) + 0.05);
  };
  const opacity = handedDown(1, (element, outer) => Number(getComputedStyle(element).opacity) * outer());

  // Out of sight on purpose, for readers of the screen.
  const isUnseen = handedDown(false, (element, outer) => getComputedStyle(element).clipPath !== "none" || outer());
  const isVisible = (element) => {
    const box = element.getBoundingClientRect();
    return element.checkVisibility({ visibilityProperty: true }) && box.width + box.height > 0 && !isUnseen(element);
  };
  const scale = (element) => {
    const matrix = element instanceof SVGGraphicsElement ? element.getScreenCTM() : null;
    return matrix ? Math.sqrt(Math.abs(matrix.a * matrix.d - matrix.b * matrix.c)) : 1;
  };

  const page = document.scrollingElement ?? document.documentElement;
  if (page.scrollWidth > view.width) found.add(`overflow: the page is ${page.scrollWidth} px wide of ${view.width}`);
  const scrolls = (element) => {
    for (let at = element.parentElement; at && at !== document.body; at = at.parentElement) {
      if (["auto", "scroll"].includes(getComputedStyle(at).overflowX)) return true;
    }
    return false;
  };

  const elements = [...document.querySelectorAll("body *, svg:root *")].filter((element) => isVisible(element));
  for (const element of elements) {
    const box = element.getBoundingClientRect();
    const style = getComputedStyle(element);
    if ((box.right > view.width + 0.5 || box.left < -0.5) && !scrolls(element)) {
      found.add(`overflow: ${shown(element)} reaches from ${box.left} to ${box.right} px of ${view.width}`);
    }
    if (element instanceof HTMLElement && style.display !== "inline" && element.scrollWidth > element.clientWidth + 1) {
      if (!["auto", "scroll"].includes(style.overflowX)) {
        found.add(`overflow: ${shown(element)} holds ${element.scrollWidth} px in ${element.clientWidth}`);
      }
    }
  }

  const walker = document.createTreeWalker(document.body ?? document.documentElement, NodeFilter.SHOW_TEXT);
  const texts = new Set();
  while (walker.nextNode()) {
    const element = walker.currentNode.parentElement;
    const isText = walker.currentNode.textContent.trim() && !element.closest("style, script, title, desc");
    if (isText && isVisible(element)) texts.add(element);
  }
  for (const element of texts) {
    const style = getComputedStyle(element);
    const inPlot = element instanceof SVGElement;
    const size = parseFloat(style.fontSize) * scale(element);
    if (size < LEAST_TEXT_SIZE - 0.05) found.add(`small: ${shown(element)} is ${size.toFixed(1)} px high`);
    const isLarge = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700);
    const least = isLarge ? LEAST_LARGE_TEXT_CONTRAST : LEAST_TEXT_CONTRAST;
    const [color, alpha] = inPlot ? [style.fill, Number(style.fillOpacity)] : [style.color, 1];
    const reached = contrast(color, alpha * opacity(element), element);
    if (reached < least) found.add(`pale: ${shown(element)} in ${color} has contrast ${reached.toFixed(2)} of ${least}`);
  }

  for (const plot of document.querySelectorAll("svg")) {
    if (!isVisible(plot)) continue;
    const frame = plot.getBoundingClientRect();
    const labels = [...plot.querySelectorAll("text")].filter(isVisible).map((label) => [label, label.getBoundingClientRect()]);
    labels.forEach(([label, box], at) => {
      const isOutside =
        box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 1 || box.bottom > frame.bottom + 1;
      if (isOutside) found.add(`cut: ${shown(label)} lies partly outside its plot`);
      for (const [other, its] of labels.slice(at + 1)) {
        const wide = Math.min(box.right, its.right) - Math.max(box.left, its.left);
        const high = Math.min(box.bottom, its.bottom) - Math.max(box.top, its.top);
        // A line of text is higher than its letters.
        if (wide > 1 && high > 0.35 * Math.min(box.height, its.height)) {
          found.add(`overlap: ${shown(label)} and ${shown(other)}`);
        }
      }
    });
    // Cells of a heat map fade on purpose, and so do their samples in the legend: of the cells the deepest counts.
    let deepest = null;
    for (const mark of plot.querySelectorAll(MARKS)) {
      const box = mark.getBoundingClientRect();
      if (mark.closest("defs") || box.width + box.height === 0) continue;
      const style = getComputedStyle(mark);
      const own = (name) => mark.getAttribute(name)?.toLowerCase();
      const paints = ["fill", "stroke"].filter((name) => style[name] !== "none" && !(name === "fill" && mark.localName === "line"));
      if (paints.length === 0 || paints.some((name) => view.decoration.includes(own(name)))) continue;
      const of = (name) => contrast(style[name], Number(style[`${name}Opacity`]) * opacity(mark), mark);
      const reached = Math.max(...paints.map(of));
      const said = `${shown(plot)} ${mark.localName} in ${paints.map((name) => style[name])}`;
      if ((own("fill-opacity") ?? own("opacity")) && !paints.includes("stroke")) {
        if (plot.classList.contains("swatch")) continue;
        if (!deepest || reached > deepest.reached) deepest = { reached, said };
        continue;
      }
      if (reached < LEAST_MARK_CONTRAST) found.add(`pale: ${said} has contrast ${reached.toFixed(2)} of ${LEAST_MARK_CONTRAST}`);
      const width = parseFloat(style.strokeWidth) * scale(mark);
      if (paints.includes("stroke") && !paints.includes("fill") && width < LEAST_LINE_WIDTH) {
        found.add(`thin: ${said} is ${width.toFixed(2)} px wide`);
      }
    }
    if (deepest && deepest.reached < LEAST_MARK_CONTRAST) {
      found.add(`pale: the deepest cell, ${deepest.said}, has contrast ${deepest.reached.toFixed(2)} of ${LEAST_MARK_CONTRAST}`);
    }
  }
  for (const figure of document.querySelectorAll("figure")) {
    const drawn = [...figure.querySelectorAll("svg.plot, .stage canvas")].filter(isVisible);
    if (drawn.length !== 1) found.add(`absent: ${shown(figure)} shows ${drawn.length} plots`);
    else if (drawn[0].getBoundingClientRect().width < Math.min(view.width, 576) - 80) {
      found.add(`small: the plot of ${shown(figure)} is ${drawn[0].getBoundingClientRect().width} px wide`);
    }
  }
  return [...found];
})
