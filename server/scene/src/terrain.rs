//! Terrain: elevation on the rasters' own grids, and what it blocks.

mod border;
mod cell;
mod elevation;
mod horizon;
mod joining;
mod max_mipmap;
mod path;
mod raster;
mod ray;
mod sampler;
mod source_horizon;
#[cfg(test)]
mod synthetic_ground;
mod tile;
mod visible_ground;
mod visible_raster;

pub(crate) use elevation::Terrain;
pub(crate) use raster::{TerrainRaster, TerrainRasterBuilder};
pub(crate) use source_horizon::min_blocking_distance_m;
pub use visible_ground::{GroundLine, GroundSight, SeenGround};
