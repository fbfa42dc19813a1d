//! A panic on purpose: the mistake one makes by indexing with a number that the compiler cannot bound.

use crate::{Recorder, Subject};

const TABLE: [f64; 3] = [1.0, 2.0, 3.0];

#[allow(
    clippy::indexing_slicing,
    reason = "this panic must be reachable: it shows that the proof works"
)]
pub(crate) fn run<R: Recorder>(recorder: &mut R) {
    let on = &mut Subject::<f64, R>::new(recorder);
    on.name = "probe";
    on.call("introduced_panic", 1_usize, |index| TABLE[index]);
}
