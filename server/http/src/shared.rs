//! What is made once for all who ask for it at the same time, and not refused to all for what one of them has had.

use crate::error::ApiError;
use moka::future::Cache;
use skyglow_app::error::AppError;
use std::{
    future::Future,
    pin::pin,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

/// Whether an error is about who asked, and not about what was asked for.
pub(crate) fn is_of_asker(error: &ApiError) -> bool {
    matches!(error, ApiError::TooManyRequests { .. } | ApiError::App(AppError::Busy { .. }))
}

/// What a cache has or gets, made once for all who ask at the same time. Where the one who makes it is refused for what that client
/// has, the next makes it.
pub(crate) async fn shared<T: Clone + Send + Sync + 'static, E: Send + Sync + 'static>(
    cache: &Cache<String, T>,
    key: &str,
    make: impl Future<Output = Result<T, E>>,
    is_of_asker: impl Fn(&E) -> bool,
) -> Result<moka::Entry<String, T>, Arc<E>> {
    let mut make = pin!(make);
    loop {
        let is_own = AtomicBool::new(false);
        let own = async {
            is_own.store(true, Ordering::Relaxed);
            make.as_mut().await
        };
        match cache.entry_by_ref(key).or_try_insert_with(own).await {
            Err(error) if !is_own.load(Ordering::Relaxed) && is_of_asker(&error) => {}
            found => return found,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Who waits for what another client makes is not refused for what that client has had.
    #[tokio::test]
    async fn refusals_are_not_shared() {
        let cache: Cache<String, u32> = Cache::new(10);
        let (begin, begun) = tokio::sync::oneshot::channel::<()>();
        let (of_first, of_second) = (cache.clone(), cache);
        let first = tokio::spawn(async move {
            let refused = async {
                let _is_there = begun.await;
                Err(ApiError::TooManyRequests { retry_after_s: 1 })
            };
            shared(&of_first, "map", refused, is_of_asker).await.map(moka::Entry::into_value)
        });
        tokio::task::yield_now().await;
        let second = tokio::spawn(async move {
            shared(&of_second, "map", async { Ok(7) }, is_of_asker).await.map(moka::Entry::into_value)
        });
        tokio::task::yield_now().await;
        assert!(!second.is_finished(), "it waits for the first");
        begin.send(()).unwrap();
        assert!(first.await.unwrap().is_err());
        assert_eq!(second.await.unwrap().ok(), Some(7));
    }
}
