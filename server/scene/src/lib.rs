//! Scenes: rasters in, light and terrain pyramids, polar grids.
//!
//! [`ingest`] reads a radiance raster (and terrain, and places) with GDAL, checks it and stores a scene;
//! [`SceneStore::open`] opens one; a [`Scene`] answers queries without GDAL or files: the light around a place by
//! azimuth and distance ([`Scene::polar_grid`]), the raster's own pixels for the reference solution
//! ([`Scene::source_pixels_within`], behind terrain [`Scene::blocked_sources`]), terrain, radiance, coverage, map tiles.
//!
//! Terrain blocks light in two ways: below an observer's horizon there is no sky ([`Scene::horizon`]), and light that leaves a
//! source below the terrain around it does not count (the blocking index of a [`PolarCell`]; the skyline of
//! each light is found at ingest).
//!
//! Lights can be changed ([`Scene::changed`]): edited in areas, given other lamps, dimmed by a plan; the changed scene shares what
//! is untouched. A [`ChangeStore`] stores scenarios and plans.
//!
//! Nothing is resampled at ingest: a scene has the raster's own grid, its lit pixels, and a mask of the measured ones.

mod array;
mod blocked_sources;
mod boundary;
mod changes;
mod convolution;
mod coverage;
mod demo;
mod dual_tree;
mod error;
mod gather;
mod gazetteer;
mod geotiff;
mod grid;
mod grid_sections;
mod ground;
mod ingest;
mod land_cover;
mod lattice;
mod light_layer;
mod light_pyramid;
mod light_shares;
mod light_tree;
mod lit_pixels;
mod map_tile;
mod mask;
mod memory;
mod mercator;
mod metadata;
mod morton;
mod place_kernel;
mod polar_grid;
mod pyramid_file;
mod removed_lights;
mod scene;
mod scene_files;
mod scene_id;
mod scene_writer;
mod sections;
mod shared_scenes;
mod skyline_of_light;
mod skyline_part;
mod skyline_queue;
mod skyline_tile;
mod skyline_tiles;
mod skyline_view;
mod skylines;
mod staging;
mod store;
mod terrain;
mod turns;

pub use boundary::{Boundary, BoundaryError, MAX_BOUNDARY_CORNERS, Position};
pub use changes::{
    Account, Area, AreaError, Change, ChangeError, ChangeId, ChangeKind, ChangeLimits, ChangeStep,
    ChangeStore, ChangeStoreError, ChangeSummary, Cursor, DocumentStore, DraftShelf, Edit, Listed,
    MAX_BRUSH_POINTS, MAX_CHANGE_DEPTH, MAX_DRAFT_BYTES, MAX_EDITS, MAX_NEW_LIGHTS,
    MAX_NEW_LIGHTS_WITH_TERRAIN, NETWORK_TIERS, Outline, Owner, Page, PixelFactors, Posting, Scenario,
    StoreAway, StoredObject, StoredPlan, Viewer,
};
pub use demo::{DEMO_ID, create_demo, demo_is_wanted};
pub use dual_tree::{Observers, PatchStore, PlaceLattice, PlaceValues, PlaceWindow};
pub use error::SceneError;
pub use gazetteer::{GAZETTEER_CREDIT, Gazetteer, WorldPlace};
pub use geotiff::{RasterError, RasterMetadata};
pub use ground::Ground;
pub use ingest::{
    IngestOptions, IngestProgress, IngestStage, LandClasses, NoisePolicy, OverlapRule, RadianceUnit,
    SkylineTime, ingest,
};
pub use land_cover::{Land, SNOW_ALBEDO};
pub use light_shares::{CellShare, LightShares, LitPixel};
pub use light_tree::{FAR_BLOCK_RATIO, NO_BLOCKS_WITHIN_M};
pub use map_tile::{PixelValues, RasterTile, TileLayer};
pub use memory::{available_bytes, memory_limit_bytes};
pub use mercator::{tile_column, tile_pixel_m, tile_row, zoom_0_pixel_m};
pub use metadata::{
    Confidence, ExamplePlace, GridMetadata, IngestReport, NamedPlace, NoiseReport, PixelCount, Recognition,
    SceneMetadata, TerrainReport, is_within,
};
pub use place_kernel::{AzimuthFactor, PlaceKernel, UniformAxis};
pub use polar_grid::{AZIMUTH_COLUMN_COUNT, NearLight, PolarCell, PolarGrid, RING_COUNT, ring_distance_m};
pub use scene::{Prepared, Scene, SumWay};
pub use scene_id::SceneId;
pub use shared_scenes::SharedScenes;
pub use skylines::{SKYLINE_AZIMUTH_COUNT, SKYLINE_DISTANCES_M};
pub use store::{SceneList, SceneStore, UploadFolder};
pub use terrain::{GroundLine, GroundSight, SeenGround};
