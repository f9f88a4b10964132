//! Places spread over a scene.

use skyglow_physics::GeoPoint;
use skyglow_scene::Scene;

/// Places spread over the scene's bounds (additive recurrence): the same every time.
pub fn places(scene: &Scene, count: usize) -> Vec<GeoPoint> {
    let [west, south, east, north] = scene.metadata().bounds;
    (1..)
        .map(|i| {
            let spread = |ratio: f64| (f64::from(i) * ratio).fract();
            (south + (north - south) * spread(0.754_877_666), west + (east - west) * spread(0.569_840_291))
        })
        .filter_map(|(lat, lon)| GeoPoint::from_deg(lat, lon).ok())
        .filter(|place| scene.contains(*place))
        .take(count)
        .collect()
}
