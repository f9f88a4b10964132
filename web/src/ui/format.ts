// Numbers as people read them.

/** A number with three significant digits or so, never in exponent form. */
export function short_number(value: number): string {
  const size = Math.abs(value);
  if (size === 0) return "0";
  const digits = size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : Math.min(2 - Math.floor(Math.log10(size)), 6);
  return value.toFixed(digits);
}

/** A quantity with the prefix that keeps it between 1 and 1000. */
export function with_prefix(value: number, unit: string): string {
  const size = Math.abs(value);
  if (size === 0) return `0 ${unit}`;
  if (size >= 1e6) return `${short_number(value / 1e6)} M${unit}`;
  if (size >= 1e4) return `${short_number(value / 1e3)} k${unit}`;
  if (size >= 1) return `${short_number(value)} ${unit}`;
  if (size >= 1e-3) return `${short_number(value * 1e3)} m${unit}`;
  if (size >= 1e-6) return `${short_number(value * 1e6)} µ${unit}`;
  return `${short_number(value * 1e9)} n${unit}`;
}

export function magnitude(brightness_mag_arcsec2: number | null): string {
  return brightness_mag_arcsec2 === null ? "no light" : brightness_mag_arcsec2.toFixed(2);
}

/** How many times the natural sky: 0.003, 0.84, 12, 340. */
export function ratio(value: number): string {
  if (value === 0) return "0";
  if (value < 0.001) return "< 0.001";
  return value >= 10 ? Math.round(value).toLocaleString("en") : value.toPrecision(2);
}

export function coordinates(latitude_deg: number, longitude_deg: number): string {
  const latitude = `${Math.abs(latitude_deg).toFixed(4)}° ${latitude_deg < 0 ? "S" : "N"}`;
  return `${latitude}, ${Math.abs(longitude_deg).toFixed(4)}° ${longitude_deg < 0 ? "W" : "E"}`;
}
