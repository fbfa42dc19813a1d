//! Every public algorithm of the control crates, called on fixed inputs.
//!
//! One list of calls serves three proofs. Linked into the bare-metal image it shows that no panic is reachable; run
//! there and on the host it shows that both compute the same bits; run there alone it gives instructions and stack.
//! A [`Recorder`] decides what is done around a call and with its results.
#![no_std]

pub mod control;
mod conversions;
mod elementary;
pub mod flight;
mod inputs;
mod kinds;
mod numbers;
mod rbd;
mod rotations;
mod spatial;

#[cfg(feature = "introduce_panic")]
mod introduced;

use core::fmt;
use core::marker::PhantomData;

use a1_model::A1;
use icub_model::Icub23;
use rbd_core::{Frame, Model, Tree};
use so3::Scalar;

pub use kinds::Kinds;
pub use numbers::Numbers;

/// What was called: `so3/f64/exp`, `a1/f32/rnea`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Label {
    /// The robot, or the crate where no robot is concerned.
    pub subject: &'static str,
    /// `f32` or `f64`.
    pub scalar: &'static str,
    /// The algorithm: its public name.
    pub algorithm: &'static str,
}

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}/{}", self.subject, self.scalar, self.algorithm)
    }
}

/// Makes the calls, and takes what they return.
pub trait Recorder {
    /// Calls `work(input)` once, and names the call after its result. An implementation measures it if it can, and must
    /// hide `input` and the result from the optimiser, or the call is computed at compile time and proves nothing.
    fn call_named<I, R>(
        &mut self,
        input: I,
        work: impl FnOnce(I) -> R,
        name: impl FnOnce(&R) -> Label,
    ) -> R;

    /// As [`Recorder::call_named`], with a name known before.
    fn call<I, R>(&mut self, label: Label, input: I, work: impl FnOnce(I) -> R) -> R {
        self.call_named(input, work, |_| label)
    }

    /// Takes one number of the result of the last call.
    fn value(&mut self, bits: u64);
}

/// The scalars the probe runs on.
pub trait Real: Scalar + Numbers {
    /// The name that stands in a [`Label`].
    const NAME: &'static str;
}

impl Real for f32 {
    const NAME: &'static str = "f32";
}

impl Real for f64 {
    const NAME: &'static str = "f64";
}

/// Elementary functions, rotations, spatial algebra, and the dynamics of a small robot with every joint kind, as a
/// const model and as a model built at run time.
pub fn basics<T: Real, R: Recorder>(recorder: &mut R)
where
    Kinds: Tree<T, 9>,
{
    let on = &mut Subject::new(recorder);
    elementary::run::<T, R>(on);
    rotations::run::<T, R>(on);
    conversions::run::<T, R>(on);
    spatial::run::<T, R>(on);
    rbd::run::<T, R, _, 9, 15>(on, "kinds", &Kinds, &kinds::hand());
    rbd::run_table::<T, R, _, 9, 15>(on, "kinds-table", &Kinds, &kinds::hand());
    rbd::second_order::run::<T, R, _, 9>(on, &Kinds);
}

/// The dynamics of A1.
pub fn a1<T: Real, R: Recorder>(recorder: &mut R)
where
    A1: Model<T, 12>,
{
    let on = &mut Subject::new(recorder);
    rbd::run::<T, R, _, 12, 18>(on, "a1", &A1, &frame(&A1, "RL_foot"));
}

/// The dynamics of iCub-23.
pub fn icub<T: Real, R: Recorder>(recorder: &mut R)
where
    Icub23: Model<T, 23>,
{
    let on = &mut Subject::new(recorder);
    rbd::run::<T, R, _, 23, 29>(on, "icub", &Icub23, &frame(&Icub23, "r_sole"));
}

/// A part of the probe, with the name of the image that runs it.
pub type Part<R> = (&'static str, fn(&mut R));

/// All parts but the jumps.
#[must_use]
pub fn parts<R: Recorder>() -> [Part<R>; 12] {
    [
        ("basics-f64", basics::<f64, R>),
        ("basics-f32", basics::<f32, R>),
        ("a1-f64", a1::<f64, R>),
        ("a1-f32", a1::<f32, R>),
        ("icub-f64", icub::<f64, R>),
        ("icub-f32", icub::<f32, R>),
        ("control-a1-f64", control::a1::<f64, R>),
        ("control-a1-f32", control::a1::<f32, R>),
        ("control-icub-f64", control::icub::<f64, R>),
        ("control-icub-f32", control::icub::<f32, R>),
        ("planner-f64", control::planner::<f64, R>),
        ("planner-f32", control::planner::<f32, R>),
    ]
}

/// A frame of a robot; its base if there is none of that name.
fn frame<T: Real, M: Model<T, N>, const N: usize>(model: &M, name: &str) -> Frame<T> {
    model.frame(name).unwrap_or(Frame::IDENTITY)
}

/// One subject's calls on one recorder, in one scalar.
struct Subject<'a, T, R> {
    recorder: &'a mut R,
    name: &'static str,
    scalar: PhantomData<T>,
}

impl<'a, T: Real, R: Recorder> Subject<'a, T, R> {
    fn new(recorder: &'a mut R) -> Self {
        Self {
            recorder,
            name: "",
            scalar: PhantomData,
        }
    }

    /// Calls one algorithm, hands over every number it returns, and returns them.
    fn call<I, O: Numbers>(
        &mut self,
        algorithm: &'static str,
        input: I,
        work: impl FnOnce(I) -> O,
    ) -> O {
        let label = Label {
            subject: self.name,
            scalar: T::NAME,
            algorithm,
        };
        let output = self.recorder.call(label, input, work);
        output.visit(&mut |x| self.recorder.value(canonical_bits(x)));
        output
    }
}

/// The bits of `x`, with one pattern for all NaNs: IEEE 754 leaves sign and payload of a NaN to the processor, and
/// x86 and ARM differ.
fn canonical_bits(x: f64) -> u64 {
    if x.is_nan() {
        f64::NAN.to_bits()
    } else {
        x.to_bits()
    }
}
