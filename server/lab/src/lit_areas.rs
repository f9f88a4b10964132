//! Areas of lit 15″ pixels: towns, and regions of them, the same every time.

use skyglow_bench::scenes::{LitPixel, PIXEL_SIDE_M};
use skyglow_render::synthetic::Noise;
use std::{collections::BTreeMap, f64::consts::TAU};

/// Flux of a pixel of middling brightness, DNB watts: 20 nW cm⁻² sr⁻¹.
const MIDDLE_FLUX_DNB_W: f64 = 135.0;

/// Lit pixels by their place on the lattice: altitude [m] and flux [DNB W].
#[derive(Debug, Default)]
pub(crate) struct LitAreas(BTreeMap<(i64, i64), [f64; 2]>);

impl LitAreas {
    /// Lights the pixel at metres east and north.
    pub(crate) fn put(&mut self, [east_m, north_m]: [f64; 2], altitude_m: f64, brightness: f64) {
        let place = [east_m, north_m].map(|metres| (metres / PIXEL_SIDE_M).floor() as i64);
        self.0.insert((place[0], place[1]), [altitude_m, MIDDLE_FLUX_DNB_W * brightness]);
    }

    /// A disc, three times as bright in its middle as at its edge, pixels a third to three times as bright as that.
    pub(crate) fn town(
        &mut self,
        noise: &mut Noise,
        [east_m, north_m]: [f64; 2],
        radius_m: f64,
        brightness: f64,
        altitude_m: impl Fn([f64; 2]) -> f64,
    ) {
        let reach = (radius_m / PIXEL_SIDE_M).ceil() as i64;
        for (column, row) in
            (-reach..=reach).flat_map(|row| (-reach..=reach).map(move |column| (column, row)))
        {
            let (right_m, up_m) = (column as f64 * PIXEL_SIDE_M, row as f64 * PIXEL_SIDE_M);
            let off = right_m.hypot(up_m) / radius_m;
            if off <= 1.0 {
                let at = [east_m + right_m, north_m + up_m];
                self.put(
                    at,
                    altitude_m(at),
                    brightness * (1.0 - off).exp() * 3f64.powf(2.0 * noise.unit() - 1.0),
                );
            }
        }
    }

    /// Thirty towns and some hundred lone pixels over the whole disc.
    pub(crate) fn region(&mut self, noise: &mut Noise, levels: &[f64]) {
        for _ in 0..30 {
            let at = turned_m(290_000.0 * noise.unit().sqrt(), TAU * noise.unit());
            let (radius_m, brightness) = (500.0 + 2_500.0 * noise.unit().powi(2), 0.3 + 2.0 * noise.unit());
            self.town(noise, at, radius_m, brightness, |place| level_m(levels, place));
        }
        for _ in 0..400 {
            let at = turned_m(298_000.0 * noise.unit().sqrt(), TAU * noise.unit());
            self.put(at, level_m(levels, at), 0.1 + 0.4 * noise.unit());
        }
    }

    /// The pixels, each at its middle.
    pub(crate) fn lit(self) -> Vec<LitPixel> {
        let middle_m = |index: i64| (index as f64 + 0.5) * PIXEL_SIDE_M;
        let pixel = |((east, north), [altitude_m, flux_dnb_w]): ((i64, i64), [f64; 2])| LitPixel {
            east_m: middle_m(east),
            north_m: middle_m(north),
            altitude_m,
            flux_dnb_w,
        };
        self.0.into_iter().map(pixel).collect()
    }
}

/// Metres east and north.
pub(crate) fn turned_m(distance_m: f64, azimuth_rad: f64) -> [f64; 2] {
    [distance_m * azimuth_rad.sin(), distance_m * azimuth_rad.cos()]
}

/// One of some altitudes, low ones more often, by hills some kilometres wide.
pub(crate) fn level_m(levels_m: &[f64], [east_m, north_m]: [f64; 2]) -> f64 {
    let broad = 0.25 * (east_m / 23_000.0).sin() * (north_m / 31_000.0).cos();
    let share = 0.5 + broad + 0.25 * ((east_m - 0.7 * north_m) / 4_000.0).sin();
    level_of_share_m(levels_m, share * share)
}

/// One of some altitudes by a share 0..=1.
pub(crate) fn level_of_share_m(levels_m: &[f64], share: f64) -> f64 {
    levels_m[((share * levels_m.len() as f64).max(0.0) as usize).min(levels_m.len() - 1)]
}
