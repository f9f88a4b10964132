//! The dark reference as it is seen: the sky of no time in particular, overhead, through the air of a request
//! (`docs/model.md#dark-reference`).

use skyglow_celestial::{
    Component,
    dark_reference::{COMPONENTS, irradiance_of_rings, radiance_outside},
};
use skyglow_physics::{BAND_COUNT, EvenSky, NodeLight, Turbidity};
use skyglow_render::celestial::CelestialTables;
use std::sync::{Arc, LazyLock};

/// The dark reference at the zenith of an eye so high above the sea, m; without tables that outside the air.
pub fn dark_sky(tables: Option<&CelestialTables>, turbidity: Turbidity, altitude_m: f64) -> EvenSky {
    let through = tables.map(|tables| tables.transmittance(turbidity, 0.0, altitude_m));
    let light = |component: Component, kernel: [f64; BAND_COUNT]| NodeLight {
        light: Arc::clone(component.light()),
        kernel,
    };
    let direct = |component: Component| {
        let radiance = radiance_outside(component, 1.0, altitude_m);
        std::array::from_fn(|band| radiance[band] * through.map_or(1.0, |through| through[band]))
    };
    let scattered = tables.map_or([[0.0; BAND_COUNT]; COMPONENTS.len()], |tables| {
        let angles_rad = tables.zenith_angles_rad();
        let rings = COMPONENTS.map(|component| irradiance_of_rings(component, angles_rad, altitude_m));
        tables.zenith_of_rings(turbidity, &rings, altitude_m)
    });
    let background = COMPONENTS.into_iter().zip(scattered).map(|(component, mut kernel)| {
        if component != Component::Stars {
            kernel
                .iter_mut()
                .zip(direct(component))
                .for_each(|(sum, direct): (&mut f64, f64)| *sum += direct);
        }
        light(component, kernel)
    });
    EvenSky {
        background: background.collect(),
        stars: vec![light(Component::Stars, direct(Component::Stars))],
        is_through_air: tables.is_some(),
    }
}

/// The dark reference outside the air, over sea level.
pub fn dark_outside() -> &'static EvenSky {
    static OUTSIDE: LazyLock<EvenSky> = LazyLock::new(|| dark_sky(None, Turbidity::default(), 0.0));
    &OUTSIDE
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_physics::{Response, photometry::brightness_mag_arcsec2};
    use std::path::Path;

    /// As measured at dark sites between solar minimum (22.0 to 22.1) and maximum (21.6); thicker air takes little of it, since it
    /// scatters as much towards the zenith as it takes; stars are a tenth of a magnitude to a meter.
    #[test]
    fn the_reference_is_that_of_dark_sites() {
        let packs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../precomputed");
        let tables = CelestialTables::open(&packs).unwrap().unwrap();
        let of = |turbidity: f64, altitude_m: f64| {
            dark_sky(Some(&tables), Turbidity::new(turbidity).unwrap(), altitude_m)
        };
        let magnitude = |value: f64| brightness_mag_arcsec2(value).unwrap();
        let in_v = |sky: &EvenSky| magnitude(sky.value(&Response::JohnsonV));
        let (site, outside) = (of(1.5, 2_400.0), dark_sky(None, Turbidity::new(1.5).unwrap(), 2_400.0));
        assert!(site.is_through_air && !outside.is_through_air);
        assert!((21.75..22.0).contains(&in_v(&site)), "{}", in_v(&site));
        let gain = magnitude(site.value(&Response::Sqm)) - magnitude(site.meter_value(&Response::Sqm));
        assert!((0.05..0.2).contains(&gain), "{gain}");
        for (turbidity, altitude_m) in [(1.5, 0.0), (2.5, 0.0), (2.5, 1_000.0), (6.0, 0.0)] {
            let loss = in_v(&of(turbidity, altitude_m)) - in_v(&outside);
            println!("{turbidity} {altitude_m}: {:.3}", in_v(&of(turbidity, altitude_m)));
            assert!((0.0..0.35).contains(&loss), "{turbidity} {altitude_m}: {loss}");
        }
        // Between turbidities and altitudes it changes by little.
        let step = |turbidity: f64, altitude_m: f64| {
            (in_v(&of(turbidity, altitude_m)) - in_v(&of(turbidity + 0.01, altitude_m + 10.0))).abs()
        };
        for turbidity in [1.5, 1.9, 2.0, 2.49, 2.5, 3.0, 4.7] {
            assert!(step(turbidity, 495.0) < 2e-3, "{turbidity}");
        }
    }
}
