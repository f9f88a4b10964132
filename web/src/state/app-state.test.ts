import assert from "node:assert/strict";
import { test } from "node:test";
import type { Scene } from "../api/types.ts";
import { searchedPlaces } from "../ui/search.ts";
import {
  besideScene,
  bestFirst,
  conditionsOf,
  coordinatesOf,
  influenceQuery,
  initialState,
  isCompared,
  landOf,
  otherScenes,
  packsOf,
  pictureConditions,
  sceneFor,
  sceneOf,
  skyConditions,
  todaysConditions,
  withCloudPattern,
} from "./app-state.ts";
import { DEFAULT_STATE, withLayer } from "./view-state.ts";

const PLAN = "p-0123456789abcdef0123";
const DEFAULT = initialState({ ...DEFAULT_STATE });

/** A request names what differs from the server's own assumptions, and the lights that are shown. */
test("conditions name what differs from the defaults", () => {
  assert.deepEqual(conditionsOf(DEFAULT), { lamp: "mixed", emission: "modern_city" });
  const own = { directUplight: 0.05, groundReflectance: 0.6, emissionKeep: "nadir_radiance" } as const;
  const shares = { direct_uplight: 0.05, ground_reflectance: 0.6, emission_keep: "nadir_radiance" };
  const state = { ...DEFAULT, ...own, turbidity: 4, clouds: 800, terrain: "off", scenario: PLAN } as const;
  const today = { lamp: "mixed", emission: "modern_city", ...shares, terrain: "off", turbidity: 4, clouds: "800" };
  assert.deepEqual(conditionsOf(state), { ...today, scenario: PLAN });
  assert.deepEqual(conditionsOf({ ...state, lights: "today" }), today);
  assert.deepEqual(todaysConditions(state), today);
});

/** The cover of clouds is named where there are clouds, and their pattern of pictures alone. */
test("requests name the cover of clouds", () => {
  const closed = { ...DEFAULT, clouds: 1500 };
  const broken = { ...closed, cloudCover: 40 };
  assert.ok(!("cloud_cover" in skyConditions({ ...DEFAULT, cloudCover: 40 })) && !("cloud_cover" in skyConditions(closed)));
  assert.equal(skyConditions(broken).cloud_cover, 0.4);
  assert.equal(todaysConditions(broken).cloud_cover, 0.4);
  const at = { lat: 46, lon: 9 };
  assert.equal(withCloudPattern({ ...at, ...skyConditions(broken) }).cloud_pattern, 3);
  assert.deepEqual(withCloudPattern({ ...at, clouds: "1500" }), { ...at, clouds: "1500" });
});

/** What sees the sky is named where it is not the eye, but never of a picture in an eye's colours. */
test("a realistic picture is of no other response", () => {
  const state = { ...DEFAULT, response: "scotopic", colours: "inferno" } as const;
  assert.equal(conditionsOf(state).response, "scotopic");
  assert.equal(pictureConditions(state).response, "scotopic");
  assert.ok(!("response" in pictureConditions({ ...state, colours: "realistic" })));
  assert.equal(conditionsOf({ ...state, colours: "realistic" }).response, "scotopic");
});

/** Land is shown in light to eye and camera, where there is terrain that counts. */
test("land in light needs terrain and an eye", () => {
  const scene = (terrain: boolean) => ({ id: "alps", terrain }) as unknown as Scene;
  const state = { ...DEFAULT, scene: "alps", scenes: [scene(true)], land: "snow" } as const;
  assert.equal(landOf(state), "snow");
  assert.equal(landOf({ ...state, colours: "realistic" }), "snow");
  assert.equal(landOf({ ...state, colours: "inferno" }), "dark");
  assert.equal(landOf({ ...state, terrain: "off" }), "dark");
  assert.equal(landOf({ ...state, scenes: [scene(false)] }), "dark");
  assert.equal(landOf({ ...state, scenes: [] }), "dark");
});

test("two skies are compared only with a scenario", () => {
  assert.ok(!isCompared({ ...DEFAULT, lights: "both" }));
  assert.ok(isCompared({ ...DEFAULT, lights: "both", scenario: PLAN }));
  assert.ok(!isCompared({ ...DEFAULT, lights: "today", scenario: PLAN }));
});

/** Another scene of the same place is shown beside this one, unless lights of this one are changed. */
test("another year is shown beside this one", () => {
  const scene = (id: string, bounds: number[]) => ({ id, bounds }) as unknown as Scene;
  const scenes = [scene("y2023", [5, 44, 12, 48]), scene("y2012", [5, 44, 12, 48]), scene("south", [5, 40, 12, 43])];
  const place = { latitude_deg: 46, longitude_deg: 8 };
  const state = { ...DEFAULT, scenes, scene: "y2023", place, beside: "y2012" };
  assert.deepEqual(
    otherScenes(state).map(({ id }) => id),
    ["y2012"],
  );
  assert.deepEqual([besideScene(state)?.id, isCompared(state)], ["y2012", true]);
  for (const other of [{ beside: "south" }, { beside: "y2023" }, { beside: null }, { place: null }, { scenario: PLAN }])
    assert.deepEqual(
      [besideScene({ ...state, ...other }), isCompared({ ...state, ...other })],
      [null, false],
      JSON.stringify(other),
    );
});

