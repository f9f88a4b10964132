// What the server says in English, in the page's language: titles by the stable names of problems, sentences by their wording, in
// which {} stands for what the server fills in and {n} for a number. Where a translation is missing, the server's own words serve.

/** The words of one language. English has none: they are the server's. */
export interface ServerWords {
  decimalSign: string;
  /** Titles by the last part of a problem's `type`. */
  problems: Readonly<Record<string, string>>;
  /** What is wrong with a parameter, by its code. */
  mistakes: Readonly<Record<string, string>>;
  /** The server's sentence, and the same with as many {} in the same order. */
  sentences: readonly (readonly [string, string])[];
}

/** Words, and whether they are the server's own, which are English on every page. */
export interface Said {
  text: string;
  isEnglish: boolean;
}

/** What stands for {} and for {n}, which is a number. */
const FILLED_IN: Readonly<Record<string, string>> = { "{}": "(.{1,400}?)", "{n}": "(-?[\\d.]+)" };

function patternOf(sentence: string): RegExp {
  const parts = sentence.split(/(\{n?\})/).map((part) => FILLED_IN[part] ?? part.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"));
  return new RegExp(`^${parts.join("")}$`, "s");
}

/** Numbers are written otherwise, a reason may be a sentence of its own; ids and names stay. */
function filledIn(value: string, spoken: ServerWords): string {
  return /^-?\d+\.\d+$/.test(value) ? value.replace(".", spoken.decimalSign) : (translated(value, spoken) ?? value);
}

/** Numbers with as many digits as people need: four decimals of a degree are ten metres. */
export function withShortNumbers(text: string): string {
  return text.replace(/(?<![\w.])-?\d+\.\d{5,}(?![\w.])/g, (number) => {
    const value = Number(number);
    return String(Math.abs(value) < 0.1 ? Number(value.toPrecision(4)) : Number(value.toFixed(4)));
  });
}

/** A sentence of the server; null where nobody has translated it. */
function translated(text: string, spoken: ServerWords): string | null {
  for (const [english, own] of spoken.sentences) {
    const found = patternOf(english).exec(text);
    if (found === null) continue;
    const values = found.slice(1);
    return own.replace(/\{\}/g, () => filledIn(values.shift() ?? "", spoken));
  }
  return null;
}

/** Words of the page's own. */
export function own(text: string): Said {
  return { text, isEnglish: false };
}

/** As a sentence stands in a text. */
export function asSentence({ text, isEnglish }: Said): Said {
  const end = /[.!?…]$/.test(text) ? "" : ".";
  return { text: `${text.charAt(0).toUpperCase()}${text.slice(1)}${end}`, isEnglish };
}

/** A sentence in the page's language if it is known there. */
export function sentenceIn(text: string, spoken: ServerWords | null): Said {
  const known = spoken === null ? null : translated(text, spoken);
  return known === null ? { text, isEnglish: true } : own(known);
}

function wordIn(otherwise: string, name: string, known: Readonly<Record<string, string>> | undefined): Said {
  const word = known !== undefined && Object.hasOwn(known, name) ? known[name] : undefined;
  return word === undefined ? { text: otherwise, isEnglish: true } : own(word);
}

/** The title of a problem by its `type`, such as `/problems/out-of-range`. */
export function titleIn(title: string, type: string | undefined, spoken: ServerWords | null): Said {
  return wordIn(title, (type ?? "").replace(/^.*\//s, ""), spoken?.problems);
}

/** What is wrong with a parameter. */
export function mistakeIn(message: string, code: string, spoken: ServerWords | null): Said {
  const said = sentenceIn(message, spoken);
  return said.isEnglish ? wordIn(message, code, spoken?.mistakes) : said;
}
