//! The force program of a tick, and its solution.
//!
//! minimise w_f |Σ f − F|² + w_m |Σ r × f − M|² + w_e |f|² over the forces f on the feet in contact, r from the centre of mass to the
//! foot, world axes, subject to the [limits](crate::limits) of each foot.
//!
//! Feet meet only in the six numbers of the wrench. With B f = (√w_f f, √w_m r × f), b the wanted wrench weighed likewise and
//! s = (b − Σ B f)/w_e, a foot whose rows n_k hold is stationary at f = Bᵀs − Σ λ_k n_k, and all feet together at
//! (w_e + Σ B P Bᵀ) s = b − Σ B f₀, P and f₀ from the [face](crate::face). So every active set costs one 6 × 6 system whatever
//! the number of rows, and remembered rows cost nothing. The search is the dual one of Goldfarb and Idnani (1983): from the
//! optimum over some rows, the most violated row enters while the multipliers of all others stay positive; a row whose multiplier
//! reaches zero leaves.

use dense_qp::Status;
use nalgebra::Vector3;
use so3::{Scalar, math};

use crate::face::{Face, MOST};
use crate::limits::{Limits, Row};
use crate::wrench::{Arm, Inverse, Square, Wrench};
use crate::{Outcome, Settings};

/// Factorisations in one tick. A tick that needs more ends with forces that keep every limit, and the next goes on from its rows.
pub(crate) const MAX_STEPS: u32 = 20;

/// The program and where its search stands.
#[derive(Clone, Debug)]
pub(crate) struct Forces<T: Scalar, const N: usize, const F: usize> {
    pub(crate) limits: Limits<T, N, F>,
    /// Feet in contact.
    pub(crate) on: [bool; F],
    pub(crate) arms: [Arm<T>; F],
    /// w_e.
    pub(crate) effort: T,
    /// The wanted wrench, weighed.
    pub(crate) wanted: Wrench<T>,
    faces: [Face<T>; F],
    forces: [Vector3<T>; F],
    /// Largest entry of Bᵀs at the last stationary point: what round-off in the forces is relative to.
    pull: T,
}

/// Why a search ended early.
enum Stop {
    Limit,
    Numerical,
}

/// How one foot's force and multipliers change as the entering row's multiplier grows by one.
#[derive(Clone, Copy)]
struct Step<T: Scalar> {
    force: Vector3<T>,
    rates: [T; MOST],
}

impl<T: Scalar> Step<T> {
    const NONE: Self = Self {
        force: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
        rates: [T::ZERO; MOST],
    };
}

impl<T: Scalar, const N: usize, const F: usize> Forces<T, N, F> {
    pub(crate) const fn new() -> Self {
        Self {
            limits: Limits::NONE,
            on: [false; F],
            arms: [Arm::ZERO; F],
            effort: T::ZERO,
            wanted: Wrench::ZERO,
            faces: [Face::FREE; F],
            forces: [Vector3::new(T::ZERO, T::ZERO, T::ZERO); F],
            pull: T::ZERO,
        }
    }

    /// What is to be solved: the wanted wrench about the centre of mass, for feet at `arms_w` from it, m, each part with its weight.
    pub(crate) fn aim(
        &mut self,
        settings: &Settings<T>,
        arms_w: &[Vector3<T>; F],
        wanted: &Wrench<T>,
    ) {
        let force = math::sqrt(settings.force_weight);
        let moment = math::sqrt(settings.moment_weight);
        self.arms = arms_w.map(|arm_w| Arm {
            force,
            moment_w: arm_w * moment,
        });
        self.effort = settings.effort_weight;
        self.wanted = Wrench {
            force_w: wanted.force_w * force,
            moment_w: wanted.moment_w * moment,
        };
    }

    /// Forces for the feet, world axes: optimal, or inside all limits and said not to be.
    pub(crate) fn solve(&mut self) -> ([Vector3<T>; F], Outcome) {
        let mut steps = 0;
        self.remember();
        let outcome = match self.search(&mut steps) {
            Ok(()) => Outcome::Solved(steps),
            Err(Stop::Limit) => Outcome::Failed(Status::Limit),
            Err(Stop::Numerical) => {
                self.faces = [Face::FREE; F];
                Outcome::Failed(Status::Numerical)
            }
        };
        (self.inside(), outcome)
    }

