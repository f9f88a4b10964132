//! Values of flags, from text.

use skyglow_physics::{PhysicsError, Turbidity};

/// A turbidity of the model, from text.
pub(crate) fn turbidity(text: &str) -> Result<Turbidity, String> {
    let number: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    Turbidity::new(number).map_err(|error: PhysicsError| error.to_string())
}

/// A share of light that ground sends back, from text.
pub(crate) fn albedo(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|albedo| (0.0..=1.0).contains(albedo)).ok_or("allowed is 0 to 1".to_owned())
}

/// Optical depth of a layer of cloud, from text.
pub(crate) fn cloud_optical_depth(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|depth| (0.0..=250.0).contains(depth)).ok_or("allowed is 0 to 250".to_owned())
}
