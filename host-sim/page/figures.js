// Lists of figures: a name and its value.

/** Writes lines of name, text and whether it is bad into a list of definitions; what stays as it is is not touched. */
export function writeAll(list, lines) {
  if (list.childElementCount !== 2 * lines.length) {
    list.replaceChildren(...lines.flatMap(([name]) => {
      const term = document.createElement("dt");
      term.textContent = name;
      return [term, document.createElement("dd")];
    }));
  }
  lines.forEach(([, text, bad], number) => {
    const cell = list.children[2 * number + 1];
    if (cell.textContent !== text) cell.textContent = text;
    cell.classList.toggle("bad", Boolean(bad));
  });
}
