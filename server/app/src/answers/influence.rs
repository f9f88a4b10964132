//! Which lights cause a sky.

use super::Assumptions;
use crate::format::rounded;
use serde::Serialize;
use skyglow_observatory::{InfluenceMap, Measure, Part, RING_EDGES_M, SECTOR_COUNT};
use skyglow_scene::Boundary;
use utoipa::ToSchema;

/// Names of the sectors, clockwise from that around north.
const SECTOR_NAMES: [&str; SECTOR_COUNT] = ["N", "NE", "E", "SE", "S", "SW", "W", "NW"];

/// A lit pixel and its part.
#[derive(Clone, Debug, Default, Serialize, ToSchema)]
pub struct InfluentialPixel {
    /// Place in the list, from 1.
    pub rank: usize,
    /// Centre, degrees north.
    pub latitude_deg: f64,
    /// Centre, degrees east.
    pub longitude_deg: f64,
    /// Column on the scene's raster, from 0, as its geotransform counts.
    pub column: u32,
    /// Row, the same way.
    pub row: u32,
    /// Distance of the centre along the ground, metres.
    pub distance_m: f64,
    /// Azimuth of the centre from the observer, degrees clockwise from north.
    pub azimuth_deg: f64,
    /// The raster's radiance, nW cm⁻² sr⁻¹, without the calibration.
    pub radiance_nw_cm2_sr: f64,
    /// Upward flux, DNB watts, calibration included.
    pub flux_dnb_w: f64,
    /// What the pixel does to the measure, in `unit`.
    pub influence: f64,
    /// Its part of `total`.
    pub share: f64,
    /// Parts of this pixel and all before it in the list.
    pub cumulative_share: f64,
}

/// Some lights together.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
pub struct PartAnswer {
    /// Sum of their influences, in `unit`.
    pub influence: f64,
    /// Their part of `total`.
    pub share: f64,
    /// Their upward flux, DNB watts, calibration included.
    pub flux_dnb_w: f64,
    /// Number of lit pixels.
    pub pixels: u64,
}

impl PartAnswer {
    /// A part of influences that sum to `total`.
    pub fn new(part: Part, total: f64) -> Self {
        let Part { influence, flux_dnb_w, pixels } = part;
        Self { influence, share: share(influence, total), flux_dnb_w, pixels }
    }
}

/// Lights at some distance.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct RingAnswer {
    /// Nearest, metres.
    pub distance_from_m: f64,
    /// Farthest, metres.
    pub distance_to_m: f64,
    /// What they do.
    #[serde(flatten)]
    pub part: PartAnswer,
}

/// Lights in some direction.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct SectorAnswer {
    /// `N`, `NE`, … `NW`.
    pub name: String,
    /// First azimuth, degrees clockwise from north.
    pub azimuth_from_deg: f64,
    /// Last azimuth, degrees; below the first where the sector passes north.
    pub azimuth_to_deg: f64,
    /// What they do.
    #[serde(flatten)]
    pub part: PartAnswer,
}

/// Which lights within 300 km cause a measure of a sky: the most influential pixels, and all by distance and direction.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct InfluenceAnswer {
    /// What the numbers depend on.
    #[serde(flatten)]
    pub assumptions: Assumptions,
    /// `norm`, `zenith`, `mean`, `horizontal` or `region`.
    pub measure: String,
    /// Unit of influences: `cd m-2`, `lx`, or `cd m-2 sr0.5` of the norm.
    pub unit: String,
    /// Sum over all lights. For every measure but `norm` it is the sky's own value of it.
    pub total: f64,
    /// Lit pixels within 300 km.
    pub lit_pixels: u64,
    /// What the pixels' influences were multiplied by to add up to the sky's own value, which takes far lights in cells
    /// and blocks: 1 for `norm`.
    pub scale: f64,
    /// Solid angle of the visible directions in the region, sr; null for other measures.
    pub region_sr: Option<f64>,
    /// The most influential pixels, the most first.
    pub pixels: Vec<InfluentialPixel>,
    /// All lights by distance.
    pub rings: Vec<RingAnswer>,
    /// All lights by azimuth.
    pub sectors: Vec<SectorAnswer>,
    /// Lights inside the boundary that the body gave; null without.
    pub boundary: Option<PartAnswer>,
}

