//! Far sources close together as one: a reference over a whole raster in minutes instead of hours.

use skyglow_physics::PointSource;
use std::collections::BTreeMap;

/// Sources within this of each other in altitude may be one, metres.
const ALTITUDE_BIN_M: f64 = 25.0;

/// The sources with those of one bin merged into one at their mean place, weighted by flux: bins `share` of the distance
/// deep and wide, 25 m high. Where bins are smaller than pixels nearly nothing is merged.
pub fn merged(sources: &[PointSource], share: f64) -> Vec<PointSource> {
    // Flux, and flux times azimuth, distance and altitude.
    let mut bins: BTreeMap<(i64, i64, i64), [f64; 4]> = BTreeMap::new();
    for source in sources {
        let bin = (
            (source.distance_m.ln() / share).floor() as i64,
            (source.azimuth_rad / share).floor() as i64,
            (source.altitude_m / ALTITUDE_BIN_M).floor() as i64,
        );
        let sums = bins.entry(bin).or_default();
        let parts = [1.0, source.azimuth_rad, source.distance_m, source.altitude_m];
        sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += source.flux_dnb_w * part);
    }
    bins.into_values()
        .filter(|sums| sums[0] > 0.0)
        .map(|[flux_dnb_w, azimuth, distance, altitude]| PointSource {
            azimuth_rad: azimuth / flux_dnb_w,
            distance_m: distance / flux_dnb_w,
            altitude_m: altitude / flux_dnb_w,
            flux_dnb_w,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(azimuth_rad: f64, distance_m: f64, altitude_m: f64) -> PointSource {
        PointSource { azimuth_rad, distance_m, altitude_m, flux_dnb_w: 1.0 + altitude_m }
    }

    /// Neighbours far off become one with their flux, and others stay.
    #[test]
    fn far_neighbours_merge_with_their_flux() {
        let far = [source(1.003, 200_000.0, 410.0), source(1.004, 200_300.0, 405.0)];
        let one = merged(&far, 0.01);
        assert_eq!(one.len(), 1);
        assert!((one[0].flux_dnb_w - 817.0).abs() < 1e-9);
        assert!(one[0].azimuth_rad > 1.003 && one[0].azimuth_rad < 1.004 && one[0].altitude_m > 405.0);
        let apart = [
            source(1.003, 200_000.0, 410.0),
            source(1.003, 200_000.0, 480.0),
            source(1.003, 210_000.0, 410.0),
            source(1.103, 200_000.0, 410.0),
        ];
        let mut kept = merged(&apart, 0.01);
        kept.sort_by(|a, b| a.flux_dnb_w.total_cmp(&b.flux_dnb_w));
        assert_eq!(kept.len(), 4);
        assert!((kept[3].altitude_m - 480.0).abs() < 1e-9);
    }
}
