//! Synthetic terrain: mountain chains along their real lines with ridged fractal noise, plains by inverse distance weighting of
//! the towns' altitudes (Shepard 1968), valleys, lakes and the sea.

use super::raster_file::RasterSpec;
use super::shapes::{Line, is_inside, map_km, smooth_step};
use super::towns::TOWNS;
use glam::DVec2;
use skyglow_physics::value_noise as noise;

/// Points of a line: latitude, longitude, and a height or altitude in metres.
type Course = [(f64, f64, f64)];
/// Lines with a half width in kilometres each.
type WideCourses = [(f64, &'static Course)];

/// A chain: its crest (latitude, longitude, height above the plain in metres) and half width, km.
const CHAINS: &WideCourses = &[
    // Alps, from the sea to Styria
    (
        42.0,
        &[
            (43.95, 7.30, 1500.0),
            (44.30, 6.95, 2300.0),
            (44.75, 6.75, 2600.0),
            (45.30, 6.75, 2900.0),
            (45.80, 6.95, 3300.0),
            (46.00, 7.65, 3200.0),
            (46.45, 8.20, 2900.0),
            (46.60, 9.00, 2500.0),
            (46.40, 9.90, 2700.0),
            (46.80, 10.75, 2700.0),
            (47.00, 11.70, 2600.0),
            (47.08, 12.70, 2700.0),
            (47.25, 13.50, 2000.0),
            (47.45, 14.60, 1700.0),
            (47.60, 15.40, 1300.0),
        ],
    ),
    // Bernese Alps, Dolomites, northern limestone Alps, Carnic Alps, Dauphiné, Provence
    (16.0, &[(46.35, 7.10, 2000.0), (46.55, 7.95, 2600.0), (46.65, 8.30, 2200.0)]),
    (24.0, &[(46.25, 10.60, 2300.0), (46.30, 11.60, 1900.0), (46.50, 12.20, 2000.0)]),
    (20.0, &[(47.20, 9.80, 1700.0), (47.42, 10.90, 1800.0), (47.50, 11.90, 1400.0), (47.50, 13.20, 1600.0)]),
    (18.0, &[(46.60, 12.80, 1700.0), (46.45, 13.60, 1700.0), (46.35, 14.50, 1400.0)]),
    (26.0, &[(45.30, 5.95, 1400.0), (44.90, 6.30, 2300.0), (44.30, 6.40, 1500.0), (43.90, 6.50, 900.0)]),
    // Apennines
    (
        20.0,
        &[
            (44.30, 8.30, 800.0),
            (44.50, 9.30, 1100.0),
            (44.25, 10.40, 1500.0),
            (43.95, 11.50, 1000.0),
            (43.45, 12.30, 1000.0),
            (42.95, 13.20, 1700.0),
            (42.50, 13.50, 2100.0),
        ],
    ),
    // Jura, Vosges, Black Forest, Swabian Alb, Massif Central, Bavarian Forest
    (
        11.0,
        &[
            (46.00, 5.75, 900.0),
            (46.35, 6.05, 1000.0),
            (46.85, 6.50, 850.0),
            (47.25, 7.20, 750.0),
            (47.42, 7.90, 400.0),
        ],
    ),
    (13.0, &[(47.80, 6.95, 850.0), (48.15, 7.10, 800.0), (48.60, 7.20, 450.0)]),
    (14.0, &[(47.75, 8.00, 850.0), (48.20, 8.15, 650.0), (48.75, 8.30, 550.0)]),
    (16.0, &[(48.05, 8.80, 400.0), (48.50, 9.60, 300.0)]),
    (30.0, &[(44.30, 3.70, 1100.0), (45.20, 4.10, 900.0), (46.00, 4.30, 500.0)]),
    (18.0, &[(48.80, 13.60, 700.0), (48.60, 14.60, 500.0)]),
];

/// A valley floor: (latitude, longitude, altitude in metres) along it.
const VALLEYS: &[&Course] = &[
    &[
        (46.40, 6.88, 375.0),
        (46.10, 7.07, 471.0),
        (46.23, 7.36, 500.0),
        (46.32, 7.99, 684.0),
        (46.48, 8.25, 1300.0),
    ],
    &[(45.47, 7.88, 253.0), (45.74, 7.32, 583.0), (45.75, 7.05, 900.0), (45.80, 6.97, 1224.0)],
    &[
        (45.44, 10.95, 70.0),
        (45.89, 11.04, 204.0),
        (46.07, 11.12, 194.0),
        (46.50, 11.35, 262.0),
        (46.67, 11.16, 325.0),
        (46.63, 10.60, 900.0),
    ],
    &[
        (46.50, 11.35, 262.0),
        (46.72, 11.65, 560.0),
        (46.80, 11.94, 838.0),
        (46.74, 12.30, 1150.0),
        (46.83, 12.77, 673.0),
    ],
    &[
        (47.86, 12.13, 450.0),
        (47.58, 12.17, 490.0),
        (47.27, 11.40, 574.0),
        (47.14, 10.57, 816.0),
        (46.90, 10.50, 1000.0),
        (46.50, 9.84, 1800.0),
    ],
    &[(46.17, 9.40, 200.0), (46.17, 9.87, 307.0), (46.22, 10.17, 441.0), (46.47, 10.37, 1225.0)],
    &[(46.16, 8.80, 200.0), (46.20, 9.02, 240.0), (46.40, 8.85, 400.0), (46.53, 8.61, 1150.0)],
    &[
        (47.50, 9.65, 400.0),
        (47.14, 9.52, 455.0),
        (46.85, 9.53, 593.0),
        (46.70, 9.20, 800.0),
        (46.64, 8.65, 1437.0),
    ],
    &[(45.92, 8.50, 197.0), (46.12, 8.29, 272.0), (46.32, 7.99, 1800.0)],
    &[(45.19, 5.73, 214.0), (45.56, 5.92, 270.0), (45.68, 6.39, 345.0), (45.50, 6.55, 480.0)],
    &[(44.10, 5.90, 480.0), (44.56, 6.08, 745.0), (44.70, 6.60, 950.0), (44.90, 6.64, 1326.0)],
    &[(46.14, 12.22, 383.0), (46.35, 12.30, 550.0), (46.54, 12.14, 1211.0)],
    &[(46.83, 12.77, 673.0), (46.80, 13.50, 550.0), (46.61, 13.85, 501.0), (46.62, 14.31, 446.0)],
    &[(47.80, 13.05, 424.0), (47.50, 13.20, 530.0), (47.30, 13.10, 650.0), (47.32, 12.80, 757.0)],
    &[(45.69, 9.95, 186.0), (46.00, 10.35, 400.0), (46.26, 10.50, 1100.0)],
    &[(45.93, 6.63, 600.0), (45.92, 6.87, 1035.0)],
];

/// A lake: half width in km, and (latitude, longitude, level in metres) along its middle.
const LAKES: &WideCourses = &[
    (4.6, &[(46.23, 6.18, 372.0), (46.40, 6.40, 372.0), (46.46, 6.65, 372.0), (46.42, 6.84, 372.0)]),
    (4.6, &[(47.54, 9.68, 395.0), (47.60, 9.42, 395.0), (47.70, 9.22, 395.0), (47.79, 9.08, 395.0)]),
    (3.4, &[(45.49, 10.64, 65.0), (45.62, 10.68, 65.0), (45.85, 10.85, 65.0)]),
    (1.6, &[(46.15, 9.38, 198.0), (46.00, 9.27, 198.0), (45.85, 9.12, 198.0)]),
    (1.4, &[(45.97, 9.27, 198.0), (45.88, 9.37, 198.0)]),
    (1.9, &[(46.14, 8.74, 193.0), (45.97, 8.65, 193.0), (45.75, 8.60, 193.0)]),
    (1.2, &[(46.00, 9.02, 271.0), (45.93, 8.92, 271.0)]),
    (3.0, &[(46.80, 6.68, 429.0), (46.96, 6.95, 429.0)]),
    (1.2, &[(47.34, 8.55, 406.0), (47.23, 8.75, 406.0)]),
    (1.4, &[(47.03, 8.36, 434.0), (46.98, 8.58, 434.0)]),
    (1.4, &[(45.67, 9.99, 186.0), (45.80, 10.08, 186.0)]),
    (1.5, &[(46.73, 7.66, 558.0), (46.68, 7.78, 558.0)]),
    (1.4, &[(45.88, 6.15, 447.0), (45.80, 6.22, 447.0)]),
    (2.8, &[(47.87, 12.40, 518.0), (47.88, 12.50, 518.0)]),
];

/// The sea south-west and the Adriatic: outlines by (latitude, longitude), closed beyond the map.
const WESTERN_SEA: &[(f64, f64)] = &[
    (42.0, 3.5),
    (43.42, 3.7),
    (43.45, 4.2),
    (43.35, 4.7),
    (43.35, 5.2),
    (43.28, 5.35),
    (43.17, 5.65),
    (43.09, 5.92),
    (43.07, 6.30),
    (43.27, 6.67),
    (43.42, 6.80),
    (43.53, 7.02),
    (43.68, 7.25),
    (43.78, 7.55),
    (43.86, 8.05),
    (44.03, 8.22),
    (44.30, 8.48),
    (44.40, 8.80),
    (44.38, 9.05),
    (44.30, 9.22),
    (44.05, 9.83),
    (43.92, 10.17),
    (43.70, 10.27),
    (43.53, 10.29),
    (43.28, 10.49),
    (42.95, 10.52),
    (42.75, 11.00),
    (42.40, 11.25),
    (42.0, 11.8),
];
const ADRIATIC: &[(f64, f64)] = &[
    (42.0, 14.9),
    (42.45, 14.23),
    (43.00, 13.88),
    (43.62, 13.53),
    (43.92, 12.92),
    (44.08, 12.58),
    (44.45, 12.30),
    (44.85, 12.45),
    (45.10, 12.35),
    (45.25, 12.31),
    (45.40, 12.40),
    (45.52, 12.70),
    (45.65, 13.10),
    (45.75, 13.50),
    (45.68, 13.74),
    (45.55, 13.70),
    (45.45, 13.50),
    (44.88, 13.80),
    (44.80, 13.92),
    (45.10, 14.20),
    (45.32, 14.40),
    (44.90, 14.90),
    (44.0, 15.5),
    (42.0, 16.0),
];

/// Around a town the mountains step back, km.
const TOWN_CLEARING_KM: f64 = 5.0;
/// The plain's altitude is worked out on a lattice this coarse, degrees.
const PLAIN_STEP_DEG: f64 = 0.1;

/// The demo's terrain.
pub(super) struct Relief {
    chains: Vec<(f64, Line)>,
    valleys: Vec<Line>,
    lakes: Vec<(f64, Line)>,
    seas: [Vec<DVec2>; 2],
    towns: Vec<(DVec2, f64)>,
}

impl Relief {
    pub(super) fn new() -> Self {
        let wide = |list: &WideCourses| list.iter().map(|(w, l)| (*w, Line::new(l))).collect();
        Self {
            chains: wide(CHAINS),
            valleys: VALLEYS.iter().map(|line| Line::new(line)).collect(),
            lakes: wide(LAKES),
            seas: [WESTERN_SEA, ADRIATIC].map(|outline| outline.iter().map(|p| map_km(p.0, p.1)).collect()),
            towns: TOWNS.iter().map(|t| (map_km(t.latitude_deg, t.longitude_deg), t.altitude_m)).collect(),
        }
    }

    /// Whether there is water.
    pub(super) fn is_water(&self, latitude_deg: f64, longitude_deg: f64) -> bool {
        let at = map_km(latitude_deg, longitude_deg);
        self.is_sea(at) || self.lakes.iter().any(|(half_km, lake)| lake.nearest(at, *half_km).is_some())
    }

    fn is_sea(&self, at: DVec2) -> bool {
        self.seas.iter().any(|outline| is_inside(outline, at))
    }

    /// The plain's altitude, metres: the mean of the towns' by the inverse fourth power of their distance.
    fn plain(&self, at: DVec2) -> f64 {
        let (mut sum, mut total) = (0.0, 0.0);
        for (position, altitude_m) in &self.towns {
            let weight = (at.distance_squared(*position) + 25.0).powi(-2);
            sum += weight * altitude_m;
            total += weight;
        }
        sum / total
    }

    /// Heights of a raster's samples, metres, row by row from the north.
    pub(super) fn heights_m(&self, spec: &RasterSpec) -> Vec<f32> {
        let (west, north) = (spec.west_deg, spec.north_deg);
        let columns = (spec.width as f64 * spec.step_deg / PLAIN_STEP_DEG).ceil() as usize + 2;
        let rows = (spec.height as f64 * spec.step_deg / PLAIN_STEP_DEG).ceil() as usize + 2;
        let plain: Vec<f64> = (0..columns * rows)
            .map(|i| {
                let (r, c) = ((i / columns) as f64, (i % columns) as f64);
                self.plain(map_km(north - r * PLAIN_STEP_DEG, west + c * PLAIN_STEP_DEG))
            })
            .collect();
        let plain_at = |latitude_deg: f64, longitude_deg: f64| {
            let (x, y) = ((longitude_deg - west) / PLAIN_STEP_DEG, (north - latitude_deg) / PLAIN_STEP_DEG);
            let (i, j) = (x as usize, y as usize);
            let (s, t) = (x - i as f64, y - j as f64);
            let row = |j: usize| plain[j * columns + i] * (1.0 - s) + plain[j * columns + i + 1] * s;
            row(j) * (1.0 - t) + row(j + 1) * t
        };
        let sample = |(latitude_deg, longitude_deg)| {
            self.height_m(map_km(latitude_deg, longitude_deg), plain_at(latitude_deg, longitude_deg)) as f32
        };
        spec.centers().map(sample).collect()
    }

    fn height_m(&self, at: DVec2, plain_m: f64) -> f64 {
        if self.is_sea(at) {
            return 0.0;
        }
        let rise = |(width_km, chain): &(f64, Line)| {
            let found = chain.nearest(at, 2.6 * width_km);
            found.map_or(0.0, |(distance_km, height_m)| height_m * (-(distance_km / width_km).powi(2)).exp())
        };
        let chains_m = self.chains.iter().map(rise).fold(0.0, |sum: f64, h| sum.hypot(h));
        let roughness = if chains_m > 30.0 { noise::ridges(at.x / 14.0, at.y / 14.0, 5, 7) } else { 0.5 };
        let hills_m = 60.0 * (noise::octaves(at.x / 9.0, at.y / 9.0, 3, 19) - 0.5).max(0.0);
        let mut height_m = plain_m.min(700.0) + hills_m + chains_m * (0.45 + 0.75 * roughness);
        let near_town = self.towns.iter().map(|(p, h)| (p.distance_squared(at), *h));
        let (town_km2, town_m) = near_town.fold((f64::INFINITY, 0.0), |a, b| if b.0 < a.0 { b } else { a });
        let clearing = (-town_km2 / (TOWN_CLEARING_KM * TOWN_CLEARING_KM)).exp();
        height_m += (town_m - height_m) * clearing;
        for valley in &self.valleys {
            if let Some((distance_km, floor_m)) = valley.nearest(at, 9.0) {
                let share = 1.0 - smooth_step(0.8, 8.0, distance_km);
                height_m += (floor_m - height_m).min(0.0) * share;
            }
        }
        for (half_km, lake) in &self.lakes {
            if let Some((distance_km, level_m)) = lake.nearest(at, half_km + 2.5) {
                let share = 1.0 - smooth_step(*half_km, half_km + 2.5, distance_km);
                height_m += (level_m - height_m) * share;
            }
        }
        height_m.max(0.0)
    }
}
