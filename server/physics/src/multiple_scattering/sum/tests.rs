use super::{super::ViewRow, *};
use crate::{
    Turbidity,
    panorama::{azimuth_rad, elevation_rad},
};

fn sum(density: &SumDensity, sources: &[PointSource], directions: &[Direction]) -> Vec<[f64; BAND_COUNT]> {
    settled(density).radiance(sources, [1.0; BAND_COUNT], directions).unwrap()
}

fn settled(density: &SumDensity) -> MultipleSum {
    MultipleSum {
        atmosphere: Atmosphere::new(Turbidity::new(2.0).unwrap()),
        ground_albedo: 0.15,
        observer_altitude_m: 800.0,
        emission: EmissionMix::garstang(),
        resolution: Resolution::coarse(),
        density: *density,
    }
}

/// A source with a skyline, seen in four directions.
fn behind(blocking_deg: f64, altitude_m: f64, distance_m: f64) -> BlockedSource {
    let source = PointSource { azimuth_rad: 0.4, distance_m, altitude_m, flux_dnb_w: 1e6 };
    BlockedSource { source, blocking_rad: blocking_deg.to_radians() }
}

fn view_directions() -> [Direction; 4] {
    [(0, 16), (2, 80), (12, 30), (60, 0)].map(|(row, column)| Direction {
        azimuth_rad: azimuth_rad(column),
        elevation_rad: elevation_rad(row),
    })
}

fn cut(sources: &[BlockedSource]) -> Vec<[f64; BAND_COUNT]> {
    settled(&SumDensity::default())
        .cut_radiance(sources, [1.0; BAND_COUNT], &view_directions(), &|| ())
        .unwrap()
}

