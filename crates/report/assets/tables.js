// Tables whose columns sort: a click or the Enter key on a heading, once more for the other direction; and whose rows can be
// filtered.
"use strict";
(() => {
  const SMALL = "⁰¹²³⁴⁵⁶⁷⁸⁹";
  // The first number of a cell, as the pages write them: −1.5 × 10⁻⁷ %, < 0.001, 0.12 ± 0.03. None: not a number.
  const number = (cell) => {
    const text = cell.replace(/\u202f/g, "").replace(/\u2212/g, "-").replace(/\s/g, " ");
    const found = /^[<≥≤≈ ]*(-?\d+(?:\.\d+)?(?:e-?\d+)?)(?: × 10(⁻?[⁰¹²³⁴⁵⁶⁷⁸⁹]+))?/.exec(text);
    if (!found) return NaN;
    const exponent = (found[2] ?? "⁰").replace("⁻", "-").replace(/[⁰¹²³⁴⁵⁶⁷⁸⁹]/g, (digit) => SMALL.indexOf(digit));
    return Number(found[1]) * 10 ** Number(exponent);
  };
  const text = (row, column) => {
    const cell = row.cells[column];
    return cell && cell.colSpan === 1 ? cell.textContent.trim() : "";
  };
  const sort = (table, column, direction) => {
    const body = table.tBodies[0];
    const rows = [...body.rows].map((row, at) => ({ row, at, words: text(row, column), value: number(text(row, column)) }));
    const said = rows.filter(({ words }) => words !== "" && words !== "–");
    const isNumeric = said.length > 0 && said.every(({ value }) => !Number.isNaN(value));
    const isLast = ({ words, value }) => words === "" || words === "–" || (isNumeric && Number.isNaN(value));
    rows.sort((a, b) => {
      if (isLast(a) || isLast(b)) return isLast(a) - isLast(b) || a.at - b.at;
      const order = isNumeric ? a.value - b.value : a.words.localeCompare(b.words, "en", { numeric: true });
      return direction * order || a.at - b.at;
    });
    body.append(...rows.map(({ row }) => row));
  };
  // A field above a long table that leaves the rows in which every word of it stands.
  const filter = (table) => {
    const rows = [...table.tBodies[0].rows].map((row) => ({ row, words: row.textContent.toLowerCase() }));
    const label = document.createElement("label");
    const field = document.createElement("input");
    const count = document.createElement("output");
    field.type = "search";
    label.append("Filter ", field);
    const line = document.createElement("p");
    line.className = "filter";
    line.append(label, " ", count);
    table.parentElement.before(line);
    field.addEventListener("input", () => {
      const wanted = field.value.toLowerCase().split(/\s+/).filter(Boolean);
      let left = 0;
      for (const { row, words } of rows) {
        row.hidden = !wanted.every((word) => words.includes(word));
        left += row.hidden ? 0 : 1;
      }
      count.textContent = wanted.length === 0 ? "" : `${left} of ${rows.length}`;
    });
  };
  for (const table of document.querySelectorAll("table.filtered")) {
    if (table.tBodies[0].rows.length > 5) filter(table);
  }
  for (const table of document.querySelectorAll("table.rows:not(.gaps)")) {
    if (!table.tBodies[0] || table.tBodies[0].rows.length < 3) continue;
    const heads = [...table.tHead.rows[0].cells];
    heads.forEach((head, column) => {
      if (head.querySelector(".unseen") || head.textContent.trim() === "") return;
      const button = document.createElement("button");
      button.type = "button";
      button.append(...head.childNodes);
      head.append(button);
      button.addEventListener("click", () => {
        const direction = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
        heads.forEach((other) => other.removeAttribute("aria-sort"));
        head.setAttribute("aria-sort", direction > 0 ? "ascending" : "descending");
        sort(table, column, direction);
      });
    });
  }
})();
