//! How the document says lists of pairs of numbers.

use utoipa::openapi::{
    RefOr, Schema, Type,
    schema::{ArrayBuilder, ObjectBuilder, SchemaType},
};

/// Lists of so many pairs at least, and a thousand at most.
fn pairs(least: usize) -> ArrayBuilder {
    let pair = ArrayBuilder::new()
        .items(ObjectBuilder::new().schema_type(Type::Number))
        .min_items(Some(2))
        .max_items(Some(2));
    ArrayBuilder::new().items(pair).min_items(Some(least)).max_items(Some(1000))
}

/// A closed curve on the sky, or none.
pub(super) fn curve_schema() -> RefOr<Schema> {
    let example = serde_json::json!([[10.0, 20.0], [50.0, 20.0], [30.0, 60.0]]);
    pairs(3)
        .schema_type(SchemaType::from_iter([Type::Array, Type::Null]))
        .description(Some(
            "A closed curve on the sky, corner by corner as `[azimuth_deg, elevation_deg]`; instead of the query's `region`.",
        ))
        .examples([example])
        .into()
}

/// Longitudes and latitudes of a stroke.
pub(super) fn points_schema() -> RefOr<Schema> {
    pairs(1).description(Some("Longitude and latitude of its points, degrees: 1 to 1000.")).into()
}
