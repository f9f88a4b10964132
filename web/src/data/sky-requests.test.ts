import assert from "node:assert/strict";
import { test } from "node:test";
import type { Scenario } from "../api/types.ts";
import { type AppState, initialState } from "../state/app-state.ts";
import { stateFromFragment } from "../state/fragment.ts";
import { requestsOf } from "./sky-requests.ts";

const PLACE = { latitude_deg: 46, longitude_deg: 8.5 };

/** A state that shows a scenario, which lies on that base. */
function painted(base: string | null, lights: AppState["lights"] = "changed"): AppState {
  const change = { kind: "scenario", scenario: { id: "s-1", base } as Scenario } as const;
  return { ...initialState(stateFromFragment("")), place: PLACE, scenario: "s-1", lights, change };
}

/** Which lights are compared: without and with what is painted. */
function compared(state: AppState): (string | undefined)[] {
  const { before, after } = requestsOf(state, "demo", PLACE).compared ?? {};
  return [before?.scenario, after?.scenario];
}

/** A measure that lies on a plan is compared with the sky of that plan: what the plan does is none of the measure's. */
test("a measure is compared with what it lies on", () => {
  assert.deepEqual(compared(painted("p-7")), ["p-7", "s-1"]);
  assert.deepEqual(compared(painted("p-7", "today")), ["p-7", "s-1"]);
  assert.deepEqual(compared(painted(null)), [undefined, "s-1"]);
  // Until it is known what it lies on, that is today's.
  assert.deepEqual(compared({ ...painted("p-7"), change: null }), [undefined, "s-1"]);
  assert.deepEqual(compared({ ...painted("p-7"), scenario: "s-2" }), [undefined, "s-2"]);
  assert.equal(requestsOf({ ...painted(null), scenario: "p-7", change: null }, "demo", PLACE).compared, null);
  assert.equal(requestsOf(painted("p-7"), "demo", PLACE).shown.scenario, "s-1");
});
