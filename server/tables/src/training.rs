//! The training set of a basis: sample points by a low-discrepancy sequence (R₃, Roberts 2018), their images and weights.

use crate::{
    axes::{OffsetAxis, TableAxes, clamped_node},
    clouds::clamped_geometry,
    fit::{Floor, TrainingImage},
    fit_constants::{
        BELOW_TRAINING_M, ELEVATED_TRAINING, LOW_ALTITUDE_M, OBLIQUE_IMPORTANCE, UNIFORM_SHARE_BELOW,
    },
    images::{SourceImages, images_of},
    layout::PIXEL_COUNT,
    multiple::MultipleTable,
    options::PrecomputeOptions,
};
use rayon::prelude::*;
use skyglow_physics::{Atmosphere, BAND_COUNT, Band, LOBE_COUNT, Lobe, single_source::SourceGeometry};

/// Geometries of the training set, in turn uniform over the axes, at low altitudes, elevated, and under clouds close below. Sources
/// below the sea, above the highest altitude or up an impossible slope are left out: the basis need not serve them. So
/// are sources at clouds and above.
pub(crate) fn training_geometries(options: &PrecomputeOptions) -> Vec<SourceGeometry> {
    let (axes, cloud) = (&options.axes, options.cloud_base());
    let mut geometries = Vec::with_capacity(options.training_geometries);
    for i in 1..100 * options.training_geometries {
        // Powers of 1/1.2207…, the three-dimensional golden ratio: R₃, an additive recurrence.
        let spread = [0.819_172_5, 0.671_043_6, 0.549_700_5].map(|ratio| (i as f64 * ratio + 0.3).fract());
        let node = match geometries.len() % if cloud.is_some() { 4 } else { 3 } {
            0 => uniform_node(axes, spread),
            1 => low_node(axes, spread),
            2 => elevated_node(axes, spread),
            _ => below_node(axes, spread),
        };
        let geometry = geometry_of(axes, node);
        let (offset_m, distance_m) = offset_and_distance_m(&geometry);
        let steepest_m = (0.7 * distance_m + 50.0).min(3_500.0);
        let is_below_clouds = clamped_geometry(geometry, cloud) == geometry;
        if (-600.0..=6_500.0).contains(&geometry.source_altitude_m)
            && offset_m <= steepest_m
            && is_below_clouds
        {
            geometries.push(geometry);
        }
        if geometries.len() == options.training_geometries {
            break;
        }
    }
    geometries
}

/// The geometry of an (observer, distance, offset), the offset on the axis about the shadow's edge.
fn geometry_of(axes: &TableAxes, (observer, distance, offset): (usize, usize, usize)) -> SourceGeometry {
    let distance_m = axes.distance_m[distance];
    let offset_m = OffsetAxis::about_shadow_edge(distance_m, axes.offset_count).offset_m(offset as f64);
    clamped_node(distance_m, axes.observer_altitude_m[observer], offset_m)
}

/// A node from numbers 0..1, all observers and distances alike, and offsets alike on each side of the kink.
fn uniform_node(axes: &TableAxes, spread: [f64; 3]) -> (usize, usize, usize) {
    let counts = [axes.observer_altitude_m.len(), axes.distance_m.len()];
    let [observer, distance] = std::array::from_fn(|k| (spread[k] * counts[k] as f64) as usize);
    let kink = OffsetAxis::about_shadow_edge(axes.distance_m[distance], axes.offset_count).kink_node as f64;
    let share = spread[2] / UNIFORM_SHARE_BELOW;
    let offset = if share < 1.0 {
        share * kink
    } else {
        let above = (spread[2] - UNIFORM_SHARE_BELOW) / (1.0 - UNIFORM_SHARE_BELOW);
        kink + above * (axes.offset_count as f64 - kink)
    };
    (observer, distance, offset as usize)
}

/// A node where people and lights are, observer and source between the sea and 1 500 m, low ones more often: few
/// nodes have both low, and in haze a far light seen from the coast is a sky of its own.
fn low_node(axes: &TableAxes, spread: [f64; 3]) -> (usize, usize, usize) {
    let observers = axes.observer_altitude_m.partition_point(|&z| z <= LOW_ALTITUDE_M);
    let observer = (spread[0].powf(1.5) * observers as f64) as usize;
    let distance = (spread[1].sqrt() * axes.distance_m.len() as f64) as usize;
    let source_m = LOW_ALTITUDE_M * spread[2] * spread[2];
    let axis = OffsetAxis::about_shadow_edge(axes.distance_m[distance], axes.offset_count);
    let offset = axis.position(source_m - axes.observer_altitude_m[observer]).round() as usize;
    (observer, distance, offset)
}

