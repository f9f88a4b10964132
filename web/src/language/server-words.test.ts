import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { server as german } from "./german/server.ts";
import { asSentence, mistakeIn, own, sentenceIn, titleIn } from "./server-words.ts";
import { LANGUAGES, loadServerWords, serverWords } from "./words.ts";

const SERVER = new URL("../../../server/", import.meta.url);
/** Where the server's sentences stand. */
const SOURCES = [
  "app/src/error.rs",
  "app/src/facts.rs",
  "app/src/observatory.rs",
  "app/src/parameters.rs",
  "app/src/reader.rs",
  "app/src/validation.rs",
  "app/src/answers/assumptions.rs",
  "app/src/answers/darker.rs",
  "app/src/answers/shares.rs",
  "app/src/answers/site.rs",
  "http/src/error.rs",
];

const source = (path: string) => readFileSync(new URL(path, SERVER), "utf8");

/** Text literals as they are said, with {} for whatever is filled in. */
function literals(rust: string): string[] {
  return [...rust.matchAll(/"((?:[^"\\]|\\.)*)"/gs)].map(([, text = ""]) =>
    text
      .replace(/\\\n\s*/g, "")
      .replaceAll('\\"', '"')
      .replace(/\{[^{}]*\}/g, "{}"),
  );
}

/** Every kind of problem that the server documents has a title, and there are no others. */
test("every kind of problem has a title", () => {
  const kinds = source("http/src/routes/problems.rs").split("pub const KINDS")[1]?.split("\n];")[0] ?? "";
  const names = [...kinds.matchAll(/\(\s*"([a-z-]+)",/g)].map(([, name]) => name);
  assert.ok(names.length > 30);
  assert.deepEqual(Object.keys(german.problems).sort(), names.sort());
});

/** What is translated is what the server says, and every detail of an error is translated. */
test("the server says what is translated", () => {
  const said = new Set(SOURCES.flatMap((path) => literals(source(path))));
  for (const [english, words] of german.sentences) {
    assert.equal(english.split(/\{n?\}/).length, words.split("{}").length, english);
    if (!english.includes("{n}")) assert.ok(said.has(english), `the server does not say: ${english}`);
  }
  assert.ok(!said.has("the server says this nowhere"));
  const errors = ["app/src/error.rs", "http/src/error.rs"].flatMap((path) => {
    const texts = source(path).match(/#\[error\(\s*"(?:[^"\\]|\\.)*"/gs) ?? [];
    return texts.flatMap(literals);
  });
  assert.ok(errors.length > 30);
  const known = german.sentences.map(([english]) => english);
  for (const detail of errors.filter((text) => text !== "{}")) assert.ok(known.includes(detail), detail);
});

/** Every kind of mistake has words. */
test("every mistake has words", () => {
  const codes = source("app/src/validation.rs").split("pub enum ValidationCode {")[1]?.split("\n}")[0] ?? "";
  const names = [...codes.matchAll(/^ {4}([A-Za-z]+),/gm)].map(([, name = ""]) =>
    name.replace(/(?!^)[A-Z]/g, (letter) => `_${letter}`).toLowerCase(),
  );
  assert.ok(names.includes("out_of_range"));
  assert.deepEqual(Object.keys(german.mistakes).sort(), names.sort());
});

/** Numbers are written as in the language, reasons within sentences are translated too, and ids stay. */
test("sentences take what is filled in", () => {
  const said = (text: string) => sentenceIn(text, german);
  assert.deepEqual(
    said("the terrain has no data at this place: the ground is taken from the nearest terrain, 1.3 km away"),
    own("das Gelände hat hier keine Daten: als Boden gilt das nächste Gelände, 1,3 km entfernt"),
  );
  assert.deepEqual(
    said("lights behind ridges count as if they were not: under clouds table packs know no skylines"),
    own(
      "Lichter hinter Bergen zählen so, als stünden die Berge nicht da: unter Wolken kennen die Tabellen keine Horizonte der Lichter",
    ),
  );
  assert.deepEqual(said("1.5 to 6"), own("1,5 bis 6"));
  assert.deepEqual(said("1.5 to 6 with multiple scattering"), own("1,5 bis 6 bei mehrfacher Streuung"));
  assert.deepEqual(said("1 to 100 km"), own("1 bis 100 km"));
  assert.deepEqual(
    said("a date from 1900-01-03 to 2099-12-28, such as 2026-08-20"),
    own("ein Datum vom 3.1.1900 bis zum 28.12.2099, wie 2026-08-20"),
  );
  assert.deepEqual(said('plan "p-1.5" is for the pixels of the scene as it was before it was ingested again').isEnglish, false);
});

/** What nobody has translated stays as the server says it, and is marked. */
test("the server's own words serve otherwise", () => {
  const strange = { text: "the moon is made of cheese", isEnglish: true };
  assert.deepEqual(sentenceIn(strange.text, german), strange);
  assert.deepEqual(sentenceIn("is required", null), { text: "is required", isEnglish: true });
  assert.deepEqual(asSentence(strange), { text: "The moon is made of cheese.", isEnglish: true });
  assert.deepEqual(titleIn("Bad parameters", "/problems/bad-parameters", german), own("Angaben, die nicht gehen"));
  assert.deepEqual(titleIn("Odd", "/problems/constructor", german), { text: "Odd", isEnglish: true });
  assert.deepEqual(mistakeIn("is out of this world", "out_of_range", german), own("liegt außerhalb des Bereichs"));
  assert.deepEqual(mistakeIn("is odd", "odd", german), { text: "is odd", isEnglish: true });
});

/** English is what the server speaks; every other language has its sentences. */
test("every language but English has the server's", async () => {
  for (const [code, { server }] of Object.entries(LANGUAGES)) {
    if (code === "en") assert.equal(server, null);
    else assert.ok((await server?.())?.decimalSign !== undefined, code);
  }
  await loadServerWords();
  assert.equal(serverWords(), null);
});
