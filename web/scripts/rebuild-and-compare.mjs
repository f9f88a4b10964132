// Builds the viewer again into a scratch folder and fails unless every byte equals the committed web/dist.
// Needs Node 20 and the packages of package-lock.json (`npm ci`).
import { execFileSync } from "node:child_process";
import { mkdtempSync, readdirSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const web = dirname(dirname(fileURLToPath(import.meta.url)));
const filesOf = (folder) =>
  new Map(
    readdirSync(folder, { recursive: true, withFileTypes: true })
      .filter((entry) => entry.isFile() && entry.name !== "SHA256SUMS")
      .map((entry) => join(entry.parentPath ?? entry.path, entry.name))
      .map((path) => [path.slice(folder.length + 1), readFileSync(path)]),
  );

const scratch = mkdtempSync(join(tmpdir(), "skyglow-web-"));
let wrong;
let count;
try {
  execFileSync(
    process.execPath,
    [join(web, "node_modules/vite/bin/vite.js"), "build", "--outDir", scratch, "--emptyOutDir", "--logLevel", "error"],
    {
      cwd: web,
      stdio: "inherit",
    },
  );
  const [committed, rebuilt] = [filesOf(join(web, "dist")), filesOf(scratch)];
  count = rebuilt.size;
  wrong = [...new Set([...committed.keys(), ...rebuilt.keys()])].filter((path) => {
    const [a, b] = [committed.get(path), rebuilt.get(path)];
    return a === undefined || b === undefined || !a.equals(b);
  });
} finally {
  rmSync(scratch, { recursive: true, force: true });
}
if (wrong.length > 0) {
  console.error(`a new build differs from web/dist:\n  ${wrong.join("\n  ")}\nBuild it again: cd web && npm ci && npm run build`);
  process.exit(1);
}
console.log(`a new build equals web/dist (${count} files)`);
