// Addresses that the map asks for, as the page can reach them.

/** What all paths of the server's interface begin with. */
const API = "/api/v1/";

/** A TileJSON names its tiles as the server believes to be reached: behind a proxy that tells it nothing, by another scheme or
 * host, or without the prefix of the page's own path. The interface lies beside the page. */
export function reachable(address: string): { url: string } {
  const url = new URL(address, document.baseURI);
  const at = url.pathname.indexOf(API);
  if (at < 0) return { url: url.href };
  return { url: new URL(`.${url.pathname.slice(at)}${url.search}`, document.baseURI).href };
}
