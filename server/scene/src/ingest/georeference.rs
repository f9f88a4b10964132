//! Georeferencing: from a geotransform and a CRS to the grid on the sphere.

use super::gdal_open::gdal_reason;
use crate::grid::{GeographicAxes, Grid};
use crate::lattice::{Lattice, node_count, node_position};
use gdal::spatial_ref::{AxisMappingStrategy, CoordTransform, SpatialRef};
use glam::DVec3;
use skyglow_physics::GeoPoint;

/// Bilinear places between lattice nodes are within this part of a pixel.
const LATTICE_TOLERANCE_PX: f64 = 0.01;
/// Pixels outside this range come from a wrong CRS, metres.
const PIXEL_SIZE_M: std::ops::RangeInclusive<f64> = 1.0..=200_000.0;
/// A datum whose places differ by less than this from WGS 84 is taken as it (0.01 m), degrees.
const SAME_DATUM_DEG: f64 = 1e-7;

/// A raster's pixels on the sphere.
struct Georeference<'a> {
    transform: &'a [f64; 6],
    width: u32,
    height: u32,
    to_wgs84: CoordTransform,
    from_wgs84: CoordTransform,
}

/// The grid of a raster.
///
/// # Errors
/// A sentence that says why the raster cannot lie where it says.
pub(super) fn grid(
    transform: &[f64; 6],
    crs: &SpatialRef,
    (width, height): (usize, usize),
) -> Result<Grid, String> {
    let name = crs.name().unwrap_or_else(|| "its CRS".to_owned());
    let size = |n: usize| u32::try_from(n).ok().filter(|n| (1..=1 << 24).contains(n));
    let (Some(width), Some(height)) = (size(width), size(height)) else {
        return Err(format!("a raster of {width} × {height} pixels is empty or too large"));
    };
    if !transform.iter().all(|g| g.is_finite()) || transform[1] * transform[5] == transform[2] * transform[4]
    {
        return Err("its geotransform is degenerate".to_owned());
    }
    check_code(crs, &name)?;
    check_grids(crs)?;
    if crs.is_geographic() {
        check_degrees(transform, width, height, &name)?;
    }
    let unknown = |error: gdal::errors::GdalError| {
        format!("GDAL cannot transform {name} to WGS 84: {}", gdal_reason(error))
    };
    let mut crs = crs.clone();
    crs.set_axis_mapping_strategy(AxisMappingStrategy::TraditionalGisOrder);
    let mut wgs84 = SpatialRef::from_epsg(4326).map_err(unknown)?;
    wgs84.set_axis_mapping_strategy(AxisMappingStrategy::TraditionalGisOrder);
    let georeference = Georeference {
        transform,
        width,
        height,
        to_wgs84: CoordTransform::new(&crs, &wgs84).map_err(unknown)?,
        from_wgs84: CoordTransform::new(&wgs84, &crs).map_err(unknown)?,
    };
    let grid = match georeference.geographic_axes(&crs) {
        Some(axes) => Grid::geographic(axes, width, height),
        None => Grid::from_lattice(georeference.lattice(&name)?),
    };
    let pixel_size_m = grid.pixel_size_m();
    if !PIXEL_SIZE_M.contains(&pixel_size_m) {
        return Err(format!(
            "a pixel would measure {pixel_size_m:.3} m on the ground, which cannot be meant; the coordinates are not of {name}"
        ));
    }
    Ok(grid)
}

/// Refuses a CRS that names files of shifts, for PROJ opens them.
fn check_grids(crs: &SpatialRef) -> Result<(), String> {
    let text = [crs.to_wkt(), crs.to_proj4()]
        .map(|text| text.unwrap_or_default().to_lowercase())
        .join(" ")
        .replace("nadgrids=@null", "");
    match ["grids=", "proj4_grids", "parameterfile"].iter().any(|word| text.contains(word)) {
        true => Err("its coordinate reference system refers to a file of shifts, which is not allowed; bring it to another: gdalwarp \
                     -t_srs EPSG:4326"
            .to_owned()),
        false => Ok(()),
    }
}

