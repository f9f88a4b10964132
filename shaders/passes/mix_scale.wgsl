// Lobe shares, the logarithm of the mixed scale and the curvature of that of every node in use, in all bands.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> requests: array<Request, MAX_BATCH>;
@group(0) @binding(2) var<storage, read> nodes: array<Node>;
// [observer altitude][lobe][band][ring][offset]
@group(0) @binding(3) var<storage, read> log_scale: array<f32>;
// [observer altitude][angle][lobe][band][ring][offset]
@group(0) @binding(4) var<storage, read> blocked_log_scale: array<f32>;
// The list of (node, band): shares and logarithm.
@group(0) @binding(5) var scales: texture_storage_2d<rgba32float, write>;
// Two texels a node: the logarithms alone and their curvatures, a channel a band.
@group(0) @binding(6) var log_scales: texture_storage_2d<rgba32float, write>;

// The middle one of the three nodes that give the curvature at a node: derivation in server/tables/src/curvature.rs.
fn curvature_node(offset: u32, kink_node: u32, offset_count: u32) -> u32 {
  return clamp(select(offset, offset + 1u, offset == kink_node), 1u, offset_count - 2u);
}

// ln of the scale of the three lobes below, at and above the middle one of those nodes.
struct Lobes {
  below: vec3<f32>,
  at: vec3<f32>,
  above: vec3<f32>,
}

fn open_lobe(first: u32) -> vec3<f32> {
  let per_lobe = BAND_COUNT * frame.ring_count * frame.offset_count;
  return vec3<f32>(log_scale[first], log_scale[first + per_lobe], log_scale[first + 2u * per_lobe]);
}

fn blocked_lobe(first: u32) -> vec3<f32> {
  let per_lobe = BAND_COUNT * frame.ring_count * frame.blocked_offset_count;
  return vec3<f32>(
    blocked_log_scale[first],
    blocked_log_scale[first + per_lobe],
    blocked_log_scale[first + 2u * per_lobe],
  );
}

fn mixed_lobes(node: Node, band: u32, middle: u32) -> Lobes {
  var lobes = Lobes(vec3<f32>(0.0), vec3<f32>(0.0), vec3<f32>(0.0));
  // One of the two loops does not run: that costs software less than a branch, both sides of which it takes.
  let open_altitudes = select(0u, requests[node.request].altitude_count, node.blocking == 0u);
  let open_row = (band * frame.ring_count + node.ring) * frame.offset_count;
  for (var altitude = 0u; altitude < open_altitudes; altitude++) {
    let layer = requests[node.request].altitude_index[altitude] * LOBE_COUNT * BAND_COUNT;
    let row = layer * frame.ring_count * frame.offset_count + open_row;
    let weight = requests[node.request].altitude_weight[altitude];
    lobes.below += weight * open_lobe(row + middle - 1u);
    lobes.at += weight * open_lobe(row + middle);
    lobes.above += weight * open_lobe(row + middle + 1u);
  }
  let blocked_altitudes = select(requests[node.request].blocked_altitude_count, 0u, node.blocking == 0u);
  let blocked_row = (band * frame.ring_count + node.ring) * frame.blocked_offset_count;
  for (var altitude = 0u; altitude < blocked_altitudes; altitude++) {
    let layer = blocked_layer(requests[node.request].blocked_altitude_index[altitude], node.blocking - 1u);
    let row = layer * LOBE_COUNT * BAND_COUNT * frame.ring_count * frame.blocked_offset_count + blocked_row;
    let weight = requests[node.request].blocked_altitude_weight[altitude];
    lobes.below += weight * blocked_lobe(row + middle - 1u);
    lobes.at += weight * blocked_lobe(row + middle);
    lobes.above += weight * blocked_lobe(row + middle + 1u);
  }
  return lobes;
}

@compute @workgroup_size(64, 1, 1)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
  let node_index = invocation.x;
  if node_index >= frame.node_count {
    return;
  }
  let node = nodes[node_index];
  let is_open = node.blocking == 0u;
  let middle = curvature_node(
    node.offset,
    select(frame.blocked_kink_node, frame.kink_node, is_open),
    select(frame.blocked_offset_count, frame.offset_count, is_open),
  );
  var log_sums = vec4<f32>(0.0);
  var curvatures = vec4<f32>(0.0);
  for (var band = 0u; band < BAND_COUNT; band++) {
    let lobes = mixed_lobes(node, band, middle);
    let beside = select(lobes.below, lobes.above, node.offset > middle);
    let own = select(beside, lobes.at, node.offset == middle);
    let shares = lobe_shares(requests[node.request].emission, own);
    textureStore(scales, list_texel(BAND_COUNT * node_index + band), shares);
    log_sums[band] = shares.w;
    curvatures[band] = mixed_curvature(shares.xyz, lobes.below, lobes.at, lobes.above);
  }
  textureStore(log_scales, list_texel(2u * node_index), log_sums);
  textureStore(log_scales, list_texel(2u * node_index + 1u), curvatures);
}
