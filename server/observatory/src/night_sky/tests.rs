use super::*;
use skyglow_physics::{BrokenClouds, SKY_RESPONSES, panorama::solid_angle_sr};
use skyglow_tables::CelestialTable;
use std::{f64::consts::PI, sync::LazyLock};

static TABLES: LazyLock<CelestialTables> = LazyLock::new(|| {
    let table = |turbidity: f64| CelestialTable::synthetic(Turbidity::new(turbidity).unwrap());
    CelestialTables::new(vec![table(2.0), table(2.5)]).unwrap()
});

/// Over Barcelona, 100 m.
pub(super) fn sky(utc: &str, horizon: &Horizon, skipping: Skipping) -> NightSky {
    between(None, utc, horizon, skipping)
}

fn between(gaps: Option<&Gaps>, utc: &str, horizon: &Horizon, skipping: Skipping) -> NightSky {
    let over = Overhead {
        place: GeoPoint::from_deg(41.38, 2.17).unwrap(),
        altitude_m: 100.0,
        horizon,
        turbidity: Turbidity::new(2.5).unwrap(),
        gaps,
    };
    let time = SkyTime { instant: Instant::parse(utc).unwrap(), solar_flux_sfu: 100.0 };
    NightSky::with(&TABLES, &over, time, &SKY_RESPONSES, skipping).unwrap()
}

fn components(sky: &NightSky) -> Vec<Component> {
    sky.components().iter().map(|sky| sky.component).collect()
}

/// A moonless night, one with the full Moon up, and noon.
const NEW_MOON: &str = "2026-08-12T23:00:00Z";
const FULL_MOON: &str = "2026-08-28T00:00:00Z";
const NOON: &str = "2026-08-12T11:50:00Z";

/// By day the Sun alone is looked for, by night with the Moon deep down all but these two.
#[test]
fn what_does_not_count_is_not_looked_for() {
    let open = Horizon::flat();
    let of = |utc: &str| components(&sky(utc, &open, Skipping::OfWhatDoesNotCount));
    assert_eq!(of(NOON), [Component::Sun]);
    let night = [
        Component::Planets,
        Component::Stars,
        Component::Starlight,
        Component::ZodiacalLight,
        Component::Airglow,
    ];
    assert_eq!(of(NEW_MOON), night);
    assert_eq!(of(FULL_MOON), [&[Component::Moon], &night[..]].concat());
}

/// A closed layer sends down its share of the illuminance from above, moonlight included, the same in every direction.
#[test]
fn the_moon_shines_through_clouds() {
    let open = Horizon::flat();
    let clear = sky(FULL_MOON, &open, Skipping::OfNothing);
    let gaps = BrokenClouds::CLOSED.gaps(1_400.0, 0.4);
    let overcast = between(Some(&gaps), FULL_MOON, &open, Skipping::OfNothing);
    let plane = |sky: &NightSky| sky.seen().seen_by(&Response::Photopic).unwrap().to_vec();
    let onto_level = |at: usize, value: &f32| {
        let row = at / AZIMUTH_COUNT;
        f64::from(*value) * elevation_rad(row).sin() * solid_angle_sr(row)
    };
    let scattered_lx: f64 = plane(&clear).iter().enumerate().map(|(at, value)| onto_level(at, value)).sum();
    let straight_lx: f64 = Component::ALL
        .iter()
        .flat_map(|component| clear.points[component.index()].iter().map(move |point| (component, point)))
        .map(|(component, point)| {
            let level = point.direction.elevation_rad.sin();
            component.light().rule(&Response::Photopic).value(point.irradiance.map(|value| level * value))
        })
        .sum();
    assert!(straight_lx > scattered_lx, "{straight_lx} {scattered_lx}");
    let wanted_cd_m2 = 0.4 * (scattered_lx + straight_lx) / PI;
    for value in plane(&overcast) {
        assert!((f64::from(value) / wanted_cd_m2 - 1.0).abs() < 2e-3, "{value} {wanted_cd_m2}");
    }
    assert!(overcast.points.iter().all(Vec::is_empty));
}

