//! What a picture or raster says about itself, in every format alike.

/// The line below a picture of made-up light.
pub const ILLUSTRATIVE: &str = "illustrative: made-up light, not measured";

/// A sentence of what something shows, and whether its light is made up.
pub fn description(shows: impl Into<String>, illustrative: bool) -> String {
    let mut words = shows.into();
    if illustrative {
        words.push_str("; ");
        words.push_str(ILLUSTRATIVE);
    }
    words
}

/// What a file says about its numbers, besides their unit. ASCII, as TIFF wants it.
///
/// | format | description | assumptions |
/// |---|---|---|
/// | PNG | text chunk `Description` | text chunk `Assumptions` |
/// | WebP | Exif `ImageDescription` | the same, on the next line |
/// | OpenEXR | `comments`, after the unit | attribute `assumptions` |
/// | TIFF | `ImageDescription`, after the unit | GDAL's metadata item `ASSUMPTIONS` |
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Notes {
    description: String,
    assumptions_json: String,
}

impl Notes {
    /// Notes of a sentence for people and a JSON document of all that the numbers depend on. What is not ASCII becomes
    /// `\u` escapes in the document and `?` in the sentence.
    pub fn new(description: &str, assumptions_json: &str) -> Self {
        let printable = |c: char| if (' '..='~').contains(&c) { c } else { '?' };
        let mut json = String::with_capacity(assumptions_json.len());
        for c in assumptions_json.chars() {
            if c.is_ascii() {
                json.push(c);
            } else {
                let mut units = [0; 2];
                for unit in c.encode_utf16(&mut units) {
                    json.push_str(&format!("\\u{unit:04x}"));
                }
            }
        }
        Self { description: description.chars().map(printable).collect(), assumptions_json: json }
    }

    /// The sentence; empty for none.
    pub fn description(&self) -> &str {
        &self.description
    }

    /// The document; empty for none.
    pub fn assumptions_json(&self) -> &str {
        &self.assumptions_json
    }

    /// A text that says what the samples are, and then the sentence.
    pub(crate) fn after(&self, samples: &str) -> String {
        if self.description.is_empty() {
            samples.to_owned()
        } else {
            format!("{samples}. {}", self.description)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn made_up_light_is_said_to_be_made_up() {
        assert_eq!(description("upward radiance", false), "upward radiance");
        assert_eq!(description("upward radiance", true), format!("upward radiance; {ILLUSTRATIVE}"));
    }

    /// Notes are ASCII and the document stays the same to a reader.
    #[test]
    fn notes_are_ascii_and_round_trip_as_json() {
        let notes = Notes::new("sky over Zürich", r#"{"attribution":"© Müller 𝄞"}"#);
        assert_eq!(notes.description(), "sky over Z?rich");
        assert_eq!(notes.assumptions_json(), r#"{"attribution":"\u00a9 M\u00fcller \ud834\udd1e"}"#);
        assert_eq!(notes.after("Radiance"), "Radiance. sky over Z?rich");
        assert_eq!(Notes::default().after("Radiance"), "Radiance");
    }
}
