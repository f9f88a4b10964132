//! What was made lately and is kept within a number of bytes; what several ask for at once is made once.

use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// Things by their keys, lately used last.
pub(super) struct Kept<K, V> {
    max_bytes: usize,
    byte_count: fn(&V) -> usize,
    places: Mutex<Vec<(K, Arc<Place<V>>)>>,
}

struct Place<V> {
    made: OnceLock<Arc<V>>,
    /// Held by who makes it.
    turn: Mutex<()>,
}

impl<K: Copy + PartialEq, V> Kept<K, V> {
    /// Nothing yet; of all but the last that is asked for, `max_bytes` are kept at most.
    pub(super) fn new(max_bytes: usize, byte_count: fn(&V) -> usize) -> Self {
        Self { max_bytes, byte_count, places: Mutex::default() }
    }

    /// What has a key, made where it is not kept. Who asks meanwhile waits for it, but for threads of the pool: `make` may need them.
    pub(super) fn get(&self, key: K, make: impl FnOnce() -> V) -> Arc<V> {
        let place = self.place(key);
        if let Some(made) = place.made.get() {
            return Arc::clone(made);
        }
        let _turn = rayon::current_thread_index().is_none().then(|| lock(&place.turn));
        let made = match place.made.get() {
            Some(made) => Arc::clone(made),
            None => {
                let made = Arc::new(make());
                // Another thread of the pool may have been first, with the same.
                let _ = place.made.set(Arc::clone(&made));
                made
            }
        };
        self.forget_oldest();
        made
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        lock(&self.places).iter().map(|(_, place)| self.bytes_of(place)).sum()
    }

    fn place(&self, key: K) -> Arc<Place<V>> {
        let mut places = lock(&self.places);
        let found = places.iter().position(|(other, _)| *other == key).map(|at| places.remove(at).1);
        let place =
            found.unwrap_or_else(|| Arc::new(Place { made: OnceLock::new(), turn: Mutex::default() }));
        places.push((key, Arc::clone(&place)));
        place
    }

    fn forget_oldest(&self) {
        let mut places = lock(&self.places);
        let mut bytes: usize = places.iter().map(|(_, place)| self.bytes_of(place)).sum();
        while bytes > self.max_bytes && places.len() > 1 {
            let (_, place) = places.remove(0);
            bytes -= self.bytes_of(&place);
        }
    }

    fn bytes_of(&self, place: &Place<V>) -> usize {
        place.made.get().map_or(0, |made| (self.byte_count)(made))
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;
    use std::{
        sync::{
            Barrier,
            atomic::{AtomicUsize, Ordering},
        },
        thread,
        time::Duration,
    };

    fn kept() -> Kept<u32, Vec<u8>> {
        Kept::new(100, Vec::len)
    }

    /// Threads that ask at once share what one of them makes, which may use the pool.
    #[test]
    fn what_many_ask_for_is_made_once() {
        let (kept, made, start) = (kept(), AtomicUsize::new(0), Barrier::new(4));
        thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    start.wait();
                    let found = kept.get(7, || {
                        made.fetch_add(1, Ordering::SeqCst);
                        thread::sleep(Duration::from_millis(30));
                        (0..10u8).into_par_iter().collect()
                    });
                    assert_eq!(found.len(), 10);
                });
            }
        });
        assert_eq!(made.load(Ordering::SeqCst), 1);
    }

    /// Threads of the pool do not wait for each other, or whoever makes something with the pool would wait for ever.
    #[test]
    fn threads_of_the_pool_do_not_wait() {
        let kept = kept();
        let ask = |_| kept.get(3, || (0..100u8).into_par_iter().map(|k| k / 2).collect()).len();
        assert_eq!((0..200).into_par_iter().map(ask).sum::<usize>(), 200 * 100);
        thread::scope(|scope| {
            let from_outside = scope.spawn(|| ask(0));
            assert!((0..50).into_par_iter().map(ask).all(|length| length == 100));
            assert_eq!(from_outside.join().unwrap(), 100);
        });
    }

    /// The longest unused goes first, and the last stays whatever its size.
    #[test]
    fn the_longest_unused_is_forgotten() {
        let (kept, made) = (kept(), AtomicUsize::new(0));
        let ask = |key: u32, bytes: usize| {
            kept.get(key, || {
                made.fetch_add(1, Ordering::SeqCst);
                vec![0; bytes]
            })
            .len()
        };
        for (key, bytes, makes) in [(1, 40, 1), (2, 40, 2), (1, 40, 2), (3, 40, 3), (1, 40, 3), (2, 40, 4)] {
            assert_eq!(ask(key, bytes), bytes);
            assert_eq!(made.load(Ordering::SeqCst), makes, "{key}");
            assert!(kept.bytes() <= 100);
        }
        assert_eq!((ask(9, 500), kept.bytes()), (500, 500));
    }
}
