//! What measuring programs share, and tests with them: reference solutions, the classes of places, how skies are judged.

pub mod class_errors;
pub mod class_scenes;
pub mod field_cache;
pub mod light_raster;
mod lit_areas;
pub mod lobe_reference;
pub mod lobe_sum;
pub mod merged_sources;
pub mod pack_source;
pub mod places;
pub mod seeds;
pub mod setup;
pub mod sky_errors;
