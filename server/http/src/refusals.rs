//! Refusals that several resources have in common, for the OpenAPI document.

use crate::problem::PROBLEM_JSON;
use std::collections::BTreeMap;
use utoipa::{
    IntoResponses,
    openapi::{ContentBuilder, Ref, RefOr, Response, ResponseBuilder},
};

/// A refusal as the document has it.
pub(crate) fn refusal(description: &str) -> RefOr<Response> {
    let problem = ContentBuilder::new().schema(Some(Ref::from_schema_name("Problem"))).build();
    ResponseBuilder::new().description(description).content(PROBLEM_JSON, problem).build().into()
}

/// Of what can be a job.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Accepted;

impl IntoResponses for Accepted {
    fn responses() -> BTreeMap<String, RefOr<Response>> {
        let words = "With `Prefer: respond-async`: it is begun, and Location is the address of the job";
        let job = ContentBuilder::new().schema(Some(Ref::from_schema_name("JobAnswer"))).build();
        let accepted = ResponseBuilder::new().description(words).content("application/json", job);
        BTreeMap::from([("202".to_owned(), accepted.build().into())])
    }
}

macro_rules! refusals {
    ($($(#[$doc:meta])* $name:ident = [$($status:literal: $description:literal),* $(,)?];)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $name;

        impl IntoResponses for $name {
            fn responses() -> BTreeMap<String, RefOr<Response>> {
                BTreeMap::from([$(($status.to_owned(), refusal($description))),*])
            }
        }
    )*};
}

refusals! {
    /// Of every resource with parameters.
    BadParameters = ["400": "Bad parameters"];
    /// Of what is had of a scene.
    OfScene = ["400": "Bad parameters", "404": "No such scene"];
    /// Of what is had of a place, with a scenario or without.
    OfPlace = [
        "400": "Bad parameters",
        "404": "No such scene or scenario, or the place lies outside it: then with its bounds",
        "409": "The scenario is a plan for an earlier state of the scene",
    ];
    /// Of a sky, and what lights do to it.
    OfSky = [
        "400": "Bad parameters",
        "404": "No such scene or scenario, or the place lies outside it: then with its bounds",
        "409": "The scenario is a plan for an earlier state of the scene",
        "422": "Altitude or turbidity out of range",
        "503": "Busy; Retry-After says when to try again",
    ];
    /// Of what comes in several formats.
    NotAcceptable = ["406": "None of the accepted formats is there"];
    /// Of what takes a body.
    BodyTooLong = ["413": "The body is too long"];
    /// Of what takes a while.
    Busy = ["503": "Busy; Retry-After says when to try again"];
    /// Of what is stored for clients.
    StorageRefused = [
        "429": "More than one client may have kept in a day, or too many requests; Retry-After says when to try again",
        "503": "Busy, or nothing can be kept; Retry-After says when to try again",
    ];
    /// Of what its owner alone may do.
    NotOwner = [
        "400": "A secret that is none",
        "401": "Neither a key nor a secret",
        "403": "It is somebody else's",
        "503": "Busy, or the disk does not let it go; Retry-After says when to try again",
    ];
    /// Of what the operator alone may do.
    NotOperator = [
        "401": "No token, or a wrong one",
        "403": "Not the operator, or the server takes no uploads",
    ];
}
