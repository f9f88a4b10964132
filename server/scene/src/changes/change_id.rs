//! Ids of scenarios and plans: truncated BLAKE3 hashes of their content.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Characters after the kind's letter and the dash: 80 bits.
const DIGITS: usize = 20;

/// The id of a scenario, `s-` and 20 hexadecimal digits, or of a plan, `p-` and as many. It is made from what it names, so the
/// same content has the same id.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct ChangeId(String);

/// Which of the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangeKind {
    /// Painted.
    Scenario,
    /// A reduction plan.
    Plan,
}

/// A text that is no id.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("an id is `s-` or `p-` and {DIGITS} hexadecimal digits")]
pub struct NoChangeId;

impl ChangeId {
    /// The id of a scenario with this content.
    pub(crate) fn of_scenario(content: &[u8]) -> Self {
        Self::of('s', content)
    }

    /// The id of a plan with this content.
    pub(crate) fn of_plan(content: &[u8]) -> Self {
        Self::of('p', content)
    }

    fn of(kind: char, content: &[u8]) -> Self {
        Self(format!("{kind}-{}", &blake3::hash(content).to_hex()[..DIGITS]))
    }

    /// From text.
    ///
    /// # Errors
    /// [`NoChangeId`].
    pub fn parse(text: &str) -> Result<Self, NoChangeId> {
        let digits = text.strip_prefix("s-").or_else(|| text.strip_prefix("p-")).ok_or(NoChangeId)?;
        let is_digit = |byte: u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte);
        let is_id = digits.len() == DIGITS && digits.bytes().all(is_digit);
        if is_id { Ok(Self(text.to_owned())) } else { Err(NoChangeId) }
    }

    /// Whether it names a plan.
    pub fn is_plan(&self) -> bool {
        self.0.starts_with('p')
    }

    /// Which of the two it names.
    pub fn kind(&self) -> ChangeKind {
        if self.is_plan() { ChangeKind::Plan } else { ChangeKind::Scenario }
    }

    /// A number for it: its first 16 digits.
    pub(super) fn number(&self) -> u64 {
        u64::from_str_radix(&self.0[2..18], 16).unwrap_or_default()
    }

    /// The id as text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl std::fmt::Display for ChangeId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl From<ChangeId> for String {
    fn from(id: ChangeId) -> Self {
        id.0
    }
}

impl TryFrom<String> for ChangeId {
    type Error = NoChangeId;

    fn try_from(text: String) -> Result<Self, NoChangeId> {
        Self::parse(&text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_read_back_and_nothing_else_is() {
        let (scenario, plan) = (ChangeId::of_scenario(b"a"), ChangeId::of_plan(b"a"));
        assert!(!scenario.is_plan() && plan.is_plan() && scenario != ChangeId::of_scenario(b"b"));
        for id in [scenario, plan] {
            assert_eq!(ChangeId::parse(id.as_str()), Ok(id));
        }
        for text in [
            "",
            "s-",
            "x-0123456789abcdef0123",
            "s-0123456789abcdef012",
            "s-0123456789ABCDEF0123",
            "p-../../../../../../../..",
        ] {
            assert_eq!(ChangeId::parse(text), Err(NoChangeId), "{text}");
        }
    }
}
