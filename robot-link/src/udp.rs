//! Datagrams over UDP.

use core::net::SocketAddr;
use std::io;
use std::net::{ToSocketAddrs, UdpSocket};

/// A socket that only talks with one other, and never waits.
#[derive(Debug)]
pub struct UdpLink {
    socket: UdpSocket,
}

impl UdpLink {
    /// A socket at `local`; port 0 is any that is free. It hears everybody until it is [connected](Self::connect).
    ///
    /// # Errors
    /// What the operating system says.
    pub fn bind(local: impl ToSocketAddrs) -> io::Result<Self> {
        let socket = UdpSocket::bind(local)?;
        socket.set_nonblocking(true)?;
        Ok(Self { socket })
    }

    /// From now on only this one is heard and spoken to.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn connect(&self, remote: impl ToSocketAddrs) -> io::Result<()> {
        self.socket.connect(remote)
    }

    /// Where it is.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }

    /// The next datagram that has come, if any; one that is longer than `memory` is cut off there. An other end that is not there is one that
    /// says nothing.
    pub fn receive<'m>(&self, memory: &'m mut [u8]) -> Option<&'m [u8]> {
        let length = self.socket.recv(memory).ok()?;
        memory.get(..length)
    }

    /// Sends a datagram. One that does not get as far as the wire is a loss like any other: the other end counts it.
    pub fn send(&self, datagram: &[u8]) {
        let _ = self.socket.send(datagram);
    }
}