    /// The last iterate, brought inside all limits.
    pub(crate) fn inside(&self) -> [Vector3<T>; F] {
        let mut forces = self.forces;
        for (foot, force) in forces.iter_mut().enumerate() {
            if !force.iter().all(|x| x.is_finite_number()) {
                *force = Vector3::zeros();
            }
            self.limits.shorten(foot, force);
        }
        forces
    }

    /// The rows of the last tick as they are now.
    fn remember(&mut self) {
        for (face, on) in self.faces.iter_mut().zip(&self.on) {
            if *on {
                self.limits.rebuild(face);
            } else {
                *face = Face::FREE;
            }
        }
    }

    fn search(&mut self, steps: &mut u32) -> Result<(), Stop> {
        let mut inverse = self.inverse(steps)?;
        loop {
            self.settle(&mut inverse, steps)?;
            let Some(mut violated) = self.most_violated() else {
                self.refine(&inverse);
                return Ok(());
            };
            loop {
                inverse = self.enter(violated, steps)?;
                match self.most_violated() {
                    Some(next) => violated = next,
                    None => break,
                }
            }
        }
    }

    /// (w_e + Σ B P Bᵀ)⁻¹.
    fn inverse(&self, steps: &mut u32) -> Result<Inverse<T>, Stop> {
        if *steps >= MAX_STEPS {
            return Err(Stop::Limit);
        }
        *steps += 1;
        let mut square = Square::diagonal(self.effort);
        for ((face, arm), on) in self.faces.iter().zip(&self.arms).zip(&self.on) {
            if *on {
                face.add_to(arm, &mut square);
            }
        }
        Ok(Inverse::new(&square))
    }

    /// The stationary forces with all rows of the faces met; rows that would pull leave.
    fn settle(&mut self, inverse: &mut Inverse<T>, steps: &mut u32) -> Result<(), Stop> {
        loop {
            let s = self.stationary(inverse);
            let least = -self.tolerance();
            let mut pulling = false;
            for face in &mut self.faces {
                if let Some((k, multiplier)) = face.least()
                    && multiplier < least
                {
                    self.limits.remove(face, k);
                    pulling = true;
                }
            }
            if !pulling {
                return self.confirm(&s);
            }
            *inverse = self.inverse(steps)?;
        }
    }

    /// Forces and multipliers of the active set, from scratch; returns s.
    fn stationary(&mut self, inverse: &Inverse<T>) -> Wrench<T> {
        let mut missing = self.wanted;
        for ((face, arm), force) in self.faces.iter().zip(&self.arms).zip(&mut self.forces) {
            *force = face.point();
            missing = missing.sub(&arm.wrench(force));
        }
        let s = inverse.solve(&missing);
        self.pull = T::ZERO;
        let feet = self.faces.iter_mut().zip(&self.arms).zip(&self.on);
        for (((face, arm), on), force) in feet.zip(&mut self.forces) {
            if *on {
                let pull = arm.pull(&s);
                self.pull = math::max(self.pull, pull.amax());
                *force += face.free(&pull);
                face.balance(&pull, force);
            }
        }
        s
    }

    /// Whether the forces make the wrench that their multiplier s says.
    fn confirm(&self, s: &Wrench<T>) -> Result<(), Stop> {
        let mut off = self.wanted.sub(&s.scaled(self.effort));
        for (arm, force) in self.arms.iter().zip(&self.forces) {
            off = off.sub(&arm.wrench(force));
        }
        // False for NaN.
        if off.size() <= self.wanted.size() * stationarity() {
            Ok(())
        } else {
            Err(Stop::Numerical)
        }
    }

    /// Takes the round-off of the search out of the forces, as far as corrections halve each time; where they do not, as with weights too far
    /// apart for the precision, all stays as it was.
    fn refine(&mut self, inverse: &Inverse<T>) {
        let (before, mut last) = (self.forces, T::INFINITY);
        for _ in 0..refinements::<T>() {
            let moves = self.correction(inverse);
            let sizes = moves.iter().flatten().map(|x| math::abs(*x));
            let size = sizes.fold(T::ZERO, |sum, x| sum + x);
            // False for NaN.
            if size <= last * T::HALF {
                last = size;
            } else {
                self.forces = before;
                return;
            }
            for (force, own) in self.forces.iter_mut().zip(&moves) {
                *force += own;
            }
        }
    }

