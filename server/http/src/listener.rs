//! Connections: the addresses of both ends for the handlers, and a problem document in place of the bare refusals
//! that the HTTP library writes by itself, before any handler is asked: an address too long (414), headers too
//! long (431), what is no HTTP (400).

use crate::{
    error::ApiError,
    problem::{PROBLEM_JSON, Problem},
};
use std::{
    future::Future,
    io,
    net::SocketAddr,
    pin::Pin,
    task::{Context, Poll, ready},
    time::Duration,
};
use tokio::{
    io::{AsyncRead, AsyncWrite, ReadBuf},
    time::Sleep,
};

/// The addresses of a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ends {
    /// The client's own.
    pub client: SocketAddr,
    /// The one of this server that the client reached; None where the system does not say.
    pub server: Option<SocketAddr>,
}

/// A connection. What goes out is passed on as it is, but for refusals without a body; a client that takes nothing of it for long
/// loses the connection, and so does one that takes less than [`MIN_BYTES_PER_S`] on average: what it is sent lies in memory.
#[derive(Debug)]
pub(crate) struct Connection<S> {
    stream: S,
    /// What takes the place of a refusal, as far as it is not sent yet.
    pending: Vec<u8>,
    /// How long a client may take nothing.
    patience: Duration,
    /// Ends when that is over; None while it takes what it is sent.
    stalled: Option<Pin<Box<Sleep>>>,
    /// Bytes that it took since.
    taken_bytes: f64,
}

/// What a client takes at least, on average over its patience: a quarter of what a slow telephone does.
const MIN_BYTES_PER_S: f64 = 2048.0;

impl<S> Connection<S> {
    pub(crate) fn new(stream: S, patience: Duration) -> Self {
        Self { stream, pending: Vec::new(), patience, stalled: None, taken_bytes: 0.0 }
    }

    /// Has patience begin anew: for another answer, or for a client that took enough.
    fn begin_patience(&mut self) {
        (self.stalled, self.taken_bytes) = (None, 0.0);
    }

    /// What a write gave, or the end of patience with it.
    fn within_patience(
        &mut self,
        written: Poll<io::Result<usize>>,
        context: &mut Context<'_>,
    ) -> Poll<io::Result<usize>> {
        if let Poll::Ready(written) = written {
            self.taken_bytes += written.as_ref().map_or(0.0, |bytes| *bytes as f64);
            if self.taken_bytes >= MIN_BYTES_PER_S * self.patience.as_secs_f64() {
                self.begin_patience();
            }
            return Poll::Ready(written);
        }
        let patience = self.patience;
        let stalled = self.stalled.get_or_insert_with(|| Box::pin(tokio::time::sleep(patience)));
        ready!(stalled.as_mut().poll(context));
        Poll::Ready(Err(io::ErrorKind::TimedOut.into()))
    }
}

/// The HTTP library's own refusals are shorter, bytes.
const MAX_REFUSAL_BYTES: usize = 1024;

/// The answer in place of a head that the HTTP library wrote: an error without a body, and so without a type of
/// it. Every answer of the router has one, those to HEAD included.
fn in_place_of(written: &[u8]) -> Option<Vec<u8>> {
    // Bodies pass by here too, megabytes of them.
    if written.len() > MAX_REFUSAL_BYTES || !written.starts_with(b"HTTP/1.") {
        return None;
    }
    let head = std::str::from_utf8(written).ok()?.strip_suffix("\r\n\r\n")?;
    let mut lines = head.split("\r\n");
    let status_line = lines.next()?;
    let status: u16 = status_line.split(' ').nth(1)?.parse().ok()?;
    let has_type = lines.any(|line| line.to_ascii_lowercase().starts_with("content-type:"));
    if !(400..500).contains(&status) || has_type {
        return None;
    }
    let problem: Problem = ApiError::Unreadable(status).problem();
    let body = serde_json::to_string(&problem).ok()?;
    tracing::info!(status, "refused before a handler was asked");
    Some(
        format!(
            "{status_line}\r\ncontent-type: {PROBLEM_JSON}\r\ncache-control: no-store\r\n\
             x-content-type-options: nosniff\r\nconnection: close\r\ncontent-length: {}\r\n\r\n{body}",
            body.len()
        )
        .into_bytes(),
    )
}

