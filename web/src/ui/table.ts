// Tables of names and numbers.

import { make } from "./dom.ts";

/** A cell of a table. */
export function cell(content: string | Node, className = ""): HTMLElement {
  return make("td", className, content);
}

/** A row that begins with what it is of. */
export function headed(name: string, ...cells: HTMLElement[]): HTMLElement {
  const header = make("th", "", name);
  header.setAttribute("scope", "row");
  return make("tr", "", header, ...cells);
}

/** A table with a head. */
export function table(columns: readonly string[], rows: readonly HTMLElement[], className: string): HTMLElement {
  const heads = columns.map((name) => {
    // A column that goes on with the one before has no name of its own.
    if (name === "") return make("td", "");
    const head = make("th", "", name);
    head.setAttribute("scope", "col");
    return head;
  });
  return make("table", className, make("thead", "", make("tr", "", ...heads)), make("tbody", "", ...rows));
}