/// Said where a share of 0 could be taken for an answer.
const EMPTY_BOUNDARY: &str = "the boundary holds the centre of no lit pixel within 300 km: its share is 0";

fn share(influence: f64, total: f64) -> f64 {
    if total > 0.0 { influence / total } else { 0.0 }
}

/// The name of a measure in the interface.
pub const fn measure_name(measure: &Measure) -> &'static str {
    match measure {
        Measure::Norm => "norm",
        Measure::Zenith => "zenith",
        Measure::Mean => "mean",
        Measure::Horizontal => "horizontal",
        Measure::Region(_) => "region",
    }
}

/// The `limit` most influential pixels of a map whose influences sum to `total`.
pub fn influential_pixels(map: &InfluenceMap, total: f64, limit: usize) -> Vec<InfluentialPixel> {
    let mut cumulative = 0.0;
    let one = |(at, position): (usize, usize)| {
        let pixel = map.pixels()[position];
        let scene = map.open_scene();
        let (column, row) = scene.column_and_row(pixel.number);
        let place = map.place(position);
        let influence = f64::from(map.influence()[position]);
        cumulative += influence;
        InfluentialPixel {
            rank: at + 1,
            latitude_deg: rounded(place.latitude_deg()),
            longitude_deg: rounded(place.longitude_deg()),
            column,
            row,
            distance_m: f64::from(pixel.distance_m),
            azimuth_deg: f64::from(pixel.azimuth_rad).to_degrees(),
            radiance_nw_cm2_sr: f64::from(scene.lit_radiance_nw_cm2_sr(pixel.number)),
            flux_dnb_w: f64::from(pixel.flux_dnb_w),
            influence,
            share: share(influence, total),
            cumulative_share: share(cumulative, total),
        }
    };
    map.most(limit).into_iter().enumerate().map(one).collect()
}

impl InfluenceAnswer {
    /// The answer from a map.
    pub fn new(
        mut assumptions: Assumptions,
        map: &InfluenceMap,
        measure: &Measure,
        limit: usize,
        boundary: Option<&Boundary>,
    ) -> Self {
        let total = map.total().influence;
        let unit = measure.unit(&assumptions.response.unit);
        let part = |part: Part| PartAnswer::new(part, total);
        let ring = |(edges, of): (&[f64], Part)| RingAnswer {
            distance_from_m: edges[0],
            distance_to_m: edges[1],
            part: part(of),
        };
        let step_deg = 360.0 / SECTOR_COUNT as f64;
        let sector = |(at, of): (usize, Part)| SectorAnswer {
            name: SECTOR_NAMES[at].to_owned(),
            azimuth_from_deg: ((at as f64 - 0.5) * step_deg).rem_euclid(360.0),
            azimuth_to_deg: (at as f64 + 0.5) * step_deg,
            part: part(of),
        };
        let boundary = boundary.map(|boundary| part(map.within(boundary)));
        if boundary.as_ref().is_some_and(|inside| inside.pixels == 0) {
            assumptions.warnings.push(EMPTY_BOUNDARY.to_owned());
        }
        Self {
            assumptions,
            measure: measure_name(measure).to_owned(),
            unit,
            total,
            lit_pixels: map.pixels().len() as u64,
            scale: map.scale,
            region_sr: map.region_sr,
            pixels: influential_pixels(map, total, limit),
            rings: RING_EDGES_M.windows(2).zip(map.rings()).map(ring).collect(),
            sectors: map.sectors().into_iter().enumerate().map(sector).collect(),
            boundary,
        }
    }
}
