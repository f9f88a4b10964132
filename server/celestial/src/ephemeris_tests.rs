//! Positions beside those of astropy 8.0.2 with its built-in ephemeris.
//!
//! Made by `get_body(name, time, location).transform_to(AltAz(obstime=time, location=location, pressure=0))` with
//! `solar_system_ephemeris.set("builtin")`, `iers.conf.auto_download = False`; its UT1 − UTC is the measured one.

use super::*;
use proptest::prelude::*;

/// Azimuth and true altitude, degrees, and distance, au.
type Place = (f64, f64, f64);

struct Check {
    utc: &'static str,
    /// Latitude and longitude, degrees, and altitude, m.
    site: [f64; 3],
    /// Sun, Moon, then the planets outwards.
    bodies: [Place; 9],
    /// Azimuth and true altitude, degrees.
    sirius: (f64, f64),
    /// Longitude and latitude of the zenith, degrees.
    zenith_galactic_deg: (f64, f64),
}

const CHECKS: [Check; 7] = [
    Check {
        utc: "1987-04-10T19:21:00Z",
        site: [46.17, 8.79, 200.0],
        bodies: [
            (296.8103, -13.2576, 1.0019024),
            (140.8633, 47.4259, 0.0025925),
            (307.7778, -34.7190, 1.1102274),
            (317.6157, -42.9444, 1.2764691),
            (276.1527, 24.7682, 2.1442479),
            (301.6018, -23.3318, 5.9341610),
            (81.9970, -37.9175, 9.4953321),
            (79.0151, -43.3632, 18.7748226),
            (66.0066, -50.4818, 30.0056516),
        ],
        sirius: (216.9505, 19.0665),
        zenith_galactic_deg: (173.9233, 42.9537),
    },
    Check {
        utc: "1999-08-11T11:00:00Z",
        site: [48.4, 11.7, 500.0],
        bodies: [
            (171.8786, 56.7101, 1.0135439),
            (171.6469, 56.6559, 0.0024597),
            (205.9311, 57.6004, 0.8204428),
            (158.2431, 43.9507, 0.3004491),
            (104.1343, -12.2230, 1.0682118),
            (287.7026, 0.1911, 4.6139242),
            (280.5541, 10.1614, 9.1331867),
            (357.8303, -58.6975, 18.8989215),
            (21.5852, -59.4909, 29.1489954),
        ],
        sirius: (215.1422, 17.8467),
        zenith_galactic_deg: (170.9513, 41.7338),
    },
    Check {
        utc: "2010-06-21T22:00:00Z",
        site: [69.65, 18.96, 10.0],
        bodies: [
            (349.4359, 3.4530, 1.0162506),
            (224.5933, -4.6554, 0.0025416),
            (357.4521, 3.0955, 1.2837046),
            (311.0131, 7.0319, 1.1436757),
            (281.7722, 5.8774, 1.7257200),
            (77.7156, -4.9475, 4.8893258),
            (261.2452, 6.2721, 9.5120439),
            (79.0679, -4.5419, 20.0688099),
            (111.1056, -5.5183, 29.4713844),
        ],
        sirius: (333.3813, -35.2860),
        zenith_galactic_deg: (100.5144, 33.5660),
    },
    Check {
        utc: "2024-02-29T05:30:00Z",
        site: [-24.63, -70.4, 2635.0],
        bodies: [
            (163.7425, -56.4320, 0.9906765),
            (79.2988, 51.9262, 0.0026494),
            (166.6783, -55.4436, 1.3663268),
            (139.4480, -37.8728, 1.5003296),
            (137.6030, -34.9893, 2.2127734),
            (266.5847, -43.4386, 5.4002625),
            (165.0212, -54.9458, 10.7114015),
            (273.7224, -37.0458, 19.9285088),
            (194.7460, -62.1446, 30.8506738),
        ],
        sirius: (262.4012, 25.5310),
        zenith_galactic_deg: (278.0631, 33.9857),
    },
    Check {
        utc: "2026-08-20T23:16:00Z",
        site: [41.38, 2.17, 0.0],
        bodies: [
            (348.3550, -35.7011, 1.0117488),
            (240.9528, -8.5663, 0.0027033),
            (356.0868, -32.4969, 1.2987015),
            (292.1152, -33.2982, 0.6407159),
            (40.4848, -13.4506, 1.9073409),
            (7.2105, -30.4480, 6.2549557),
            (113.4955, 28.7575, 8.7198285),
            (65.7075, 4.4911, 19.5551824),
            (124.4945, 33.0732, 29.0549513),
        ],
        sirius: (65.2954, -48.5627),
        zenith_galactic_deg: (85.9993, -6.0331),
    },
    Check {
        utc: "2031-12-31T23:59:59Z",
        site: [-77.85, 166.67, 30.0],
        bodies: [
            (15.8513, 34.7880, 0.9832371),
            (232.3256, -19.7538, 0.0027287),
            (353.9552, 34.8665, 1.2559955),
            (332.1780, 29.7900, 1.1973541),
            (70.1436, 16.1996, 1.7725075),
            (16.1526, 34.7473, 6.1930341),
            (169.0194, -33.3091, 8.1084002),
            (176.8857, -35.6160, 18.1343903),
            (104.4662, -6.7761, 29.7857846),
        ],
        sirius: (194.1856, 4.9870),
        zenith_galactic_deg: (315.5553, -22.9755),
    },
    Check {
        utc: "2008-01-15T12:00:00Z",
        site: [0.0, -179.9, 0.0],
        bodies: [
            (185.6882, -68.7066, 0.9836382),
            (281.9163, -7.8882, 0.0024953),
            (225.2123, -62.9181, 1.1406905),
            (123.7695, -48.7754, 1.2405220),
            (316.0591, 51.0283, 0.6678228),
            (144.7795, -61.2429, 6.1661919),
            (75.8980, 43.3019, 8.5285637),
            (262.1690, -36.8658, 20.6971624),
            (241.1635, -57.8863, 30.9234321),
        ],
        sirius: (216.8986, 68.9094),
        zenith_galactic_deg: (218.1932, 10.1861),
    },
];

