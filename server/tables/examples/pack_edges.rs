//! One row of single sources as a pack has it, against exact images, by columns from the source: where the basis rounds
//! off an edge.
//!
//! `pack_edges PACK CACHE OBSERVER_M SOURCE_M LOBE ROW [nodes]`: CACHE of `multiple_accuracy` for the pack's turbidity; LOBE 0,
//! 1, 2 are `lambert`, `horizon`, `oblique`. With `nodes` distance and offset are the nearest nodes of the pack (an observer at a node too
//! leaves the basis alone). A line for each distance: the error of red in % by columns of 1.4 degrees, and how much brighter
//! the source's own column is than column 100.

use skyglow_physics::{Atmosphere, LOBE_COUNT, Turbidity, single_source::SourceGeometry};
use skyglow_tables::{
    Pack,
    images::images_of,
    layout::{HALF_COLUMN_COUNT, PIXEL_COUNT, image_index},
};
use std::{error::Error, path::Path};

#[path = "kept_fields/mod.rs"]
mod kept_fields;
#[path = "pack_source/mod.rs"]
mod pack_source;
use pack_source::{basis_sample, coefficients_at};

const COLUMNS: [usize; 12] = [0, 1, 2, 3, 4, 6, 8, 12, 20, 32, 64, 127];
const DISTANCES_M: [f64; 9] = [4e3, 6e3, 9e3, 13e3, 18e3, 27e3, 36e3, 49e3, 66e3];
const RED: usize = 0;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (asked, at_nodes) = match arguments.as_slice() {
        [asked @ .., nodes] if nodes == "nodes" => (asked, true),
        asked => (asked, false),
    };
    let [pack, cache, observer, source, lobe, row] = asked else {
        return Err("usage: pack_edges PACK CACHE OBSERVER_M SOURCE_M LOBE ROW [nodes]".into());
    };
    let (observer_altitude_m, source_m, lobe, row): (f64, f64, usize, usize) =
        (observer.parse()?, source.parse()?, lobe.parse()?, row.parse()?);
    let mut lobes = [0.0; LOBE_COUNT];
    *lobes.get_mut(lobe).ok_or("there is no such lobe")? = 1.0;
    let pack = Pack::open(Path::new(pack))?;
    let air = Atmosphere::new(Turbidity::new(pack.manifest().turbidity)?);
    let multiple = [kept_fields::kept_table(air, Path::new(cache))?];
    for mut distance_m in DISTANCES_M {
        if at_nodes {
            let from = |node: &f64| (node / distance_m).ln().abs();
            let nodes = pack.manifest().axes.distance_m.iter().copied();
            distance_m = nodes.min_by(|a, b| from(a).total_cmp(&from(b))).ok_or("no distances")?;
        }
        let tables = pack.resident(&[distance_m]);
        let mut offset_m = source_m - observer_altitude_m;
        if at_nodes {
            let axis = &tables.offset_axis[0];
            offset_m = axis.offset_m(axis.position(offset_m).round());
        }
        let coefficients = coefficients_at(&tables, 0, observer_altitude_m, offset_m, lobes);
        let geometry = SourceGeometry {
            distance_m,
            source_altitude_m: observer_altitude_m + offset_m,
            observer_altitude_m,
        };
        let exact = images_of(&[air], &multiple, &geometry).swap_remove(0);
        let image = image_index(lobe, RED);
        let of_image = |column: usize| {
            let at = image * PIXEL_COUNT + row * HALF_COLUMN_COUNT + column;
            exact.log_scale[image].exp() * f64::from(exact.shape[at])
        };
        let of_pack = |column: usize| -> f64 {
            let functions = coefficients[RED].iter().enumerate();
            functions.map(|(k, c)| c * basis_sample(&tables, k, row, column)).sum()
        };
        let errors = COLUMNS.map(|c| format!("{c}: {:+.1}", 100.0 * (of_pack(c) / of_image(c) - 1.0)));
        println!(
            "{distance_m:6.0} m, {offset_m:+5.0} m, {:4.0} times: {}",
            of_image(0) / of_image(100),
            errors.join("  ")
        );
    }
    Ok(())
}
