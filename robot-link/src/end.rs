//! What carries datagrams for an end, and what records and replays it, need not know which end it is.

/// An end of the link. It has no clock and asks for nothing: the same bytes at the same times give the same answers, bit for bit.
pub trait End {
    /// Takes a datagram that came at the time `now`, ns.
    fn hear(&mut self, bytes: &[u8], now: u64);

    /// Its turn at the time `now`, ns: writes the datagram that it sends to the beginning of `out` and returns the length; `None` if it sends
    /// nothing in this turn.
    fn turn(&mut self, now: u64, out: &mut [u8]) -> Option<usize>;
}
