//! A patch: the sky next to one light as it is, minus the same as the polar grid and the packs' nodes have it.
//!
//! A patch is eight columns by up to eight rows around the light. The grid's part of it is made of the images of the four
//! nodes around the light (two rings, two offsets), which lights at the same nodes share, each in two columns: an image stands on
//! a column, and is a mean across one within [`AVERAGED`] columns of its light, as `skyglow_tables::images` makes it.

use super::{air::Air, low_rows::ROWS, sight_line::SightLine};
use crate::{cpu::lanes::LANES, table_set::TableSet};
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, Panorama,
    panorama::azimuth_rad,
    simd::multiply_add,
    simd_dispatch,
    source_pixel::{MAX_SOURCE_DISTANCE_M, MIN_SOURCE_DISTANCE_M},
};
use skyglow_scene::{RING_COUNT, ring_distance_m};
use skyglow_tables::images::{ACROSS_COLUMN, NEAR_COLUMN_COUNT as AVERAGED};

/// Columns and rows of a patch.
const SIDE: usize = LANES;
/// A patch counts in full within so many columns or rows of its light, and falls to nothing at [`REACH`].
const FULL_WITHIN: f32 = 3.0;
const REACH: f32 = 4.0;
/// Columns of a node's image that patches look at: 0 to 4 from its own, and as many on the other side.
const HALF: usize = SIDE / 2 + 1;
const BOTH_SIDES: usize = 2 * HALF - 1;
/// Azimuths that make them: two for column 0, which is even, four for each other averaged one, one for the rest.
const SAMPLES: usize = 2 + 4 * (AVERAGED - 1) + (HALF - AVERAGED);

/// A light that is visible.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SelectedLight {
    /// Its place among the near lights.
    pub index: u32,
    pub nodes: PatchNodes,
    pub fractions: NodeFractions,
    pub sight_line: SightLine,
    /// Its elevation in rows and its azimuth in columns.
    pub row: f32,
    pub column: f32,
    /// Its flux, DNB watts.
    pub flux_dnb_w: f32,
    /// How much of its patch counts, 0..=1.
    pub weight: f32,
}

/// The nodes around a light and the first row of its patch: lights between the same nodes share their images.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PatchNodes {
    ring: u32,
    /// Node at or below it on the axes of the ring and of the next.
    offsets: [u32; 2],
    first_row: i32,
}

/// Place of a distance among the rings.
fn ring_position(distance_m: f32) -> f32 {
    let log = (f64::from(distance_m) / MIN_SOURCE_DISTANCE_M).ln()
        / (MAX_SOURCE_DISTANCE_M / MIN_SOURCE_DISTANCE_M).ln();
    ((RING_COUNT - 1) as f64 * log).clamp(0.0, (RING_COUNT - 1) as f64) as f32
}

/// Where a light is between its nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeFractions {
    /// From its ring to the next, 0..=1.
    out: f32,
    /// From the node below it to the one above on the axes of both rings, 0..=1.
    up: [f32; 2],
}

impl PatchNodes {
    /// The nodes around a light, and where it is between them.
    pub(crate) fn of(set: &TableSet, distance_m: f32, offset_m: f32, row: f32) -> (Self, NodeFractions) {
        let position = ring_position(distance_m);
        let ring = (position as usize).min(RING_COUNT - 2);
        let positions = [ring, ring + 1].map(|ring| set.axis(ring).position(offset_m));
        let offsets = positions.map(|position| (position as usize).min(set.offset_count() - 2) as u32);
        let nodes =
            Self { ring: ring as u32, offsets, first_row: row.floor() as i32 - (SIDE / 2 - 1) as i32 };
        let up = std::array::from_fn(|ring| (positions[ring] - offsets[ring] as f32).clamp(0.0, 1.0));
        (nodes, NodeFractions { out: position - ring as f32, up })
    }

    /// Their order, as one number.
    pub(crate) fn key(self) -> u64 {
        let [below, above] = self.offsets.map(u64::from);
        // Rows from −8 up: lights more than four below the lowest are not selected.
        let row = (self.first_row + SIDE as i32).max(0) as u64;
        (u64::from(self.ring) << 48) | (below << 32) | (above << 16) | row
    }

    /// Rows of the patch that are in the sky.
    pub(crate) fn rows(self) -> std::ops::Range<usize> {
        let row = |row: i32| row.clamp(0, ELEVATION_COUNT as i32) as usize;
        row(self.first_row)..row(self.first_row + SIDE as i32)
    }
}

/// Radiance per watt, `[row of the patch][band][column or half column]`.
type OfBands<const N: usize> = [[[f32; N]; BAND_COUNT]; SIDE];

