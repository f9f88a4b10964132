// One place for what went wrong, in plain words.

import { describeProblem } from "../api/problem.ts";
import { words } from "../language/words.ts";
import { make } from "./dom.ts";

export class Notice {
  constructor(private readonly container: HTMLElement) {}

  show(reason: unknown): void {
    const { headline, sentences } = describeProblem(reason);
    const close = make("button", "notice-close", "×") as HTMLButtonElement;
    close.type = "button";
    close.setAttribute("aria-label", words().problems.close);
    close.addEventListener("click", () => this.clear());
    this.container.replaceChildren(
      make("div", "notice-text", make("strong", "", headline), ...sentences.map((text) => make("p", "", text))),
      close,
    );
    this.container.hidden = false;
  }

  clear(): void {
    this.container.hidden = true;
    this.container.replaceChildren();
  }
}
