//! The OpenAPI document: its head, and what is the same of every operation.

use crate::refusals::refusal;
use skyglow_app::{answers::CompactHeader, parquet_table};
use utoipa::{
    OpenApi,
    openapi::{
        Content, ContentBuilder, KnownFormat, ObjectBuilder, PathItem, RefOr, Response, ResponseBuilder,
        SchemaFormat, Type,
        path::Operation,
        security::{ApiKey as SecurityApiKey, ApiKeyValue, HttpAuthScheme, HttpBuilder, SecurityScheme},
    },
};

/// The document's head.
#[derive(OpenApi)]
#[openapi(
    info(
        title = "Skyglow",
        description = "The night sky of a place, brightened by the lights around it. Names carry their units; \
                       times are RFC 3339 UTC; errors are RFC 9457 problem documents."
    ),
    tags(
        (name = "sky", description = "The sky of a place"),
        (name = "influence", description = "Which lights cause the sky of a place"),
        (name = "plans", description = "What to dim, and what if: reduction plans and painted scenarios"),
        (name = "scenes", description = "Rasters of light with their terrain and places"),
        (name = "tiles", description = "Map tiles"),
        (name = "standards", description = "OGC APIs (Common, EDR, Tiles, Maps, Processes) and STAC: the same under the names of standards"),
        (name = "atmospheres", description = "Resident table packs"),
        (name = "operation", description = "For those who run the server"),
    ),
    // The head of a binary answer, and lines of answers: no path names them.
    components(schemas(CompactHeader, skyglow_app::answers::SkyLine)),
    servers((url = "/")),
    // A key is never needed: it has a rate and a quota of its own.
    security((), ("api_key" = []), ("bearer_key" = [])),
    modifiers(&Secrets)
)]
pub(crate) struct Document;

/// How clients say who they are.
struct Secrets;

impl utoipa::Modify for Secrets {
    fn modify(&self, document: &mut utoipa::openapi::OpenApi) {
        let components = document.components.get_or_insert_default();
        let bearer = |description: &str| {
            let http = HttpBuilder::new().scheme(HttpAuthScheme::Bearer).description(Some(description));
            SecurityScheme::Http(http.build())
        };
        let header =
            ApiKeyValue::with_description("X-Api-Key", "The key of a client that the operator knows");
        components.add_security_scheme("api_key", SecurityScheme::ApiKey(SecurityApiKey::Header(header)));
        components.add_security_scheme("bearer_key", bearer("The same"));
        components.add_security_scheme("operator_token", bearer("The operator's token"));
    }
}

/// What every path may answer, where it says nothing of it itself.
const OF_EVERY_PATH: [(&str, &str); 2] = [
    ("401", "A token or key that nobody has"),
    ("429", "Too many requests; Retry-After says when to try again"),
];

/// Adds what is the same of every operation of its kind, and has bodies that are no text called bytes.
pub(crate) fn complete(document: &mut utoipa::openapi::OpenApi) {
    for (path, item) in &mut document.paths.paths {
        if let Some(get) = &mut item.get
            && is_raster(get)
        {
            add_parts(get);
        }
        for operation in operations(item) {
            if path.starts_with("/api/") {
                OF_EVERY_PATH.iter().for_each(|refusal| add(operation, refusal));
            }
            for response in operation.responses.responses.values_mut() {
                let RefOr::T(response) = response else { continue };
                let is_binary = |media_type: &str| {
                    media_type.starts_with("image/")
                        || media_type == "application/zip"
                        || media_type.contains("vnd.skyglow")
                        || media_type == parquet_table::MEDIA_TYPE
                };
                let files = response.content.iter_mut().filter(|(media_type, _)| is_binary(media_type));
                files.for_each(|(_, content)| *content = RefOr::T(bytes()));
            }
        }
    }
}

fn operations(item: &mut PathItem) -> impl Iterator<Item = &mut Operation> {
    [&mut item.get, &mut item.post, &mut item.put, &mut item.delete].into_iter().flatten()
}

/// Adds a refusal that an operation does not name itself.
fn add(operation: &mut Operation, (status, description): &(&str, &str)) {
    operation.responses.responses.entry((*status).to_owned()).or_insert_with(|| refusal(description));
}

/// The schema of bytes that generators of clients know.
fn bytes() -> Content {
    let format = SchemaFormat::KnownFormat(KnownFormat::Binary);
    let schema = ObjectBuilder::new().schema_type(Type::String).format(Some(format)).build();
    ContentBuilder::new().schema(Some(schema)).build()
}

/// What an operation answers when all is well.
fn answer(operation: &Operation) -> Option<&Response> {
    match operation.responses.responses.get("200")? {
        RefOr::T(response) => Some(response),
        RefOr::Ref(_) => None,
    }
}

fn is_raster(operation: &Operation) -> bool {
    answer(operation).is_some_and(|answer| answer.content.contains_key("image/tiff"))
}

/// Says that parts of a file can be asked for.
fn add_parts(operation: &mut Operation) {
    let content = answer(operation).map(|answer| answer.content.clone()).unwrap_or_default();
    let mut part =
        ResponseBuilder::new().description("The part of it that the Range header asks for").build();
    part.content = content;
    operation.responses.responses.insert("206".to_owned(), part.into());
    add(operation, &("416", "None of the bytes asked for is there; Content-Range says how many are"));
}
