//! Scene ids: `[a-z0-9-]{1,64}`, safe as a folder name and in a URL.

use crate::error::SceneError;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Maximum length of an id, characters.
const MAX_LENGTH: usize = 64;

/// The name of a scene: 1 to 64 of `a-z`, `0-9`, `-`.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct SceneId(String);

impl SceneId {
    /// From text that must already be an id.
    ///
    /// # Errors
    /// [`SceneError::InvalidId`].
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        let allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        if text.is_empty() || text.len() > MAX_LENGTH || !text.chars().all(allowed) {
            return Err(SceneError::InvalidId { id: text.chars().take(2 * MAX_LENGTH).collect() });
        }
        Ok(Self(text.to_owned()))
    }

    /// The default id of a file: its name without extension, lower case, every run of other characters
    /// made one `-`.
    ///
    /// # Errors
    /// [`SceneError::InvalidId`] when nothing of the name is left.
    pub fn from_file_name(path: &Path) -> Result<Self, SceneError> {
        let stem = path.file_stem().map(|s| s.to_string_lossy().to_lowercase()).unwrap_or_default();
        let mut id = String::new();
        for c in stem.chars() {
            if c.is_ascii_lowercase() || c.is_ascii_digit() {
                id.push(c);
            } else if !id.is_empty() && !id.ends_with('-') {
                id.push('-');
            }
            if id.len() == MAX_LENGTH {
                break;
            }
        }
        Self::parse(id.trim_end_matches('-'))
    }

    /// The id as text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl std::fmt::Display for SceneId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl TryFrom<String> for SceneId {
    type Error = SceneError;

    fn try_from(text: String) -> Result<Self, SceneError> {
        Self::parse(&text)
    }
}

impl From<SceneId> for String {
    fn from(id: SceneId) -> Self {
        id.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_name_becomes_an_id() {
        let id = |name: &str| SceneId::from_file_name(Path::new(name)).map(String::from);
        assert_eq!(id("/x/VNP46A4_kenya_2023.tif").unwrap(), "vnp46a4-kenya-2023");
        assert_eq!(id("  Ünder (1).tiff").unwrap(), "nder-1");
        assert_eq!(id(&"a".repeat(99)).unwrap().len(), 64);
        assert!(id("日本.tif").is_err());
    }

    #[test]
    fn ids_that_could_leave_the_folder_are_refused() {
        for bad in ["", "..", "a/b", "A", "a_b", "a b", "é", &"a".repeat(65)] {
            assert!(SceneId::parse(bad).is_err(), "{bad}");
        }
        assert!(SceneId::parse("demo-2").is_ok());
        assert!(serde_json::from_str::<SceneId>("\"../x\"").is_err());
    }
}
