// Holds the committed web/dist to its sources, with plain Node 18 and no packages.
//   node scripts/dist-hash.mjs write   after a build: lists the SHA-256 of every source and every built file
//   node scripts/dist-hash.mjs check   fails when a source or a built file is not the listed one
// The list has the form of `sha256sum`, so `cd web && sha256sum --check dist/SHA256SUMS` reads it too.
import { createHash } from "node:crypto";
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join, relative, sep } from "node:path";
import { fileURLToPath } from "node:url";

const web = dirname(dirname(fileURLToPath(import.meta.url)));
const listPath = join(web, "dist", "SHA256SUMS");
// Tests do not reach the built form; everything else here does.
const SOURCES = [
  "index.html",
  "embed.html",
  "public",
  "package.json",
  "package-lock.json",
  "tsconfig.json",
  "vite.config.ts",
  "src",
  "dist",
];
const isListed = (path) => !path.endsWith(".test.ts") && path !== listPath;

function filesUnder(path) {
  let entries;
  try {
    entries = readdirSync(path, { withFileTypes: true });
  } catch (error) {
    if (error.code === "ENOTDIR") return [path];
    if (error.code === "ENOENT") return [];
    throw error;
  }
  return entries.flatMap((entry) => filesUnder(join(path, entry.name)));
}

function sums() {
  const paths = SOURCES.flatMap((name) => filesUnder(join(web, name))).filter(isListed);
  return new Map(
    paths
      .map((path) => [relative(web, path).split(sep).join("/"), createHash("sha256").update(readFileSync(path)).digest("hex")])
      .sort(([a], [b]) => (a < b ? -1 : 1)),
  );
}

function listed() {
  let text;
  try {
    text = readFileSync(listPath, "utf8");
  } catch {
    console.error("web/dist has no SHA256SUMS. Build it: cd web && npm ci && npm run build");
    process.exit(1);
  }
  return new Map(
    text
      .trim()
      .split("\n")
      .map((line) => [line.slice(66), line.slice(0, 64)]),
  );
}

const found = sums();
if (process.argv[2] === "write") {
  writeFileSync(listPath, [...found].map(([path, sum]) => `${sum}  ${path}\n`).join(""));
  console.log(`dist/SHA256SUMS lists ${found.size} files`);
} else if (process.argv[2] === "check") {
  const wanted = listed();
  const wrong = [
    ...[...wanted.keys()].filter((path) => !found.has(path)).map((path) => `missing: ${path}`),
    ...[...found.keys()].filter((path) => !wanted.has(path)).map((path) => `not listed: ${path}`),
    ...[...wanted].filter(([path, sum]) => found.has(path) && found.get(path) !== sum).map(([path]) => `changed: ${path}`),
  ];
  if (wrong.length > 0) {
    console.error(
      `web/dist does not belong to its sources:\n  ${wrong.join("\n  ")}\nBuild it again: cd web && npm ci && npm run build`,
    );
    process.exit(1);
  }
  console.log(`web/dist belongs to its sources (${wanted.size} files)`);
} else {
  console.error("usage: node scripts/dist-hash.mjs write|check");
  process.exit(2);
}
