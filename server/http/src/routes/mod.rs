//! The handlers, one file a resource.

pub mod atmospheres;
mod brightness;
pub mod darker;
pub mod docs;
mod frame;
pub mod health;
pub mod horizon;
pub mod influence;
pub mod jobs;
mod kept;
pub mod layers;
pub mod night;
pub mod panorama;
pub mod plans;
pub mod problems;
pub mod scenarios;
pub mod scenes;
pub mod shares;
pub mod site;
pub mod skies;
pub mod sky;
pub mod tilejson;
pub mod tiles;
pub mod uploads;
pub mod viewer;
