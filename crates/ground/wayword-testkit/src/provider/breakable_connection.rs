//! TCP connections that can break on order: close, reset, trickle or never end. HTTP libraries cannot produce these faults, so
//! this file wraps the stream beneath them.

use axum::{
    extract::connect_info::Connected,
    serve::{IncomingStream, Listener},
};
use std::{
    io,
    net::SocketAddr,
    pin::Pin,
    sync::{Arc, Mutex, PoisonError},
    task::{Context, Poll},
    time::Duration,
};
use tokio::{
    io::{AsyncRead, AsyncWrite, ReadBuf},
    net::{TcpListener, TcpStream},
    time::Sleep,
};

/// How a connection breaks the responses that are written to it from now on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ConnectionBreak {
    /// Closes before any byte.
    Close,
    /// Sends the head and half of the body, then a TCP reset.
    Reset,
    /// Sends the head, then a byte at a time, with this time between two bytes.
    Trickle(Duration),
    /// Sends a body that never ends instead.
    Endless,
}

/// A switch, shared between a connection and the handler of its requests, with which the handler orders it to break.
#[derive(Clone, Default)]
pub(super) struct BreakSwitch(Arc<Mutex<Option<ConnectionBreak>>>);

impl BreakSwitch {
    /// Orders the connection to break from its next response on.
    pub(super) fn order_break(&self, how: ConnectionBreak) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(how);
    }

    /// The break that was ordered, if any.
    fn ordered_break(&self) -> Option<ConnectionBreak> {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Connected<IncomingStream<'_, BreakableListener>> for BreakSwitch {
    fn connect_info(stream: IncomingStream<'_, BreakableListener>) -> Self {
        stream.io().line.clone()
    }
}

/// A listener that wraps every connection it accepts in a [`BreakableConnection`].
pub(super) struct BreakableListener(pub(super) TcpListener);

impl Listener for BreakableListener {
    type Io = BreakableConnection;
    type Addr = SocketAddr;

    async fn accept(&mut self) -> (BreakableConnection, SocketAddr) {
        loop {
            match self.0.accept().await {
                Ok((stream, address)) => {
                    // Otherwise an answer waits for the acknowledgement of the one before. If this cannot be set, answers are
                    // only slower.
                    let _ = stream.set_nodelay(true);
                    return (
                        BreakableConnection { stream, line: BreakSwitch::default(), sent: 0, half: None, pause: None },
                        address,
                    );
                }
                // Out of sockets: wait until some are free again.
                Err(_) => tokio::time::sleep(Duration::from_millis(50)).await,
            }
        }
    }

    fn local_addr(&self) -> io::Result<SocketAddr> {
        self.0.local_addr()
    }
}

/// A TCP connection. Once its [`BreakSwitch`] orders a break, it spoils the bytes that are written to it.
pub(super) struct BreakableConnection {
    stream: TcpStream,
    /// The switch that the handler of the requests has too.
    line: BreakSwitch,
    /// Bytes sent since the order to break.
    sent: usize,
    /// The byte of the response at which the break begins: the end of the head for a trickle, the middle of the body for a reset.
    half: Option<usize>,
    /// The pause before the next byte of a trickle.
    pause: Option<Pin<Box<Sleep>>>,
}

/// The beginning of a response that never ends: a head without a length, and the beginning of a reply in JSON.
const ENDLESS_HEAD: &[u8] = b"HTTP/1.1 200 OK\r\ncontent-type: application/json\r\nconnection: close\r\n\r\n\
    {\"choices\":[{\"message\":{\"role\":\"assistant\",\"content\":\"";
/// A piece of the reply of a response that never ends, which is sent again and again.
const ENDLESS_WORDS: [u8; 16 * 1024] = [b'w'; 16 * 1024];

impl BreakableConnection {
    /// Sends bytes, and counts those that were sent.
    fn send_bytes(&mut self, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        let sent = Pin::new(&mut self.stream).poll_write(cx, bytes);
        if let Poll::Ready(Ok(count)) = sent {
            self.sent += count;
        }
        sent
    }

    /// Sends the head and half of the body, then resets. The response must be written in one piece, as small ones are.
    fn send_half_and_reset(&mut self, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        let half = *self.half.get_or_insert_with(|| head_bytes(bytes) + (bytes.len() - head_bytes(bytes)) / 2);
        match half.saturating_sub(self.sent) {
            0 => {
                self.stream.set_zero_linger()?;
                Poll::Ready(Err(io::ErrorKind::ConnectionReset.into()))
            }
            remaining => self.send_bytes(cx, &bytes[..remaining.min(bytes.len())]),
        }
    }

    /// Sends the head at once, then one byte after each pause of `every`.
    fn send_trickle(&mut self, cx: &mut Context<'_>, bytes: &[u8], every: Duration) -> Poll<io::Result<usize>> {
        let head = *self.half.get_or_insert_with(|| head_bytes(bytes));
        if self.sent < head {
            let remaining = (head - self.sent).min(bytes.len());
            return self.send_bytes(cx, &bytes[..remaining]);
        }
        let pause = self.pause.get_or_insert_with(|| Box::pin(tokio::time::sleep(every)));
        if pause.as_mut().poll(cx).is_pending() {
            return Poll::Pending;
        }
        self.pause = None;
        self.send_bytes(cx, &bytes[..bytes.len().min(1)])
    }

    /// Sends until the other side closes the connection.
    fn send_endless(&mut self, cx: &mut Context<'_>) -> Poll<io::Result<usize>> {
        loop {
            let next = ENDLESS_HEAD.get(self.sent..).filter(|rest| !rest.is_empty()).unwrap_or(&ENDLESS_WORDS);
            match self.send_bytes(cx, next) {
                Poll::Ready(Ok(_)) => {}
                stopped => return stopped,
            }
        }
    }
}

/// The number of bytes of a response before its body.
fn head_bytes(bytes: &[u8]) -> usize {
    bytes.windows(4).position(|window| window == b"\r\n\r\n").map_or(bytes.len(), |at| at + 4)
}

impl AsyncRead for BreakableConnection {
    fn poll_read(mut self: Pin<&mut Self>, cx: &mut Context<'_>, buffer: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(cx, buffer)
    }
}

impl AsyncWrite for BreakableConnection {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        match self.line.ordered_break() {
            None => Pin::new(&mut self.stream).poll_write(cx, bytes),
            Some(ConnectionBreak::Close) => Poll::Ready(Err(io::ErrorKind::ConnectionAborted.into())),
            Some(ConnectionBreak::Reset) => self.send_half_and_reset(cx, bytes),
            Some(ConnectionBreak::Trickle(every)) => self.send_trickle(cx, bytes, every),
            Some(ConnectionBreak::Endless) => self.send_endless(cx),
        }
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        // An orderly shutdown would be sent before the reset.
        if self.line.ordered_break() == Some(ConnectionBreak::Reset) {
            return Poll::Ready(Ok(()));
        }
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}
