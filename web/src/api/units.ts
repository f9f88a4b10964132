// The server's units as people write them.

const POWERS: Record<string, string> = { "-1": "", "-2": "²", "-3": "³" };

/** "nW cm-2 sr-1" as "nW/cm²/sr". */
export function typeset(unit: string): string {
  return unit.replace(/ ?\b([A-Za-zµ]+)(-[123])\b/g, (_, name: string, power: string) => `/${name}${POWERS[power] ?? ""}`);
}
