//! The server: accepts, and ends in good time.

use crate::{
    config::HttpConfig,
    listener::{Ends, Listener},
};
use axum::Router;
use std::{future::Future, io};
use tokio::{net::TcpListener, sync::oneshot};

/// Serves until `ending` is ready; then takes no more connections, lets the answers under way finish, and ends
/// after `config.drain_timeout_s` whatever is left (a half-sent request would hold it for ever).
///
/// # Errors
/// What the listener says.
pub async fn serve(
    listener: TcpListener,
    router: Router,
    config: &HttpConfig,
    ending: impl Future<Output = ()> + Send + 'static,
) -> io::Result<()> {
    let (ended, has_ended) = oneshot::channel();
    let service = router.into_make_service_with_connect_info::<Ends>();
    let serving = axum::serve(Listener(listener), service).with_graceful_shutdown(async move {
        ending.await;
        // Nobody listens only when the server has ended already.
        let _ = ended.send(());
    });
    let drained = async {
        if has_ended.await.is_err() {
            std::future::pending::<()>().await;
        }
        tokio::time::sleep(config.drain_timeout()).await;
    };
    tokio::select! {
        result = async { serving.await } => result,
        () = drained => {
            tracing::warn!("some connections did not finish in time");
            Ok(())
        }
    }
}
