//! The elevation of a place: bilinear in the first raster that has a value, else the nearest valid sample within 5 km.

use super::joining;
use super::raster::TerrainRaster;
use crate::grid::Grid;
use crate::ground::Ground;
use crate::sections::{Flaw, Sections};
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint, Slope};
use std::{
    borrow::Cow,
    f64::consts::{FRAC_PI_2, PI},
    fs::File,
};

/// Missing terrain is taken from the nearest valid sample within this, metres: under lights and observers alike.
const MAX_FILL_DISTANCE_M: f64 = 5_000.0;
/// Rings searched for the nearest valid sample, at most; finer terrain is searched at a stride.
const MAX_SEARCH_RINGS: i64 = 40;

/// Elevation from one or more rasters; where they overlap, the first that has a value counts.
#[derive(Debug, Default)]
pub(crate) struct Terrain {
    pub(crate) rasters: Vec<TerrainRaster>,
}

impl Terrain {
    /// Rasters with what lies around each of them, so that elevation is bilinear from one to the next.
    pub(crate) fn joined(mut rasters: Vec<TerrainRaster>) -> Self {
        joining::join(&mut rasters);
        Self { rasters }
    }

    /// Rasters as they are.
    pub(crate) fn new(rasters: Vec<TerrainRaster>) -> Self {
        Self { rasters }
    }

    /// Bytes of memory that it takes, about.
    pub(crate) fn byte_count(&self) -> u64 {
        self.rasters.iter().map(TerrainRaster::byte_count).sum()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.rasters.is_empty()
    }

    /// Elevation at a place, metres, bilinear between sample centres; may be negative. `None` where there
    /// is none.
    pub(crate) fn elevation_m(&self, place: GeoPoint) -> Option<f64> {
        self.rasters.iter().find_map(|raster| raster.bilinear_m(0, place))
    }

    /// The same from overviews whose samples are not much finer than `resolution_m`.
    pub(crate) fn overview_m(&self, place: GeoPoint, resolution_m: f64) -> Option<f64> {
        self.rasters.iter().find_map(|raster| raster.overview_m(place, resolution_m))
    }

    /// How the ground lies at a place, by differences over two samples of the raster that has a value there; level where one of them
    /// is missing.
    pub(crate) fn slope(&self, place: GeoPoint) -> Slope {
        let Some(raster) = self.rasters.iter().find(|raster| raster.bilinear_m(0, place).is_some()) else {
            return Slope::default();
        };
        let step_m = raster.sample_size_m();
        let at = |azimuth_rad: f64| self.elevation_m(place.destination(azimuth_rad, step_m));
        let [north_m, east_m, south_m, west_m] = [0.0, FRAC_PI_2, PI, 1.5 * PI].map(at);
        let rise =
            |ahead_m: Option<f64>, behind_m: Option<f64>| Some((ahead_m? - behind_m?) / (2.0 * step_m));
        let gradient = rise(east_m, west_m).zip(rise(north_m, south_m));
        gradient.map_or_else(Slope::default, |(to_east, to_north)| Slope::of_gradient(to_east, to_north))
    }

