//! Who asks, for fair shares: an address and the networks around it, a known client, the operator.

use skyglow_scene::NETWORK_TIERS;
use std::net::IpAddr;

/// Whom a share belongs to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Party {
    /// The system does not say.
    #[default]
    Unknown,
    /// The operator, who has no share: all is theirs.
    Operator,
    /// A known client, by the hash of its name.
    Key(u64),
    /// An address of IPv4.
    V4(u32),
    /// A /64 of IPv6, which one client holds whole.
    V6(u64),
}

/// A party, or a network around it.
pub(crate) type Tier = (u8, Party);

impl Party {
    /// The party of an address.
    pub(crate) fn of_address(address: Option<IpAddr>) -> Self {
        match address.map(|address| address.to_canonical()) {
            Some(IpAddr::V4(address)) => Self::V4(address.into()),
            Some(IpAddr::V6(address)) => Self::V6((u128::from(address) >> 64) as u64),
            None => Self::Unknown,
        }
    }

    /// The party of a known client.
    pub(crate) fn of_key(name: &str) -> Self {
        let hash = blake3::hash(name.as_bytes());
        Self::Key(hash.as_bytes().iter().take(8).fold(0, |sum, byte| sum << 8 | u64::from(*byte)))
    }

    /// The party and the networks around it, from the inside out: of IPv6 /64, /56 (a household) and /48 (a site).
    pub(crate) fn tiers(self) -> [Tier; 3] {
        match self {
            Self::V6(network) => [0_u8, 1, 2].map(|tier| {
                let bits = 64 - NETWORK_TIERS[2 - usize::from(tier)];
                (tier, Self::V6(network >> bits << bits))
            }),
            other => [0, 1, 2].map(|tier| (tier, other)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn party(address: &str) -> Party {
        Party::of_address(Some(address.parse().unwrap()))
    }

    /// Addresses of a /64 are one party, those of a /56 and a /48 share tiers.
    #[test]
    fn households_and_sites_are_tiers() {
        let own = party("2001:db8:1:200::1");
        assert_eq!(own, party("2001:db8:1:200:ffff::9"));
        let shared = |other: &str| {
            let tiers = own.tiers().into_iter().zip(party(other).tiers());
            tiers.map(|(a, b)| a == b).collect::<Vec<_>>()
        };
        assert_eq!(shared("2001:db8:1:2ff::1"), [false, true, true]);
        assert_eq!(shared("2001:db8:1:300::1"), [false, false, true]);
        assert_eq!(shared("2001:db8:2:200::1"), [false, false, false]);
        assert_eq!(party("::ffff:10.0.0.1"), party("10.0.0.1"));
        assert_ne!(Party::of_key("city"), Party::of_key("park"));
    }
}
