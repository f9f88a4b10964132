//! Valkey, or Redis: what servers of one service share that may be lost. Where it is away each server goes on by itself.

use prometheus_client::metrics::gauge::Gauge;
use redis::{Client, Connection, FromRedisValue, RedisError, cmd};
use skyglow_scene::DraftShelf;
use std::{
    sync::{
        Mutex, OnceLock, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

/// How long a connection or an answer may take.
const TIMEOUT: Duration = Duration::from_millis(500);
/// How long it is not asked again after it did not answer.
const PAUSE: Duration = Duration::from_secs(2);
/// Connections that are kept for the next question.
const MAX_IDLE: usize = 8;
/// How long a draft is there that nobody uses, seconds: as long as in memory.
const DRAFT_IDLE_S: u64 = 600;
/// Longest draft that is put there.
const MAX_DRAFT_BYTES: usize = 32 << 20;

/// A Valkey whose address cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("valkey must be an address such as redis://valkey:6379 or redis://:PASSWORD@valkey:6379/0: {0}")]
pub struct BadValkey(String);

/// The server of what is shared for some minutes.
pub struct Valkey {
    client: Client,
    idle: Mutex<Vec<Connection>>,
    failed: Mutex<Option<Instant>>,
    is_away: AtomicBool,
    /// 1 where it is away.
    gauge: OnceLock<Gauge>,
    /// Hides addresses in the names of what is counted.
    key: [u8; 32],
}

impl std::fmt::Debug for Valkey {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Valkey").field("is_away", &self.is_away).finish_non_exhaustive()
    }
}

impl Valkey {
    /// The one at an address; it is not asked yet.
    ///
    /// # Errors
    /// [`BadValkey`].
    pub fn new(address: &str) -> Result<Self, BadValkey> {
        // What the parser says does not repeat the address, which may have a password.
        let client = Client::open(address).map_err(|error| BadValkey(error.category().to_owned()))?;
        let password =
            client.get_connection_info().redis_settings().password().unwrap_or_default().to_owned();
        Ok(Self {
            client,
            idle: Mutex::default(),
            failed: Mutex::default(),
            is_away: AtomicBool::new(false),
            gauge: OnceLock::new(),
            key: blake3::derive_key("skyglow names of what is counted in valkey", password.as_bytes()),
        })
    }

    /// Says where it is noted that it is away.
    pub(crate) fn show_in(&self, gauge: Gauge) {
        gauge.set(i64::from(self.is_away.load(Ordering::Relaxed)));
        // The first is the one that is scraped.
        let _is_set = self.gauge.set(gauge);
    }

    pub(crate) fn key(&self) -> &[u8; 32] {
        &self.key
    }

    /// Asks it; None where it is away, or was a moment ago.
    pub(crate) fn ask<T: FromRedisValue>(&self, question: &redis::Cmd) -> Option<T> {
        let paused = |failed: Option<Instant>| failed.is_some_and(|at| at.elapsed() < PAUSE);
        if paused(*self.failed.lock().unwrap_or_else(PoisonError::into_inner)) {
            return None;
        }
        let kept = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let was_kept = kept.is_some();
        let mut answer = self.ask_by(kept, question);
        // A connection that was kept may have been closed meanwhile. What took too long may have been done: it is not asked again.
        if was_kept && answer.as_ref().is_err_and(RedisError::is_connection_dropped) {
            self.idle.lock().unwrap_or_else(PoisonError::into_inner).clear();
            answer = self.ask_by(None, question);
        }
        self.note(answer)
    }

    fn ask_by<T: FromRedisValue>(
        &self,
        kept: Option<Connection>,
        question: &redis::Cmd,
    ) -> Result<T, RedisError> {
        let mut connection = match kept {
            Some(connection) => connection,
            None => {
                let connection = self.client.get_connection_with_timeout(TIMEOUT)?;
                connection.set_read_timeout(Some(TIMEOUT))?;
                connection.set_write_timeout(Some(TIMEOUT))?;
                connection
            }
        };
        let answer = question.query(&mut connection)?;
        let mut idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        if idle.len() < MAX_IDLE {
            idle.push(connection);
        }
        Ok(answer)
    }

    fn note<T>(&self, answer: Result<T, RedisError>) -> Option<T> {
        let is_away = answer.is_err();
        *self.failed.lock().unwrap_or_else(PoisonError::into_inner) = is_away.then(Instant::now);
        if self.is_away.swap(is_away, Ordering::Relaxed) != is_away {
            if let Some(gauge) = self.gauge.get() {
                gauge.set(i64::from(is_away));
            }
            match &answer {
                Ok(_) => tracing::info!("Valkey answers again: limits and drafts are those of all servers"),
                Err(error) => {
                    tracing::warn!(%error, "Valkey does not answer: limits and drafts are this server's own until it does");
                }
            }
        }
        answer.ok()
    }
}

fn draft_name(id: &str) -> String {
    format!("skyglow:draft:{id}")
}

impl DraftShelf for Valkey {
    fn put(&self, id: &str, bytes: &[u8]) {
        if bytes.len() <= MAX_DRAFT_BYTES {
            let mut set = cmd("SET");
            set.arg(draft_name(id)).arg(bytes).arg("EX").arg(DRAFT_IDLE_S);
            let _best_effort = self.ask::<()>(&set);
        }
    }

    fn get(&self, id: &str) -> Option<Vec<u8>> {
        let mut get = cmd("GETEX");
        get.arg(draft_name(id)).arg("EX").arg(DRAFT_IDLE_S);
        self.ask::<Option<Vec<u8>>>(&get).flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where nobody listens, questions have no answer, soon, and the gauge says so.
    #[test]
    fn one_that_is_away_keeps_nobody_waiting() {
        let nobody = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let address = format!("redis://{}", nobody.local_addr().unwrap());
        drop(nobody);
        let (valkey, gauge) = (Valkey::new(&address).unwrap(), Gauge::default());
        valkey.show_in(gauge.clone());
        assert_eq!(gauge.get(), 0);
        let began = Instant::now();
        (0..1000).for_each(|_| valkey.put("p-1", b"draft"));
        assert!(valkey.get("p-1").is_none() && began.elapsed() < PAUSE);
        assert_eq!(gauge.get(), 1);
    }

    #[test]
    fn an_address_that_is_none_is_refused() {
        let refused = Valkey::new("http://:secret@valkey:6379").unwrap_err().to_string();
        assert!(refused.contains("redis://") && !refused.contains("secret"), "{refused}");
        assert_ne!(
            Valkey::new("redis://:one@valkey").unwrap().key,
            Valkey::new("redis://:two@valkey").unwrap().key
        );
    }
}