/// The light of each source adds up to that of all.
#[test]
#[ignore = "slow: `make check` leaves it to `make test`"]
fn sources_add_up() {
    let sources: Vec<PointSource> = [(100.0, 2_000.0), (700.0, 9_000.0), (1_500.0, 40_000.0)]
        .map(|(altitude_m, distance_m)| behind(0.0, altitude_m, distance_m).source)
        .to_vec();
    let density = SumDensity::default();
    let all = sum(&density, &sources, &view_directions());
    let each = settled(&density).radiance_of_each(&sources, [1.0; BAND_COUNT], &view_directions()).unwrap();
    assert_eq!(each.len(), sources.len());
    for (direction, all) in all.iter().enumerate() {
        for band in 0..BAND_COUNT {
            let together: f64 = each.iter().map(|one| one[direction][band]).sum();
            assert!((together / all[band] - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
#[ignore = "slow: `make check` leaves it to `make test`"]
fn halving_its_steps_hardly_moves_the_sum() {
    let sources: Vec<PointSource> = (0..40)
        .map(|i| {
            let spread = |ratio: f64| (f64::from(i) * ratio).fract();
            PointSource {
                azimuth_rad: 6.0 * spread(0.82),
                distance_m: 2_000.0 * 80f64.powf(spread(0.67)),
                altitude_m: 1_500.0 * spread(0.55),
                flux_dnb_w: 1e6,
            }
        })
        .collect();
    let directions = [(0, 10), (3, 200), (20, 90), (63, 0)].map(|(row, column)| Direction {
        azimuth_rad: azimuth_rad(column),
        elevation_rad: elevation_rad(row),
    });
    let default = sum(&SumDensity::default(), &sources, &directions);
    let with = |density: &SumDensity| {
        let other = sum(density, &sources, &directions);
        let pairs = default.iter().flatten().zip(other.iter().flatten());
        pairs.map(|(a, b)| (b / a - 1.0).abs()).fold(0.0, f64::max)
    };
    let used = SumDensity::default();
    assert!(with(&SumDensity { azimuths: 81, ..used }) < 1e-3);
    assert!(with(&SumDensity { distances: 143, ..used }) < 3e-3);
    // Coarse fields of neighbouring altitudes differ by more than what lies between them does.
    assert!(with(&SumDensity { altitude_step_m: 150.0, ..used }) < 0.01);
    // The checks can fail.
    assert!(with(&SumDensity { azimuths: 7, ..used }) > 5e-3);
    let coarse = with(&SumDensity { altitude_step_m: 1e4, ..used });
    assert!(coarse > 0.05, "{coarse}");
}

#[test]
fn a_sky_without_sources_is_dark() {
    let directions = [Direction { azimuth_rad: 0.0, elevation_rad: 0.5 }];
    assert_eq!(sum(&SumDensity::default(), &[], &directions), [[0.0; BAND_COUNT]]);
}

/// Sources behind skylines leave open ones unchanged bit for bit, and cost fields only at their own
/// altitudes.
#[test]
#[ignore = "slow: `make check` leaves it to `make test`"]
fn skylines_do_not_change_open_sources() {
    let open = [behind(0.0, 100.0, 9_000.0), behind(0.0, 400.0, 50_000.0)];
    let density = SumDensity::default();
    let alone: Vec<PointSource> = open.iter().map(|blocked| blocked.source).collect();
    let expected = sum(&density, &alone, &view_directions());
    assert_eq!(cut(&open), expected);
    assert_eq!(settled(&density).field_count(&open), 2);
    // A source behind a skyline up to the zenith is one that is not there.
    let dark = behind(90.0, 300.0, 4_000.0);
    assert_eq!(cut(&[open[0], dark, open[1]]), expected);
    assert!(cut(&[dark]).iter().flatten().all(|value| *value == 0.0));
    // The control: with its light it is seen.
    assert_ne!(cut(&[open[0], BlockedSource::open(dark.source), open[1]]), expected);
    // Of a skyline at a node of the axis, as high as the observer, what it leaves takes two fields; four angles are
    // around one between nodes.
    let count = |sources: &[BlockedSource]| settled(&density).field_count(sources);
    assert_eq!(count(&[behind(8.0, 800.0, 4_000.0)]), 3);
    assert_eq!(count(&[behind(9.0, 798.0, 4_000.0), behind(10.0, 798.0, 5_000.0)]), 6);
    assert_eq!(count(&[]), 0);
    let solved = std::sync::atomic::AtomicUsize::new(0);
    let advance = || {
        solved.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    };
    let sources = [behind(8.0, 800.0, 4_000.0)];
    settled(&density).cut_radiance(&sources, [1.0; BAND_COUNT], &view_directions(), &advance).unwrap();
    assert_eq!(solved.into_inner(), 3);
}

/// A skyline between the angles leaves what a field solved behind it shows, and higher ones leave less.
#[test]
#[ignore = "slow: `make check` leaves it to `make test`"]
fn interpolated_skylines_agree_with_fields() {
    let distance_m = [1_000.0, 6_000.0, 25_000.0, 90_000.0];
    // Degrees, and the largest mean error there: what coarse fields of neighbouring angles differ by on their own is a
    // per cent from 8° on.
    let angles_deg = [0.0, 0.4, 1.4, 2.8, 5.6, 11.0, 22.0, 45.0];
    let largest_mean = [0.003, 0.003, 0.003, 0.003, 0.006, 0.03, 0.03, 0.06];
    // All at once, so that each field is solved once: in every direction the sum over one source alone.
    let sources: Vec<BlockedSource> = angles_deg
        .iter()
        .flat_map(|&angle_deg| distance_m.map(|distance_m| behind(angle_deg, 300.0, distance_m)))
        .collect();
    let settled = settled(&SumDensity::default());
    let rows: Vec<f64> = view_directions().iter().map(|direction| direction.elevation_rad).collect();
    let nodes = Nodes::new(&sources, settled.observer_altitude_m, &settled.density);
    let tables = settled.solve(nodes, &rows, &|| ()).unwrap();
    let weights = settled.emission.weights();
    let mut before = vec![f64::INFINITY; distance_m.len() * rows.len()];
    for (number, &angle_deg) in angles_deg.iter().enumerate() {
        let blocking_rad = f64::to_radians(angle_deg);
        let setting = settled.setting(300.0).unwrap().behind(blocking_rad).unwrap();
        let field = SourceField::solve(setting, &settled.resolution);
        let (mut errors, mut steps) = (Vec::new(), Vec::new());
        for (row, direction) in view_directions().iter().enumerate() {
            let rays = ViewRow::new(&field, settled.observer_altitude_m, direction.elevation_rad).unwrap();
            for (place, &distance_m) in distance_m.iter().enumerate() {
                let index = number * 4 + place;
                let source = &sources[index].source;
                let log_sent = settled.log_sent(blocking_rad);
                let log = tables.log_radiance(row, index, source, log_sent, direction.azimuth_rad);
                let solved = rays.radiance_per_watt(distance_m, direction.azimuth_rad - source.azimuth_rad);
                let solved: f64 = solved[1].iter().zip(weights).map(|(value, weight)| value * weight).sum();
                errors.push((log[1].exp() / solved - 1.0).abs());
                steps.push((before[row * 4 + place].exp() / solved - 1.0).abs());
                let slot = &mut before[row * 4 + place];
                assert!(log[1] < *slot, "{angle_deg} {row} {distance_m}");
                *slot = log[1];
            }
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        println!("{angle_deg}: mean {:.4}, taking the angle before {:.4}", mean(&errors), mean(&steps));
        assert!(mean(&errors) < largest_mean[number], "{angle_deg}: {}", mean(&errors));
        // The control: the angle before is another one.
        assert!(mean(&steps) > 2.0 * mean(&errors), "{angle_deg}");
    }
}

/// At altitudes between those solved, a skyline leaves what a field of that altitude shows.
#[test]
#[ignore = "slow: `make check` leaves it to `make test`"]
fn interpolated_altitudes_agree_with_fields() {
    let distance_m = [2_000.0, 8_000.0, 40_000.0];
    // From 700 m below the observer to 1500 m above.
    let altitudes_m = [100.0, 550.0, 720.0, 1_050.0, 2_300.0];
    let sources: Vec<BlockedSource> = altitudes_m
        .iter()
        .flat_map(|&altitude_m| distance_m.map(|distance_m| behind(8.0, altitude_m, distance_m)))
        .collect();
    let rows: Vec<f64> = view_directions().iter().map(|direction| direction.elevation_rad).collect();
    let log_left_with = |cut_offset_step: f64| -> Vec<f64> {
        let settled = settled(&SumDensity { cut_offset_step, altitude_step_m: 1e5, ..SumDensity::default() });
        let nodes = Nodes::new(&sources, settled.observer_altitude_m, &settled.density);
        let tables = settled.solve(nodes, &rows, &|| ()).unwrap();
        let log_sent = settled.log_sent(8f64.to_radians());
        // The lowest and the highest altitude are solved themselves.
        let between = 3..12;
        let at = |index: usize, row: usize| {
            let (weights, source) = (&tables.nodes.cut_weights[index], &sources[index].source);
            tables.cut.log_at(row, weights, source, view_directions()[row].azimuth_rad)[1] + log_sent
        };
        between
            .flat_map(|index| (0..rows.len()).map(move |row| (index, row)))
            .map(|(i, row)| at(i, row))
            .collect()
    };
    let settled = settled(&SumDensity::default());
    let weights = settled.emission.weights();
    let mut log_left = Vec::new();
    for &altitude_m in &altitudes_m[1..4] {
        let open = settled.setting(altitude_m).unwrap();
        let fields = [open, open.behind(8f64.to_radians()).unwrap()]
            .map(|setting| SourceField::solve(setting, &settled.resolution));
        for &distance_m in &distance_m {
            for direction in view_directions() {
                let [open, cut] = [0, 1].map(|which: usize| {
                    let rays =
                        ViewRow::new(&fields[which], settled.observer_altitude_m, direction.elevation_rad);
                    let lobes = rays.unwrap().radiance_per_watt(distance_m, direction.azimuth_rad - 0.4)[1];
                    lobes.iter().zip(weights).map(|(value, weight)| value * weight).sum::<f64>()
                });
                log_left.push((cut / open).ln());
            }
        }
    }
    let error = |step: f64| {
        let pairs =
            log_left_with(step).into_iter().zip(&log_left).map(|(a, b)| (a - b).abs()).collect::<Vec<_>>();
        pairs.iter().sum::<f64>() / pairs.len() as f64
    };
    let (used, sparse) = (error(SumDensity::default().cut_offset_step), error(5.0));
    println!("mean error {used:.4}; with altitudes far apart {sparse:.4}");
    assert!(used < 0.02 && sparse > 3.0 * used, "{used} {sparse}");
}
