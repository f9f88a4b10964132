// The viewer's words in the language of whoever looks at it, in parts that come with what says them.

import { loadSetting, saveSetting } from "../ui/storage.ts";
import { page } from "./english/page.ts";
import type { PlaceWords } from "./english/place.ts";
import type { ReportWords } from "./english/report.ts";
import { applyWords } from "./markup.ts";
import type { ServerWords } from "./server-words.ts";

/** The words that the page begins with, and those that come later. */
export interface WordsByPart {
  page: typeof page;
  place: PlaceWords;
  report: ReportWords;
}
export type Part = keyof WordsByPart;
export const PARTS: readonly Part[] = ["page", "place", "report"];

interface Language {
  /** In the language itself. */
  name: string;
  load: { readonly [P in Part]: () => Promise<WordsByPart[P]> };
  /** What the server says, in the language; null: as it says it. */
  server: (() => Promise<ServerWords>) | null;
}

/** English begins with the viewer; all else comes when it is needed. */
export const LANGUAGES: Readonly<Record<string, Language>> = {
  en: {
    name: "English",
    load: {
      page: () => Promise.resolve(page),
      place: async () => (await import("./english/place.ts")).place,
      report: async () => (await import("./english/report.ts")).report,
    },
    server: null,
  },
  de: {
    name: "Deutsch",
    load: {
      page: async () => (await import("./german/page.ts")).page,
      place: async () => (await import("./german/place.ts")).place,
      report: async () => (await import("./german/report.ts")).report,
    },
    server: async () => (await import("./german/server.ts")).server,
  },
};

const LANGUAGE_KEY = "skyglow.language";

const loaded: { [P in Part]?: WordsByPart[P] } = { page };
let ofServer: ServerWords | null = null;

function part<P extends Part>(name: P): WordsByPart[P] {
  const found = loaded[name];
  if (found === undefined) throw new Error(`the words of "${name}" are not loaded`);
  return found;
}

/** The words that the page begins with. Ask when they are shown: before `chooseLanguage` they are English. */
export function words(): WordsByPart["page"] {
  return part("page");
}

/** The words of what is there for a picked place. */
export function placeWords(): WordsByPart["place"] {
  return part("place");
}

/** The words of reports. */
export function reportWords(): WordsByPart["report"] {
  return part("report");
}

/** What the server says, in the page's language; null: as it says it, which is what there is until these are loaded. */
export function serverWords(): ServerWords | null {
  return ofServer;
}

/** Loads them; without them the server's own words serve. */
export async function loadServerWords(): Promise<void> {
  try {
    ofServer ??= (await LANGUAGES[words().locale]?.server?.()) ?? null;
  } catch {
    // The next answer tries again.
  }
}

/** Loads a part in the page's language, once, and puts its words into the page. */
export async function loadWords(name: Part): Promise<void> {
  if (loaded[name] !== undefined) return;
  // What the server says comes with what shows its answers.
  const [found] = await Promise.all([LANGUAGES[words().locale]?.load[name](), ...(name === "place" ? [loadServerWords()] : [])]);
  if (found === undefined) return;
  Object.assign(loaded, { [name]: found });
  // The page came with these in English.
  if (words().locale !== page.locale) applyWords(found);
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
  if (code === page.locale) return;
  try {
    loaded.page = (await LANGUAGES[code]?.load.page()) ?? page;
  } catch {
    return; // English serves.
  }
  document.documentElement.lang = words().locale;
  applyWords(words());
}

/** Chooses a language for this visit and the next ones. What is shown is in the page's address and stays. */
export function switchLanguage(code: string): void {
  saveSetting(LANGUAGE_KEY, code);
  location.reload();
}
