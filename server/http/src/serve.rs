//! The server: accepts, gives up on clients that stall, and ends in good time.

use crate::{
    config::HttpConfig,
    listener::{Connection, Ends},
    party::{Party, Tier},
    routes::viewer::compress_viewer,
    trust::is_trusted,
};
use axum::{Router, body::Body, extract::ConnectInfo};
use hyper::{server::conn::http1, service::service_fn};
use hyper_util::{
    rt::{TokioIo, TokioTimer},
    server::graceful::GracefulShutdown,
};
use std::{
    collections::HashMap,
    future::Future,
    io,
    net::IpAddr,
    pin::pin,
    sync::{Arc, Mutex, PoisonError},
    time::Duration,
};
use tokio::{net::TcpListener, sync::Semaphore};
use tower::ServiceExt;

/// How long nothing is accepted after the system had no room for a connection.
const PAUSE: Duration = Duration::from_millis(200);
/// What a connection may buffer of what comes in, bytes: the longest head.
const MAX_BUFFER_BYTES: usize = 128 * 1024;
/// What the system may hold of an answer unsent, bytes: a connection is writable again when half of it went out, so that a slow
/// client is seen to take some of it long before it is taken for a stalled one.
const MAX_UNSENT_BYTES: u32 = 32 * 1024;
/// Part of all connections that one client may hold: an address of IPv4, a /64 of IPv6.
const SHARE_OF_A_CLIENT: usize = 4;

/// Serves until `ending` is ready; then takes no more connections, lets the answers under way finish, and ends
/// after `config.drain_timeout_s` whatever is left (a half-sent request would hold it for ever).
///
/// Connections have places, of which one address holds no more than a fourth; who comes when all are taken waits in the system's
/// queue. A client that does not send the head of a request within `config.idle_timeout_s`, or does not take what it is sent for so
/// long, loses its connection.
///
/// # Errors
/// None today: what the listener says is logged, and it goes on.
pub async fn serve(
    listener: TcpListener,
    router: Router,
    config: &HttpConfig,
    ending: impl Future<Output = ()> + Send + 'static,
) -> io::Result<()> {
    // Nobody waits for it, neither a visitor nor the end.
    drop(tokio::task::spawn_blocking(compress_viewer));
    let idle = config.idle_timeout();
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(idle).max_buf_size(MAX_BUFFER_BYTES);
    let places = Arc::new(Semaphore::new(config.connections.clamp(1, Semaphore::MAX_PERMITS)));
    let share = Arc::new(Share::new((config.connections / SHARE_OF_A_CLIENT).max(1)));
    let graceful = GracefulShutdown::new();
    let mut ending = pin!(ending);
    loop {
        let place = tokio::select! {
            place = Arc::clone(&places).acquire_owned() => place.map_err(io::Error::other)?,
            () = &mut ending => break,
        };
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            () = &mut ending => break,
        };
        let (stream, client) = match accepted {
            Ok(accepted) => accepted,
            Err(error) => {
                // A connection that was given up, or no room for files: it goes on when there is some.
                tracing::warn!(%error, "a connection was not accepted");
                tokio::time::sleep(PAUSE).await;
                continue;
            }
        };
        let held = match is_trusted(client.ip(), &config.trusted_proxies) {
            true => None,
            false => match Share::hold(&share, client.ip()) {
                Some(held) => Some(held),
                // Closed at once: an answer would have to wait for a request.
                None => continue,
            },
        };
        // Small answers go out at once.
        let _best_effort = stream.set_nodelay(true);
        #[cfg(target_os = "linux")]
        let _best_effort = socket2::SockRef::from(&stream).set_tcp_notsent_lowat(MAX_UNSENT_BYTES);
        let ends = Ends { client, server: stream.local_addr().ok() };
        let router = router.clone();
        let service = service_fn(move |request: hyper::Request<hyper::body::Incoming>| {
            let mut request = request.map(Body::new);
            request.extensions_mut().insert(ConnectInfo(ends));
            router.clone().oneshot(request)
        });
        let connection = http.serve_connection(TokioIo::new(Connection::new(stream, idle)), service);
        let connection = graceful.watch(connection);
        tokio::spawn(async move {
            // What goes wrong with a connection is its client's affair.
            let _ended = connection.await;
            drop((place, held));
        });
    }
    drop(listener);
    tokio::select! {
        () = graceful.shutdown() => {}
        () = tokio::time::sleep(config.drain_timeout()) => {
            tracing::warn!("some connections did not finish in time");
        }
    }
    Ok(())
}

/// How many connections each client holds, and the networks around it: twice and three times as many.
#[derive(Debug)]
struct Share {
    most: usize,
    held: Mutex<HashMap<Tier, usize>>,
}

/// A connection that a client holds until this is dropped.
#[derive(Debug)]
struct Held {
    share: Arc<Share>,
    party: Party,
}

impl Share {
    fn new(most: usize) -> Self {
        Self { most, held: Mutex::default() }
    }

    fn hold(share: &Arc<Self>, client: IpAddr) -> Option<Held> {
        let party = Party::of_address(Some(client));
        let mut held = share.held.lock().unwrap_or_else(PoisonError::into_inner);
        let has_room = |tier: &Tier| {
            held.get(tier).copied().unwrap_or(0) < share.most.saturating_mul(usize::from(tier.0) + 1)
        };
        if !party.tiers().iter().all(has_room) {
            return None;
        }
        party.tiers().into_iter().for_each(|tier| *held.entry(tier).or_default() += 1);
        Some(Held { share: Arc::clone(share), party })
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        let mut held = self.share.held.lock().unwrap_or_else(PoisonError::into_inner);
        for tier in self.party.tiers() {
            if let Some(count) = held.get_mut(&tier) {
                *count -= 1;
                if *count == 0 {
                    held.remove(&tier);
                }
            }
        }
    }
}
