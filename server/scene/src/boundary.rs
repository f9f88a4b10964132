//! Areas on the ground, such as a municipality: GeoJSON polygons (RFC 7946), with point-in-polygon tests by ray casting and the
//! even–odd rule over sides sorted into bands of latitude.

use glam::DVec3;
use serde::Serialize;
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint};
use std::f64::consts::PI;
use thiserror::Error;

/// Maximum number of corners of all rings of a boundary together.
pub const MAX_BOUNDARY_CORNERS: usize = 50_000;
/// Longitudes may continue beyond ±180° around the Earth, up to this, degrees.
const MAX_LONGITUDE_DEG: f64 = 360.0;
/// Bands of latitude that sides are sorted into, at most.
const MAX_BANDS: usize = 4096;
/// Sides that a place is compared with, in the mean over the bands, at most: coasts have tens, and with thousands a million
/// lights would take minutes.
const MAX_SIDES_PER_BAND: usize = 1000;

/// Longitude and latitude, degrees.
pub type Position = [f64; 2];

/// Why polygons bound no area.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BoundaryError {
    /// No polygon, a polygon without rings, or a ring without corners.
    #[error("it is empty: at least one polygon with an outer ring is needed")]
    Empty,
    /// More corners than are taken.
    #[error("{count} corners, at most {MAX_BOUNDARY_CORNERS} are taken")]
    TooManyCorners {
        /// Corners given.
        count: usize,
    },
    /// Sides that overlap so many others' latitudes that the point-in-polygon test would be slow.
    #[error(
        "it is too intricate: {sides} sides lie at the same latitude, in the mean, at most {MAX_SIDES_PER_BAND} are taken"
    )]
    TooIntricate {
        /// Sides in a band of latitude, in the mean.
        sides: usize,
    },
    /// A corner that is no place.
    #[error("longitude {}, latitude {} is no place", position[0], position[1])]
    NoPlace {
        /// The corner.
        position: Position,
    },
    /// A ring whose last corner is not its first.
    #[error("a ring is open: its last corner must be its first")]
    Open,
    /// A ring with fewer than three corners, or all of them on a line.
    #[error("a ring encloses no area")]
    Flat,
    /// A side that crosses the antimeridian by jumping from one end of the longitudes to the other.
    #[error(
        "a side spans {span_deg} degrees of longitude: cut the polygon at the antimeridian, or count longitudes on beyond 180"
    )]
    Jump {
        /// Degrees of longitude from corner to corner.
        span_deg: f64,
    },
}

/// An area bounded by polygons; a place in any of them is inside.
///
/// Sides are straight in longitude and latitude. Holes are outside; where rings of one polygon overlap, an even number of rings
/// around a place leaves it outside.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Boundary {
    west_deg: f64,
    east_deg: f64,
    south_deg: f64,
    north_deg: f64,
    /// Sides of all polygons, each with its polygon's number, polygon by polygon.
    sides: Vec<(u32, [Position; 2])>,
    /// Sides of band b of latitude are `in_band[band_start[b]..band_start[b + 1]]`, ascending.
    band_start: Vec<u32>,
    in_band: Vec<u32>,
}

impl Boundary {
    /// From polygons of closed rings, the outer one first.
    ///
    /// # Errors
    /// [`BoundaryError`].
    pub fn new(polygons: &[Vec<Vec<Position>>]) -> Result<Self, BoundaryError> {
        let count: usize = polygons.iter().flatten().map(Vec::len).sum();
        if count > MAX_BOUNDARY_CORNERS {
            return Err(BoundaryError::TooManyCorners { count });
        }
        if polygons.is_empty() || polygons.iter().any(Vec::is_empty) {
            return Err(BoundaryError::Empty);
        }
        polygons.iter().flatten().try_for_each(|ring| check(ring))?;
        let sides: Vec<(u32, [Position; 2])> = (0u32..)
            .zip(polygons)
            .flat_map(|(polygon, rings)| rings.iter().map(move |ring| (polygon, ring)))
            .flat_map(|(polygon, ring)| ring.windows(2).map(move |pair| (polygon, [pair[0], pair[1]])))
            .collect();
        let corners = || sides.iter().map(|(_, side)| side[0]);
        let min = |axis: usize| corners().map(|corner| corner[axis]).fold(f64::INFINITY, f64::min);
        let max = |axis: usize| corners().map(|corner| corner[axis]).fold(f64::NEG_INFINITY, f64::max);
        let mut boundary = Self {
            west_deg: min(0),
            east_deg: max(0),
            south_deg: min(1),
            north_deg: max(1),
            sides,
            band_start: Vec::new(),
            in_band: Vec::new(),
        };
        boundary.sort_into_bands()?;
        Ok(boundary)
    }

