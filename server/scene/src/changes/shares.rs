//! Who has how much stored, by network: hierarchical max-min fairness (Bertsekas, Gallager 1992, section 6.5.2), for which the
//! oldest of the heaviest network goes first.

use super::change_id::ChangeId;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// When something was last renewed, nanoseconds since 1970, and what it is.
pub(super) type Aged = (u64, ChangeId);

/// A network with what is stored for it and those inside it.
#[derive(Debug, Default)]
pub(super) struct Share {
    /// In units of what one document weighs at least.
    weight: f64,
    parts: BTreeMap<u64, Share>,
    /// What may go, at the innermost networks.
    documents: BTreeSet<Aged>,
    /// The time of the oldest that may go, here or further inside; not kept of the outermost.
    oldest_ns: Option<u64>,
}

impl Share {
    /// Adds to what all networks of a path have stored, the widest first; less where negative.
    pub(super) fn weigh(&mut self, path: &[u64], weight: f64) {
        self.weight += weight;
        self.inside(path, |part, rest| part.weigh(rest, weight));
    }

    /// Says that something may go.
    pub(super) fn offer(&mut self, path: &[u64], document: Aged) {
        if path.is_empty() {
            self.documents.insert(document);
        } else {
            self.inside(path, |part, rest| part.offer(rest, document));
        }
    }

    /// Says that something may not go, or is gone.
    pub(super) fn withdraw(&mut self, path: &[u64], document: &Aged) {
        if path.is_empty() {
            self.documents.remove(document);
        } else {
            self.inside(path, |part, rest| part.withdraw(rest, document));
        }
    }

    fn inside(&mut self, path: &[u64], change: impl FnOnce(&mut Share, &[u64])) {
        let Some((first, rest)) = path.split_first() else { return };
        let part = self.parts.entry(*first).or_default();
        change(part, rest);
        let oldest_ns = part.parts.values().filter_map(|part| part.oldest_ns).min();
        part.oldest_ns = part.documents.first().map(|(time_ns, _)| *time_ns).or(oldest_ns);
        if part.weight < 0.5 && part.oldest_ns.is_none() {
            self.parts.remove(first);
        }
    }

    /// What goes next: of the heaviest network the heaviest inside it, and there the oldest. Within a factor of two networks are
    /// as heavy as each other, and the one with the oldest document counts as the heaviest.
    pub(super) fn next_to_go(&self) -> Option<&ChangeId> {
        let some = self.parts.values().filter(|part| part.oldest_ns.is_some());
        match some.max_by_key(|part| (part.weight.max(1.0).log2() as u32, Reverse(part.oldest_ns))) {
            Some(heaviest) => heaviest.next_to_go(),
            None => self.documents.first().map(|(_, id)| id),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn id(number: usize) -> ChangeId {
        ChangeId::of_scenario(&number.to_le_bytes())
    }

    /// Of the heaviest network the heaviest inside it loses, its oldest first, until it is as light as the others.
    #[test]
    fn the_oldest_of_the_heaviest_goes_first() {
        let mut share = Share::default();
        let light: Vec<[u64; 3]> = (0..10).map(|network| [network, 0, 0]).collect();
        let heavy: Vec<[u64; 3]> = (0..20).map(|network| [99, 1, network]).collect();
        let neighbour = [99, 2, 0];
        let all = light.iter().chain(&heavy).chain([&neighbour]);
        let mut put = Vec::new();
        for (number, path) in all.cycle().take(31 * 10).enumerate() {
            let is_once = number < 31 || heavy.contains(path);
            if is_once {
                share.weigh(path, 1.0);
                share.offer(path, (number as u64, id(number)));
                put.push((number, *path));
            }
        }
        for _ in 0..199 {
            let gone = share.next_to_go().unwrap().clone();
            let (number, path) = *put.iter().find(|(number, _)| id(*number) == gone).unwrap();
            assert!(heavy.contains(&path), "{path:?} loses {number}");
            let older = put.iter().find(|(_, other)| *other == path).unwrap();
            assert_eq!(older.0, number, "the oldest first");
            share.withdraw(&path, &(number as u64, gone));
            share.weigh(&path, -1.0);
            put.retain(|(other, _)| *other != number);
        }
        assert_eq!(put.len(), 12, "what is left: one each");
    }

    /// What may not go weighs all the same, and does not hide what may.
    #[test]
    fn what_may_not_go_weighs_all_the_same() {
        let mut share = Share::default();
        share.weigh(&[1, 1, 1], 100.0);
        share.weigh(&[2, 2, 2], 1.0);
        share.offer(&[2, 2, 2], (5, id(5)));
        assert_eq!(share.next_to_go(), Some(&id(5)));
        share.offer(&[1, 1, 1], (9, id(9)));
        assert_eq!(share.next_to_go(), Some(&id(9)));
        share.withdraw(&[1, 1, 1], &(9, id(9)));
        share.withdraw(&[2, 2, 2], &(5, id(5)));
        assert_eq!(share.next_to_go(), None);
    }
}
