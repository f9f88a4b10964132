//! The memory that there is, divided: packs, what is under way, open scenes, caches. Together they stay below it.

use crate::{
    config::{HttpConfig, PART_FOR_BODIES},
    state::SHARE_OF_SENDING,
};
use skyglow_observatory::CacheSizes;
use skyglow_scene::{MAX_DRAFT_BYTES, memory_limit_bytes};
use thiserror::Error;

/// Taken for the memory that there is where nobody says.
const MEMORY_IF_UNKNOWN_BYTES: u64 = 4 << 30;
/// What the program takes beside packs: code, threads, connections, and whatever is counted nowhere.
const BASE_BYTES: u64 = 256 << 20;
/// Of what packs leave, this part is nobody's: memory that is given back has holes.
const PART_FOR_HOLES: u64 = 8;
/// Of what packs leave, this part is for what is under way, unless the operator says how much, and no more than so much.
const PART_UNDER_WAY: u64 = 4;
const MAX_UNDER_WAY_BYTES: u64 = 16 << 30;
/// Of the rest, this part is for caches, and open scenes have the others.
const PART_FOR_CACHES: u64 = 3;
/// The least for caches, beside maps of the zenith's brightness.
const LEAST_CACHES_BYTES: u64 = 64 << 20;
/// Maps of the zenith's brightness that there is room for in any case: one of a scene with changes holds those too.
const LEAST_BRIGHTNESS_MAPS: u64 = 2;

/// Who has how much memory, bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MemoryShares {
    /// All that there is.
    pub limit_bytes: u64,
    /// The program with its packs.
    pub program_bytes: u64,
    /// Pictures, rasters, plans and influences that are made, and answers until they are sent.
    pub under_way_bytes: u64,
    /// The same of bodies of requests, and of answers that were not counted when they were made.
    pub in_transit_bytes: u64,
    /// Open scenes and what is made of them.
    pub observatory: CacheSizes,
    /// Draft plans.
    pub drafts_bytes: u64,
    /// Rendered skies.
    pub skies_bytes: u64,
    /// Maps of influences.
    pub influences_bytes: u64,
    /// Maps of the zenith's brightness.
    pub brightnesses_bytes: u64,
}

/// Too little memory for the packs and the least of the rest.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "{} MiB of memory are too little: the program with its packs takes {}, what is under way up to {} (memory_budget_bytes), and \
     open scenes and caches take {} at least; give it more memory, or fewer packs",
    mib(*limit_bytes), mib(*program_bytes), mib(*under_way_bytes), mib(*least_bytes)
)]
pub struct TooLittleMemory {
    limit_bytes: u64,
    program_bytes: u64,
    under_way_bytes: u64,
    least_bytes: u64,
}

fn mib(bytes: u64) -> u64 {
    bytes.div_ceil(1 << 20)
}

impl MemoryShares {
    /// Bytes that packs may take at most, where there is room for nothing else.
    pub fn most_for_packs() -> u64 {
        memory_limit_bytes().unwrap_or(MEMORY_IF_UNKNOWN_BYTES).saturating_sub(BASE_BYTES)
    }

    /// Divides what the control group or the machine has.
    ///
    /// * `packs_bytes`: of main memory that packs take.
    /// * `brightness_map_bytes`: of one map of the zenith's brightness, which the cache always has room for.
    ///
    /// # Errors
    /// [`TooLittleMemory`].
    pub fn of_machine(
        packs_bytes: u64,
        brightness_map_bytes: u64,
        config: &HttpConfig,
    ) -> Result<Self, TooLittleMemory> {
        let limit_bytes = memory_limit_bytes().unwrap_or(MEMORY_IF_UNKNOWN_BYTES);
        Self::of(limit_bytes, packs_bytes, brightness_map_bytes, config)
    }