/// Whether the CRS is of the kind that its EPSG code names. PROJ looks the code up, and ends the program where it finds a CRS of
/// another kind than the one that it was given.
fn check_code(crs: &SpatialRef, name: &str) -> Result<(), String> {
    let (Some("EPSG"), Ok(code)) = (crs.auth_name().as_deref(), crs.auth_code()) else { return Ok(()) };
    let kind = |crs: &SpatialRef| (crs.is_geographic(), crs.is_projected());
    match u32::try_from(code).ok().and_then(|code| SpatialRef::from_epsg(code).ok()) {
        Some(known) if kind(&known) != kind(crs) => {
            let of_code = known.name().unwrap_or_else(|| "another".to_owned());
            Err(format!("it says that {name} is EPSG:{code}, which is another kind of CRS: {of_code}"))
        }
        _ => Ok(()),
    }
}

/// Whether the corners can be degrees.
fn check_degrees(g: &[f64; 6], width: u32, height: u32, name: &str) -> Result<(), String> {
    let (w, h) = (f64::from(width), f64::from(height));
    let corners = [(0.0, 0.0), (w, 0.0), (0.0, h), (w, h)]
        .map(|(c, r)| (g[0] + c * g[1] + r * g[2], g[3] + c * g[4] + r * g[5]));
    // Grids of pixel centres reach half a pixel over the poles and the whole circle.
    let slack = g[5].abs() + g[4].abs() + 1e-6;
    let (min, max) =
        corners.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), c| (a.min(c.0), b.max(c.0)));
    let spans_too_much = max - min > 360.0 + 2.0 * (g[1].abs() + g[2].abs());
    if let Some((x, y)) = corners
        .iter()
        .find(|(x, y)| y.abs() > 90.0 + slack || !(-360.0 - slack..=540.0 + slack).contains(x))
        // A raster from 350 to 370 crosses Greenwich; one that starts a whole turn away is not in degrees.
        .or(corners.first().filter(|_| spans_too_much || min >= 360.0 || max <= -360.0))
    {
        return Err(format!(
            "its corner ({x}, {y}) is no longitude and latitude, so {name} is not the CRS of this raster"
        ));
    }
    Ok(())
}

