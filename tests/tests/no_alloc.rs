//! A counting allocator sees no allocation in any algorithm that the bare-metal images run.

use core::hint::black_box;
use std::collections::BTreeSet;

use allocation_counter::measure;
use saltus_probe::{Label, Recorder, basics, control, flight};

/// Counts the allocations of every call.
#[derive(Default)]
struct Counting {
    called: BTreeSet<String>,
    allocating: BTreeSet<String>,
}

impl Recorder for Counting {
    fn call_named<I, R>(
        &mut self,
        input: I,
        work: impl FnOnce(I) -> R,
        name: impl FnOnce(&R) -> Label,
    ) -> R {
        let input = black_box(input);
        let mut result = None;
        let allocations = measure(|| result = Some(black_box(work(input))));
        let result = result.unwrap_or_else(|| unreachable!("measure calls its argument"));
        let label = name(&result).to_string();
        if allocations.count_total > 0 {
            self.allocating.insert(label.clone());
        }
        self.called.insert(label);
        result
    }

    fn value(&mut self, _: u64) {}
}

#[test]
fn no_algorithm_allocates() {
    let mut counting = Counting::default();
    // The part with every function and every joint kind; A1 and iCub run the same code on other tables.
    basics::<f64, _>(&mut counting);
    basics::<f32, _>(&mut counting);
    control::a1::<f64, _>(&mut counting);
    control::icub::<f64, _>(&mut counting);
    // Whole jumps of both machines.
    flight::a1::<f64, _>(&mut counting);
    flight::icub(&mut counting);
    assert_eq!(counting.allocating, BTreeSet::new());
    for label in [
        "so3/f32/exp",
        "kinds/f64/aba_derivatives",
        "kinds-table/f32/contact_dynamics",
        "dense-qp/f64/solve infeasible",
        "landing/f64/Landing::step",
        "contact-sim/f64/NativeSimulator::step",
        "wbc-qp/f64/TorqueJump::tick",
        "a1-jump/f64/landing tick",
        "icub-jump/f64/push-off tick",
        "icub-jump/f64/landing tick",
        "icub-jump/f64/joint PD tick",
    ] {
        assert!(counting.called.contains(label), "{label} was not called");
    }
}

#[test]
fn an_allocation_would_be_seen() {
    let mut counting = Counting::default();
    let label = Label {
        subject: "test",
        scalar: "f64",
        algorithm: "vec",
    };
    counting.call(label, 3, |n| vec![0.0_f64; n]);
    assert!(counting.allocating.contains("test/f64/vec"));
}