    /// The nearest valid elevation within [`MAX_FILL_DISTANCE_M`], metres, and its distance, to about a
    /// fortieth of that distance.
    fn nearest_m(&self, place: GeoPoint) -> Option<(f64, f64)> {
        let found = self.rasters.iter().filter_map(|raster| nearest_in(raster, place));
        found.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The ground at a place by the model's rule: the terrain there, else its nearest valid sample within
    /// [`MAX_FILL_DISTANCE_M`], else unknown.
    pub(crate) fn ground(&self, place: GeoPoint) -> Ground {
        match self.elevation_m(place) {
            Some(elevation_m) => Ground::Here { elevation_m },
            None => self.nearest_m(place).map_or(Ground::Unknown, |(elevation_m, distance_m)| {
                Ground::Nearest { elevation_m, distance_m }
            }),
        }
    }

    /// The sections to store.
    pub(crate) fn to_sections(&self) -> Vec<(String, Cow<'_, [u8]>)> {
        let mut sections: Vec<(String, Cow<'_, [u8]>)> =
            vec![("layers".into(), Cow::Owned((self.rasters.len() as u32).to_le_bytes().to_vec()))];
        for (index, raster) in self.rasters.iter().enumerate() {
            sections.extend(raster.to_sections(index));
        }
        sections
    }

    /// Undoes [`Self::to_sections`].
    ///
    /// * `file`: in which large sections stay.
    pub(crate) fn from_sections(sections: &Sections<'_>, file: Option<&File>) -> Result<Self, Flaw> {
        let count = *sections.numbers::<u32>("layers")?.first().ok_or("has no layer count")?;
        let rasters = (0..count as usize).map(|index| TerrainRaster::from_sections(sections, index, file));
        Ok(Self { rasters: rasters.collect::<Result<_, _>>()? })
    }
}

fn nearest_in(raster: &TerrainRaster, place: GeoPoint) -> Option<(f64, f64)> {
    let grid = raster.grid();
    let reach = MAX_FILL_DISTANCE_M / raster.sample_size_m();
    let stride = (reach / MAX_SEARCH_RINGS as f64).ceil().max(1.0) as i64;
    let (column, row) = position_near(grid, place, reach)?;
    let target = place.unit_vector();
    let mut best: Option<(f64, f64)> = None;
    // A square ring holds places from its own distance to √2 of it: look 1.5 times as far as a hit. Along a
    // parallel a sample is shorter than the mean size by up to the cosine of the latitude.
    let rings = ((reach * anisotropy(grid, row)) / stride as f64).ceil() as i64 + 1;
    let mut last_ring = rings.min(8 * MAX_SEARCH_RINGS);
    let mut ring = 0;
    while ring <= last_ring {
        for (dc, dr) in square_ring(ring) {
            let Some(elevation_m) = raster.sample_m(0, column + dc * stride, row + dr * stride) else {
                continue;
            };
            let (c, r) = ((column + dc * stride) as u32, (row + dr * stride) as u32);
            let distance_m = EARTH_RADIUS_M * grid.center(c, r).distance(target);
            if distance_m <= MAX_FILL_DISTANCE_M && best.is_none_or(|(_, d)| distance_m < d) {
                if best.is_none() {
                    last_ring = last_ring.min(ring + ring / 2 + 1);
                }
                best = Some((elevation_m, distance_m));
            }
        }
        ring += 1;
    }
    best
}

/// The sample under a place, or where it would be if the place is a little outside the grid.
fn position_near(grid: &Grid, place: GeoPoint, reach: f64) -> Option<(i64, i64)> {
    if let Some((column, row)) = grid.pixel_at(place) {
        return Some((i64::from(column), i64::from(row)));
    }
    let axes = grid.axes()?;
    let mut column = (place.longitude_deg() - axes.first_longitude_deg) / axes.longitude_step_deg;
    let turn = 360.0 / axes.longitude_step_deg;
    column -= turn * ((column - 0.5 * f64::from(grid.width)) / turn).round();
    let row = (place.latitude_deg() - axes.first_latitude_deg) / axes.latitude_step_deg;
    let slack = 3.0 * reach + 1.0;
    let near = (-slack..f64::from(grid.width) + slack).contains(&column)
        && (-slack..f64::from(grid.height) + slack).contains(&row);
    near.then_some((column.floor() as i64, row.floor() as i64))
}

/// How much more samples fit into a distance along the parallel than by the mean sample size.
fn anisotropy(grid: &Grid, row: i64) -> f64 {
    let row = row.clamp(0, i64::from(grid.height) - 1) as u32;
    let [a, b, c, _] = grid.corners(grid.width / 2, row);
    let (wide, high) = (a.distance(b), b.distance(c));
    let mean = (wide * high).sqrt();
    if mean.is_finite() && mean > 0.0 { (mean / wide.min(high)).clamp(1.0, 8.0) } else { 1.0 }
}

/// The offsets of a square ring around the origin.
fn square_ring(ring: i64) -> impl Iterator<Item = (i64, i64)> {
    let rows = -ring..=ring;
    rows.flat_map(move |dr| {
        let step = if dr.abs() == ring { 1 } else { (2 * ring).max(1) };
        (-ring..=ring).step_by(step as usize).map(move |dc| (dc, dr))
    })
}