/// Cosines and sines of the azimuths of a node's samples, in two vectors.
struct Azimuths([[[f32; LANES]; 2]; 2]);

impl Azimuths {
    fn new() -> Self {
        let step = azimuth_rad(1);
        let mut azimuths = [0.0; 2 * LANES];
        for (azimuth, (column, across, _)) in azimuths.iter_mut().zip(samples()) {
            *azimuth = (column as f64 + across) * step;
        }
        let vector = |which: usize| {
            let of = |f: fn(f64) -> f64| std::array::from_fn(|lane| f(azimuths[which * LANES + lane]) as f32);
            [of(f64::cos), of(f64::sin)]
        };
        Self([vector(0), vector(1)])
    }
}

/// Column, place across it and weight of every sample.
fn samples() -> impl Iterator<Item = (usize, f64, f64)> {
    (0..HALF).flat_map(|column| {
        let averaged = column < AVERAGED;
        ACROSS_COLUMN.into_iter().filter_map(move |(across, weight)| match column {
            0 if across < 0.0 => None,
            0 => Some((0, across, 2.0 * weight)),
            _ if averaged => Some((column, across, weight)),
            // One of the four stands for a column that is a point.
            _ => (across == ACROSS_COLUMN[0].0).then_some((column, 0.0, 1.0)),
        })
    })
}

/// Ring, offset and first row of a node's image.
type NodeKey = (u32, u32, i32);
/// The image of a node in the rows of a patch, columns −4 to 4 from its own.
type NodeImage = OfBands<BOTH_SIDES>;

/// Rings, offsets and first rows whose images are cached: of two rings side by side every offset, in four rows.
const CACHED: [usize; 3] = [2, 64, 4];

/// Makes patches; caches the images of nodes, which lights side by side share.
pub(crate) struct PatchMaker<'a> {
    air: &'a Air,
    set: &'a TableSet,
    azimuths: Azimuths,
    /// Sine and cosine of the elevation of every row.
    elevations: [[f32; 2]; ELEVATION_COUNT],
    /// Column and weight of every sample.
    shares: [(usize, f32); SAMPLES],
    /// Whose image is cached at each place, and where among the images; none before the first.
    cached: Vec<Option<(NodeKey, usize)>>,
    /// As many as were wanted: most tasks have few nodes, and to clear room for all takes longer than their images.
    images: Vec<NodeImage>,
}

/// Where the image of a node is cached.
#[inline(always)]
fn slot((ring, offset, first_row): NodeKey) -> usize {
    let [rings, offsets, rows] = CACHED;
    ((ring as usize % rings) * offsets + offset as usize % offsets) * rows
        + first_row.rem_euclid(rows as i32) as usize
}

impl<'a> PatchMaker<'a> {
    pub(crate) fn new(air: &'a Air, set: &'a TableSet) -> Self {
        let mut shares = [(0, 0f32); SAMPLES];
        for (share, (column, _, weight)) in shares.iter_mut().zip(samples()) {
            *share = (column, weight as f32);
        }
        let cached = vec![None; CACHED.iter().product()];
        Self { air, set, azimuths: Azimuths::new(), elevations: *ROWS, shares, cached, images: Vec::new() }
    }

    /// Calls `add` with a position in a panorama and what a light changes there and in the columns after it, W m⁻² sr⁻¹.
    #[inline(always)]
    pub(crate) fn for_each(
        &mut self,
        light: &SelectedLight,
        flux_per_dnb_flux: [f32; BAND_COUNT],
        limit: &GridLimit,
        mut add: impl FnMut(usize, &[f32]),
    ) {
        let mut patch = [[[0f32; SIDE]; BAND_COUNT]; SIDE];
        fill(self, light, flux_per_dnb_flux, limit, &mut patch);
        let first_column = first_column(light);
        // Columns before north.
        let before = SIDE.min(AZIMUTH_COUNT - first_column);
        for row in light.nodes.rows() {
            let of_row = &patch[(row as i32 - light.nodes.first_row) as usize];
            for (band, changes) in
                of_row.iter().enumerate().filter(|(band, _)| flux_per_dnb_flux[*band] > 0.0)
            {
                let first = Panorama::index(band, row, 0);
                add(first + first_column, &changes[..before]);
                if before < SIDE {
                    add(first, &changes[before..]);
                }
            }
        }
    }
}

/// What the grid can have of a light in every direction at most, W m⁻² sr⁻¹: packs have no sharp peak where a node stands far
/// above the observer, and what they lack cannot be taken away.
pub(crate) struct GridLimit(Vec<[f32; AZIMUTH_COUNT + SIDE]>);

