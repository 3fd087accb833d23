// Tables whose columns sort: a click or the Enter key on a heading, once more for the other direction.
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
