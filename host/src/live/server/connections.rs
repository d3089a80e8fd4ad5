//! Limits on connections: their number, in all and of one address, and their time without a viewer.
//!
//! A connection needs no token before its first request, so anybody who reaches the port can open some. These must not use
//! up the program's descriptors or keep a viewer out for long.

use std::collections::HashMap;
use std::io;
use std::net::{IpAddr, Ipv6Addr, SocketAddr};
use std::pin::Pin;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll};
use std::time::Duration;

use axum::extract::connect_info::Connected;
use axum::serve::{IncomingStream, Listener};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::time::{Sleep, sleep};

/// Greatest number of connections: below 1024, the usual limit of descriptors.
const MOST: usize = 256;
/// Greatest number of connections of one address: 16 viewers with the files of their pages need fewer.
const MOST_OF_ADDRESS: usize = 64;
/// Time after which a connection that is not a viewer's is closed, whatever it sends.
const REQUESTS: Duration = Duration::from_secs(30);

/// Listener that closes excess connections at once.
#[derive(Debug)]
pub(super) struct LimitedListener {
    inner: TcpListener,
    open: OpenConnections,
}

impl LimitedListener {
    pub(super) fn new(inner: TcpListener) -> Self {
        let open = OpenConnections::default();
        Self { inner, open }
    }
}

impl Listener for LimitedListener {
    type Io = Connection;
    type Addr = SocketAddr;

    async fn accept(&mut self) -> (Connection, SocketAddr) {
        loop {
            let (stream, address) = Listener::accept(&mut self.inner).await;
            if let Some(permit) = self.open.permit(address.ip()) {
                let connection = Connection {
                    stream,
                    end: Box::pin(sleep(REQUESTS)),
                    upgraded: Upgraded::default(),
                    _permit: permit,
                };
                return (connection, address);
            }
        }
    }

    fn local_addr(&self) -> io::Result<SocketAddr> {
        self.inner.local_addr()
    }
}

/// Number of open connections of each network.
#[derive(Clone, Debug, Default)]
struct OpenConnections(Arc<Mutex<HashMap<IpAddr, usize>>>);

impl OpenConnections {
    fn lock(&self) -> MutexGuard<'_, HashMap<IpAddr, usize>> {
        // A panic leaves nothing half-changed.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns a permit for a connection from this address; none if there are too many.
    fn permit(&self, address: IpAddr) -> Option<Permit> {
        let network = network(address);
        let mut open = self.lock();
        let own = open.get(&network).copied().unwrap_or(0);
        if own >= MOST_OF_ADDRESS || open.values().sum::<usize>() >= MOST {
            return None;
        }
        open.insert(network, own + 1);
        Some(Permit {
            network,
            open: self.clone(),
        })
    }
}

/// Network whose connections are counted together: an IPv4 address, or a /64 of IPv6, which one machine may own.
fn network(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) => {
            Ipv6Addr::from_bits(address.to_bits() & !u128::from(u64::MAX)).into()
        }
        address => address,
    }
}

/// Permit of one connection, freed on drop.
#[derive(Debug)]
struct Permit {
    network: IpAddr,
    open: OpenConnections,
}

impl Drop for Permit {
    fn drop(&mut self) {
        let mut open = self.open.lock();
        if let Some(own) = open.get_mut(&self.network) {
            *own -= 1;
            if *own == 0 {
                open.remove(&self.network);
            }
        }
    }
}

/// Whether a connection is a viewer's, which has no time limit.
#[derive(Clone, Debug, Default)]
pub(super) struct Upgraded(Arc<AtomicBool>);

impl Upgraded {
    /// Removes the connection's time limit.
    pub(super) fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Connected<IncomingStream<'_, LimitedListener>> for Upgraded {
    fn connect_info(stream: IncomingStream<'_, LimitedListener>) -> Self {
        stream.io().upgraded.clone()
    }
}

/// Connection that fails when its time is over.
#[derive(Debug)]
pub(super) struct Connection {
    stream: TcpStream,
    end: Pin<Box<Sleep>>,
    upgraded: Upgraded,
    _permit: Permit,
}

impl Connection {
    /// Stream before the time is over; an error after it, which wakes a waiting reader.
    fn stream(&mut self, context: &mut Context<'_>) -> io::Result<Pin<&mut TcpStream>> {
        let is_upgraded = self.upgraded.0.load(Ordering::Relaxed);
        if !is_upgraded && self.end.as_mut().poll(context).is_ready() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        Ok(Pin::new(&mut self.stream))
    }
}

impl AsyncRead for Connection {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        self.stream(context)?.poll_read(context, buffer)
    }
}

impl AsyncWrite for Connection {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        self.stream(context)?.poll_write(context, bytes)
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.stream(context)?.poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.stream(context)?.poll_shutdown(context)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        self.stream(context)?.poll_write_vectored(context, bytes)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ip(text: &str) -> IpAddr {
        text.parse().unwrap()
    }

    #[test]
    fn an_address_has_its_share_and_all_together_their_bound() {
        let open = OpenConnections::default();
        let mut permits: Vec<_> = (0..MOST_OF_ADDRESS)
            .map(|_| open.permit(ip("127.0.0.1")).unwrap())
            .collect();
        // One address, also written as IPv6.
        for same in ["127.0.0.1", "::ffff:127.0.0.1"] {
            assert!(open.permit(ip(same)).is_none(), "{same}");
        }
        for other in 1..MOST / MOST_OF_ADDRESS {
            let network = format!("2001:db8:0:{other}::");
            permits.extend(
                (0..MOST_OF_ADDRESS)
                    .map(|host| open.permit(ip(&format!("{network}{host:x}"))).unwrap()),
            );
        }
        assert_eq!(permits.len(), MOST);
        assert!(open.permit(ip("192.168.0.2")).is_none());
        permits.swap_remove(0);
        assert!(open.permit(ip("192.168.0.2")).is_some());
        permits.clear();
        assert!(open.lock().is_empty());
    }
}
