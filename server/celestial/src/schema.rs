//! Schemas of times and dates, which are written as text.

use crate::time::{CalendarDate, Instant};
use utoipa::{
    PartialSchema, ToSchema,
    openapi::{KnownFormat, ObjectBuilder, RefOr, Schema, SchemaFormat, schema::Type},
};

fn text(format: KnownFormat) -> RefOr<Schema> {
    let format = SchemaFormat::KnownFormat(format);
    ObjectBuilder::new().schema_type(Type::String).format(Some(format)).into()
}

impl PartialSchema for Instant {
    fn schema() -> RefOr<Schema> {
        text(KnownFormat::DateTime)
    }
}

impl ToSchema for Instant {}

impl PartialSchema for CalendarDate {
    fn schema() -> RefOr<Schema> {
        text(KnownFormat::Date)
    }
}

impl ToSchema for CalendarDate {}