/// What is left out changes the sky by less than the bound, and by dusk, where it counts, nothing is.
#[test]
fn what_is_left_out_is_within_its_bound() {
    let open = Horizon::flat();
    let mut left_out = 0;
    for utc in [NOON, "2026-08-12T18:50:00Z", "2026-08-12T19:05:00Z", "2026-08-12T20:30:00Z", FULL_MOON] {
        let [all, some] =
            [Skipping::OfNothing, Skipping::OfWhatDoesNotCount].map(|skipping| sky(utc, &open, skipping));
        left_out += all.components().len() - some.components().len();
        let luminances = [&all, &some].map(|sky| sky.seen().seen_by(&Response::Photopic).unwrap().to_vec());
        let worst = luminances[0].iter().zip(&luminances[1]).map(|(all, some)| all / some - 1.0);
        let worst = worst.fold(0f32, f32::max);
        assert!(f64::from(worst) < 3.0 * DAY_BOUND, "{utc}: {worst:e}");
    }
    assert!(left_out > 6);
}

/// Each component is the sum of its beams: starlight of a dark night stands in its direct light, the Sun's in scattered light alone.
#[test]
fn components_have_luminances() {
    let night = sky(NEW_MOON, &Horizon::flat(), Skipping::OfWhatDoesNotCount);
    for component in night.components() {
        let is_point = !component.component.is_extended();
        assert_eq!(component.direct_illuminance_lx > 0.0, is_point, "{component:?}");
        assert!(component.zenith_luminance_cd_m2 > 0.0 && component.mean_luminance_cd_m2 > 0.0);
    }
    let of = |component| night.components().iter().find(|sky| sky.component == component).unwrap();
    let airglow = of(Component::Airglow);
    assert!((3e-5..3e-4).contains(&airglow.zenith_luminance_cd_m2), "{airglow:?}");
    let day = sky(NOON, &Horizon::flat(), Skipping::OfWhatDoesNotCount);
    let lux = day.components()[0].direct_illuminance_lx;
    assert!((2e4..1.4e5).contains(&lux), "{lux}");
    let seen: f64 = night.components().iter().map(|sky| sky.mean_luminance_cd_m2).sum();
    assert!(seen > 1e-4 && seen < 1e-2, "{seen}");
}

/// A full Moon lights the ground by tenths of a lux, most of it straight; a moonless night by a thousandth.
#[test]
fn the_moon_lights_the_ground() {
    let lux = |utc: &str| {
        let sky = sky(utc, &Horizon::flat(), Skipping::OfWhatDoesNotCount);
        let beams = sky.beams(Slope::default());
        beams.iter().map(|beams| beams.horizontal(&Response::Photopic)).sum::<f64>()
    };
    let (moonlit, dark) = (lux(FULL_MOON), lux(NEW_MOON));
    assert!((0.02..0.3).contains(&moonlit) && (1e-6..1e-3).contains(&dark), "{moonlit} {dark}");
}

/// Ground hides what is behind it and adds nothing.
#[test]
fn ground_hides_the_natural_sky() {
    let wall = Horizon::new((0..AZIMUTH_COUNT).map(|c| if c < 128 { 0.5 } else { 0.0 }).collect()).unwrap();
    let [open, walled] =
        [&Horizon::flat(), &wall].map(|horizon| sky(NEW_MOON, horizon, Skipping::OfWhatDoesNotCount));
    let [open_seen, walled_seen] =
        [&open, &walled].map(|sky| sky.seen().seen_by(&Response::Photopic).unwrap());
    for row in [0, 10, 40] {
        for column in [3, 200] {
            let at = row * AZIMUTH_COUNT + column;
            let hidden = wall.hides_sample(row, column);
            assert_eq!(walled_seen[at], if hidden { 0.0 } else { open_seen[at] });
        }
    }
    let [all, some] = [(&open, &Horizon::flat()), (&walled, &wall)]
        .map(|(sky, horizon)| sky.seen_stars(sky.seen().plane(1), horizon, |_, sky| sky));
    assert!(some.count.visible < all.count.visible && some.count.visible > 500);
    assert_eq!(some.limits.iter().filter(|limit| limit.limit_mag.is_none()).count(), 4);
}