fn enu(azimuth_deg: f64, elevation_deg: f64) -> DVec3 {
    Direction { azimuth_rad: azimuth_deg.to_radians(), elevation_rad: elevation_deg.to_radians() }.enu()
}

fn positions(check: &Check) -> Positions {
    let [latitude_deg, longitude_deg, altitude_m] = check.site;
    let site = Site::new(latitude_deg, longitude_deg, altitude_m).unwrap();
    Positions::new(site, Instant::parse(check.utc).unwrap())
}

/// Within 0.005° of astropy: the most that UT1 − UTC turns the sky.
#[test]
fn bodies_are_where_astropy_has_them() {
    let bodies = [Body::Sun, Body::Moon].into_iter().chain(Planet::ALL.map(Body::Planet));
    let mut worst_deg = [0.0f64; 2];
    for check in &CHECKS {
        let positions = positions(check);
        for (body, (azimuth_deg, altitude_deg, distance_au)) in bodies.clone().zip(check.bodies) {
            let found = positions.of(body);
            let off_deg = found.direction().enu().angle_between(enu(azimuth_deg, altitude_deg)).to_degrees();
            assert!(off_deg < 0.005, "{} {body:?}: {off_deg:.4}", check.utc);
            let place = usize::from(!matches!(body, Body::Sun | Body::Moon));
            worst_deg[place] = worst_deg[place].max(off_deg);
            assert!((found.distance_au() / distance_au - 1.0).abs() < 2e-5, "{} {body:?}", check.utc);
        }
    }
    println!("Sun and Moon within {:.4}° of astropy, planets within {:.4}°", worst_deg[0], worst_deg[1]);
}

/// Stars and the axes of the maps.
#[test]
fn stars_are_where_astropy_has_them() {
    for check in &CHECKS {
        let positions = positions(check);
        // Sirius of the catalogue; its proper motion, 1.3″ a year, is in neither.
        let sirius = positions.of_star(1.767_793_059_349_06, -0.291_751_176_118_750_7);
        let off_deg = sirius.angle_between(enu(check.sirius.0, check.sirius.1)).to_degrees();
        assert!(off_deg < 0.005, "{}: {off_deg}", check.utc);
        let (longitude_deg, latitude_deg) = check.zenith_galactic_deg;
        let zenith = positions.galactic_from_enu() * DVec3::Z;
        // Galactic axes turn the other way than azimuths: east is before north.
        let expected = enu(90.0 - longitude_deg, latitude_deg);
        let off_deg = zenith.angle_between(expected).to_degrees();
        assert!(off_deg < 0.015, "{}: {off_deg}", check.utc);
    }
}

/// The first and the last hour that there is, and a day beyond for what a night looks at.
#[test]
fn positions_hold_to_the_ends() {
    for (utc, days) in [("1900-01-01T00:00:00Z", 0.0), ("2099-12-31T23:59:59Z", 0.4)] {
        let epoch = Epoch::new(Instant::parse(utc).unwrap().plus_s(days * 86_400.0));
        assert!((epoch.sun_distance_au() - 0.9833).abs() < 5e-4, "{utc}");
        assert!((epoch.geocentric_au(Body::Moon).length() * AU_M / 3.8e8 - 1.0).abs() < 0.08, "{utc}");
    }
}

#[test]
fn refraction_is_that_of_almanacs() {
    for (altitude_deg, arcmin) in [(-0.567_f64, 34.0), (0.0, 29.0), (10.0, 5.4), (45.0, 1.0), (89.9, 0.0)] {
        let apparent_rad = skyglow_physics::beam::apparent_altitude_rad(altitude_deg.to_radians(), 0.0);
        let got = (apparent_rad.to_degrees() - altitude_deg) * 60.0;
        assert!((got - arcmin).abs() < 0.6, "{altitude_deg}: {got}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Turns keep lengths, and nothing jumps within a minute: no body moves faster than the sky turns.
    #[test]
    fn positions_are_continuous(
        days in -25_000.0..47_000.0_f64, latitude in -90.0..90.0_f64, longitude in -180.0..180.0_f64,
    ) {
        let site = Site::new(latitude, longitude, 0.0).unwrap();
        let at = Instant::from_unix_s(days * 86_400.0).unwrap();
        let later = at.plus_s(60.0);
        for body in [Body::Sun, Body::Moon, Body::Planet(Planet::Mercury), Body::Planet(Planet::Neptune)] {
            let [one, two] = [at, later].map(|at| Positions::new(site, at).of(body).enu_au.normalize());
            prop_assert!(one.angle_between(two).to_degrees() < 0.27);
        }
        let turn = Positions::new(site, at).galactic_from_enu();
        prop_assert!((turn.determinant() - 1.0).abs() < 1e-12);
        prop_assert!((turn * turn.transpose()).abs_diff_eq(DMat3::IDENTITY, 1e-12));
    }
}
