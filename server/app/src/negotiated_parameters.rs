//! Sets of parameters of which not every form of an answer takes all: their defaults are said in words, for who sends every default.

use crate::parameters::{
    InfluenceParameters, InfluenceRasterParameters, PanoramaParameters, Parameter, ParameterSet,
    PlanListParameters,
};
use utoipa::openapi::path::{Parameter as ApiParameter, ParameterIn};

/// Those of influences where not every layer of tiles takes them, or needs a place.
#[derive(Clone, Copy, Debug)]
pub struct OptionalInfluenceParameters;

impl utoipa::IntoParams for OptionalInfluenceParameters {
    fn into_params(_: impl Fn() -> Option<ParameterIn>) -> Vec<ApiParameter> {
        let optional =
            |parameter: &Parameter| Parameter { required: false, ..*parameter }.with_default_in_words();
        InfluenceRasterParameters::ALL.iter().map(optional).collect()
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