    /// How forces on their faces have to move: with t = Bᵀ(b − Σ B f) − w_e f, what is left of the gradient, by (w_e + P BᵀB P)⁻¹ P t
    /// = P(t − Bᵀ (w_e + Σ B P Bᵀ)⁻¹ Σ B P t)/w_e.
    ///
    /// Bᵀs grows with the part of the wanted wrench that the limits forbid, to 5·10⁷ N for forces of some hundred newtons, and its
    /// round-off is in the forces. t is w_e times as large.
    fn correction(&self, inverse: &Inverse<T>) -> [Vector3<T>; F] {
        let mut missing = self.wanted;
        for (arm, force) in self.arms.iter().zip(&self.forces) {
            missing = missing.sub(&arm.wrench(force));
        }
        let per_effort = T::ONE / self.effort;
        let (mut moves, mut answer) = ([Vector3::zeros(); F], Wrench::ZERO);
        let feet = self.faces.iter().zip(&self.arms).zip(&self.on);
        for ((((face, arm), on), force), own) in feet.zip(&self.forces).zip(&mut moves) {
            if *on {
                *own = face.free(&(arm.pull(&missing) - force * self.effort)) * per_effort;
                answer = answer.sub(&arm.wrench(own));
            }
        }
        let s = inverse.solve(&answer);
        let feet = self.faces.iter().zip(&self.arms).zip(&self.on);
        for (((face, arm), on), own) in feet.zip(&mut moves) {
            if *on {
                *own += face.free(&arm.pull(&s));
            }
        }
        moves
    }

    /// Violation, or multiplier below zero, that is round-off, N.
    fn tolerance(&self) -> T {
        let sum = self.forces.iter().fold(T::ONE, |sum, f| sum + f.amax());
        (sum * T::of(4096.0) + self.pull * T::of(8.0)) * T::EPSILON
    }

    /// Foot and number of the row that is violated most.
    fn most_violated(&self) -> Option<(usize, usize)> {
        let (mut worst, mut most) = (None, self.tolerance());
        for (foot, (force, on)) in self.forces.iter().zip(&self.on).enumerate() {
            if *on {
                let violation = self.limits.most_violated(foot, force);
                if violation.force > most {
                    (worst, most) = (Some((foot, violation.row)), violation.force);
                }
            }
        }
        worst
    }

    /// Moves until the row holds, past the multipliers that reach zero on the way; returns the inverse of the new active set.
    fn enter(&mut self, (foot, row): (usize, usize), steps: &mut u32) -> Result<Inverse<T>, Stop> {
        let Row { normal, most } = self.limits.row(row);
        let mut multiplier = T::ZERO;
        loop {
            let limits = &self.limits;
            let (Some(face), Some(arm)) = (self.faces.get_mut(foot), self.arms.get(foot)) else {
                return Err(Stop::Numerical);
            };
            let split = face.split(&normal);
            if !split.is_independent(&normal) || face.is_full() {
                // The force cannot move along the normal: the rows that it depends on give way until one is let go.
                let rates = face.combination(&normal).map(|x| -x);
                let Some((k, t)) = face.blocking(&rates, MOST) else {
                    return Err(Stop::Numerical);
                };
                face.advance(t, &rates);
                multiplier += t;
                limits.remove(face, k);
                continue;
            }
            face.push(row, most, &split, multiplier);
            let arm = *arm;
            let inverse = self.inverse(steps)?;
            // The old set answers a pull along the normal's free part t with K⁻¹ B t, K = K' + B t (B t)ᵀ/|t|² and K' of the new set.
            let along = arm.wrench(&split.rest);
            let answer = inverse.solve(&along);
            let per_length = T::ONE / split.rest.norm_squared();
            let stiff = T::ONE + along.dot(&answer) * per_length;
            let share = T::ONE / stiff;
            let s = answer.scaled(share);
            let here = split.rest * share;

            let force = self.forces.get(foot).copied().unwrap_or_default();
            let (mut t, mut blocking) = ((normal.dot(&force) - most) * stiff * per_length, None);
            let mut steps_of = [Step::NONE; F];
            let feet = self.faces.iter().zip(&self.arms).zip(&self.on);
            for (i, (step, ((face, arm), on))) in steps_of.iter_mut().zip(feet).enumerate() {
                if !*on {
                    continue;
                }
                let pull = arm.pull(&s);
                step.force = face.free(&pull);
                if i == foot {
                    step.force -= here;
                }
                step.rates = face.combination(&(pull - step.force));
                let old = face.len() - usize::from(i == foot);
                if let Some((k, reach)) = face.blocking(&step.rates, old)
                    && reach < t
                {
                    (t, blocking) = (reach, Some((i, k)));
                }
            }
            let feet = self.faces.iter_mut().zip(&mut self.forces);
            for (step, (face, force)) in steps_of.iter().zip(feet) {
                *force += step.force * t;
                face.advance(t, &step.rates);
            }
            let Some((other, k)) = blocking else {
                return Ok(inverse);
            };
            if let Some(face) = self.faces.get_mut(foot) {
                multiplier = face.pop();
            }
            if let Some(face) = self.faces.get_mut(other) {
                self.limits.remove(face, k);
            }
        }
    }
}

