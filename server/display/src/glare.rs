//! Light that the eye scatters over what it looks at: the general disability glare equation (CIE 146:2002; Vos 2003), which is Stiles
//! and Holladay's 10/θ² at middle angles.

use rayon::prelude::*;
use skyglow_physics::{
    AZIMUTH_COUNT, Direction, ELEVATION_COUNT,
    panorama::{azimuth_rad, elevation_rad, solid_angle_sr},
    sampler::Taps,
};
use std::{
    f64::consts::{FRAC_PI_2, TAU},
    sync::LazyLock,
};

/// Of the observer.
const AGE_YEARS: f64 = 30.0;
/// Of brown to green eyes.
const PIGMENT: f64 = 0.5;
/// The equation holds from here on, degrees.
const LEAST_DEG: f64 = 0.1;
/// The sky is summed over cells of so many samples along each side.
const CELL_SAMPLES: usize = 4;
const ACROSS: usize = AZIMUTH_COUNT / CELL_SAMPLES;
const UP: usize = ELEVATION_COUNT / CELL_SAMPLES;
/// Within this the sky is its own veil, degrees.
const NEAREST_CELL_DEG: f64 = 4.0;
/// Nearer to Moon and Sun than this their veil is found for every pixel; samples of the grid have that of this angle.
const HALO_DEG: f64 = 5.0;

/// Luminance of an even sky's own veil over that of the sky. The even backgrounds that thresholds are known for have it too.
const EVEN_SKY_VEIL: f64 = 0.045;

/// The even background that hides as much as a luminance with a veil over it, cd m⁻².
pub(crate) fn even_background_cd_m2(luminance_cd_m2: f64, veil_cd_m2: f64) -> f64 {
    ((luminance_cd_m2 + veil_cd_m2) / (1.0 + EVEN_SKY_VEIL)).max(luminance_cd_m2)
}

/// Luminance of the veil over illuminance at the eye, sr⁻¹, at an angle from a light.
pub fn veil_per_lx(angle_deg: f64) -> f64 {
    let theta = angle_deg.max(LEAST_DEG);
    let ageing = 1.0 + (AGE_YEARS / 62.5).powi(4);
    10.0 / theta.powi(3) + (5.0 / (theta * theta) + 0.1 * PIGMENT / theta) * ageing + 0.0025 * PIGMENT
}

/// The same of the illuminance of a surface that faces the light.
fn veil_facing(angle_deg: f64) -> f64 {
    veil_per_lx(angle_deg) * angle_deg.to_radians().cos().max(0.0)
}

/// Angle between directions, degrees; from the chord, which tells small angles better than a cosine.
fn between_deg(a: Direction, b: Direction) -> f64 {
    let (a, b) = (a.enu(), b.enu());
    let chord = ((a.x - b.x).powi(2) + (a.y - b.y).powi(2) + (a.z - b.z).powi(2)).sqrt();
    2.0 * (0.5 * chord).min(1.0).asin().to_degrees()
}

/// Moon or Sun that no ground hides, as a source of glare.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Halo<const PLANES: usize = 4> {
    direction: Direction,
    radius_deg: f64,
    illuminance_lx: [f64; PLANES],
}

impl<const PLANES: usize> Halo<PLANES> {
    /// Of a disc by the illuminance of a surface that faces it.
    pub(crate) fn new(direction: Direction, radius_rad: f64, illuminance_lx: [f64; PLANES]) -> Self {
        Self { direction, radius_deg: radius_rad.to_degrees(), illuminance_lx }
    }

    /// What it adds near by to the veil of the samples, cd m⁻²; None further away.
    pub(crate) fn near(&self, direction: Direction) -> Option<[f64; PLANES]> {
        let angle_deg = between_deg(direction, self.direction).max(self.radius_deg);
        let more = veil_facing(angle_deg) - veil_facing(HALO_DEG);
        (angle_deg < HALO_DEG).then(|| self.illuminance_lx.map(|lx| more * lx))
    }

