//! What decides an answer, as one hash: for ETags and the keys of caches.

use crate::{error::AppError, facts::SourceFacts};
use serde::Serialize;
use skyglow_observatory::{BrightnessRequest, MapLight, SkyRequest};
use std::sync::LazyLock;

/// What tells this build of the program from any other: the hash of its executable, for a change in how something
/// is found, drawn or worded is another answer, whatever the version says.
pub fn program() -> &'static str {
    static HASH: LazyLock<String> = LazyLock::new(|| {
        let hash = |path| {
            let mut hasher = blake3::Hasher::new();
            hasher.update_reader(std::fs::File::open(path)?)?;
            std::io::Result::Ok(hasher.finalize().to_hex().to_string())
        };
        std::env::current_exe().and_then(hash).unwrap_or_else(|_| env!("CARGO_PKG_VERSION").to_owned())
    });
    &HASH
}

/// A request as bytes that are the same for the same request: JSON with its fields in the order of the type.
///
/// # Errors
/// [`AppError::Internal`] for what is no JSON, only by a defect.
pub fn canonical_bytes(request: &impl Serialize) -> Result<Vec<u8>, AppError> {
    serde_json::to_vec(request).map_err(AppError::internal)
}

/// The hash of everything that decides an answer's bytes, 32 hexadecimal digits. The program itself is added.
///
/// # Errors
/// As [`canonical_bytes`].
pub fn fingerprint(parts: &impl Serialize) -> Result<String, AppError> {
    hash_of(program(), parts)
}

fn hash_of(program: &str, parts: &impl Serialize) -> Result<String, AppError> {
    let mut hasher = blake3::Hasher::new();
    hasher.update(program.as_bytes());
    hasher.update(&canonical_bytes(parts)?);
    Ok(hasher.finalize().to_hex()[..32].to_owned())
}

/// What decides a sky: the request, the scene's version, the packs, the executor and what it runs on.
///
/// # Errors
/// As [`canonical_bytes`].
pub fn sky_key(request: &SkyRequest, scene_version: &str, facts: &SourceFacts) -> Result<String, AppError> {
    let device = (&facts.pack_checksums, &facts.executor, &facts.adapter);
    fingerprint(&("sky", request, scene_version, device))
}

/// What decides a map of the zenith's brightness, which is found on the processor, whatever renders skies.
///
/// # Errors
/// As [`canonical_bytes`].
pub fn brightness_key(
    request: &BrightnessRequest,
    scene_version: &str,
    facts: &SourceFacts,
) -> Result<String, AppError> {
    fingerprint(&("brightness", request, scene_version, &facts.pack_checksums))
}

/// What decides the same but for the program, whose executable is another one on each machine where it is an interpreter.
///
/// # Errors
/// As [`canonical_bytes`].
pub fn brightness_content(
    request: &BrightnessRequest,
    scene_version: &str,
    facts: &SourceFacts,
) -> Result<String, AppError> {
    let version = env!("CARGO_PKG_VERSION");
    hash_of(version, &("brightness", request, scene_version, &facts.pack_checksums))
}

/// Where the metadata of an atlas (PMTiles) has its key.
pub const ATLAS_KEY: &str = "atlas_key";
/// Where it has the parameters that it was made with.
pub const ATLAS_QUERY: &str = "atlas_query";
/// Where it has the pixels of the scene from one place to the next.
pub const ATLAS_STEP: &str = "atlas_step";
/// Where it has west, south, east and north and the least and the greatest zoom of the file when it was whole: what is cut out of it has others.
pub const ATLAS_EXTENT: &str = "atlas_extent";

/// What decides what a map shows, of however many places it is: the request, the scene's version, the packs that it is made with, and the
/// version of the program.
///
/// # Errors
/// As [`canonical_bytes`].
pub fn atlas_key(
    request: &BrightnessRequest,
    scene_version: &str,
    facts: &SourceFacts,
) -> Result<String, AppError> {
    let kind = facts.kinds_under(request.cloud_base_m).find(|kind| kind.scattering == request.scattering);
    let packs = match request.light {
        MapLight::Artificial => kind.map_or("", |kind| kind.checksums.as_str()),
        // The natural sky has tables of its own.
        MapLight::Total(_) => facts.pack_checksums.as_str(),
    };
    let of_any_size = BrightnessRequest { max_places: 0, ..request.clone() };
    hash_of(env!("CARGO_PKG_VERSION"), &("atlas", of_any_size, scene_version, packs))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers that differ in the last bit, absent fields and enum variants differ.
    #[test]
    fn canonical_bytes_tell_requests_apart() {
        let bytes = |value: &(f64, Option<&str>)| canonical_bytes(value).unwrap();
        assert_eq!(bytes(&(0.1, None)), bytes(&(0.1, None)));
        assert_ne!(bytes(&(0.1, None)), bytes(&(0.1f64.next_up(), None)));
        assert_ne!(bytes(&(0.1, None)), bytes(&(0.1, Some("null"))));
        assert_ne!(fingerprint(&("ab", "c")).unwrap(), fingerprint(&("a", "bc")).unwrap());
    }
}
