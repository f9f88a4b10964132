import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { page as english } from "./english/page.ts";
import { place } from "./english/place.ts";
import { pageWithWords } from "./markup.ts";
import { LANGUAGES, loadWords, matchLanguage, PARTS, placeWords, words } from "./words.ts";

const PAGE = readFileSync(new URL("../../index.html", import.meta.url), "utf8");

type Leaf = string | ((...values: string[]) => string);

/** Every word with its name; of lists, each. */
function leaves(value: unknown, name = ""): [string, Leaf][] {
  if (typeof value === "string" || typeof value === "function") return [[name, value as Leaf]];
  return Object.entries(value as object).flatMap(([key, part]) => leaves(part, `${name}.${key}`));
}

/** All parts of a language. */
async function allWords(code: string): Promise<object> {
  const language = LANGUAGES[code];
  assert.ok(language !== undefined);
  return Object.assign({}, ...(await Promise.all(PARTS.map((part) => language.load[part]()))));
}

for (const code of Object.keys(LANGUAGES)) {
  /** A language has every word, and says what it is given. */
  test(`${code} has every word`, async () => {
    const spoken = await allWords(code);
    assert.equal((spoken as { locale?: string }).locale, code);
    const wanted = leaves(await allWords("en"));
    const found = new Map(leaves(spoken));
    assert.deepEqual([...found.keys()].sort(), wanted.map(([name]) => name).sort());
    for (const [name, original] of wanted) {
      const said = found.get(name);
      if (typeof original === "string") {
        assert.ok(typeof said === "string" && said.trim() !== "" && said === said.trim(), name);
      } else {
        assert.ok(typeof said === "function" && said.length === original.length, name);
        const values = Array.from({ length: original.length }, (_, i) => `value ${i}`);
        const text = said(...values);
        assert.ok(
          values.every((value) => text.includes(value)),
          `${name}: ${text}`,
        );
      }
    }
  });

  /** The page can be filled with the words of A language. */
  test(`the page takes the words of ${code}`, async () => {
    const page = pageWithWords(PAGE, await allWords(code));
    assert.doesNotMatch(page, /data-text="[^"]*"[^<>]*><\//);
    assert.match(page, /<li data-text="welcome\.pick"><b>[^<]+<\/b>[^<]+<\/li>/);
  });
}

/** No group of one part hides one of another. */
test("groups of words are in one part each", async () => {
  const parts = await Promise.all(PARTS.map(async (part) => Object.keys((await LANGUAGES.en?.load[part]()) ?? {})));
  const groups = parts.flat();
  assert.ok(groups.length > 20 && new Set(groups).size === groups.length, groups.join(" "));
});

/** What comes later cannot be asked for before. */
test("a part must be loaded before it is said", async () => {
  assert.throws(() => placeWords(), /"place" are not loaded/);
  await loadWords("place");
  assert.equal(placeWords(), place);
});

test("the page has no words of its own", () => {
  const shown = PAGE.replace(/<!--.*?-->/gs, "")
    .replace(/^.*<body/s, "<body")
    .replace(/<[^<>]*>/g, "\n");
  const own = shown
    .split("\n")
    .map((line) => line.trim())
    .filter((line) => /\p{L}/u.test(line));
  // Names are the same in every language.
  assert.deepEqual(own, ["Skyglow", "inferno", "viridis", "cividis", "mag/arcsec²", "cd/m²", "/api/docs"]);
  assert.doesNotMatch(PAGE, /\s(aria-label|title|placeholder|data-waiting)="/);
});

/** A page that wants words that there are not is no page. */
test("a page of unknown words is refused", () => {
  assert.throws(() => pageWithWords(`<p data-text="welcome.nothing"></p>`, english), /welcome\.nothing/);
  assert.throws(() => pageWithWords(`<p data-text="top.noSceneCovers"></p>`, english), /top\.noSceneCovers/);
  assert.throws(() => pageWithWords(`<p data-text-colour="welcome.title"></p>`, english), /data-text-colour/);
  assert.throws(() => pageWithWords(`<p data-text="welcome.title">Hello</p>`, english), /own/);
  assert.equal(
    pageWithWords(`<input data-text-label="page.noScript" />`, english),
    `<input data-text-label="page.noScript" aria-label="Skyglow's viewer needs JavaScript. The same data is at" />`,
  );
});

/** The first known language is spoken, English where there is none. */
test("the first known language is taken", () => {
  assert.equal(matchLanguage(["de-AT", "en"]), "de");
  assert.equal(matchLanguage(["tlh", "en-GB", "de"]), "en");
  assert.equal(matchLanguage(["constructor"]), "en");
  assert.equal(words(), english);
});