impl<S: AsyncWrite + Unpin> Connection<S> {
    fn poll_send_pending(&mut self, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        while !self.pending.is_empty() {
            let sent = Pin::new(&mut self.stream).poll_write(context, &self.pending);
            let sent = ready!(self.within_patience(sent, context))?;
            if sent == 0 {
                return Poll::Ready(Err(io::ErrorKind::WriteZero.into()));
            }
            self.pending.drain(..sent);
        }
        Poll::Ready(Ok(()))
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for Connection<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let read = Pin::new(&mut self.stream).poll_read(context, buffer);
        // Another request, for whose answer it has time again.
        if matches!(read, Poll::Ready(Ok(()))) {
            self.begin_patience();
        }
        read
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Connection<S> {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        ready!(self.poll_send_pending(context))?;
        match in_place_of(bytes) {
            Some(answer) => {
                // Sent at the flush that follows.
                self.pending = answer;
                Poll::Ready(Ok(bytes.len()))
            }
            None => {
                let written = Pin::new(&mut self.stream).poll_write(context, bytes);
                self.within_patience(written, context)
            }
        }
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        pieces: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        ready!(self.poll_send_pending(context))?;
        let first = pieces.iter().find(|piece| !piece.is_empty());
        match first.and_then(|piece| in_place_of(piece).map(|answer| (answer, piece.len()))) {
            Some((answer, length)) => {
                self.pending = answer;
                Poll::Ready(Ok(length))
            }
            None => {
                let written = Pin::new(&mut self.stream).poll_write_vectored(context, pieces);
                self.within_patience(written, context)
            }
        }
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        ready!(self.poll_send_pending(context))?;
        Pin::new(&mut self.stream).poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        ready!(self.poll_send_pending(context))?;
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_refusals_without_a_body_are_replaced() {
        let refusal = b"HTTP/1.1 414 URI Too Long\r\nconnection: close\r\ncontent-length: 0\r\n\r\n";
        let answer = String::from_utf8(in_place_of(refusal).unwrap()).unwrap();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        assert!(head.starts_with("HTTP/1.1 414 URI Too Long\r\ncontent-type: application/problem+json\r\n"));
        assert!(head.ends_with(&format!("content-length: {}", body.len())));
        let body: serde_json::Value = serde_json::from_str(body).unwrap();
        assert_eq!((&body["status"], &body["type"]), (&414.into(), &"/problems/unreadable".into()));
        for other in [
            "HTTP/1.1 200 OK\r\ncontent-length: 0\r\n\r\n",
            "HTTP/1.1 404 Not Found\r\nContent-Type: application/problem+json\r\ncontent-length: 9\r\n\r\n",
            "HTTP/1.1 404 Not Found\r\ncontent-length: 2\r\n\r\nno",
            "HTTP/1.1 503 Service Unavailable\r\ncontent-length: 0\r\n\r\n",
            "400 of these",
            "",
        ] {
            assert_eq!(in_place_of(other.as_bytes()), None, "{other}");
        }
    }

    /// A refusal arrives whole through a narrow pipe and the rest as it is.
    #[tokio::test]
    async fn a_refusal_arrives_whole_in_a_narrow_pipe() {
        use tokio::io::{AsyncReadExt, AsyncWriteExt};
        let (near, mut far) = tokio::io::duplex(7);
        let sending = tokio::spawn(async move {
            let mut connection = Connection::new(near, Duration::from_secs(60));
            connection.write_all(b"HTTP/1.1 200 OK\r\n\r\nhello").await?;
            connection.write_all(b"HTTP/1.1 431 Headers\r\ncontent-length: 0\r\n\r\n").await?;
            connection.shutdown().await
        });
        let mut got = String::new();
        far.read_to_string(&mut got).await.unwrap();
        sending.await.unwrap().unwrap();
        assert!(
            got.starts_with("HTTP/1.1 200 OK\r\n\r\nhelloHTTP/1.1 431 Headers\r\ncontent-type: "),
            "{got}"
        );
        assert!(got.ends_with('}'), "{got}");
    }

    /// Writes an answer to a client that takes so many bytes every eight seconds; patience is ten.
    async fn send_to(bytes_each_time: usize) -> io::Result<()> {
        use tokio::io::{AsyncReadExt, AsyncWriteExt};
        let (near, mut far) = tokio::io::duplex(1024);
        let mut connection = Connection::new(near, Duration::from_secs(10));
        let reading = tokio::spawn(async move {
            let mut some = vec![0; bytes_each_time];
            loop {
                tokio::time::sleep(Duration::from_secs(8)).await;
                if far.read_exact(&mut some).await.is_err() {
                    return;
                }
            }
        });
        let sent = connection.write_all(&[1; 100_000]).await;
        reading.abort();
        sent
    }

    /// A client that takes nothing, or next to nothing, loses the connection and a slow one does not.
    #[tokio::test(start_paused = true)]
    async fn only_a_stalled_client_loses_its_connection() {
        assert!(send_to(24_000).await.is_ok());
        for next_to_nothing in [0, 7, 8_000] {
            assert_eq!(send_to(next_to_nothing).await.unwrap_err().kind(), io::ErrorKind::TimedOut);
        }
    }
}
