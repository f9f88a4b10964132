// Small helpers for the page's own elements.

import type { Said } from "../language/server-words.ts";

/** The element of that id, which the page's HTML must have. */
export function byId<T extends HTMLElement>(id: string, type: new () => T): T {
  const element = document.getElementById(id);
  if (!(element instanceof type)) throw new Error(`the page has no ${type.name} "${id}"`);
  return element;
}

/** A new element with a class and text or children. */
export function make(tag: string, className: string, ...content: (string | Node)[]): HTMLElement {
  const element = document.createElement(tag);
  if (className !== "") element.className = className;
  element.append(...content);
  return element;
}

/** Marks what the server says, which is English on every page. */
export function inEnglish<E extends HTMLElement>(element: E): E {
  element.lang = "en";
  return element;
}

/** A new element that says what the server says. */
export function told(tag: string, className: string, { text, isEnglish }: Said): HTMLElement {
  const element = make(tag, className, text);
  return isEnglish ? inEnglish(element) : element;
}

/** Hands a file to whoever looks at the page. */
export function saveFile(blob: Blob, fileName: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = fileName;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** Calls once things have been quiet for a while, unless that is cancelled. */
export function debounced<A extends unknown[]>(
  waitMs: number,
  call: (...args: A) => void,
): ((...args: A) => void) & { cancel: () => void } {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const soon = (...args: A) => {
    clearTimeout(timer);
    timer = setTimeout(() => call(...args), waitMs);
  };
  return Object.assign(soon, { cancel: () => clearTimeout(timer) });
}
