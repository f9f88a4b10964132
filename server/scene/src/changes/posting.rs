//! Who has a scenario or plan stored: whom it counts for, who may remove it, and who finds it in lists.

use blake3::Hash;
use serde::{Deserialize, Serialize};
use std::net::{IpAddr, Ipv6Addr};

/// Lengths of the prefixes of IPv6 networks that one client may hold, the widest first.
pub const NETWORK_TIERS: [u32; 3] = [48, 56, 64];

/// Whom something counts for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Account {
    /// Nobody known: programs beside a server.
    #[default]
    Nobody,
    /// A client's address, and the networks around it.
    Address(IpAddr),
    /// Somebody known by a name.
    Name(String),
}

/// The network of an address that a tier of [`NETWORK_TIERS`] counts by. An address of IPv4 is its own network.
fn network_of(address: IpAddr, tier: usize) -> IpAddr {
    match (address.to_canonical(), NETWORK_TIERS.get(tier)) {
        (IpAddr::V6(address), Some(prefix)) => {
            IpAddr::V6(Ipv6Addr::from(u128::from(address) & u128::MAX << (128 - prefix)))
        }
        (address, _) => address,
    }
}

/// Numbers that stand for an account's networks, the widest first: keyed hashes, from which no address is found without the key.
pub(super) type Networks = [u64; NETWORK_TIERS.len()];

impl Account {
    pub(super) fn networks(&self, key: &[u8; 32]) -> Networks {
        let number = |text: &str| {
            let hash = blake3::keyed_hash(key, text.as_bytes());
            hash.as_bytes().iter().take(8).fold(0, |number, byte| number << 8 | u64::from(*byte))
        };
        match self {
            Account::Nobody => Networks::default(),
            Account::Address(address) => {
                std::array::from_fn(|tier| number(&format!("network {}", network_of(*address, tier))))
            }
            Account::Name(name) => [number(&format!("name {name}")); NETWORK_TIERS.len()],
        }
    }
}

/// Who may remove something: the hash of a name or a secret. The time that comparing takes says nothing about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Owner(Hash);

impl Owner {
    /// Somebody known by a name.
    pub fn by_name(name: &str) -> Self {
        Self(Hash::from_bytes(blake3::derive_key("skyglow owner by name", name.as_bytes())))
    }

    /// Whoever has a secret.
    pub fn by_secret(secret: &str) -> Self {
        Self(Hash::from_bytes(blake3::derive_key("skyglow owner by secret", secret.as_bytes())))
    }

    /// A new secret, 32 hexadecimal digits.
    ///
    /// # Errors
    /// Where the system has no random numbers.
    pub fn new_secret() -> std::io::Result<String> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes).map_err(std::io::Error::other)?;
        Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
    }

    pub(super) fn to_hex(self) -> String {
        self.0.to_hex().to_string()
    }
}

/// How something is to be stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Posting {
    /// Whom it counts for.
    pub account: Account,
    /// Who may remove it.
    pub owner: Option<Owner>,
    /// Whether lists name it to others than its owner. If not, its id follows from its owner too, so nobody else finds it.
    pub listed: bool,
    /// Whether it stays whatever its age and however much is stored.
    pub pinned: bool,
}

impl Default for Posting {
    fn default() -> Self {
        Self { account: Account::Nobody, owner: None, listed: true, pinned: false }
    }
}

/// The same as it is stored.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub(super) struct Posted {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) owner: Option<String>,
    pub(super) networks: Networks,
    pub(super) unlisted: bool,
    pub(super) pinned: bool,
    /// What the time of storage has beyond whole seconds.
    pub(super) created_ns: u32,
}

impl Posted {
    pub(super) fn new(posting: &Posting, key: &[u8; 32], created_ns: u32) -> Self {
        Self {
            owner: posting.owner.map(Owner::to_hex),
            networks: posting.account.networks(key),
            unlisted: !posting.listed,
            pinned: posting.pinned,
            created_ns,
        }
    }

    pub(super) fn is_of(&self, owner: Option<&Owner>) -> bool {
        let own = self.owner.as_ref().and_then(|text| Hash::from_hex(text).ok());
        own.zip(owner).is_some_and(|(own, other)| own == other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Addresses of one household share what the household holds, and no more.
    #[test]
    fn networks_are_shared_as_far_as_they_reach() {
        let networks = |text: &str| Account::Address(text.parse().unwrap()).networks(&[7; 32]);
        let shared = |a: &str, b: &str| {
            networks(a).iter().zip(networks(b)).filter(|(one, other)| **one == *other).count()
        };
        assert_eq!(shared("2001:db8:1:100::1", "2001:db8:1:100:ffff::2"), 3);
        assert_eq!(shared("2001:db8:1:100::1", "2001:db8:1:113::1"), 2, "a /59");
        assert_eq!(shared("2001:db8:1:100::1", "2001:db8:1:200::1"), 1);
        assert_eq!(shared("2001:db8:1:100::1", "2001:db8:2:100::1"), 0);
        assert_eq!(shared("192.0.2.1", "::ffff:192.0.2.1"), 3);
        assert_eq!(shared("192.0.2.1", "192.0.2.2"), 0);
        let address = Account::Address("192.0.2.1".parse().unwrap());
        assert_ne!(address.networks(&[7; 32]), address.networks(&[8; 32]), "the key hides addresses");
        assert_ne!(Account::Name("a".to_owned()).networks(&[7; 32]), Networks::default());
    }

    #[test]
    fn owners_are_known_by_name_or_secret() {
        let owner = Owner::by_secret("s");
        let posted = Posted::new(&Posting { owner: Some(owner), ..Posting::default() }, &[7; 32], 0);
        assert!(posted.is_of(Some(&owner)) && !posted.is_of(None));
        assert!(!posted.is_of(Some(&Owner::by_name("s"))) && !posted.is_of(Some(&Owner::by_secret("t"))));
        assert!(!Posted::default().is_of(None), "what is nobody's is not everybody's");
        assert!(!format!("{posted:?}").contains("\"s\""));
        assert_ne!(Owner::new_secret().unwrap(), Owner::new_secret().unwrap());
    }
}