    /// Whether a place is inside. Places right on a side may fall either way.
    pub fn contains(&self, place: GeoPoint) -> bool {
        let (longitude_deg, latitude_deg) = (place.longitude_deg(), place.latitude_deg());
        [-360.0, 0.0, 360.0].iter().any(|turn_deg| self.contains_at(longitude_deg + turn_deg, latitude_deg))
    }

    /// A circle around the area: its centre as a unit vector and its radius along the chord, metres; the whole sphere for
    /// large areas.
    pub fn circle(&self) -> (DVec3, f64) {
        const STEPS: u32 = 8;
        let (west, south, east, north) = (self.west_deg, self.south_deg, self.east_deg, self.north_deg);
        let whole = (DVec3::Z, 2.0 * EARTH_RADIUS_M);
        if east - west > 60.0 || north - south > 60.0 {
            return whole;
        }
        let place = |x: f64, y: f64| {
            let (longitude, latitude) = (west + x * (east - west), south + y * (north - south));
            GeoPoint::from_rad_unchecked(
                latitude.to_radians().clamp(-0.5 * PI, 0.5 * PI),
                longitude.to_radians(),
            )
            .unit_vector()
        };
        let points: Vec<DVec3> = (0..=STEPS)
            .map(|step| f64::from(step) / f64::from(STEPS))
            .flat_map(|at| [place(at, 0.0), place(at, 1.0), place(0.0, at), place(1.0, at)])
            .collect();
        let center = points.iter().sum::<DVec3>().normalize_or_zero();
        let radius = points.iter().map(|point| center.distance(*point)).fold(0.0, f64::max);
        if center == DVec3::ZERO { whole } else { (center, 1.1 * EARTH_RADIUS_M * radius + 1.0) }
    }

    /// Sides that a place is compared with, in the mean.
    pub(crate) fn sides_per_band(&self) -> usize {
        self.in_band.len() / (self.band_start.len() - 1).max(1)
    }

    fn sort_into_bands(&mut self) -> Result<(), BoundaryError> {
        let count = self.sides.len().clamp(1, MAX_BANDS);
        let bands = |side: &[Position; 2]| {
            let [a, b] = side.map(|corner| self.band_at(corner[1], count));
            a.min(b)..=a.max(b)
        };
        let entries: usize = self.sides.iter().map(|(_, side)| bands(side).count()).sum();
        let sides = entries / count;
        if sides > MAX_SIDES_PER_BAND {
            return Err(BoundaryError::TooIntricate { sides });
        }
        let mut in_bands: Vec<Vec<u32>> = vec![Vec::new(); count];
        for (number, (_, side)) in (0u32..).zip(&self.sides) {
            in_bands[bands(side)].iter_mut().for_each(|band| band.push(number));
        }
        let ends = in_bands.iter().scan(0, |end, band| {
            *end += band.len() as u32;
            Some(*end)
        });
        self.band_start = std::iter::once(0).chain(ends).collect();
        self.in_band = in_bands.concat();
        Ok(())
    }

    fn band_at(&self, latitude_deg: f64, count: usize) -> usize {
        let part = (latitude_deg - self.south_deg) / (self.north_deg - self.south_deg);
        ((part * count as f64) as usize).min(count - 1)
    }

