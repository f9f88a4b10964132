//! The handlers, one file a resource.

pub mod atmospheres;
pub mod docs;
mod frame;
pub mod health;
pub mod influence;
pub mod panorama;
pub mod plans;
pub mod problems;
pub mod scenarios;
pub mod scenes;
pub mod site;
pub mod sky;
pub mod tilejson;
pub mod tiles;
pub mod viewer;
