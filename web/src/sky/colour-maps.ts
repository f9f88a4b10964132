// Colour maps of even lightness that stay readable with colour-blind eyes (matplotlib's, CC0),
// as 33 evenly spaced sRGB anchors in hex.

export type ColourMapName = "inferno" | "viridis" | "cividis";
/** Of pictures, and of map tiles. */
type AnyMapName = ColourMapName | "plasma";

const ANCHORS: Record<AnyMapName, string> = {
  inferno:
    "0000040403120b0724150b37210c4a2f0a5b3d09654a0c6b57106e64156e71196e7d1e6d8a226a972766a32c61b0315bbc3754" +
    "c73e4cd24644db503be45a31eb6628f1731df68013f98e09fb9d07fcac11fbbc21f9cb35f5db4cf2ea69f3f68afcffa4",
  viridis:
    "440154470d6048186a482374472d7b4537814240863e49893b528b375b8d33638d2f6b8e2c728e297a8e26828e23898e21918c" +
    "1f988b1fa08822a78528ae8032b67a3fbc734ec36b5ec96270cf5784d44b98d83eaddc30c2df23d8e219ece51bfde725",
  cividis:
    "00224e00285b002e6a0533711a386f273e6e32436d3b496c434e6c4b546c535a6d5a5f6e61656f686a716f70737676767d7c78" +
    "8482798c8878938e789b9476a39a74aba072b4a76fbcae6cc4b468cdbb63d5c25edec958e7d150f0d846f9e03afee838",
  plasma:
    "0d08872206903105973f049c4c02a15901a56600a77201a87e03a88a09a59511a1a01a9caa2395b32c8ebc3587c43e7fcc4778" +
    "d24f71d9586adf6263e56b5deb7556f07f4ff48948f89441fb9f3afdab33feb72dfdc328fcd025f9dd25f5eb27f0f921",
};

export const COLOUR_MAPS: readonly ColourMapName[] = ["inferno", "viridis", "cividis"];
/** How a sky is coloured: as the eye or a camera sees it, or by its brightness. */
export type PictureStyle = "eye" | "realistic" | ColourMapName;
export const STYLES: readonly PictureStyle[] = ["eye", "realistic", ...COLOUR_MAPS];

/** `count` RGB triples, evenly spaced over the map. */
export function colourTable(name: AnyMapName, count: number): Uint8ClampedArray {
  const hex = ANCHORS[name];
  const last = hex.length / 6 - 1;
  const channel = (anchor: number, offset: number) => parseInt(hex.slice(anchor * 6 + offset, anchor * 6 + offset + 2), 16);
  const table = new Uint8ClampedArray(count * 3);
  for (let i = 0; i < count; i++) {
    const position = (i / (count - 1)) * last;
    const anchor = Math.min(Math.floor(position), last - 1);
    const part = position - anchor;
    for (let c = 0; c < 3; c++) {
      table[i * 3 + c] = channel(anchor, c * 2) * (1 - part) + channel(anchor + 1, c * 2) * part;
    }
  }
  return table;
}

/** The map as a CSS gradient from left (darkest) to right. */
export function colourGradient(name: ColourMapName): string {
  const stops = ANCHORS[name].match(/.{6}/g) ?? [];
  return `linear-gradient(to right, ${stops.map((stop) => `#${stop}`).join(", ")})`;
}

/** The part of a map that tiles of a logarithmic layer use, as thin as they are where they are dark. */
export function tileGradient(name: AnyMapName): string {
  const count = 256;
  const table = colourTable(name, count);
  const stops = Array.from({ length: 18 }, (_, i) => {
    const part = 0.15 + (0.85 * i) / 17;
    const at = 3 * Math.round(part * (count - 1));
    return `rgba(${table[at]}, ${table[at + 1]}, ${table[at + 2]}, ${(0.25 + 0.75 * Math.sqrt(part)).toFixed(2)})`;
  });
  return `linear-gradient(to right, ${stops.join(", ")})`;
}

/** Whether a style is of colours of light, as the eye or a camera sees them: stars are in it, and it is of no other response. */
export function isOfLight(style: PictureStyle): style is "eye" | "realistic" {
  return style === "eye" || style === "realistic";
}
