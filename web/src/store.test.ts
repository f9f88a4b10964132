import assert from "node:assert/strict";
import { test } from "node:test";
import { Store } from "./store.ts";

test("a watcher hears of its own values alone", () => {
  const store = new Store({ lamp: "hps", turbidity: 2.5 });
  const heard: string[] = [];
  store.watch(["lamp"], ({ lamp }) => heard.push(lamp));
  store.set({ turbidity: 4 });
  store.set({ lamp: "hps" });
  store.set({ lamp: "lps" });
  assert.deepEqual(heard, ["hps", "lps"]);
  assert.deepEqual(store.state, { lamp: "lps", turbidity: 4 });
});

test("a watcher may set the state, and all agree", () => {
  const store = new Store({ wanted: 1, allowed: 1 });
  const heard: [number, number][] = [];
  store.watch(["wanted", "allowed"], ({ wanted, allowed }) => heard.push([wanted, allowed]));
  store.watch(["wanted"], ({ wanted }) => store.set({ allowed: Math.min(wanted, 3) }));
  store.set({ wanted: 7 });
  assert.deepEqual(heard, [
    [1, 1],
    [7, 1],
    [7, 3],
  ]);
});

test("what is made of the state is watched too", () => {
  const store = new Store({ names: ["Nairobi"] });
  let calls = 0;
  store.watch([({ names }) => names.length], () => calls++);
  store.set({ names: ["Thika"] });
  assert.equal(calls, 1);
  store.set({ names: [] });
  assert.equal(calls, 2);
});
