//! Work that a client asks about later (`Prefer: respond-async`, RFC 7240): how far it is, and what came of it for some minutes.

use crate::{
    asker::Work,
    party::{Party, Tier},
};
use axum::{
    body::Bytes,
    http::{HeaderMap, StatusCode},
};
use std::{
    cmp::Reverse,
    collections::HashMap,
    hash::{BuildHasher, RandomState},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};
use tokio::task::AbortHandle;

/// Jobs at a time, those that are done included; of one household, and of one site.
const MAX_JOBS: usize = 64;
const MAX_OF_A_HOUSEHOLD: usize = 8;
const MAX_OF_A_SITE: usize = 16;
/// How long what came of a job is there to be had; and where that is long.
const KEPT_FOR: Duration = Duration::from_secs(600);
const LONG_KEPT_FOR: Duration = Duration::from_secs(60);
/// How long it is there that nothing came of it.
const FAILURE_KEPT_FOR: Duration = Duration::from_secs(30);
/// What is longer is long, bytes.
const LONG_BYTES: usize = 1 << 20;

/// All jobs, by their ids.
#[derive(Debug, Default)]
pub(crate) struct Jobs(Mutex<HashMap<String, Job>>);

#[derive(Debug)]
struct Job {
    party: Party,
    work: Arc<Work>,
    task: Option<AbortHandle>,
    ended: Option<(Instant, Arc<Outcome>)>,
}

/// The answer that the client would have had.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outcome {
    pub(crate) status: StatusCode,
    pub(crate) headers: HeaderMap,
    pub(crate) body: Bytes,
}

/// How a job stands.
#[derive(Clone, Debug)]
pub(crate) enum Standing {
    /// It waits for its turn.
    Queued,
    /// This part is done, 0 to 1.
    Running(f64),
    /// It ended so.
    Ended(Arc<Outcome>),
}

/// No room for another job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TooMany;

