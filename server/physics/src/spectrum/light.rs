//! A spectrum with the rules of the responses that were asked of it.

use super::{KernelShape, Response, SpectralRule, Spectrum};
use std::sync::{Arc, PoisonError, RwLock};

/// A kind of light: its spectrum, and what responses make of it behind a sky, found once each.
#[derive(Debug)]
pub struct Light {
    spectrum: Spectrum,
    shape: KernelShape,
    rules: RwLock<Vec<(Response, Arc<SpectralRule>)>>,
}

impl Light {
    /// Light of a spectrum, W nm⁻¹ per watt that the satellite sees.
    pub fn new(spectrum: Spectrum) -> Self {
        Self { spectrum, shape: KernelShape::Polynomial, rules: RwLock::default() }
    }

    /// The same behind skies of another shape.
    #[must_use]
    pub fn behind(self, shape: KernelShape) -> Self {
        Self { shape, ..self }
    }

    /// The spectrum, W nm⁻¹ per watt that the satellite sees.
    pub fn spectrum(&self) -> &Spectrum {
        &self.spectrum
    }

    /// What a response makes of it, in the response's unit, behind a sky of 1 m⁻² sr⁻¹ at every node.
    pub fn rule(&self, response: &Response) -> Arc<SpectralRule> {
        let known = |rules: &[(Response, Arc<SpectralRule>)]| {
            rules.iter().find(|(of, _)| of == response).map(|(_, rule)| Arc::clone(rule))
        };
        if let Some(rule) = known(&self.rules.read().unwrap_or_else(PoisonError::into_inner)) {
            return rule;
        }
        let rule = SpectralRule::of_shape(&self.spectrum, &response.curve(), self.shape);
        let rule = rule.scaled(response.value_per_w_m2_sr());
        let mut rules = self.rules.write().unwrap_or_else(PoisonError::into_inner);
        if let Some(rule) = known(&rules) {
            return rule;
        }
        let rule = Arc::new(rule);
        // Curves of users come and go; those with a name are a dozen.
        rules.retain(|(of, _)| !matches!((of, response), (Response::Custom(_), Response::Custom(_))));
        rules.push((response.clone(), Arc::clone(&rule)));
        rule
    }
}

impl PartialEq for Light {
    fn eq(&self, other: &Self) -> bool {
        self.spectrum == other.spectrum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::{LampPreset, NODE_COUNT, RGB_BANDS};

    #[test]
    fn rules_are_found_once_and_have_units() {
        let light = Light::new(LampPreset::Led4000k.spectrum());
        let rule = light.rule(&Response::Photopic);
        assert!(Arc::ptr_eq(&rule, &light.rule(&Response::Photopic)));
        let lumens = light.spectrum().lumens();
        assert!((rule.value([2.0; NODE_COUNT]) / (2.0 * lumens) - 1.0).abs() < 1e-9);
        let parts: f64 = RGB_BANDS.iter().map(|band| light.rule(band).value([1.0; NODE_COUNT])).sum();
        let whole = light.rule(&Response::Band { from_nm: 400, to_nm: 700 }).value([1.0; NODE_COUNT]);
        assert!((parts / whole - 1.0).abs() < 1e-9);
    }
}
