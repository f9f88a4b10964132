import assert from "node:assert/strict";
import { test } from "node:test";
import { PlanTrial, type PlanTrialEvents } from "./plan-trial.ts";

const heard: string[] = [];
const EVENTS: PlanTrialEvents = { failed: (reason) => heard.push(`failed ${String(reason)}`), ended: () => heard.push("ended") };
const storePlan = (id: string) => () => Promise.resolve(heard.push(`asked ${id}`));

test("of a row of plans the last is stored, once", async () => {
  heard.length = 0;
  const trial = new PlanTrial(EVENTS, 20);
  for (const id of ["a", "b", "c"]) trial.next(storePlan(id));
  assert.ok(trial.isOpen());
  await new Promise((resolve) => setTimeout(resolve, 60));
  assert.deepEqual(heard, ["asked c", "ended"]);
  assert.ok(!trial.isOpen());
  trial.next(storePlan("d"));
  assert.equal(await trial.end(), true);
  assert.equal(await trial.end(), true);
  await new Promise((resolve) => setTimeout(resolve, 40));
  assert.deepEqual(heard.slice(2), ["asked d", "ended"]);
});

test("a plan that cannot be stored is reported", async () => {
  heard.length = 0;
  const trial = new PlanTrial(EVENTS, 20);
  trial.next(() => Promise.reject(new Error("enough")));
  assert.equal(await trial.end(), false);
  assert.deepEqual(heard, ["failed Error: enough", "ended"]);
  assert.equal(await trial.end(), true, "it is reported once");
});