impl Jobs {
    fn lock(&self) -> MutexGuard<'_, HashMap<String, Job>> {
        let mut jobs = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_kept = |(ended, outcome): &(Instant, Arc<Outcome>)| {
            let is_failure = outcome.status.is_client_error() || outcome.status.is_server_error();
            let is_long = outcome.body.len() > LONG_BYTES;
            ended.elapsed()
                < match (is_failure, is_long) {
                    (true, _) => FAILURE_KEPT_FOR,
                    (false, true) => LONG_KEPT_FOR,
                    (false, false) => KEPT_FOR,
                }
        };
        jobs.retain(|_, job| job.ended.as_ref().is_none_or(is_kept));
        jobs
    }

    /// A new job's id, which nobody can guess. Where its networks have too many, their oldest that ended goes; where there are too
    /// many in all, the oldest that ended of whoever has most.
    ///
    /// # Errors
    /// [`TooMany`] where none of them has ended.
    pub(crate) fn begin(&self, party: Party, work: Arc<Work>) -> Result<String, TooMany> {
        let mut jobs = self.lock();
        let count = |jobs: &HashMap<String, Job>, tier: Tier| {
            jobs.values().filter(|job| job.party.tiers()[usize::from(tier.0)] == tier).count()
        };
        let [_, household, site] = party.tiers();
        for (tier, most) in [(household, MAX_OF_A_HOUSEHOLD), (site, MAX_OF_A_SITE)] {
            if count(&jobs, tier) >= most {
                let of_tier = jobs.iter().filter(|(_, job)| job.party.tiers()[usize::from(tier.0)] == tier);
                let ended = of_tier.filter_map(|(id, job)| Some((job.ended.as_ref()?.0, id.clone())));
                let (_, oldest) = ended.min().ok_or(TooMany)?;
                jobs.remove(&oldest);
            }
        }
        if jobs.len() >= MAX_JOBS {
            let ended = jobs.iter().filter_map(|(id, job)| {
                let of_site = count(&jobs, job.party.tiers()[2]);
                Some((Reverse(of_site), job.ended.as_ref()?.0, id.clone()))
            });
            let (_, _, oldest) = ended.min().ok_or(TooMany)?;
            jobs.remove(&oldest);
        }
        let random: Vec<u8> =
            (0..4).flat_map(|number: u8| RandomState::new().hash_one(number).to_le_bytes()).collect();
        let id = blake3::hash(&random).to_hex()[..32].to_owned();
        jobs.insert(id.clone(), Job { party, work, task: None, ended: None });
        Ok(id)
    }

    /// Says what does a job, to be ended with it.
    pub(crate) fn set_task(&self, id: &str, task: AbortHandle) {
        match self.lock().get_mut(id) {
            Some(job) => job.task = Some(task),
            None => task.abort(),
        }
    }

    /// Says what came of a job, if it is still wanted.
    pub(crate) fn end(&self, id: &str, outcome: Outcome) {
        if let Some(job) = self.lock().get_mut(id)
            && job.ended.is_none()
        {
            job.ended = Some((Instant::now(), Arc::new(outcome)));
        }
    }

    /// How a job stands; None for one that is not known, or not any more.
    pub(crate) fn standing(&self, id: &str) -> Option<Standing> {
        let jobs = self.lock();
        let job = jobs.get(id)?;
        Some(match (&job.ended, job.work.done()) {
            (Some((_, outcome)), _) => Standing::Ended(Arc::clone(outcome)),
            (None, Some(done)) => Standing::Running(done),
            (None, None) => Standing::Queued,
        })
    }

    /// Ends a job and forgets it; whether there was one.
    pub(crate) fn cancel(&self, id: &str) -> bool {
        let job = self.lock().remove(id);
        if let Some(task) = job.as_ref().and_then(|job| job.task.as_ref()) {
            task.abort();
        }
        job.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Jobs are queued, run, end, and are gone when they are cancelled.
    #[test]
    fn a_job_stands_as_its_work_does() {
        let jobs = Jobs::default();
        let work = Arc::<Work>::default();
        let id = jobs.begin(Party::V4(1), work.clone()).unwrap();
        assert!(matches!(jobs.standing(&id), Some(Standing::Queued)));
        work.note(0.5);
        assert!(matches!(jobs.standing(&id), Some(Standing::Running(done)) if done == 0.5));
        jobs.end(&id, Outcome { status: StatusCode::CREATED, ..Outcome::default() });
        let Some(Standing::Ended(outcome)) = jobs.standing(&id) else { panic!("it ended") };
        assert_eq!(outcome.status, StatusCode::CREATED);
        assert!(jobs.cancel(&id) && !jobs.cancel(&id) && jobs.standing(&id).is_none());
    }

    /// Ended jobs of many networks make room for whoever comes.
    #[test]
    fn ended_jobs_make_room_for_others() {
        let jobs = Jobs::default();
        for number in 0..MAX_JOBS as u64 {
            let id = jobs
                .begin(Party::V6((number / 8) * 0x100 + (number / 16) * 0x1_0000), Arc::default())
                .unwrap();
            jobs.end(&id, Outcome { status: StatusCode::BAD_REQUEST, ..Outcome::default() });
        }
        assert!(jobs.begin(Party::V4(7), Arc::default()).is_ok());
        assert!(jobs.begin(Party::V4(8), Arc::default()).is_ok());
    }

    /// A party's new job takes the place of its oldest that ended, and no other's.
    #[test]
    fn a_party_has_so_many_jobs() {
        let jobs = Jobs::default();
        let begin = |party| jobs.begin(party, Arc::default());
        let other = begin(Party::V4(2)).unwrap();
        jobs.end(&other, Outcome::default());
        let ids: Vec<String> =
            (0..MAX_OF_A_HOUSEHOLD as u64).map(|of| begin(Party::V6(of)).unwrap()).collect();
        assert_eq!(begin(Party::V6(99)), Err(TooMany), "one household");
        jobs.end(&ids[3], Outcome::default());
        assert!(begin(Party::V6(99)).is_ok());
        assert!(jobs.standing(&ids[3]).is_none() && jobs.standing(&other).is_some());
    }
}
