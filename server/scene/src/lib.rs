//! Scenes: rasters in, light and terrain pyramids, polar grids.
