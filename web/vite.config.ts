import { defineConfig, type Plugin } from "vite";
import { page } from "./src/language/english/page.ts";
import { place } from "./src/language/english/place.ts";
import { pageWithWords } from "./src/language/markup.ts";

// `npm run dev` shows sources live and asks a running server (`skyglow serve`) for data.
const server = process.env.SKYGLOW_URL ?? "http://127.0.0.1:8080";
// The server stores only what comes from its own pages: it must see the host that the page sees.
const sameOrigin = { target: server, changeOrigin: false };

/** The page comes with its words in English; at run time another language takes their place. */
function wordsOfPage(): Plugin {
  return {
    name: "words-of-page",
    transformIndexHtml: { order: "pre", handler: (html) => pageWithWords(html, { ...page, ...place }) },
  };
}

/** The page is seen once its styles are there: on a slow line they come before the scripts, which are asked for at once. */
function stylesFirst(): Plugin {
  const handler = (html: string) => {
    const [style] = /\n\s*<link rel="stylesheet"[^>]*>/.exec(html) ?? [];
    return style === undefined ? html : html.replace(style, "").replace(/\n\s*<script/, (script) => `${style}${script}`);
  };
  return { name: "styles-first", transformIndexHtml: { order: "post", handler } };
}

/** The parts of a language are files of the same names: its own comes before. */
function chunkName(path: string | null): string {
  const [, language, part] = /language\/(\w+)\/(\w+)\.ts$/.exec(path ?? "") ?? [];
  return language === undefined ? "[name]" : `${language}-${part}`;
}

export default defineConfig({
  base: "./",
  plugins: [wordsOfPage(), stylesFirst()],
  build: {
    target: "es2022",
    // A strict content security policy allows no data: scripts, fonts or styles, and the preload helper
    // would only repeat what the page already names.
    assetsInlineLimit: 0,
    // The built form carries other people's work; their terms go with it.
    license: { fileName: "LICENCES.md" },
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 1400,
    rollupOptions: {
      input: { index: "index.html", embed: "embed.html", offline: "src/offline/worker.ts" },
      output: {
        // A worker of a fixed name, for browsers come back to it.
        entryFileNames: ({ name }) => (name === "offline" ? "offline.js" : "assets/[name]-[hash].js"),
        chunkFileNames: ({ facadeModuleId }) => `assets/${chunkName(facadeModuleId)}-[hash].js`,
      },
    },
  },
  worker: { format: "es" },
  server: { proxy: { "/api": sameOrigin, "/healthz": sameOrigin, "/readyz": sameOrigin } },
});