impl GridLimit {
    /// A part of the sky as the grid has it, `[band][row][column]`.
    pub(crate) fn new(sky: &[f32], part: f32) -> Self {
        let around = |row: &[f32]| std::array::from_fn(|column| part * row[column % AZIMUTH_COUNT]);
        Self(sky.chunks_exact(AZIMUTH_COUNT).map(around).collect())
    }

    /// In a patch's columns from the first on, which goes on past north.
    #[inline(always)]
    fn from(&self, band: usize, row: usize, first_column: usize) -> &[f32] {
        &self.0[band * ELEVATION_COUNT + row][first_column..][..SIDE]
    }
}

/// The first column of a light's patch.
#[inline(always)]
fn first_column(light: &SelectedLight) -> usize {
    (light.column.floor() as usize + AZIMUTH_COUNT - (SIDE / 2 - 1)) % AZIMUTH_COUNT
}

/// What gets through to the observer along each row of a patch, `[band][row]`.
#[inline(always)]
fn transmittances<const FUSED: bool>(
    maker: &PatchMaker<'_>,
    sight_line: &SightLine,
    first_row: i32,
) -> [[f32; SIDE]; BAND_COUNT] {
    let (mut sines, mut cosines) = ([0f32; SIDE], [1f32; SIDE]);
    for row in 0..SIDE {
        let elevation =
            usize::try_from(first_row + row as i32).ok().and_then(|row| maker.elevations.get(row));
        [sines[row], cosines[row]] = elevation.copied().unwrap_or([0.0, 1.0]);
    }
    sight_line.transmittance::<FUSED, SIDE>(maker.air, [&sines, &cosines])
}

/// Makes the image of a node unless it is cached, and says where it is.
#[inline(always)]
fn image_node<const FUSED: bool>(
    maker: &mut PatchMaker<'_>,
    key: NodeKey,
    rows: std::ops::Range<usize>,
) -> usize {
    let known = &mut maker.cached[slot(key)];
    let at = match *known {
        Some((of, at)) if of == key => return at,
        Some((_, at)) => at,
        None => {
            maker.images.push([[[0.0; BOTH_SIDES]; BAND_COUNT]; SIDE]);
            maker.images.len() - 1
        }
    };
    *known = Some((key, at));
    let (ring, offset, first_row) = key;
    let offset_m = maker.set.offset_axis()[ring as usize].offset_m(f64::from(offset));
    let sight_line = SightLine::new(maker.air, ring_distance_m(ring as usize), offset_m);
    let transmittance = transmittances::<FUSED>(maker, &sight_line, first_row);
    for row in rows {
        let transmittance = transmittance.map(|of_band| of_band[(row as i32 - first_row) as usize]);
        let elevation = maker.elevations[row];
        let mut columns = [[0f32; HALF]; BAND_COUNT];
        for (vector, [cosines, sines]) in maker.azimuths.0.iter().enumerate() {
            let radiance =
                sight_line.radiance::<FUSED, LANES>(maker.air, transmittance, elevation, [cosines, sines]);
            for (lane, &(column, weight)) in maker.shares.iter().skip(vector * LANES).take(LANES).enumerate()
            {
                for band in 0..BAND_COUNT {
                    columns[band][column] += weight * radiance[band][lane];
                }
            }
        }
        maker.images[at][(row as i32 - first_row) as usize] =
            columns.map(|half| std::array::from_fn(|column| half[column.abs_diff(HALF - 1)]));
    }
    at
}

/// How much of a patch counts at a distance from its light in columns or rows.
#[inline(always)]
fn taper(distance: f32) -> f32 {
    ((REACH - distance.abs()) / (REACH - FULL_WITHIN)).clamp(0.0, 1.0)
}

simd_dispatch! {
    /// The patch of a light, W m⁻² sr⁻¹.
    fn fill(
        maker: &mut PatchMaker<'_>,
        light: &SelectedLight,
        flux_per_dnb_flux: [f32; BAND_COUNT],
        limit: &GridLimit,
        patch: &mut OfBands<SIDE>,
    ) = fill_body::<FUSED>;
}