/// How often the optimum is corrected. In double precision its round-off is below 10⁻⁷ N, and not worth the time; in single precision it is up
/// to some newtons, of which one correction leaves a hundredth and two what the forces have of their own.
fn refinements<T: Scalar>() -> u32 {
    if T::EPSILON < T::of(1e-12) { 0 } else { 2 }
}

/// Largest error of the wrench, relative to the wanted one, of forces that are called optimal.
fn stationarity<T: Scalar>() -> T {
    T::of(if T::EPSILON < T::of(1e-12) {
        1e-9
    } else {
        1e-2
    })
}

#[cfg(test)]
mod tests {
    use super::{Face, Forces, Wrench};
    use crate::{Outcome, Settings};
    use a1_model::{A1Geared, BUILD, FEET};
    use nalgebra::Vector3;
    use proptest::prelude::{prop_assert, proptest};
    use proptest::strategy::Strategy;
    use rbd_core::{Configuration, Frame, Limbs, Tree};
    use so3::Scalar;

    fn vector(most: f64) -> impl Strategy<Value = Vector3<f64>> {
        [-most..most, -most..most, -most..most].prop_map(Vector3::from)
    }

    /// Every multiplier, of all feet.
    fn multipliers(faces: &[Face<f64>; 4]) -> impl Iterator<Item = f64> {
        let all = faces.iter().flat_map(|face| face.without(usize::MAX));
        all.map(|(_, multiplier)| multiplier)
    }

    proptest! {
        /// A row that has entered leaves the search where the new rows have their optimum, found anew: with the same forces, and with
        /// multipliers that are the same and not below zero. (From anywhere else `settle` would find back, but by more factorisations.)
        #[test]
        fn a_row_enters_to_the_optimum_of_the_rows_that_hold(
            joints in [-0.3..0.3, 0.5..1.0, -1.9..-1.2_f64], force_w in vector(900.0), moment_w in vector(90.0), torque in 5.0..40.0_f64,
        ) {
            let q = Configuration {
                joints: core::array::from_fn(|j| joints[j % 3]),
                ..Configuration::NEUTRAL
            };
            let limbs = Limbs::new(&A1Geared, &q, &FEET.map(|foot| foot.frame));
            let mut forces = Forces::<f64, 12, 4>::new();
            forces.limits.write((0.5, 250.0), &limbs, &[true; 4], (&[0.0; 12], &[torque; 12]));
            forces.on = [true; 4];
            let arms_w = limbs.ends.each_ref().map(|end| end.position);
            forces.aim(&Settings::new(&BUILD), &arms_w, &Wrench { force_w, moment_w });
            let mut steps = 0;
            let begun = forces.inverse(&mut steps).and_then(|mut inverse| forces.settle(&mut inverse, &mut steps));
            prop_assert!(begun.is_ok());
            while let Some(violated) = forces.most_violated() {
                // A tick that ran out of factorisations.
                let Ok(inverse) = forces.enter(violated, &mut steps) else { break };
                let mut anew = forces.clone();
                let _ = anew.stationary(&inverse);
                let close = |a: f64, b: f64| (a - b).abs() < 1e-7 * (1.0 + anew.pull);
                for (moved, anew) in forces.forces.iter().zip(&anew.forces) {
                    prop_assert!(moved.iter().zip(anew).all(|(a, b)| close(*a, *b)), "{moved} {anew}");
                }
                for (moved, anew) in multipliers(&forces.faces).zip(multipliers(&anew.faces)) {
                    prop_assert!(close(moved, anew), "{moved} {anew}");
                    prop_assert!(anew > 0.0 || close(anew, 0.0), "{anew}");
                }
            }
        }
    }

