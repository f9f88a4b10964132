// What the service worker keeps for times without a network, and how an answer that it kept says so.

/** When a kept answer came: the page tells it. */
export const STORED_HEADER = "x-skyglow-stored";

export const SHELL_CACHE = "skyglow-shell-1";
export const ANSWER_CACHE = "skyglow-answers-1";
/** Files of some three versions of the viewer. */
export const MAX_FILES = 90;
/** Some fifteen places, each with its sky, its night and whose light it is, and the tiles around. */
export const MAX_ANSWERS = 400;

export type Kind = "page" | "file" | "answer" | "tile" | "other";

/** Answers about a place, and what the viewer begins with. */
const ANSWERS =
  /^(scenes|atmospheres|night|scenes\/[^/]+\/(places|site|sky|panorama\.sky|shares|night|tiles\/[^/]+\/tilejson\.json))$/;
const TILES = /^scenes\/[^/]+\/tiles\/[^/]+\/\d+\/\d+\/[^/]+$/;

/** What a request is for. `scope`: the address below which the worker works. */
export function kindOf(address: string, scope: string): Kind {
  const { href, origin } = new URL(address);
  if (origin !== new URL(scope).origin || !href.startsWith(scope)) return "other";
  const path = href.slice(scope.length).replace(/[?#].*$/, "");
  if (path === "" || path === "index.html") return "page";
  if (path.startsWith("assets/")) return "file";
  if (!path.startsWith("api/v1/")) return "other";
  const asked = path.slice("api/v1/".length);
  if (ANSWERS.test(asked)) return "answer";
  return TILES.test(asked) ? "tile" : "other";
}

/** An answer that was kept, marked as such. */
export function asStored(kept: Response): Response {
  const headers = new Headers(kept.headers);
  headers.set(STORED_HEADER, kept.headers.get("date") ?? "");
  return new Response(kept.body, { status: kept.status, statusText: kept.statusText, headers });
}