#[inline(always)]
fn fill_body<const FUSED: bool>(
    maker: &mut PatchMaker<'_>,
    light: &SelectedLight,
    flux_per_dnb_flux: [f32; BAND_COUNT],
    limit: &GridLimit,
    patch: &mut OfBands<SIDE>,
) {
    let step = azimuth_rad(1) as f32;
    let along = light.column - light.column.floor();
    let (mut cosines, mut sines, mut tapers) = ([0f32; LANES], [0f32; LANES], [0f32; LANES]);
    for lane in 0..LANES {
        let from = lane as f32 - (SIDE / 2 - 1) as f32 - along;
        // Within a tenth of a radian their series are right to 1e-8.
        let (x, square) = (from * step, from * step * from * step);
        sines[lane] = x * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0)));
        cosines[lane] = 1.0 - square * (0.5 - square * (1.0 / 24.0));
        tapers[lane] = light.weight * taper(from);
    }
    let NodeFractions { out, up } = light.fractions;
    let weights = [(1.0 - out, up[0]), (out, up[1])]
        .map(|(of_ring, up): (f32, f32)| [of_ring * (1.0 - up), of_ring * up]);
    let PatchNodes { ring, offsets, first_row } = light.nodes;
    let mut nodes = [(0, 0f32); 4];
    for (node, at) in nodes.iter_mut().zip(0u32..) {
        let (next, above) = (at / 2, at % 2);
        let key = (ring + next, offsets[next as usize] + above, first_row);
        let weight = weights[next as usize][above as usize];
        *node = (image_node::<FUSED>(maker, key, light.nodes.rows()), weight);
    }
    let transmittance = transmittances::<FUSED>(maker, &light.sight_line, first_row);
    let first_column = first_column(light);
    for row in light.nodes.rows() {
        let at = (row as i32 - light.nodes.first_row) as usize;
        let elevation = maker.elevations[row];
        let transmittance = transmittance.map(|of_band| of_band[at]);
        let exact = light.sight_line.radiance::<FUSED, LANES>(
            maker.air,
            transmittance,
            elevation,
            [&cosines, &sines],
        );
        let of_row = taper(row as f32 - light.row);
        for band in 0..BAND_COUNT {
            // The light's own column is the fourth; a part of it stands on the fifth.
            let (mut own, mut next) = ([0f32; LANES], [0f32; LANES]);
            for (node, weight) in nodes {
                let of_node = &maker.images[node][at][band];
                for lane in 0..LANES {
                    own[lane] = multiply_add::<FUSED>(weight, of_node[lane + 1], own[lane]);
                    next[lane] = multiply_add::<FUSED>(weight, of_node[lane], next[lane]);
                }
            }
            let flux = light.flux_dnb_w * flux_per_dnb_flux[band];
            let limit = limit.from(band, row, first_column);
            for lane in 0..LANES {
                let of_grid = (flux * (own[lane] + along * (next[lane] - own[lane]))).min(limit[lane]);
                patch[at][band][lane] = of_row * tapers[lane] * (flux * exact[band][lane] - of_grid);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{near_field::sight_line::tests::elevation_of, synthetic};
    use skyglow_physics::{Atmosphere, EmissionMix, Turbidity, near_light::NearScattering};

    #[test]
    fn no_more_is_taken_than_the_grid_has() {
        let set = TableSet::new(synthetic::table_set(&[2.0], 8)).unwrap();
        let scattering = NearScattering::of(EmissionMix::garstang());
        let air = Air::new(scattering, &Atmosphere::new(Turbidity::new(2.0).unwrap()), 640.0);
        // A kilometre above the eye and two away, seen across north.
        let (distance_m, offset_m) = (2_000.0, 1_000.0);
        let sight_line = SightLine::new(&air, f64::from(distance_m), f64::from(offset_m));
        let row = elevation_of(&sight_line) / azimuth_rad(1) as f32 - 0.5;
        let (nodes, fractions) = PatchNodes::of(&set, distance_m, offset_m, row);
        let light = SelectedLight {
            index: 0,
            nodes,
            fractions,
            sight_line,
            row,
            column: 0.4,
            flux_dnb_w: 1.0,
            weight: 1.0,
        };
        let changed = |sky: f32| {
            let limit = GridLimit::new(&vec![sky; Panorama::LEN], 0.9);
            let mut changes = vec![0f32; Panorama::LEN];
            PatchMaker::new(&air, &set).for_each(&light, [1.0; BAND_COUNT], &limit, |at, values| {
                changes[at..].iter_mut().zip(values).for_each(|(change, value)| *change += value);
            });
            changes
        };
        let [bright, dim] = [1.0, 1e-10].map(changed);
        let least = |changes: &[f32]| changes.iter().copied().fold(f32::INFINITY, f32::min);
        assert!(least(&bright) < -5e-9 && least(&dim) >= -0.9e-10, "{} {}", least(&bright), least(&dim));
        // What is put there instead is the same, so that nothing else differs; on both sides of north there is some.
        let differs = |at: usize| bright[at] != dim[at];
        for (at, (bright, dim)) in bright.iter().zip(&dim).enumerate() {
            assert!(dim >= bright, "{at}: {bright} {dim}");
        }
        let first = Panorama::index(1, row as usize, 0);
        assert!(differs(first) && differs(first + AZIMUTH_COUNT - 1) && !differs(first + AZIMUTH_COUNT / 2));
    }
}
