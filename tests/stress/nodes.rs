//! A small step ε before each node and one behind it: what jumps there does not shrink with ε.

use crate::{
    checks::{Check, Outcome, Report},
    rig::{Bench, Rig, row_maxima, widened},
    walks::{LOOKS, STAND, Stand, reference_cd_m2, request_at},
};
use skyglow_physics::photometry::natural_sky_luminance_cd_m2;
use skyglow_scene::{RING_COUNT, ring_distance_m};
use std::{error::Error, f64::consts::TAU};

/// A place on an axis and a way off it, as a stand.
type Move = fn(f64, f64) -> Stand;

/// What f32 leaves: it knows the place between two offsets to 2e-6 of their distance, over which a low ray towards a lamp
/// changes by up to 4e-4; and where 64 functions nearly cancel, near a lamp, a hundred times the rounding is left.
const JUMP: f64 = 1e-3;

/// The nodes of one axis.
struct Axis {
    name: &'static str,
    nodes: Vec<f64>,
    epsilon: f64,
    at: Move,
}

pub(crate) fn run(bench: &Bench, report: &mut Report) -> Outcome {
    let rig = &bench.shipped;
    let flux_dnb_w = natural_sky_luminance_cd_m2() / reference_cd_m2(rig, STAND)?[LOOKS.len() - 1];
    for axis in axes(rig) {
        let sides = Sides { rig, axis: &axis, flux_dnb_w };
        let (mut worst, mut where_worst) = (0.0, 0.0);
        for &x in &axis.nodes {
            let found = sides.jump(x, 1.0)?;
            if found > worst {
                (worst, where_worst) = (found, x);
            }
        }
        let planted = axis.nodes.first().map_or(Ok(0.0), |&x| sides.jump(x, 1.01))?;
        let name = format!("epsilon about each node: {}", axis.name);
        let check = Check::new(name, "jump, of the row's brightest", axis.nodes.len());
        let note = format!("at {where_worst}; planted: a hundredth more light behind the node");
        report.add(check.found(worst, JUMP, planted).note(note));
    }
    Ok(())
}

/// The two sides of a node.
struct Sides<'a> {
    rig: &'a Rig,
    axis: &'a Axis,
    flux_dnb_w: f64,
}

impl Sides<'_> {
    /// The part of the step from one side of a node to the other that does not shrink with ε: 2·step(½) − step(1),
    /// of the row's brightest. Behind the node there is `more` times the light.
    fn jump(&self, x: f64, more: f64) -> Result<f64, Box<dyn Error>> {
        let sky = |by: f64| -> Result<Vec<f64>, Box<dyn Error>> {
            let stand = (self.axis.at)(x, by);
            let stand = Stand { azimuth_rad: stand.azimuth_rad.rem_euclid(TAU), ..stand };
            let flux_dnb_w = if by > 0.0 { more * self.flux_dnb_w } else { self.flux_dnb_w };
            Ok(widened(&self.rig.sky(&request_at(self.rig, stand, flux_dnb_w)?)?).collect())
        };
        let epsilon = self.axis.epsilon;
        let wide = [sky(-epsilon)?, sky(epsilon)?];
        let near = [sky(-0.5 * epsilon)?, sky(0.5 * epsilon)?];
        let brightest = row_maxima(&wide[1]);
        let mut worst: f64 = 0.0;
        for sample in 0..brightest.len() {
            let step = |sides: &[Vec<f64>; 2]| sides[1][sample] - sides[0][sample];
            let jump = (2.0 * step(&near) - step(&wide)).abs() / brightest[sample];
            worst = worst.max(if jump.is_nan() { f64::INFINITY } else { jump });
        }
        Ok(worst)
    }
}

fn axes(rig: &Rig) -> [Axis; 5] {
    let tables = &rig.set.tables()[0];
    let rings: Vec<f64> = (1..RING_COUNT - 1).map(ring_distance_m).collect();
    // The offsets of a lamp 20 km away that are nodes of its two rings.
    let ring = rings.partition_point(|distance_m| *distance_m < STAND.distance_m);
    let offsets = [ring, ring + 1]
        .into_iter()
        .flat_map(|ring| {
            (0..tables.offset_count).map(move |node| tables.offset_axis[ring].offset_m(node as f64))
        })
        .map(|offset_m| offset_m + STAND.observer_altitude_m)
        .filter(|altitude_m| (1.0..5_999.0).contains(altitude_m))
        .collect();
    let inner = |nodes: &[f64]| nodes[1..nodes.len() - 1].to_vec();
    [
        Axis {
            name: "rings",
            nodes: rings,
            epsilon: 1e-6,
            at: |x, by| Stand { distance_m: x * (1.0 + by), ..STAND },
        },
        Axis {
            name: "observer altitudes",
            nodes: inner(&tables.observer_altitude_m),
            epsilon: 1e-2,
            at: |x, by| Stand { observer_altitude_m: x + by, ..STAND },
        },
        // f32 knows altitudes of kilometres to a quarter of a millimetre.
        Axis {
            name: "source offsets",
            nodes: offsets,
            epsilon: 2e-2,
            at: |x, by| Stand { source_altitude_m: x + by, ..STAND },
        },
        Axis {
            name: "turbidities",
            nodes: inner(&rig.set.kinds()[0].turbidities),
            epsilon: 1e-6,
            at: |x, by| Stand { turbidity: x + by, ..STAND },
        },
        Axis {
            name: "azimuth columns, north among them",
            nodes: (0..256).map(|column| f64::from(column) * TAU / 256.0).collect(),
            epsilon: 1e-6,
            at: |x, by| Stand { azimuth_rad: x + by, ..STAND },
        },
    ]
}