test("a region belongs to its own measure", () => {
  const region = [
    { azimuthDeg: 10, elevationDeg: 20 },
    { azimuthDeg: 50, elevationDeg: 20 },
    { azimuthDeg: 30, elevationDeg: 60 },
  ];
  const place = { latitude_deg: 46.1234567, longitude_deg: 8 };
  const query = { ...coordinatesOf(place), measure: "zenith" };
  assert.equal(query.lat, 46.12346);
  assert.deepEqual(influenceQuery({ ...DEFAULT, region }, place, {}), query);
  const marked = { ...query, measure: "region", region: "10,20;50,20;30,60" };
  assert.deepEqual(influenceQuery({ ...DEFAULT, region, measure: "region" }, place, {}), marked);
});

test("scene and packs are those of the state", () => {
  assert.equal(sceneOf({ ...DEFAULT, scene: "demo" }), null);
  assert.deepEqual(packsOf(DEFAULT), []);
});

/** A place is shown in the scene that is there, real data before the demo, the smaller before the larger. */
test("the scene is that of the place", () => {
  const scene = (id: string, bounds: number[], illustrative = false) => ({ id, bounds, illustrative }) as unknown as Scene;
  const scenes = [
    scene("demo", [5, 43, 14, 49], true),
    scene("europe", [-10, 35, 30, 60]),
    scene("alps", [5, 44, 12, 48]),
    scene("fiji", [176, -20, -178, -15]),
  ];
  const at = (latitudeDeg: number, longitudeDeg: number, shown: string | null = null) =>
    sceneFor({ scenes, scene: shown }, { latitude_deg: latitudeDeg, longitude_deg: longitudeDeg })?.id ?? null;
  assert.equal(at(46, 8), "alps");
  assert.equal(at(46, 8, "demo"), "demo");
  assert.equal(at(46, 8, "fiji"), "alps");
  assert.equal(at(52, 13), "europe");
  assert.equal(at(-17, 179), "fiji");
  assert.equal(at(-17, -179), "fiji");
  assert.equal(at(-17, 0), null);
  assert.deepEqual(bestFirst(scenes)[3]?.id, "demo");
});

/** Of scenes of one land the newest is shown, whatever their order; one of a part of it comes before. */
test("of several years the newest is shown", () => {
  const scene = (id: string, date: string | null, east = 42) => ({ id, date, bounds: [34, -5, east, 5] }) as unknown as Scene;
  const nairobi = { latitude_deg: -1.29, longitude_deg: 36.82 };
  const shown = (scenes: Scene[], current: string | null = null) => sceneFor({ scenes, scene: current }, nairobi)?.id;
  const [y2020, y2023] = [scene("y2020", "2020"), scene("y2023", "2023", 42.1)];
  assert.deepEqual([shown([y2020, y2023]), shown([y2023, y2020]), shown([y2020, y2023], "y2020")], ["y2023", "y2023", "y2020"]);
  assert.equal(shown([scene("march", "2023-03"), y2020, scene("span", "2022-01/2023-11"), scene("may", "2023-05-17")]), "span");
  assert.equal(shown([scene("year", "2023"), scene("may", "2023-05")]), "year");
  assert.equal(shown([y2020, scene("unknown", null)]), "y2020");
  assert.equal(shown([scene("africa", "2024", 90), y2020]), "y2020");
  // Of one date, or of none, the one that was ingested last.
  const ingested = (id: string, date: string | null, at?: string) => ({
    ...scene(id, date),
    ...(at === undefined ? {} : { ingested: at }),
  });
  const [march, may] = [ingested("march", null, "2026-03-01T00:00:00Z"), ingested("may", null, "2026-05-01T00:00:00Z")];
  assert.deepEqual([shown([march, may]), shown([may, march]), shown([ingested("old", null), march])], ["may", "may", "march"]);
  assert.equal(shown([ingested("late", "2020", "2026-05-01T00:00:00Z"), ingested("early", "2023")]), "early");
  const demo = { ...scene("demo", "2025"), illustrative: true };
  assert.equal(shown([demo, { ...y2020, illustrative: false }]), "y2020");
  // The search lists it once, under that scene.
  const found = { ...nairobi, name: "Nairobi", population: 1 };
  const scenes = [y2020, y2023].map((each) => ({ ...each, title: each.id }));
  assert.deepEqual(
    searchedPlaces([found, { ...found }], { scenes, scene: null }).map(({ sceneTitle }) => sceneTitle),
    ["y2023"],
  );
  assert.equal(searchedPlaces([found], { scenes, scene: "y2020" })[0]?.sceneTitle, undefined);
});

/** Two colour scales over each other say nothing: one is on at a time. Terrain has no colours. */
test("one coloured layer is on at a time", () => {
  const layers = { elevation: 0.6, brightness: 0, radiance: 0.85, influence: 0 };
  assert.deepEqual(withLayer(layers, "influence", 0.9), { elevation: 0.6, brightness: 0, radiance: 0, influence: 0.9 });
  assert.deepEqual(withLayer(layers, "elevation", 0.3), { ...layers, elevation: 0.3 });
  assert.deepEqual(withLayer(layers, "influence", 0), layers);
});
