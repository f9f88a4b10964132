// How lamps send their light: a usual kind, and for experts its shares and what of it the satellite saw.

import { words } from "../language/words.ts";
import type { AppStore } from "../state/app-store.ts";
import { EMISSION_KEEPS } from "../state/view-state.ts";
import { byId, debounced } from "./dom.ts";
import { emissions, sharesOf } from "./lamps.ts";
import { fillSelect } from "./select.ts";

/** A slider at rest for this long changes the sky. */
const WAIT_MS = 180;

export function mountEmissionControls(store: AppStore): void {
  const emission = byId("emission", HTMLSelectElement);
  const directUplight = byId("direct-uplight", HTMLInputElement);
  const groundReflectance = byId("ground-reflectance", HTMLInputElement);
  const keep = byId("emission-keep", HTMLSelectElement);
  keep.addEventListener("change", () => store.set({ emissionKeep: EMISSION_KEEPS.find((name) => name === keep.value) ?? "flux" }));
  const say = (slider: HTMLInputElement) => {
    byId(`${slider.id}-value`, HTMLOutputElement).value = slider.disabled ? "" : `${slider.value} %`;
    slider.setAttribute("aria-valuetext", `${slider.value} %`);
  };
  const wire = (slider: HTMLInputElement, set: (share: number) => void) => {
    const setSoon = debounced(WAIT_MS, set);
    slider.addEventListener("input", () => {
      say(slider);
      setSoon(Number(slider.value) / 100);
    });
    return setSoon;
  };
  const setDirect = wire(directUplight, (share) => store.set({ directUplight: share }));
  const setGround = wire(groundReflectance, (share) => store.set({ groundReflectance: share }));
  // A usual kind has its own shares.
  emission.addEventListener("change", () => {
    setDirect.cancel();
    setGround.cancel();
    store.set({ emission: emission.value, directUplight: null, groundReflectance: null });
  });
  store.watch(["emission"], (state) => fillSelect(emission, emissions(), state.emission));
  store.watch(["emission", "directUplight", "groundReflectance"], (state) => {
    const shares = sharesOf(state.emission);
    const show = (slider: HTMLInputElement, share: number | undefined) => {
      slider.disabled = share === undefined;
      if (share !== undefined) slider.value = String(+(100 * share).toFixed(2));
      say(slider);
    };
    show(directUplight, shares === null ? undefined : (state.directUplight ?? shares[0]));
    show(groundReflectance, shares === null ? undefined : (state.groundReflectance ?? shares[1]));
  });
  store.watch(["emissionKeep"], ({ emissionKeep }) => {
    const { keepFlux, keepNadirRadiance } = words().assumptions;
    const titles = { flux: keepFlux, nadir_radiance: keepNadirRadiance };
    fillSelect(
      keep,
      EMISSION_KEEPS.map((name) => [name, titles[name]] as const),
      emissionKeep,
    );
  });
}
