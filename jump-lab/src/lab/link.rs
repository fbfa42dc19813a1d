//! A link between a robot and its controller: packets that come late, now later and now sooner, and some never.

use super::{Disturbance, Key};
use crate::noise::Noise;

/// A packet under way.
#[derive(Clone, Copy)]
struct Packet<P> {
    sent: f64,
    arrives: f64,
    load: P,
}

/// One direction of a link, with packets of kind `P`.
pub struct Link<P> {
    latency: f64,
    jitter: f64,
    loss: f64,
    noise: Noise,
    under_way: Vec<Packet<P>>,
    /// When the newest packet that was received was sent, s.
    newest: f64,
}

impl<P: Copy> Link<P> {
    /// A link with a share of the latency and jitter of `disturbance`, and at least `least` of each, s.
    #[must_use]
    pub fn new(disturbance: &Disturbance, share: f64, least: f64, seed: u64) -> Self {
        Self {
            latency: (share * disturbance.seconds(Key::Latency)).max(least),
            jitter: (share * disturbance.seconds(Key::Jitter)).max(least),
            loss: disturbance.get(Key::Loss),
            noise: Noise::new(seed, 0.0),
            under_way: Vec::new(),
            newest: f64::NEG_INFINITY,
        }
    }

    /// Longest time under way, s.
    #[must_use]
    pub const fn longest(&self) -> f64 {
        self.latency + self.jitter
    }

    /// Sends a packet at time `now`, s.
    pub fn send(&mut self, now: f64, load: P) {
        let late = self.latency + self.jitter * self.noise.uniform();
        if self.noise.uniform() >= self.loss {
            self.under_way.push(Packet {
                sent: now,
                arrives: now + late,
                load,
            });
        }
    }

    /// The newest packet that has arrived by `now` and is newer than the last one received, with its age, s.
    pub fn receive(&mut self, now: f64) -> Option<(P, f64)> {
        // Times are sums of ticks: a packet that is due now must not wait for a rounding error.
        let due = now + 1e-9;
        let arrived = self.under_way.iter().filter(|packet| packet.arrives <= due);
        let found = arrived.max_by(|a, b| a.sent.total_cmp(&b.sent)).copied();
        self.under_way.retain(|packet| packet.arrives > due);
        let packet = found.filter(|packet| packet.sent > self.newest)?;
        self.newest = packet.sent;
        Some((packet.load, (now - packet.sent).max(0.0)))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::Link;
    use crate::lab::{Disturbance, Lab, PlantArgument};

    fn link(text: &str) -> Link<u32> {
        let disturbance = PlantArgument::plant(Some(&text.parse().unwrap()), Lab::A1, 0);
        Link::new(&disturbance, 1.0, 0.0, 3)
    }

    #[test]
    fn a_perfect_link_hands_over_at_once() {
        let mut link = Link::new(&Disturbance::NOMINAL, 1.0, 0.0, 3);
        for k in 0..10 {
            let now = f64::from(k) * 1e-3;
            link.send(now, k);
            assert_eq!(link.receive(now), Some((k, 0.0)));
            assert_eq!(link.receive(now), None);
        }
    }

    #[test]
    fn latency_is_an_age_and_jitter_never_goes_back_in_time() {
        let mut link = link("latency_ms=2,jitter_ms=3");
        let mut last = None;
        for k in 0..1000_u32 {
            let now = f64::from(k) * 1e-3;
            link.send(now, k);
            if let Some((load, age)) = link.receive(now) {
                assert!((2e-3 - 1e-9..=5e-3 + 1e-3).contains(&age), "{age}");
                assert!(last.is_none_or(|last| load > last));
                last = Some(load);
            }
        }
        assert!(last.unwrap() > 990);
    }

    #[test]
    fn as_many_are_lost_as_it_says() {
        let mut link = link("loss=0.25");
        let count = (0..4000_u32)
            .filter(|k| {
                link.send(f64::from(*k), *k);
                link.receive(f64::from(*k)).is_some()
            })
            .count();
        assert!((2850..3150).contains(&count), "{count}");
    }
}
