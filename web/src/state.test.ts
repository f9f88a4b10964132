import assert from "node:assert/strict";
import { test } from "node:test";
import { DEFAULT_STATE, fragment_from_state, state_from_fragment, type ViewState } from "./state.ts";

const EVERYTHING: ViewState = {
  scene: "kenya-2023",
  place: { latitude_deg: -1.28638, longitude_deg: 36.81722 },
  scenario: "p-0123456789abcdef0123",
  lights: "today",
  split: 0.25,
  view: { zoom: 7.31, latitude_deg: -1.25, longitude_deg: 36.9 },
  turbidity: 3.2,
  scattering: "single",
  clouds: 1500,
  lamp: "led_4000k",
  emission: "shielded",
  terrain: "off",
  projection: "perspective",
  gaze: { azimuth_deg: 210.5, elevation_deg: 20, field_deg: 55 },
  sky: "total",
  colours: "realistic",
  exposure_ev: 1.5,
  unit: "ratio",
  measure: "region",
  region: [
    { azimuth_deg: 350, elevation_deg: 2.5 },
    { azimuth_deg: 20.5, elevation_deg: 3 },
    { azimuth_deg: 5, elevation_deg: 40 },
  ],
  layers: { elevation: 0.65, brightness: 0.5, radiance: 0.4, influence: 0.9 },
};

test("a fragment restores everything that it was made from", () => {
  assert.deepEqual(state_from_fragment(fragment_from_state(EVERYTHING)), EVERYTHING);
});

test("an empty fragment is the default state, and the default state an empty fragment", () => {
  assert.deepEqual(state_from_fragment(""), { ...DEFAULT_STATE });
  assert.equal(fragment_from_state({ ...DEFAULT_STATE }), "");
});

test("a place on the equator and the prime meridian is not taken for a missing one", () => {
  const place = { latitude_deg: 0, longitude_deg: 0 };
  assert.deepEqual(state_from_fragment(fragment_from_state({ ...DEFAULT_STATE, place })).place, place);
});

test("what makes no sense in a fragment takes its default", () => {
  const state = state_from_fragment("#lat=91&lon=10&turbidity=clear&scattering=double&clouds=low&projection=mercator&scene=../etc&lamp=%3Cb%3E&terrain=maybe&radiance=7&map=3/1&scenario=p-1&lights=none&measure=region&region=1,2;3,4&look=10/20");
  assert.deepEqual(state, { ...DEFAULT_STATE });
});

test("a lamp of own fluxes survives", () => {
  const state = { ...DEFAULT_STATE, lamp: "0.5,0.6,0.1" };
  assert.equal(state_from_fragment(fragment_from_state(state)).lamp, "0.5,0.6,0.1");
});