/// A node whose source stands above the observer, as lights on the slopes of a valley do: the bright spot around each is at
/// another place, which takes many functions.
fn elevated_node(axes: &TableAxes, spread: [f64; 3]) -> (usize, usize, usize) {
    let [highest_m, nearest_m, farthest_m, steepest_deg] = ELEVATED_TRAINING;
    let observers = axes.observer_altitude_m.partition_point(|&z| z <= highest_m);
    let observer = (spread[0] * observers as f64) as usize;
    let distance = distance_between(axes, [nearest_m, farthest_m], spread[1]);
    let distance_m = axes.distance_m[distance];
    let axis = OffsetAxis::about_shadow_edge(distance_m, axes.offset_count);
    let offset_m = distance_m * (steepest_deg * spread[2]).to_radians().tan();
    (observer, distance, axis.position(offset_m).round() as usize)
}

/// A node whose source stands close below the observer, between that and the sea: under clouds the observer sees the lit cloud
/// overhead, and a dark horizon under it.
fn below_node(axes: &TableAxes, spread: [f64; 3]) -> (usize, usize, usize) {
    let observer = (1 + (spread[0] * (axes.observer_altitude_m.len() - 1) as f64) as usize)
        .min(axes.observer_altitude_m.len() - 1);
    let distance = distance_between(axes, BELOW_TRAINING_M, spread[1]);
    let axis = OffsetAxis::about_shadow_edge(axes.distance_m[distance], axes.offset_count);
    let offset_m = -axes.observer_altitude_m[observer] * spread[2];
    (observer, distance, axis.position(offset_m).round() as usize)
}

/// The distance nearest to the one at a share 0..1 of the way between two, in logarithms.
fn distance_between(axes: &TableAxes, [nearest_m, farthest_m]: [f64; 2], share: f64) -> usize {
    let wanted_m = nearest_m * (farthest_m / nearest_m).powf(share);
    let apart = |distance_m: f64| (distance_m / wanted_m).ln().abs();
    (0..axes.distance_m.len())
        .min_by(|&a, &b| apart(axes.distance_m[a]).total_cmp(&apart(axes.distance_m[b])))
        .unwrap_or_default()
}

/// Images at the training geometries, `[geometry][atmosphere]`; `advance` is called once each.
pub(crate) fn training_images(
    atmospheres: &[Atmosphere],
    multiple: &[MultipleTable],
    geometries: &[SourceGeometry],
    advance: &(dyn Fn() + Sync),
) -> Vec<Vec<SourceImages>> {
    geometries
        .par_iter()
        .map(|geometry| {
            let images = images_of(atmospheres, multiple, geometry);
            advance();
            images
        })
        .collect()
}

/// The training set of one turbidity: images at the longest and the shortest wavelength, which have the others between them.
pub(crate) fn training_set(
    options: &PrecomputeOptions,
    geometries: &[SourceGeometry],
    images: &[Vec<SourceImages>],
    turbidity: usize,
) -> Vec<TrainingImage> {
    let mut set = Vec::with_capacity(geometries.len() * LOBE_COUNT * 2);
    for (geometry, images) in geometries.iter().zip(images) {
        let (offset_m, distance_m) = offset_and_distance_m(geometry);
        let floor = Floor::of(options.scattering, options.clouds.is_some(), offset_m, distance_m);
        for (lobe, shapes) in
            Lobe::ALL.into_iter().zip(images[turbidity].shape.chunks_exact(BAND_COUNT * PIXEL_COUNT))
        {
            let importance = if lobe == Lobe::Oblique { OBLIQUE_IMPORTANCE } else { 1.0 };
            let of_band = |band: Band| shapes[band.index() * PIXEL_COUNT..][..PIXEL_COUNT].to_vec();
            set.extend([Band::LONGEST, Band::SHORTEST].map(|band| TrainingImage {
                shape: of_band(band),
                floor,
                importance,
            }));
        }
    }
    set
}

/// Offset and distance of a node, metres.
pub(crate) fn offset_and_distance_m(geometry: &SourceGeometry) -> (f64, f64) {
    (geometry.source_altitude_m - geometry.observer_altitude_m, geometry.distance_m)
}
