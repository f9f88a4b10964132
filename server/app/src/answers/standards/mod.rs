//! The documents of OGC APIs and of STAC, and coverages as CoverageJSON.

mod base;
mod collection;
mod coverage;
mod grid;
mod process;
mod stac;
mod tileset;

pub use base::Base;
pub use collection::{collection, collections, conformance, landing};
pub use coverage::{Coverage, area_coverage, position_coverage, trajectory_coverage};
pub use grid::LonLatGrid;
pub use process::{process_description, process_list, status_info};
pub use stac::{MAX_LAYER_PIXELS, StacItem, stac_catalog, stac_collection, stac_item};
pub use tileset::{finest_zoom, is_in_tileset, tile_matrix_set, tile_matrix_sets, tileset, tilesets};
