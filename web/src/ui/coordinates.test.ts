import assert from "node:assert/strict";
import { test } from "node:test";
import { page as german } from "../language/german/page.ts";
import { words } from "../language/words.ts";
import { placeFromText } from "./coordinates.ts";
import { coordinates } from "./format.ts";

function assertRead(text: string, latitudeDeg: number, longitudeDeg: number): void {
  const place = placeFromText(text);
  assert.ok(place !== null, `${text} is read`);
  assert.ok(Math.abs(place.latitude_deg - latitudeDeg) < 1e-6, `${text}: latitude ${place.latitude_deg}`);
  assert.ok(Math.abs(place.longitude_deg - longitudeDeg) < 1e-6, `${text}: longitude ${place.longitude_deg}`);
}

/** Coordinates are read latitude first, with signs or letters before or behind, whatever stands between them. */
test("coordinates are latitude first", () => {
  for (const text of [
    "-1.29, 36.82",
    "-1.29,36.82",
    "-1.29 36.82",
    "1.29°S 36.82°E",
    "S1.29 E36.82",
    "S 1.29°, E 36.82°",
    "1.29 S / 36.82 E",
  ])
    assertRead(text, -1.29, 36.82);
  assertRead("−33.9249; 18.4241", -33.9249, 18.4241);
  assertRead("36.82E 1.29S", -1.29, 36.82);
  assertRead("46, 8", 46, 8);
  assertRead("0 0", 0, 0);
});

test("degrees, minutes and seconds are read", () => {
  const [latitude, longitude] = [-(1 + 17 / 60 + 11 / 3600), 36 + 49 / 60 + 2 / 3600];
  for (const text of [`1°17'11"S 36°49'2"E`, `1° 17′ 11″ S, 36° 49′ 2″ E`, `S 1°17'11'' E 36°49'2''`])
    assertRead(text, latitude, longitude);
  assertRead(`46°10.2'N 8°47.4'E`, 46.17, 8.79);
});

test("commas may be signs of decimals", () => {
  for (const text of ["-1,29 36,82", "-1,29; 36,82", "-1,29, 36,82", "-1,29,36,82", "1,29° S 36,82° E"])
    assertRead(text, -1.29, 36.82);
});

test("links of maps are read", () => {
  assertRead("geo:-1.29,36.82?z=12", -1.29, 36.82);
  assertRead("https://www.openstreetmap.org/#map=12/-1.29/36.82", -1.29, 36.82);
  assertRead("https://www.openstreetmap.org/?mlat=-1.29&mlon=36.82#map=5/1/2", -1.29, 36.82);
  assertRead("https://www.google.com/maps/place/X/@1.5,2.5,17z/data=!3m1!4b1!3d-1.29!4d36.82", -1.29, 36.82);
  assertRead("https://www.google.com/maps/@-1.29,36.82,12z", -1.29, 36.82);
  assertRead("https://maps.google.com/?q=-1.29,36.82", -1.29, 36.82);
  assertRead("https://maps.apple.com/?ll=-1.29,36.82", -1.29, 36.82);
  assertRead("https://sky.example/#scene=demo&lat=-1.29&lon=36.82", -1.29, 36.82);
});

/** What is no place is none: names, angles out of range, twice the same axis. */
test("what is no place is not read", () => {
  for (const text of [
    "",
    "91, 10",
    "10, 181",
    "Nairobi",
    "1.29",
    "10N 20N",
    `1°75'S 36°E`,
    "https://example.org/",
    "12 Main Street, 5",
  ])
    assert.equal(placeFromText(text), null, text);
});

/** Coordinates are written as a language writes numbers, and what the page writes it also reads. */
test("what the page writes is read", () => {
  const english = { ...words() };
  const place = { latitude_deg: -46.53, longitude_deg: 8.1234 };
  const written = () => coordinates(place.latitude_deg, place.longitude_deg);
  assert.equal(written(), "46.5300° S, 8.1234° E");
  assert.deepEqual(placeFromText(written()), place);
  Object.assign(words(), { decimalSign: german.decimalSign, compass: german.compass });
  try {
    assert.equal(written(), "46,5300° S, 8,1234° O");
    assert.deepEqual(placeFromText(written()), place);
  } finally {
    Object.assign(words(), english);
  }
});
