import assert from "node:assert/strict";
import { test } from "node:test";
import { DraftRow, type DraftRowEvents } from "./draft-row.ts";

const told: string[] = [];
const EVENTS: DraftRowEvents = { failed: (reason) => told.push(`failed ${String(reason)}`), ended: () => told.push("ended") };
const draft = (id: string) => () => Promise.resolve(told.push(`asked ${id}`));

test("of a row of drafts the last is kept, once, and at once where the row is ended", async () => {
  told.length = 0;
  const row = new DraftRow(EVENTS, 20);
  for (const id of ["a", "b", "c"]) row.goOn(draft(id));
  assert.ok(row.isOpen());
  await new Promise((resolve) => setTimeout(resolve, 60));
  assert.deepEqual(told, ["asked c", "ended"]);
  assert.ok(!row.isOpen());
  row.goOn(draft("d"));
  assert.equal(await row.end(), true);
  assert.equal(await row.end(), true);
  await new Promise((resolve) => setTimeout(resolve, 40));
  assert.deepEqual(told.slice(2), ["asked d", "ended"]);
});

test("a draft that cannot be kept is told, to whoever waits for it too", async () => {
  told.length = 0;
  const row = new DraftRow(EVENTS, 20);
  row.goOn(() => Promise.reject(new Error("enough")));
  assert.equal(await row.end(), false);
  assert.deepEqual(told, ["failed Error: enough", "ended"]);
  assert.equal(await row.end(), true, "it is told once");
});