    /// What it adds to the veil of the samples, cd m⁻², as if it were no nearer than the halo's edge.
    pub(crate) fn far(&self, direction: Direction) -> [f64; PLANES] {
        let part = veil_facing(between_deg(direction, self.direction).max(HALO_DEG));
        self.illuminance_lx.map(|lx| part * lx)
    }
}

impl Halo {
    /// Of its luminance alone.
    pub(crate) fn photopic(&self) -> Halo<1> {
        let Self { direction, radius_deg, illuminance_lx } = *self;
        Halo { direction, radius_deg, illuminance_lx: [illuminance_lx[1]] }
    }
}

/// What an eye makes of a whole sky before it looks at a part.
#[derive(Clone, Debug)]
pub(crate) struct Glare<const PLANES: usize = 4> {
    /// Mean luminance of the sky, cd m⁻², which the eye adapts to.
    pub(crate) mean_cd_m2: f64,
    /// Luminance of the veil over each sample by plane, `[row][column]`.
    pub(crate) veil: Vec<[f32; PLANES]>,
}

impl<const PLANES: usize> Glare<PLANES> {
    /// Of a sky by its planes, X, Y, Z and scotopic or photopic alone, `[row][column]`.
    pub(crate) fn new(planes: [&[f32]; PLANES], halos: &[Halo<PLANES>]) -> Self {
        let mut flux = vec![[0.0; PLANES]; UP * ACROSS];
        let photopic = planes[PLANES.min(2) - 1];
        let mut sum = 0.0;
        for row in 0..ELEVATION_COUNT {
            let solid_angle_sr = solid_angle_sr(row);
            for column in 0..AZIMUTH_COUNT {
                let cell = &mut flux[row / CELL_SAMPLES * ACROSS + column / CELL_SAMPLES];
                for (cell, plane) in cell.iter_mut().zip(planes) {
                    *cell += solid_angle_sr * f64::from(plane[row * AZIMUTH_COUNT + column]);
                }
                sum += solid_angle_sr * f64::from(photopic[row * AZIMUTH_COUNT + column]);
            }
        }
        let cells = veil_of_cells(&flux);
        let of_sample = |at: usize| {
            let (row, column) = (at / AZIMUTH_COUNT, at % AZIMUTH_COUNT);
            let direction = Direction { azimuth_rad: azimuth_rad(column), elevation_rad: elevation_rad(row) };
            let mut veil = between(&cells, row, column);
            for far in halos.iter().map(|halo| halo.far(direction)) {
                veil.iter_mut().zip(far).for_each(|(veil, far)| *veil += far);
            }
            veil.map(|veil| veil as f32)
        };
        let veil = (0..ELEVATION_COUNT * AZIMUTH_COUNT).into_par_iter().map(of_sample).collect();
        Self { mean_cd_m2: sum / TAU, veil }
    }

    /// The veil between samples.
    pub(crate) fn at(&self, taps: &Taps) -> [f64; PLANES] {
        std::array::from_fn(|i| {
            (0..4).map(|tap| taps.weight[tap] * f64::from(self.veil[taps.offset[tap]][i])).sum()
        })
    }
}

/// Veil over the middle of a cell by illuminance from another: `[row to][row from][columns between]`. It is the same for every sky.
static KERNELS: LazyLock<Vec<[[f64; ACROSS]; UP]>> = LazyLock::new(|| {
    let middle = |row: usize, column: usize| Direction {
        azimuth_rad: column as f64 * TAU / ACROSS as f64,
        elevation_rad: (row as f64 + 0.5) * FRAC_PI_2 / UP as f64,
    };
    let kernel = |to: usize, from: usize, turn: usize| {
        veil_facing(between_deg(middle(to, 0), middle(from, turn)).max(NEAREST_CELL_DEG))
    };
    let rows = |to: usize| std::array::from_fn(|from| std::array::from_fn(|turn| kernel(to, from, turn)));
    (0..UP).map(rows).collect()
});

