// What a meter reads in the field, beside what the model has there.

import { placeWords } from "../language/words.ts";
import { type AppState, sceneOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId, saveFile } from "./dom.ts";
import { fixed, percent } from "./format.ts";
import { csvOf, excess, METER_ERROR_MAG, readingFrom, readingsFrom, withReading } from "./readings.ts";
import { loadSetting, saveSetting } from "./storage.ts";

const READINGS_KEY = "skyglow.readings";

/** Magnitudes of the model's meter; null where it has none. */
function modelMag({ answer }: Readonly<AppState>): number | null {
  return answer?.sky.sqm_total_brightness_mag_arcsec2 ?? null;
}

/** How both agree, in a sentence. */
function told(readMag: number, model: number): string {
  const say = placeWords().meter;
  const { brighterMag, times } = excess(readMag, model);
  if (Math.abs(brighterMag) <= METER_ERROR_MAG) return say.agrees(fixed(model, 2));
  const [mag, part] = [fixed(Math.abs(brighterMag), 2), percent(Math.abs(times - 1))];
  return brighterMag > 0 ? say.brighter(fixed(model, 2), mag, part) : say.darker(fixed(model, 2), mag, part);
}

export function mountMeter(store: AppStore): void {
  const field = byId("meter-reading", HTMLInputElement);
  const status = byId("meter-told", HTMLElement);
  const keep = byId("meter-keep", HTMLButtonElement);
  const save = byId("meter-save", HTMLButtonElement);
  const show = () => {
    const [reading, model] = [readingFrom(field.value), modelMag(store.state)];
    keep.disabled = reading === null || model === null;
    if (field.value.trim() === "") status.textContent = "";
    else if (reading === null) status.textContent = placeWords().meter.noReading;
    else status.textContent = model === null ? placeWords().meter.noModel : told(reading, model);
    const { length } = readingsFrom(loadSetting(READINGS_KEY));
    save.hidden = length === 0;
    save.textContent = placeWords().meter.save(length);
  };
  field.addEventListener("input", show);
  keep.addEventListener("click", () => {
    const { state } = store;
    const { place, time, answer } = state;
    const [reading, model, scene] = [readingFrom(field.value), modelMag(state), sceneOf(state)];
    if (reading === null || model === null || place === null || scene === null || answer === null) return;
    const readAt = new Date().toISOString().replace(/\.\d+/, "");
    const { latitude_deg, longitude_deg } = place;
    const { turbidity } = answer;
    const entry = { latitude_deg, longitude_deg, readAt, time, readMag: reading, modelMag: model, scene: scene.id, turbidity };
    saveSetting(READINGS_KEY, JSON.stringify(withReading(readingsFrom(loadSetting(READINGS_KEY)), entry)));
    field.value = "";
    show();
    status.textContent = placeWords().meter.kept;
  });
  save.addEventListener("click", () => {
    const table = csvOf(readingsFrom(loadSetting(READINGS_KEY)));
    saveFile(new Blob([table], { type: "text/csv" }), "skyglow readings.csv");
  });
  store.watch(["answer"], show);
}
