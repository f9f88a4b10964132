// The viewer's words in the language of whoever looks at it.

import { loadSetting, saveSetting } from "../ui/storage.ts";
import { english, type Words } from "./english.ts";
import { applyWords } from "./page.ts";

interface Language {
  /** In the language itself. */
  name: string;
  load: () => Promise<Words>;
}

/** English comes with the viewer, the others when they are chosen. */
export const LANGUAGES: Readonly<Record<string, Language>> = {
  en: { name: "English", load: () => Promise.resolve(english) },
  de: { name: "Deutsch", load: async () => (await import("./german.ts")).german },
};

const LANGUAGE_KEY = "skyglow.language";

let current: Words = english;

/** The words of the page's language. Ask when they are shown: before `chooseLanguage` they are English. */
export function words(): Words {
  return current;
}

/** The first language of these tags that the viewer speaks; "de-AT" is spoken as "de". */
export function matchLanguage(tags: readonly string[]): string {
  const codes = tags.flatMap((tag) => [tag, tag.split("-")[0] ?? tag]);
  return codes.find((code) => Object.hasOwn(LANGUAGES, code)) ?? "en";
}

/** Takes the language that was chosen on an earlier visit, else the browser's, and puts its words into the page. */
export async function chooseLanguage(): Promise<void> {
  const saved = loadSetting(LANGUAGE_KEY);
  const code = matchLanguage([...(saved === null ? [] : [saved]), ...navigator.languages]);
  if (code === english.locale) return;
  try {
    current = (await LANGUAGES[code]?.load()) ?? english;
  } catch {
    return; // English serves.
  }
  document.documentElement.lang = current.locale;
  applyWords(current);
}

/** Chooses a language for this visit and the next ones. What is shown is in the page's address and stays. */
export function switchLanguage(code: string): void {
  saveSetting(LANGUAGE_KEY, code);
  location.reload();
}
