// Where things lie in the textures: server/engine/src/twin/indexing.rs

const CELLS_PER_ROW: u32 = 1024u;

fn cell_texel(cell: u32, band: u32) -> vec2<u32> {
  return vec2<u32>((cell % CELLS_PER_ROW) * 3u + band, cell / CELLS_PER_ROW);
}

fn mixed_texel(node: u32, band: u32, quad: u32, quad_count: u32) -> vec2<u32> {
  return vec2<u32>(band * quad_count + quad, node);
}

fn shape_texel(
  lobe: u32,
  band: u32,
  ring: u32,
  ring_count: u32,
  offset: u32,
  octet: u32,
  octet_count: u32,
) -> vec2<u32> {
  return vec2<u32>(offset * octet_count + octet, (lobe * 3u + band) * ring_count + ring);
}
