// Whoever asks for less motion gets none from the map.

export const IS_STILL = matchMedia("(prefers-reduced-motion: reduce)").matches;