    /// Divides so many bytes. What the configuration says of caches is the most that they get.
    ///
    /// # Errors
    /// [`TooLittleMemory`].
    pub fn of(
        limit_bytes: u64,
        packs_bytes: u64,
        brightness_map_bytes: u64,
        config: &HttpConfig,
    ) -> Result<Self, TooLittleMemory> {
        let program_bytes = BASE_BYTES + packs_bytes;
        let left = limit_bytes.saturating_sub(program_bytes);
        let under_way_bytes = match config.memory_budget_bytes {
            0 => (left / PART_UNDER_WAY).min(MAX_UNDER_WAY_BYTES),
            bytes => bytes,
        };
        let bodies_bytes = (under_way_bytes / PART_FOR_BODIES).max(config.body_limit_bytes as u64);
        let in_transit_bytes = under_way_bytes / SHARE_OF_SENDING + bodies_bytes;
        let rest = (left - left / PART_FOR_HOLES).saturating_sub(under_way_bytes + in_transit_bytes);
        let for_caches = rest / PART_FOR_CACHES;
        let least_brightnesses_bytes = LEAST_BRIGHTNESS_MAPS * brightness_map_bytes;
        let least_bytes = LEAST_CACHES_BYTES + least_brightnesses_bytes;
        if for_caches < least_bytes {
            return Err(TooLittleMemory {
                limit_bytes,
                program_bytes,
                under_way_bytes: under_way_bytes + in_transit_bytes,
                least_bytes: PART_FOR_CACHES * least_bytes,
            });
        }
        let most = CacheSizes::most(rest - for_caches);
        let others = [
            most.changed_scenes_bytes,
            most.light_bytes,
            most.ready_requests_bytes,
            MAX_DRAFT_BYTES,
            config.cache_bytes,
            config.influence_cache_bytes,
        ];
        let of_others: u128 = others.iter().map(|bytes| u128::from(*bytes)).sum();
        let wanted = of_others + u128::from(config.brightness_cache_bytes);
        let brightnesses_bytes =
            part(config.brightness_cache_bytes, for_caches, wanted).max(least_brightnesses_bytes);
        let [
            changed_scenes_bytes,
            light_bytes,
            ready_requests_bytes,
            drafts_bytes,
            skies_bytes,
            influences_bytes,
        ] = others.map(|bytes| part(bytes, for_caches - brightnesses_bytes, of_others));
        Ok(Self {
            limit_bytes,
            program_bytes,
            under_way_bytes,
            in_transit_bytes,
            observatory: CacheSizes { changed_scenes_bytes, light_bytes, ready_requests_bytes, ..most },
            drafts_bytes,
            skies_bytes,
            influences_bytes,
            brightnesses_bytes,
        })
    }

    /// Caches together, bytes; those of answers are among what is under way.
    pub fn caches_bytes(&self) -> u64 {
        let CacheSizes { changed_scenes_bytes, light_bytes, ready_requests_bytes, .. } = self.observatory;
        [changed_scenes_bytes, light_bytes, ready_requests_bytes].iter().sum::<u64>()
            + self.drafts_bytes
            + self.skies_bytes
            + self.influences_bytes
            + self.brightnesses_bytes
    }

    /// The configuration with these shares in place of the most that it allows.
    #[must_use]
    pub fn put_into(&self, config: HttpConfig) -> HttpConfig {
        HttpConfig {
            memory_budget_bytes: self.under_way_bytes,
            cache_bytes: self.skies_bytes,
            influence_cache_bytes: self.influences_bytes,
            brightness_cache_bytes: self.brightnesses_bytes,
            ..config
        }
    }
}

/// What is had of `wanted` bytes where all want `sum`, and so many are there.
fn part(wanted: u64, there: u64, sum: u128) -> u64 {
    let had = u128::from(wanted) * u128::from(there).min(sum) / sum.max(1);
    u64::try_from(had).unwrap_or(u64::MAX)
}

