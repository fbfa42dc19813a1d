//! Whole jumps in closed loop with the contact simulator: what a control tick costs on the way, and the same bits
//! on every machine.
//!
//! Every control tick is a call of its own; its result is given as one digest, because a jump has tens of thousands
//! of numbers.

mod a1;
mod closed_loop;
mod icub;
mod plan;

pub use a1::{Flight, HOLD, a1, feet, jump, settings};
pub use closed_loop::Simulated;
pub use icub::{IcubFlight, icub, icub_machine, icub_settings};
pub use plan::{BYTES, PLAN, Planned};

use crate::{Label, Numbers, Part, Real, Recorder, canonical_bits};

/// The jumps.
#[must_use]
pub fn parts<R: Recorder>() -> [Part<R>; 3] {
    [
        ("jump-a1-f64", a1::<f64, R>),
        ("jump-a1-f32", a1::<f32, R>),
        ("jump-icub-f64", icub::<R>),
    ]
}

/// Calls `work`, named after its result, and hands over a digest of what it returns.
fn digested<T: Real, R: Recorder, I, O: Numbers>(
    recorder: &mut R,
    subject: &'static str,
    input: I,
    work: impl FnOnce(I) -> O,
    name: impl FnOnce(&O) -> &'static str,
) -> O {
    let output = recorder.call_named(input, work, |output| Label {
        subject,
        scalar: T::NAME,
        algorithm: name(output),
    });
    recorder.value(digest(&output));
    output
}

/// The FNV-1a hash of the bits of every number.
#[must_use]
pub fn digest<O: Numbers>(output: &O) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    output.visit(&mut |x| {
        for byte in canonical_bits(x).to_le_bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    });
    hash
}