impl Georeference<'_> {
    /// CRS coordinates of a pixel position.
    fn apply(&self, column: f64, row: f64) -> (f64, f64) {
        let g = self.transform;
        (g[0] + column * g[1] + row * g[2], g[3] + column * g[4] + row * g[5])
    }

    /// The axes when rows and columns run along WGS 84 parallels and meridians.
    fn geographic_axes(&self, crs: &SpatialRef) -> Option<GeographicAxes> {
        let g = self.transform;
        if !crs.is_geographic() || g[2] != 0.0 || g[4] != 0.0 || g[1] <= 0.0 {
            return None;
        }
        let (w, h) = (f64::from(self.width), f64::from(self.height));
        let positions = [(0.0, 0.0), (w, 0.0), (0.5 * w, 0.5 * h), (0.0, h), (w, h)];
        let points: Vec<_> = positions.iter().map(|&(c, r)| self.apply(c, r)).collect();
        let places = transform(&self.to_wgs84, &points);
        let same = points.iter().zip(&places).all(|(a, b)| {
            let turn = (a.0 - b.0 + 180.0).rem_euclid(360.0) - 180.0;
            // Beyond the pole GDAL may fail; the half pixel there is cut off anyway.
            a.1.abs() > 90.0 || (turn.abs() < SAME_DATUM_DEG && (a.1 - b.1).abs() < SAME_DATUM_DEG)
        });
        same.then_some(GeographicAxes {
            first_longitude_deg: g[0],
            first_latitude_deg: g[3],
            longitude_step_deg: g[1],
            latitude_step_deg: g[5],
        })
    }

    /// Unit vectors at pixel positions; NaN where the position is no place, or not the place's only image.
    fn vectors(&self, positions: &[(f64, f64)]) -> Vec<DVec3> {
        let points: Vec<_> = positions.iter().map(|&(c, r)| self.apply(c, r)).collect();
        let places = transform(&self.to_wgs84, &points);
        let back = transform(&self.from_wgs84, &places);
        let g = self.transform;
        let pixel = (g[1] * g[5] - g[2] * g[4]).abs().sqrt();
        let vector = |index: usize| {
            let (point, place, back): (_, (f64, f64), _) = (points[index], places[index], back[index]);
            let miss = (point.0 - back.0).hypot(point.1 - back.1);
            // 360 degrees apart is the same meridian.
            let same = miss <= pixel || (miss - 360.0).abs() <= pixel;
            if !(same && place.1.abs() <= 90.0) {
                return DVec3::NAN;
            }
            GeoPoint::from_rad_unchecked(place.1.to_radians(), place.0.to_radians()).unit_vector()
        };
        (0..points.len()).map(vector).collect()
    }

    fn nodes(&self, step: u32) -> Vec<DVec3> {
        let mut positions = Vec::new();
        for j in 0..node_count(self.height, step) {
            for i in 0..node_count(self.width, step) {
                positions.push((node_position(i, self.width, step), node_position(j, self.height, step)));
            }
        }
        self.vectors(&positions)
    }

    /// The widest lattice that is true to the tolerance.
    fn lattice(&self, name: &str) -> Result<Lattice, String> {
        let off_world =
            || format!("its coordinates lie off the world in {name}, so that is not the CRS of this raster");
        let mut step = 64;
        loop {
            let nodes = self.nodes(step);
            if nodes.iter().filter(|node| node.is_finite()).count() * 5 < nodes.len() * 2 {
                return Err(off_world());
            }
            let lattice = Lattice::new(self.width, self.height, step, nodes).ok_or_else(off_world)?;
            if step == 1 || self.worst_miss_px(&lattice) <= LATTICE_TOLERANCE_PX {
                return Ok(lattice);
            }
            step /= 2;
        }
    }

    /// The largest distance, in pixels, of bilinear places from true ones in the middle of the cells, by
    /// up to 64 × 64 of them.
    fn worst_miss_px(&self, lattice: &Lattice) -> f64 {
        let step = f64::from(lattice.step());
        let cells = |length: u32| node_count(length, lattice.step()) - 1;
        let (columns, rows) = (cells(self.width), cells(self.height));
        let mut positions = Vec::new();
        for j in (0..rows).step_by(rows.div_ceil(64) as usize) {
            for i in (0..columns).step_by(columns.div_ceil(64) as usize) {
                let middle =
                    |index: u32, length: u32| ((f64::from(index) + 0.5) * step).min(f64::from(length) - 0.5);
                positions.push((middle(i, self.width), middle(j, self.height)));
            }
        }
        let exact = self.vectors(&positions);
        let miss = |(&(x, y), exact): (&(f64, f64), &DVec3)| {
            let size = lattice.point(x + 0.5, y).distance(lattice.point(x - 0.5, y));
            lattice.point(x, y).distance(*exact) / size
        };
        let misses = positions.iter().zip(&exact).map(miss);
        misses.filter(|miss| miss.is_finite()).fold(0.0, f64::max)
    }
}

/// Transforms points; infinite where that fails.
fn transform(by: &CoordTransform, points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let (mut x, mut y): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
    // An error only says that some point failed; those come back infinite.
    let _some_failed = by.transform_coords(&mut x, &mut y, &mut []);
    x.into_iter().zip(y).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// EPSG:3857 names a file that is none ("@null") in the text of older programs: it stays allowed.
    #[test]
    fn a_crs_that_names_files_is_refused() {
        let named = "PROJCS[\"x\",GEOGCS[\"x\",DATUM[\"x\",SPHEROID[\"x\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],\
                     UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Mercator_1SP\"],PARAMETER[\"central_meridian\",0],\
                     PARAMETER[\"scale_factor\",1],UNIT[\"metre\",1],EXTENSION[\"PROJ4\",\"+proj=merc +a=6378137 +b=6378137 \
                     +units=m +nadgrids=/etc/passwd\"]]";
        let refused = |crs: &SpatialRef| check_grids(crs).is_err();
        assert!(refused(&SpatialRef::from_wkt(named).unwrap()));
        assert!(!refused(&SpatialRef::from_wkt(&named.replace("/etc/passwd", "@null")).unwrap()));
        assert!(!refused(&SpatialRef::from_epsg(3857).unwrap()));
        assert!(!refused(&SpatialRef::from_epsg(21037).unwrap()));
    }
}
