import assert from "node:assert/strict";
import { test } from "node:test";
import { fragmentFromState, stateFromFragment } from "./fragment.ts";
import { DEFAULT_STATE, type ViewState } from "./view-state.ts";

const EVERYTHING: ViewState = {
  scene: "kenya-2023",
  place: { latitude_deg: -1.28638, longitude_deg: 36.81722 },
  scenario: "p-0123456789abcdef0123",
  lights: "today",
  beside: "kenya-2012",
  split: 0.25,
  view: { zoom: 7.31, latitude_deg: -1.25, longitude_deg: 36.9 },
  time: "2026-08-12T22:30:00Z",
  turbidity: 3.2,
  scattering: "single",
  clouds: 1500,
  cloudCover: 35,
  lamp: "hps:0.7,led_4000k:0.3",
  emission: "garstang_1986",
  directUplight: 0.05,
  groundReflectance: 0.6,
  emissionKeep: "nadir_radiance",
  terrain: "off",
  response: "scotopic",
  projection: "perspective",
  gaze: { azimuthDeg: 210.5, elevationDeg: 20, fieldDeg: 55 },
  sky: "total",
  colours: "realistic",
  exposureEv: 1.5,
  adaptationCdM2: 0.0031,
  land: "snow",
  unit: "ratio",
  measure: "region",
  surface: "slope",
  region: [
    { azimuthDeg: 350, elevationDeg: 2.5 },
    { azimuthDeg: 20.5, elevationDeg: 3 },
    { azimuthDeg: 5, elevationDeg: 40 },
  ],
  pins: [
    { latitude_deg: 46.27917, longitude_deg: 9.4625 },
    { latitude_deg: -1.5, longitude_deg: 36 },
  ],
  isReport: true,
  layers: { elevation: 0.65, brightness: 0, radiance: 0, influence: 0.9 },
};

/** A fragment restores everything that it was made from. */
test("a fragment restores the whole state", () => {
  assert.deepEqual(stateFromFragment(fragmentFromState(EVERYTHING)), EVERYTHING);
});

/** An empty fragment is the default state, and the default state an empty fragment. */
test("an empty fragment is the default state", () => {
  assert.deepEqual(stateFromFragment(""), { ...DEFAULT_STATE });
  assert.equal(fragmentFromState({ ...DEFAULT_STATE }), "");
});

/** A place on the equator and the prime meridian is not taken for a missing one. */
test("a place at 0°, 0° is a place", () => {
  const place = { latitude_deg: 0, longitude_deg: 0 };
  assert.deepEqual(stateFromFragment(fragmentFromState({ ...DEFAULT_STATE, place })).place, place);
});

/** Links of earlier viewers name emissions otherwise. */
test("former names of emissions are read", () => {
  assert.equal(stateFromFragment("#emission=garstang").emission, "garstang_1986");
  assert.equal(stateFromFragment("#emission=shielded").emission, "full_cutoff");
  assert.equal(stateFromFragment("#emission=0.2,0.8,0").emission, "0.2,0.8,0");
});

/** The API writes times with seconds, and people copy them. */
test("times with seconds are read", () => {
  assert.equal(stateFromFragment("#time=2026-08-12T22:30:59Z").time, "2026-08-12T22:30:00Z");
  assert.equal(stateFromFragment("#time=2026-08-12T22:30Z").time, "2026-08-12T22:30:00Z");
  assert.equal(stateFromFragment("#time=2026-08-12T22:30:99Z").time, null);
});

/** What makes no sense in a fragment takes its default. */
test("invalid values take their default", () => {
  const state = stateFromFragment(
    "#lat=91&lon=10&turbidity=clear&scattering=double&clouds=low&cover=most&projection=mercator&scene=../etc&lamp=%3Cb%3E&terrain=maybe&response=owl&uplight=2&ground=dark&keep=calm&radiance=7&map=3/1&scenario=p-1&lights=none&beside=../x&measure=region&region=1,2;3,4&look=10/20&land=sea&time=2026-13-01T00:00Z",
  );
  assert.deepEqual(state, { ...DEFAULT_STATE });
});

/** One colour scale lies on the map at a time, whatever a link names; terrain has none. */
test("a link has one coloured layer", () => {
  const layers = (link: string) => stateFromFragment(link).layers;
  assert.deepEqual(layers("#radiance=0.5&brightness=0.8&elevation=0.6"), {
    elevation: 0.6,
    brightness: 0,
    radiance: 0.5,
    influence: 0,
  });
  assert.deepEqual(layers("#influence=0.9&brightness=0.8"), { elevation: 0, brightness: 0, radiance: 0, influence: 0.9 });
  // What a link names is meant, and not what is on where it names nothing.
  assert.deepEqual(layers("#brightness=0.8"), { elevation: 0, brightness: 0.8, radiance: 0, influence: 0 });
  assert.deepEqual(layers("#radiance=0"), { ...DEFAULT_STATE.layers, radiance: 0 });
  assert.deepEqual(layers("#influence=0"), DEFAULT_STATE.layers);
});

test("a lamp of own fluxes survives", () => {
  const state = { ...DEFAULT_STATE, lamp: "0.5,0.6,0.1" };
  assert.equal(stateFromFragment(fragmentFromState(state)).lamp, "0.5,0.6,0.1");
});
