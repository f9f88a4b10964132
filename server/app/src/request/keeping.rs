//! How what is posted is kept, and which part of a list of what is kept is asked for.

use crate::{
    error::AppError,
    parameters::{self as p, ParameterSet},
    reader::Reader,
    validation::ValidationCode,
};
use skyglow_scene::Cursor;

/// Entries of a list that are answered at once unless told otherwise, as the table of parameters says.
const DEFAULT_ENTRIES: usize = 500;

/// How a scenario or plan is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Keeping {
    /// Whether lists name it to others than its owner.
    pub listed: bool,
    /// Whether it stays whatever its age and however much is kept.
    pub pinned: bool,
}

/// Part of a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListRequest {
    /// Entries in it at most.
    pub limit: usize,
    /// Where it begins; None for the newest.
    pub after: Option<Cursor>,
}

pub(super) fn read_keeping(reader: &mut Reader) -> Keeping {
    let listed = reader.choice(&p::LISTED) != Some("off");
    Keeping { listed, pinned: reader.choice(&p::PINNED) == Some("on") }
}

/// Reads which part of a list is asked for.
///
/// # Errors
/// [`AppError::Parameters`].
pub fn list_request(query: Option<&str>) -> Result<ListRequest, AppError> {
    let mut reader = Reader::new(query, p::KeptListParameters::ALL);
    let limit = reader.integer(&p::ENTRIES).map_or(DEFAULT_ENTRIES, |limit| limit as usize);
    let after = reader.text(&p::AFTER).map(Cursor::parse);
    if after == Some(None) {
        reader.fail(&p::AFTER, ValidationCode::Malformed, None, None);
    }
    reader.finish()?;
    Ok(ListRequest { limit, after: after.flatten() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_lists_are_read_or_refused() {
        let all = ListRequest { limit: DEFAULT_ENTRIES, after: None };
        assert_eq!(list_request(None), Ok(all));
        assert_eq!(p::ENTRIES.default.parse(), Ok(DEFAULT_ENTRIES));
        let part = list_request(Some("limit=2&after=17.p-0123456789abcdef0123")).unwrap();
        assert_eq!(
            (part.limit, part.after.unwrap().to_string()),
            (2, "17.p-0123456789abcdef0123".to_owned())
        );
        for bad in [
            "limit=0",
            "limit=1001",
            "limit=x",
            "after=",
            "after=17",
            "after=-1.p-0123456789abcdef0123",
            "page=2",
        ] {
            assert!(list_request(Some(bad)).is_err(), "{bad}");
        }
    }
}
