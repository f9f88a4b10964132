//! Writing a scene: to a folder beside its place first, which is then moved there by one rename.

use crate::error::SceneError;
use crate::grid_sections;
use crate::scene::Scene;
use crate::scene_files::{
    LAND_COVER_FILE, LIGHT_FILE, METADATA_FILE, PLACES_FILE, SKYLINES_FILE, StoredFile, StoredScene,
    TERRAIN_FILE,
};
use crate::sections;
use crate::staging::Staging;
use serde::Serialize;
use std::borrow::Cow;
use std::fs::File;
use std::io::Write;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;

/// What others may do with the files of a scene: nothing, and the group may read.
const FILE_MODE: u32 = 0o640;

/// Writes a scene and moves it to its place. `metadata.version` is filled in.
pub(crate) fn write(scenes_dir: &Path, scene: &mut Scene, replace: bool) -> Result<(), SceneError> {
    std::fs::create_dir_all(scenes_dir).map_err(SceneError::io(scenes_dir))?;
    let staging = Staging::below(scenes_dir)?;
    let mut files = Vec::new();
    let mut put = |name: &str, content: &[u8]| {
        files.push(StoredFile::new(name, content));
        write_synced(&staging.path().join(name), content)
    };
    put(LIGHT_FILE, &light_bytes(scene).map_err(SceneError::io(staging.path()))?)?;
    if !scene.terrain.is_empty() {
        let bytes = sections::pack(&scene.terrain.to_sections()).map_err(SceneError::io(staging.path()))?;
        put(TERRAIN_FILE, &bytes)?;
    }
    if !scene.land_cover.is_empty() {
        let bytes =
            sections::pack(&scene.land_cover.to_sections()).map_err(SceneError::io(staging.path()))?;
        put(LAND_COVER_FILE, &bytes)?;
    }
    if let Some(skylines) = &scene.first_layer().lights.skylines {
        let bytes = sections::pack(&skylines.to_sections()).map_err(SceneError::io(staging.path()))?;
        put(SKYLINES_FILE, &bytes)?;
    }
    if !scene.places.is_empty() {
        put(PLACES_FILE, &json(&&*scene.places, staging.path())?)?;
    }
    let stored = StoredScene::new(scene.metadata.clone(), files)
        .map_err(|error| SceneError::io(staging.path())(error.into()))?;
    scene.metadata.version.clone_from(&stored.metadata.version);
    write_synced(&staging.path().join(METADATA_FILE), &json(&stored, staging.path())?)?;
    sync_dir(staging.path())?;
    staging.move_to(&scenes_dir.join(scene.metadata.id.as_str()), &scene.metadata.id, replace)?;
    sync_dir(scenes_dir)
}

fn json<T: Serialize>(value: &T, path: &Path) -> Result<Vec<u8>, SceneError> {
    serde_json::to_vec_pretty(value).map_err(|error| SceneError::io(path)(error.into()))
}

fn light_bytes(scene: &Scene) -> Result<Vec<u8>, std::io::Error> {
    let mut parts = grid_sections::to_sections(&scene.grid, "");
    parts.push((
        "codes".into(),
        Cow::Owned(sections::pack_ascending(&scene.first_layer().lights.pixels.codes)),
    ));
    parts.push((
        "radiance".into(),
        Cow::Borrowed(bytemuck::cast_slice(&scene.first_layer().lights.pixels.radiance_nw_cm2_sr)),
    ));
    parts.push((
        "altitude".into(),
        Cow::Borrowed(bytemuck::cast_slice(&scene.first_layer().lights.pixels.altitude_m)),
    ));
    parts.extend(scene.mask.to_sections());
    sections::pack(&parts)
}

fn write_synced(path: &Path, content: &[u8]) -> Result<(), SceneError> {
    let write = || -> std::io::Result<()> {
        let mut file = File::options().write(true).create_new(true).mode(FILE_MODE).open(path)?;
        file.write_all(content)?;
        file.sync_all()
    };
    write().map_err(SceneError::io(path))
}

pub(crate) fn sync_dir(path: &Path) -> Result<(), SceneError> {
    File::open(path).and_then(|dir| dir.sync_all()).map_err(SceneError::io(path))
}
