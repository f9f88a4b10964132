//! Sets of parameters of which not every form of an answer takes all: their defaults are said in words, for who sends every default.

use crate::parameters::{
    InfluenceParameters, InfluenceRasterParameters, MEASURE, PanoramaParameters, Parameter, ParameterSet,
    PlanListParameters, SKY, SOLAR_FLUX, TILE_MEASURE, TIME,
};
use utoipa::openapi::path::{Parameter as ApiParameter, ParameterIn};

/// Those of influences and of maps of brightness, of which not every layer of tiles takes all, or needs a place.
#[derive(Clone, Copy, Debug)]
pub struct LayerParameters;

impl utoipa::IntoParams for LayerParameters {
    fn into_params(_: impl Fn() -> Option<ParameterIn>) -> Vec<ApiParameter> {
        let optional =
            |parameter: &Parameter| Parameter { required: false, ..*parameter }.with_default_in_words();
        let of_influence = InfluenceRasterParameters::ALL.iter().filter(|one| one.name != MEASURE.name);
        of_influence.chain(&[TILE_MEASURE, SKY, TIME, SOLAR_FLUX]).map(optional).collect()
    }
}

macro_rules! negotiated_sets {
    ($($(#[$doc:meta])* $name:ident = $set:ident;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name;

        impl utoipa::IntoParams for $name {
            fn into_params(_: impl Fn() -> Option<ParameterIn>) -> Vec<ApiParameter> {
                $set::ALL.iter().map(Parameter::with_default_in_words).collect()
            }
        }
    )*};
}

negotiated_sets! {
    /// Those of a panorama in the format that is accepted, which may not take all of them.
    NegotiatedPanoramaParameters = PanoramaParameters;
    /// Those of influences in the format that is accepted.
    NegotiatedInfluenceParameters = InfluenceParameters;
    /// Those of a plan in the format that is accepted.
    NegotiatedPlanParameters = PlanListParameters;
}
