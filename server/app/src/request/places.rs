//! Places of the world by name, and the scene in which each lies.

use crate::{
    error::AppError,
    parameters::{self as p, ParameterSet},
    reader::Reader,
    validation::ValidationCode,
};
use serde::Serialize;
use skyglow_scene::{Gazetteer, SceneMetadata, WorldPlace, is_within};
use utoipa::ToSchema;

/// So many are answered at most.
const MAX_FOUND: usize = 10;
/// Characters of a name.
const MAX_NAME_CHARS: usize = 100;

/// A place that was found.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct FoundPlace {
    /// The place, of GeoNames (CC BY 4.0).
    #[serde(flatten)]
    pub place: WorldPlace,
    /// Id of the scene in which it lies: measured light before made-up light, then the finest pixels.
    pub scene: Option<String>,
}

/// Reads a name and finds the world's places of that name, the most populous of those that have it whole first.
///
/// # Errors
/// [`AppError::Parameters`].
pub fn world_places(query: Option<&str>, scenes: &[SceneMetadata]) -> Result<Vec<FoundPlace>, AppError> {
    let mut reader = Reader::new(query, p::WorldPlacesParameters::ALL);
    let name = reader.text(&p::NAME).map(|name| name.trim().to_owned());
    let code = match &name {
        None => Some(ValidationCode::Missing),
        Some(name) if name.is_empty() => Some(ValidationCode::Malformed),
        Some(name) if name.chars().count() > MAX_NAME_CHARS => Some(ValidationCode::NotAllowed),
        Some(_) => None,
    };
    if let Some(code) = code {
        reader.fail(&p::NAME, code, None, None);
    }
    reader.finish()?;
    let found = Gazetteer::world().search(&name.unwrap_or_default(), MAX_FOUND);
    let with_scene = |place: &WorldPlace| FoundPlace {
        place: place.clone(),
        scene: scene_at(scenes, place).map(|scene| scene.id.to_string()),
    };
    Ok(found.into_iter().map(with_scene).collect())
}

fn scene_at<'a>(scenes: &'a [SceneMetadata], place: &WorldPlace) -> Option<&'a SceneMetadata> {
    let holds = |scene: &&SceneMetadata| is_within(scene.bounds, place.latitude_deg, place.longitude_deg);
    let worse = |a: &&SceneMetadata, b: &&SceneMetadata| {
        a.illustrative.cmp(&b.illustrative).then(a.pixel_size_m.total_cmp(&b.pixel_size_m))
    };
    scenes.iter().filter(holds).min_by(worse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_and_refused() {
        let found = world_places(Some("name=nairobi"), &[]).unwrap();
        assert_eq!((found[0].place.name.as_str(), &found[0].scene), ("Nairobi", &None));
        assert!(found.len() <= MAX_FOUND);
        let long = format!("name={}", "a".repeat(MAX_NAME_CHARS + 1));
        for (query, code) in [
            (None, ValidationCode::Missing),
            (Some("name=%20%20"), ValidationCode::Malformed),
            (Some(long.as_str()), ValidationCode::NotAllowed),
        ] {
            let error = world_places(query, &[]).err().unwrap();
            assert_eq!(error.field_errors()[0].code, code, "{query:?}");
        }
    }
}