/// Stars are seen by the limit of their direction: thousands in the dark, none at noon, fewer near the horizon.
#[test]
fn stars_are_seen_by_the_limit_where_they_are() {
    let open = Horizon::flat();
    let of = |utc: &str| {
        let sky = sky(utc, &open, Skipping::OfWhatDoesNotCount);
        sky.seen_stars(sky.seen().plane(1), &open, |_, sky| sky)
    };
    let (dark, moonlit, noon) = (of(NEW_MOON), of(FULL_MOON), of(NOON));
    assert!((3_500..5_000).contains(&dark.count.above_horizon), "{:?}", dark.count);
    assert!(dark.count.visible > 2 * moonlit.count.visible && moonlit.count.visible > 0);
    assert_eq!((noon.count.visible, noon.milky_way), (0, None));
    // A veil as bright as the sky hides as many as a sky of twice the light.
    let veiled = {
        let sky = sky(NEW_MOON, &open, Skipping::OfWhatDoesNotCount);
        sky.seen_stars(sky.seen().plane(1), &open, |_, sky| 2.0 * sky)
    };
    assert!(
        veiled.count.visible < dark.count.visible && veiled.limits[0].limit_mag < dark.limits[0].limit_mag
    );
    assert_eq!(veiled.limits[0].luminance_cd_m2, dark.limits[0].luminance_cd_m2);
    let [zenith, low] = [dark.limits[0], dark.limits[1]].map(|limit| limit.limit_mag.unwrap());
    assert!(zenith > low + 0.3 && (5.5..7.0).contains(&zenith), "{zenith} {low}");
    let [contrast, by_moonlight] = [dark, moonlit].map(|stars| stars.milky_way.unwrap().contrast);
    assert!((0.05..3.0).contains(&contrast) && contrast > by_moonlight, "{contrast} {by_moonlight}");
}

/// Every minute of a night at the pole, on the equator, in polar day and under a Sun in the zenith, every direction and response: nothing
/// is negative or dark, and no logarithm bends by more than 0.05 from minute to minute; in twilight it changes by a third.
#[test]
#[ignore = "slow: `make check` leaves it to `make test`"]
fn no_minute_of_a_day_jumps() {
    let packs = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../precomputed");
    let tables = CelestialTables::open(&packs).unwrap().unwrap();
    let open = Horizon::flat();
    for (place, from_utc, minutes) in [
        ((90.0, 0.0), "2026-10-03T12:00:00Z", 360),
        ((0.0, 10.0), "2026-08-12T16:00:00Z", 840),
        ((75.0, 20.0), "2026-06-21T18:00:00Z", 360),
        // The Sun stands 0.1° from the zenith on this noon.
        ((23.4, 0.0), "2026-06-21T11:00:00Z", 120),
    ] {
        let over = Overhead {
            place: GeoPoint::from_deg(place.0, place.1).unwrap(),
            altitude_m: 0.0,
            horizon: &open,
            turbidity: Turbidity::new(2.5).unwrap(),
            gaps: None,
        };
        let from = Instant::parse(from_utc).unwrap();
        let logs: Vec<Vec<f32>> = (0..minutes)
            .into_par_iter()
            .map(|minute| {
                let time = SkyTime { instant: from.plus_s(60.0 * f64::from(minute)), solar_flux_sfu: 100.0 };
                let sky = NightSky::new(&tables, &over, time, &SKY_RESPONSES).unwrap();
                let all = (0..SKY_RESPONSES.len()).flat_map(|place| sky.seen().plane(place));
                let logs: Vec<f32> = all.map(|value| value.ln()).collect();
                assert!(logs.iter().all(|log| log.is_finite()), "{place:?}, minute {minute}");
                logs
            })
            .collect();
        let (mut worst, mut step) = ((0.0, 0), 0.0f32);
        for (minute, three) in logs.windows(3).enumerate() {
            for ((before, now), after) in three[0].iter().zip(&three[1]).zip(&three[2]) {
                let bend = (after - 2.0 * now + before).abs();
                step = step.max((after - now).abs());
                worst = if bend > worst.0 { (bend, minute + 1) } else { worst };
            }
        }
        println!(
            "{place:?}: bends by {:.4} in minute {}, changes by {step:.3} a minute at most",
            worst.0, worst.1
        );
        assert!(worst.0 < 0.05, "{place:?}: {:.3} in minute {}", worst.0, worst.1);
    }
}
