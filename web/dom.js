// Elements from names, attributes and children. Texts are always texts: a name from a file cannot become markup.
export const $ = (id) => document.getElementById(id);

export const make = (name, attributes = {}, ...children) => {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value === false || value == null) continue;
    if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else element.setAttribute(key, value === true ? "" : value);
  }
  element.append(...children.filter((child) => child != null));
  return element;
};

// A table that scrolls in itself where it is too wide; the first cell of a row names it. `of` is what it
// belongs to.
export const table = (caption, heads, rows, of) => make("div", { class: "scroll", tabindex: "0", role: "group", "aria-label": `${caption}: ${of}` },
  make("table", {},
    make("caption", {}, caption),
    make("thead", {}, make("tr", {}, ...heads.map((head) => make("th", { scope: "col" }, head)))),
    make("tbody", {}, ...rows.map(([first, ...others]) =>
      make("tr", {}, make("th", { scope: "row" }, first), ...others.map((cell) => make("td", {}, cell)))))));

// A plot that the module drew: it consists of numbers and of labels that are escaped there.
export const picture = (svg) => {
  const parsed = new DOMParser().parseFromString(svg, "image/svg+xml").documentElement;
  return document.importNode(parsed, true);
};

export const fill = (element, ...children) => {
  element.replaceChildren(...children.filter((child) => child != null));
  return element;
};

export const save = (name, parts, type = "text/plain") => {
  const address = URL.createObjectURL(new Blob(parts, { type }));
  const link = make("a", { href: address, download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
};

// A number as it is typed, with a decimal point or comma.
export const number = (text) => Number(text.trim().replace(",", "."));
