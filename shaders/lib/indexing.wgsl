// Requires types. Layout of lists and tables in textures. Derivations: server/render/src/twin/indexing.rs

const CELLS_PER_ROW: u32 = 1024u;

fn list_texel(item: u32) -> vec2<u32> {
  return vec2<u32>(item % CELLS_PER_ROW, item / CELLS_PER_ROW);
}

fn cell_texel(cell: u32, band: u32) -> vec2<u32> {
  return vec2<u32>((cell % CELLS_PER_ROW) * BAND_COUNT + band, cell / CELLS_PER_ROW);
}

const NODE_ROWS: u32 = 8192u;

fn mixed_texel(node: u32, band: u32, quad: u32, quad_count: u32) -> vec2<u32> {
  return vec2<u32>((node / NODE_ROWS * BAND_COUNT + band) * quad_count + quad, node % NODE_ROWS);
}

const BLOCKED_ANGLE_COUNT: u32 = 7u;

fn blocked_layer(observer_altitude: u32, angle_index: u32) -> u32 {
  return observer_altitude * BLOCKED_ANGLE_COUNT + angle_index;
}

fn shape_texel(
  row: u32,
  observer_altitude: u32,
  lobe: u32,
  band: u32,
  octet: u32,
  octet_count: u32,
) -> vec2<u32> {
  return vec2<u32>(((observer_altitude * LOBE_COUNT + lobe) * BAND_COUNT + band) * octet_count + octet, row);
}
