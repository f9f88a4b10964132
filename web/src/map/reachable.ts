// Addresses that the map asks for, as the page can reach them.

/** A TileJSON may name its tiles relative to the server, which the worker that asks for them cannot resolve, or,
 * behind a proxy, by the scheme that the server saw instead of the page's. */
export function reachable(address: string): { url: string } {
  const url = new URL(address, document.baseURI);
  if (url.host === location.host) url.protocol = location.protocol;
  return { url: url.href };
}
