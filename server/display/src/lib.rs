//! From a sky as it is seen to a picture: projections, colour maps, legends, encoders.
//!
//! ```text
//! SeenSky  -> Sampler -> picture() -> RgbImage    -> encode_png, encode_webp     (for eyes)
//!                     -> hdr_picture_with() -> HdrImage -> encode_hdr_png          (for eyes before a screen that goes above white)
//!                     -> raster()  -> FloatRaster -> encode_exr, encode_tiff     (for programs)
//!         -> LogPlane::of_sky()                   -> encode_sky                  (for programs that draw)
//! ```
//! Pictures and rasters have the zenith at the top and north in column 0; [`SeenSky`] counts rows from the
//! horizon up. Exposure and colour range are fixed by the caller or by constants here, never taken from the
//! picture, so two places can be compared by eye; the eye alone adapts to the sky, unless the caller says to what.
//!
//! [`SeenSky`]: skyglow_physics::SeenSky

pub mod bodies;
pub mod colormap;
mod colour_bins;
pub mod encode;
pub mod error;
pub mod eye;
pub mod false_colour;
#[cfg(test)]
mod fixtures;
pub mod glare;
pub mod ground;
pub mod hdr;
mod ink;
pub mod legend;
mod lit;
pub mod notes;
pub mod options;
mod painter;
mod panels;
pub mod picture;
pub mod projection;
pub mod raster;
pub mod realistic;
mod text;
pub mod tile;

pub use bodies::{Behind, Disc, PointLight, SkyBodies};
pub use colormap::Colormap;
pub use encode::{
    LogPlane, PointTable, encode_exr, encode_hdr_png, encode_png, encode_sky, encode_tiff, encode_webp,
};
pub use error::DisplayError;
pub use false_colour::{ColourRange, Scale};
pub use hdr::{HdrImage, hdr_picture_with};
pub use notes::Notes;
pub use options::{DynamicRange, GroundStyle, PictureOptions, Projection, Sky, Style};
pub use picture::{picture, picture_with};
pub use raster::{FloatRaster, raster};