    fn contains_at(&self, longitude_deg: f64, latitude_deg: f64) -> bool {
        let inside = |low: f64, value: f64, high: f64| low <= value && value <= high;
        if !inside(self.west_deg, longitude_deg, self.east_deg)
            || !inside(self.south_deg, latitude_deg, self.north_deg)
        {
            return false;
        }
        let band = self.band_at(latitude_deg, self.band_start.len() - 1);
        let numbers = self.band_start[band] as usize..self.band_start[band + 1] as usize;
        let crosses_east = |side: &[Position; 2]| {
            let [a, b] = side;
            (a[1] > latitude_deg) != (b[1] > latitude_deg)
                && longitude_deg < a[0] + (latitude_deg - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        };
        let polygons = self.in_band[numbers].chunk_by(|a, b| self.polygon(*a) == self.polygon(*b));
        polygons.into_iter().any(|sides| {
            sides.iter().filter(|number| crosses_east(&self.sides[**number as usize].1)).count() % 2 == 1
        })
    }

    fn polygon(&self, side: u32) -> u32 {
        self.sides[side as usize].0
    }
}

/// Refuses a ring that bounds nothing.
fn check(ring: &[Position]) -> Result<(), BoundaryError> {
    let (Some(first), Some(last)) = (ring.first(), ring.last()) else { return Err(BoundaryError::Empty) };
    let is_place = |[longitude_deg, latitude_deg]: &Position| {
        longitude_deg.abs() <= MAX_LONGITUDE_DEG && latitude_deg.abs() <= 90.0
    };
    if let Some(&position) = ring.iter().find(|position| !is_place(position)) {
        return Err(BoundaryError::NoPlace { position });
    }
    if first != last {
        return Err(BoundaryError::Open);
    }
    // Whole turns are sides along the edges of a map of the world.
    let jumps = ring.windows(2).map(|pair| (pair[1][0] - pair[0][0]).abs());
    if let Some(span_deg) = jumps.into_iter().find(|&span_deg| span_deg > 180.0 && span_deg != 360.0) {
        return Err(BoundaryError::Jump { span_deg });
    }
    let origin = ring[0];
    let twice_area = |pair: &[Position]| {
        let [a, b] = [pair[0], pair[1]].map(|corner| [corner[0] - origin[0], corner[1] - origin[1]]);
        (a[0] * b[1] - b[0] * a[1]).abs()
    };
    if ring.windows(2).map(twice_area).fold(0.0, f64::max) == 0.0 { Err(BoundaryError::Flat) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn boundary(polygons: &[&[&[Position]]]) -> Result<Boundary, BoundaryError> {
        let polygons: Vec<Vec<Vec<Position>>> =
            polygons.iter().map(|rings| rings.iter().map(|ring| ring.to_vec()).collect()).collect();
        Boundary::new(&polygons)
    }

    fn contains(boundary: &Boundary, longitude_deg: f64, latitude_deg: f64) -> bool {
        boundary.contains(GeoPoint::from_deg(latitude_deg, longitude_deg).unwrap())
    }

    fn square(west: f64, south: f64, side: f64) -> [Position; 5] {
        let (east, north) = (west + side, south + side);
        [[west, south], [east, south], [east, north], [west, north], [west, south]]
    }

    #[test]
    fn a_hole_is_outside_and_a_second_polygon_inside() {
        let area =
            boundary(&[&[&square(7.0, 46.0, 1.0), &square(7.25, 46.25, 0.5)], &[&square(9.0, 46.0, 0.1)]])
                .unwrap();
        assert!(contains(&area, 7.1, 46.5) && contains(&area, 9.05, 46.05));
        assert!(!contains(&area, 7.5, 46.5) && !contains(&area, 8.5, 46.5) && !contains(&area, 7.5, 45.9));
    }

    /// Longitudes continue beyond 180° across the antimeridian, and the world is one square.
    #[test]
    fn longitudes_may_exceed_180_degrees() {
        let fiji = boundary(&[&[&square(177.0, -19.0, 4.0)]]).unwrap();
        assert!(
            contains(&fiji, 178.0, -17.0)
                && contains(&fiji, -179.5, -17.0)
                && !contains(&fiji, -178.5, -17.0)
        );
        let west = boundary(&[&[&square(-181.0, -19.0, 2.0)]]).unwrap();
        assert!(
            contains(&west, 179.5, -18.0) && contains(&west, -179.5, -18.0) && !contains(&west, 178.0, -18.0)
        );
        let world = boundary(&[&[&[
            [-180.0, -90.0],
            [180.0, -90.0],
            [180.0, 90.0],
            [-180.0, 90.0],
            [-180.0, -90.0],
        ]]])
        .unwrap();
        assert!(contains(&world, 0.0, 0.0) && contains(&world, 179.9, -80.0));
    }

    /// Overlapping polygons are united and do not cut each other out.
    #[test]
    fn overlapping_polygons_are_united() {
        let (a, b) = (square(7.0, 46.0, 1.0), square(7.5, 46.5, 1.0));
        let area = boundary(&[&[&a], &[&b]]).unwrap();
        assert!(contains(&area, 7.75, 46.75) && contains(&area, 7.2, 46.2) && contains(&area, 8.4, 47.4));
        assert!(!contains(&area, 7.2, 47.2) && !contains(&area, 8.2, 46.2));
        // As two rings of one polygon they do.
        assert!(!contains(&boundary(&[&[&a, &b]]).unwrap(), 7.75, 46.75));
    }

    #[test]
    fn what_bounds_no_area_is_refused_and_said_why() {
        let refused = |polygons: &[&[&[Position]]]| boundary(polygons).unwrap_err();
        assert_eq!(refused(&[]), BoundaryError::Empty);
        assert_eq!(refused(&[&[]]), BoundaryError::Empty);
        assert_eq!(refused(&[&[&[]]]), BoundaryError::Empty);
        assert_eq!(refused(&[&[&square(7.0, 46.0, 1.0)[..4]]]), BoundaryError::Open);
        assert_eq!(refused(&[&[&[[7.0, 46.0], [8.0, 47.0], [7.0, 46.0]]]]), BoundaryError::Flat);
        assert_eq!(refused(&[&[&[[7.0, 46.0]]]]), BoundaryError::Flat);
        assert!(matches!(refused(&[&[&square(f64::NAN, 46.0, 1.0)]]), BoundaryError::NoPlace { .. }));
        assert!(matches!(refused(&[&[&square(7.0, 89.5, 1.0)]]), BoundaryError::NoPlace { .. }));
        let jump = [[179.0, 0.0], [-179.0, 0.0], [-179.0, 1.0], [179.0, 1.0], [179.0, 0.0]];
        assert_eq!(refused(&[&[&jump]]), BoundaryError::Jump { span_deg: 358.0 });
        let mut comb: Vec<Position> =
            (0..20_000).map(|tooth| [7.0 + 1e-4 * f64::from(tooth), 46.0 + f64::from(tooth % 2)]).collect();
        comb.push(comb[0]);
        assert!(matches!(refused(&[&[&comb]]), BoundaryError::TooIntricate { sides: 19_000.. }));
        let many = vec![[7.0, 46.0]; MAX_BOUNDARY_CORNERS + 1];
        assert!(matches!(refused(&[&[&many]]), BoundaryError::TooManyCorners { .. }));
    }

    proptest! {
        #[test]
        fn bands_change_nothing(
            ring in prop::collection::vec((5.0f64..9.0, 44.0f64..48.0), 3..60),
            places in prop::collection::vec((4.5f64..9.5, 43.5f64..48.5), 40),
        ) {
            let mut ring: Vec<Position> = ring.into_iter().map(|(x, y)| [x, y]).collect();
            ring.push(ring[0]);
            let area = boundary(&[&[&ring]]).unwrap();
            for (x, y) in places {
                let crossings = ring.windows(2).filter(|pair| {
                    let [a, b] = [pair[0], pair[1]];
                    (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
                });
                // Degrees go through radians and back.
                let near = |pair: &[Position]| {
                    let [a, b] = [pair[0], pair[1]];
                    let cross = (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
                    cross.abs() < 1e-9
                };
                prop_assume!(!ring.windows(2).any(near) && ring.iter().all(|corner| (corner[1] - y).abs() > 1e-9));
                prop_assert_eq!(contains(&area, x, y), crossings.count() % 2 == 1);
            }
        }
    }
}