impl std::fmt::Display for MemoryShares {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "of {} MiB of memory the program with its packs takes {}, open scenes have {}, what is under way {}, caches {}",
            mib(self.limit_bytes),
            mib(self.program_bytes),
            mib(self.observatory.scenes_bytes),
            mib(self.under_way_bytes + self.in_transit_bytes),
            mib(self.caches_bytes()),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GIB: u64 = 1 << 30;
    const MIB: u64 = 1 << 20;
    const MAP_BYTES: u64 = 7_200_000;

    fn shares(
        limit_bytes: u64,
        packs_bytes: u64,
        config: &HttpConfig,
    ) -> Result<MemoryShares, TooLittleMemory> {
        MemoryShares::of(limit_bytes, packs_bytes, MAP_BYTES, config)
    }

    fn sum(shares: &MemoryShares) -> u64 {
        shares.program_bytes
            + shares.under_way_bytes
            + shares.in_transit_bytes
            + shares.observatory.scenes_bytes
            + shares.caches_bytes()
    }

    /// Everything together is below what there is, and grows with it up to the most that is of use.
    #[test]
    fn all_shares_together_stay_below_the_limit() {
        let config = HttpConfig::default();
        let mut before: Option<MemoryShares> = None;
        for (gib, packs_mib) in [(1, 200), (2, 900), (4, 900), (16, 900), (64, 900)] {
            let shares = shares(gib * GIB, packs_mib * MIB, &config).unwrap();
            assert!(sum(&shares) <= gib * GIB, "{gib} GiB: {shares:?}");
            assert!(sum(&shares) > shares.program_bytes + (gib * GIB - shares.program_bytes) / 2 || gib > 16);
            assert!(
                shares.brightnesses_bytes >= 2 * MAP_BYTES && shares.drafts_bytes > 4 * MIB,
                "{shares:?}"
            );
            let effective = shares.put_into(config.clone());
            assert_eq!(
                effective.memory_budget()
                    + effective.memory_budget() / SHARE_OF_SENDING
                    + effective.body_budget(),
                shares.under_way_bytes + shares.in_transit_bytes
            );
            if let Some(before) = before.filter(|_| gib > 2) {
                assert!(before.observatory.scenes_bytes < shares.observatory.scenes_bytes);
                assert!(before.under_way_bytes < shares.under_way_bytes);
                assert!(before.caches_bytes() <= shares.caches_bytes());
            }
            before = Some(shares);
        }
        let large = before.unwrap();
        assert_eq!(large.influences_bytes, config.influence_cache_bytes);
        assert_eq!(large.observatory, CacheSizes::most(large.observatory.scenes_bytes));
    }

    /// What the operator says holds: more for what is under way leaves less for the rest, caches have no more than they may.
    #[test]
    fn what_the_operator_says_holds() {
        let config =
            HttpConfig { memory_budget_bytes: GIB, influence_cache_bytes: 8 * MIB, ..HttpConfig::default() };
        let shares = shares(4 * GIB, 900 * MIB, &config).unwrap();
        assert_eq!(shares.under_way_bytes, GIB);
        assert!(shares.influences_bytes <= 8 * MIB && sum(&shares) <= 4 * GIB, "{shares:?}");
        let much = HttpConfig { influence_cache_bytes: u64::MAX, cache_bytes: u64::MAX, ..config };
        assert!(sum(&self::shares(16 * GIB, 900 * MIB, &much).unwrap()) <= 16 * GIB);
    }

    /// Where packs and the least of the rest do not fit, it says so.
    #[test]
    fn too_little_memory_is_refused() {
        let config = HttpConfig::default();
        let refused = shares(GIB, 900 * MIB, &config).unwrap_err().to_string();
        assert!(
            refused.starts_with("1024 MiB of memory are too little: the program with its packs takes 1156"),
            "{refused}"
        );
        let budget = HttpConfig { memory_budget_bytes: 3 * GIB, ..config };
        assert!(shares(4 * GIB, 900 * MIB, &budget).is_err());
    }
}