    /// Forces on two diagonal feet, of numbers that both precisions have exactly; no joint binds.
    fn diagonal<T: Scalar>(wanted: [f64; 6]) -> [Vector3<f64>; 4]
    where
        A1Geared: Tree<T, 12>,
    {
        let q = Configuration {
            joints: [T::of(0.5); 12],
            ..Configuration::NEUTRAL
        };
        let feet = FEET.map(|foot| Frame {
            link: foot.frame.link,
            ..Frame::IDENTITY
        });
        let limbs = Limbs::new(&A1Geared, &q, &feet);
        let mut forces = Forces::<T, 12, 4>::new();
        forces.on = [true, false, false, true];
        let torques = (&[T::ZERO; 12], &[T::of(1e6); 12]);
        let pyramid = (T::HALF, T::of(256.0));
        forces.limits.write(pyramid, &limbs, &forces.on, torques);
        let arms_w = [[1.5, 1.0], [1.5, -1.0], [-1.5, 1.0], [-1.5, -1.0]];
        let arms_w = arms_w.map(|[x, y]| Vector3::new(x, y, -2.0).map(|x| T::of(x / 8.0)));
        let mut settings = Settings::new(&BUILD.cast());
        settings.force_weight = T::ONE;
        settings.moment_weight = T::of(16.0);
        settings.effort_weight = T::of(1.0 / 8192.0);
        let [fx, fy, fz, mx, my, mz] = wanted.map(T::of);
        let wanted = Wrench {
            force_w: Vector3::new(fx, fy, fz),
            moment_w: Vector3::new(mx, my, mz),
        };
        forces.aim(&settings, &arms_w, &wanted);
        let (found, outcome) = forces.solve();
        assert!(matches!(outcome, Outcome::Solved(_)), "{outcome:?}");
        found.map(|force| force.map(Scalar::to_f64))
    }

    /// Of the same numbers single precision makes forces that are right to their own round-off. Uncorrected they are off by 2 to 106 mN, 240 to
    /// 11 000 units of it.
    #[test]
    fn single_precision_makes_forces_of_its_own_round_off() {
        for wanted in [
            [0.0, 0.0, 120.0, 0.0, 10.0, 0.0],
            [0.0, 0.0, 120.0, 5.0, -3.0, 4.0],
            [100.0, 0.0, 120.0, 0.0, 10.0, 0.0],
            [300.0, 50.0, 120.0, 20.0, 10.0, 30.0],
            [30.0, 500.0, 400.0, -20.0, 10.0, -5.0],
            [-300.0, 200.0, 500.0, 50.0, 10.0, -5.0],
            [20.0, 20.0, -100.0, 50.0, 10.0, -5.0],
        ] {
            let (single, double) = (diagonal::<f32>(wanted), diagonal::<f64>(wanted));
            let feet = single.iter().zip(&double);
            let off = feet.fold(0.0, |most: f64, (s, d)| most.max((s - d).amax()));
            let size = double.iter().fold(0.0, |most: f64, f| most.max(f.amax()));
            let most = 8.0 * f64::from(f32::EPSILON) * size;
            assert!(off < most, "{wanted:?}: {off:e} of {size}");
        }
    }
}
