// The link that is passed on: its page tells previews the place and its picture, and leads to the view.

/** @param brightestDeg azimuth that the preview's picture looks towards; null: south */
export function sharedLink(viewerAddress: string, brightestDeg: number | null): string {
  const { hash } = new URL(viewerAddress);
  const view = new URLSearchParams(hash.slice(1));
  if (!["scene", "lat", "lon"].every((name) => view.has(name))) return viewerAddress;
  const url = new URL("./at", viewerAddress);
  url.search = hash.slice(1) + (brightestDeg === null ? "" : `&towards=${Math.round(brightestDeg)}`);
  return url.href;
}