/// The veil over the middle of every cell.
fn veil_of_cells<const PLANES: usize>(flux: &[[f64; PLANES]]) -> Vec<[f64; PLANES]> {
    let row_of = |kernels: &[[f64; ACROSS]; UP]| {
        let mut veil = vec![[0.0; PLANES]; ACROSS];
        for (sources, kernel) in flux.chunks_exact(ACROSS).zip(kernels) {
            for (column, veil) in veil.iter_mut().enumerate() {
                for (turn, part) in kernel.iter().enumerate() {
                    let source = &sources[(column + turn) % ACROSS];
                    veil.iter_mut().zip(source).for_each(|(veil, source)| *veil += part * source);
                }
            }
        }
        veil
    };
    KERNELS.par_iter().flat_map_iter(row_of).collect()
}

/// Between the middles of the cells, by bilinear interpolation; the highest and the lowest hold beyond.
fn between<const PLANES: usize>(cells: &[[f64; PLANES]], row: usize, column: usize) -> [f64; PLANES] {
    let place = |at: usize| (at as f64 + 0.5) / CELL_SAMPLES as f64 - 0.5;
    let across = place(column) + ACROSS as f64;
    let up = place(row).clamp(0.0, (UP - 1) as f64);
    let (left, low) = (across.floor() as usize, (up.floor() as usize).min(UP - 2));
    let (right, above) = (across - left as f64, up - low as f64);
    let cell = |row: usize, column: usize, i: usize| cells[row * ACROSS + column % ACROSS][i];
    let along = |row: usize, i: usize| (1.0 - right) * cell(row, left, i) + right * cell(row, left + 1, i);
    std::array::from_fn(|i| (1.0 - above) * along(low, i) + above * along(low + 1, i))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stiles and Holladay's law (CIE 1939) is that of middle angles, to a third; nearer the veil is thicker.
    #[test]
    fn veils_are_those_of_stiles_and_holladay() {
        for angle_deg in [3.0, 5.0, 10.0, 20.0, 30.0] {
            let ratio = veil_per_lx(angle_deg) / (10.0 / (angle_deg * angle_deg));
            assert!((0.6..1.2).contains(&ratio), "{angle_deg}: {ratio}");
        }
        // The viewer's values.
        for (angle_deg, wanted) in
            [(0.5, 101.1682), (1.0, 15.31933), (5.0, 0.3023977), (20.0, 0.01829626), (60.0, 0.003636483)]
        {
            assert!(
                (veil_per_lx(angle_deg) / wanted - 1.0).abs() < 1e-6,
                "{angle_deg}: {}",
                veil_per_lx(angle_deg)
            );
        }
        assert!(veil_per_lx(0.0) == veil_per_lx(0.1));
    }

    /// Under an even sky the veil is some hundredths of its luminance everywhere, and the mean is that luminance.
    #[test]
    fn an_even_sky_has_an_even_veil() {
        let plane = vec![2e-4f32; ELEVATION_COUNT * AZIMUTH_COUNT];
        let glare = Glare::new([&plane, &plane, &plane, &plane], &[]);
        assert!((glare.mean_cd_m2 / 2e-4 - 1.0).abs() < 1e-5, "{}", glare.mean_cd_m2);
        for veil in &glare.veil {
            let part = f64::from(veil[1]) / 2e-4;
            assert!((0.01..0.08).contains(&part), "{part}");
        }
    }

    /// The veil of a Moon is continuous where pixels take over from samples.
    #[test]
    fn a_moon_has_a_halo_that_fades() {
        let at =
            |elevation_deg: f64| Direction { azimuth_rad: 1.0, elevation_rad: elevation_deg.to_radians() };
        let halo = Halo::new(at(30.0), 0.26f64.to_radians(), [0.0809; 4]);
        let near = |away_deg: f64| halo.near(at(30.0 + away_deg)).map_or(0.0, |veil| veil[1]);
        assert!(near(0.5) > near(1.0) && near(1.0) > near(4.0) && near(4.999) < 1e-4 && near(5.1) == 0.0);
    }
}
