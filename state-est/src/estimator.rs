//! One step of the estimator.

use nalgebra::{Rotation3, Vector3};
use rbd_core::{
    Axes, Configuration, FrameJacobian, GRAVITY, Kinematics, Motion, Posture, Tangent, Transform,
    Tree, forward_kinematics, frame_jacobian,
};
use so3::{Scalar, math, orthonormalize_step};

use crate::feet::{Seen, consensus, turn_of_feet, turn_of_soles};
use crate::filter::{FEET, Filter, POSITION, VELOCITY};
use crate::{Fault, Foot, Sample, Settings};

/// The estimator of a robot with `N` joints and `F` feet; `S` must be F + 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimator<T: Scalar, const N: usize, const F: usize, const S: usize> {
    /// The feet.
    pub feet: [Foot<T>; F],
    /// Pose of the IMU in the base.
    pub imu: Transform<T>,
    /// Noise, gates and limits.
    pub settings: Settings<T>,
}

/// Memory of the estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T: Scalar, const F: usize, const S: usize> {
    filter: Filter<T, S>,
    rot_wb: Rotation3<T>,
    /// Bias of the gyroscope, base axes.
    bias_b: Vector3<T>,
    /// The last good IMU sample, base axes, bias not removed.
    force_b: Vector3<T>,
    rate_b: Vector3<T>,
    anchored: [bool; F],
    confidence: [T; F],
    coasting: T,
    /// Time for which most feet have agreed, s.
    agreed: T,
    /// Time for which soles have told the gyroscope's bias, s, and that for which its first value counts; up to that of its gain.
    heard: T,
}

/// Whether the estimate may be acted on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Fresh.
    Good,
    /// IMU samples are missing, for a short time so far.
    Coasting,
    /// They are missing for too long: the estimate stands still where it was.
    Lost,
}

/// The estimate after one step; always finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate<T: Scalar, const F: usize> {
    /// Pose of the base in the world.
    pub base: Transform<T>,
    /// Velocity of the base, base axes.
    pub velocity: Motion<T>,
    /// How sure it is that each foot stands on the ground, 0 to 1.
    pub confidence: [T; F],
    /// Whether it may be acted on.
    pub status: Status,
    /// The first thing that was wrong with the sample.
    pub fault: Option<Fault>,
}

impl<T: Scalar, const F: usize, const S: usize> State<T, F, S> {
    /// Standing still in a known place.
    #[must_use]
    pub fn new<M: Tree<T, N>, const N: usize>(
        estimator: &Estimator<T, N, F, S>,
        model: &M,
        start: &Configuration<T, N>,
    ) -> Self {
        let mut kinematics = Kinematics::IDENTITY;
        forward_kinematics(model, &Posture::new(model, start), &mut kinematics);
        let mut mean = [Vector3::zeros(); S];
        if let Some(p) = mean.get_mut(POSITION) {
            *p = start.base.point(&estimator.imu.translation);
        }
        for (slot, foot) in mean.iter_mut().skip(FEET).zip(&estimator.feet) {
            *slot = kinematics.frame(&foot.frame).translation;
        }
        let rot_wb = start.base.rotation;
        Self {
            filter: Filter::new(mean, T::of(1e-3)),
            rot_wb,
            bias_b: Vector3::zeros(),
            force_b: rot_wb.inverse() * -gravity::<T>(),
            rate_b: Vector3::zeros(),
            anchored: [false; F],
            confidence: [T::ZERO; F],
            coasting: T::ZERO,
            agreed: T::ZERO,
            heard: estimator.settings.agreement,
        }
    }

    /// The same, under way instead of at rest: the IMU's point moves at `vel_w`, world axes, m/s. An IMU feels how a velocity changes and
    /// never the velocity, so that a robot which is let go in motion has to be told.
    #[must_use]
    pub fn moving(mut self, vel_w: Vector3<T>) -> Self {
        if let Some(v) = self.filter.mean.get_mut(VELOCITY) {
            *v = vel_w;
        }
        self
    }

    /// From now on the middle of the feet is at `middle_w`, m, and the base heads along `heading`, rad about the vertical: the world is another one,
    /// as at the start of a plan for a robot that begins it where the last one has left it. Tilt, motion, biases and what is known of them stay.
    ///
    /// The heading is the direction of the base's x axis, seen from above. False, and nothing changes, unless every foot stands and the numbers are finite.
    #[must_use]
    pub fn stand_at(&mut self, middle_w: &Vector3<T>, heading: T) -> bool {
        let known = is_finite(middle_w) && heading.is_finite_number();
        if !known || F == 0 || self.anchored.contains(&false) {
            return false;
        }
        let ahead = self.rot_wb * Vector3::x();
        let turn = heading - math::atan2(ahead.y, ahead.x);
        let turned = so3::exp(&(Vector3::z() * turn));
        let feet = self.filter.mean.iter().skip(FEET);
        let sum = feet.fold(Vector3::zeros(), |sum, foot| sum + foot);
        let shift = middle_w - turned * (sum / T::of(F as f64));
        for (row, x) in self.filter.mean.iter_mut().enumerate() {
            *x = turned * *x;
            if row != VELOCITY {
                *x += shift;
            }
        }
        self.rot_wb = turned * self.rot_wb;
        true
    }

    /// Where the feet stand in the world, m: the middles of balls, or the points of soles. None unless every foot stands.
    #[must_use]
    pub fn feet(&self) -> Option<[Vector3<T>; F]> {
        let mut feet_w = [Vector3::zeros(); F];
        for (foot, mean) in feet_w.iter_mut().zip(self.filter.mean.iter().skip(FEET)) {
            *foot = *mean;
        }
        let stands = !self.anchored.contains(&false);
        stands.then_some(feet_w)
    }

    fn is_finite(&self) -> bool {
        let vectors = [&self.bias_b, &self.force_b, &self.rate_b];
        self.filter.is_finite()
            && self.rot_wb.matrix().iter().all(|x| x.is_finite_number())
            && vectors.into_iter().all(is_finite)
    }
}

impl<T: Scalar, const N: usize, const F: usize, const S: usize> Estimator<T, N, F, S> {
    /// One step of `dt` seconds; `None` if no sample arrived.
    #[must_use]
    pub fn step<M: Tree<T, N>>(
        &self,
        model: &M,
        state: &mut State<T, F, S>,
        sample: Option<&Sample<T, N, F>>,
        dt: T,
    ) -> Estimate<T, F> {
        const { assert!(S == F + 2, "S must be F + 2") };
        // Also false for NaN.
        if !(dt > T::ZERO && dt <= self.settings.max_dt) {
            return self.report(state, Some(Fault::Step));
        }
        let before = *state;
        let mut fault = self.read_imu(state, sample, dt);
        if state.coasting > self.settings.max_coasting {
            state.rate_b = state.bias_b;
            if let Some(v) = state.filter.mean.get_mut(VELOCITY) {
                *v = Vector3::zeros();
            }
            state.confidence = [T::ZERO; F];
            return self.report(state, fault);
        }
        self.propagate(state, dt);
        match sample {
            Some(sample) => {
                let (seen, wrong) = self.look(model, state, sample);
                fault = fault.or(wrong);
                self.correct(state, &seen, dt);
                self.level(state, &seen, dt);
            }
            None => state.confidence = [T::ZERO; F],
        }
        if !state.is_finite() {
            *state = before;
            fault = fault.or(Some(Fault::Diverged));
        }
        self.report(state, fault)
    }

    /// Takes the IMU's numbers where they are possible, and counts the time without.
    fn read_imu(
        &self,
        state: &mut State<T, F, S>,
        sample: Option<&Sample<T, N, F>>,
        dt: T,
    ) -> Option<Fault> {
        let s = &self.settings;
        let within = |x: &Vector3<T>, limit: T| x.iter().all(|x| math::abs(*x) <= limit);
        let fault = match sample {
            None => Some(Fault::Missing),
            Some(x) => {
                let gyroscope = within(&x.angular_velocity_i, s.max_angular_velocity);
                let accelerometer = within(&x.specific_force_i, s.max_specific_force);
                if gyroscope {
                    state.rate_b = self.imu.rotation * x.angular_velocity_i;
                }
                if accelerometer {
                    state.force_b = self.imu.rotation * x.specific_force_i;
                }
                match (gyroscope, accelerometer) {
                    (false, _) => Some(Fault::Gyroscope),
                    (true, false) => Some(Fault::Accelerometer),
                    (true, true) => None,
                }
            }
        };
        state.coasting = if fault.is_some() {
            // Not beyond the limit: sums of small numbers must not end in a stuck float.
            math::min(state.coasting + dt, s.max_coasting + s.max_dt)
        } else {
            T::ZERO
        };
        fault
    }

    /// Attitude by the gyroscope, position and velocity by the accelerometer.
    fn propagate(&self, state: &mut State<T, F, S>, dt: T) {
        let turn = so3::exp(&((state.rate_b - state.bias_b) * (dt * T::HALF)));
        // The force is felt at the middle of the step.
        let middle = state.rot_wb * turn;
        let acceleration = middle * state.force_b + gravity::<T>();
        state.rot_wb = orthonormalize_step(&(middle * turn));
        // What is not there, or beyond the range at an impact, may have been as large as the range.
        let deviation = if state.coasting > T::ZERO {
            self.settings.max_specific_force
        } else {
            self.settings.accelerometer
        };
        state.filter.predict(&acceleration, deviation, dt);
    }

    /// Where the legs say the feet are, and how the IMU moves if they stand.
    fn look<M: Tree<T, N>>(
        &self,
        model: &M,
        state: &State<T, F, S>,
        sample: &Sample<T, N, F>,
    ) -> ([Seen<T>; F], Option<Fault>) {
        let mut q = Configuration {
            base: Transform::IDENTITY,
            joints: sample.joints,
        };
        let mut v = Tangent::ZERO;
        v.joints = sample.joint_velocities;
        let mut blind = [false; N];
        let mut fault = None;
        let joints = q.joints.iter_mut().zip(&mut v.joints).zip(&mut blind);
        for (i, ((q, qd), blind)) in joints.enumerate() {
            // What an encoder can say; false for NaN.
            let sane = |x: T| math::abs(x) <= T::of(1e4);
            if !(sane(*q) && sane(*qd)) {
                (*q, *qd, *blind) = (T::ZERO, T::ZERO, true);
                fault = fault.or(Some(Fault::Joint(i)));
            }
        }
        let mut kinematics = Kinematics::IDENTITY;
        forward_kinematics(model, &Posture::new(model, &q), &mut kinematics);
        let mut jacobian = FrameJacobian::ZERO;
        let omega_b = state.rate_b - state.bias_b;
        let mut seen = [Seen {
            arm_w: Vector3::zeros(),
            velocity_w: Vector3::zeros(),
            rolling_w: Vector3::zeros(),
            turning_w: None,
            evidence: T::ZERO,
        }; F];
        let feet = self.feet.iter().zip(&sample.evidence);
        for (i, (seen, (foot, evidence))) in seen.iter_mut().zip(feet).enumerate() {
            frame_jacobian(
                model,
                &kinematics,
                &foot.frame,
                Axes::LocalWorldAligned,
                &mut jacobian,
            );
            let motion = jacobian.mul(&v);
            let arm_b = kinematics.frame(&foot.frame).translation - self.imu.translation;
            let up = Vector3::z() * foot.radius;
            let turning_w = state.rot_wb * (omega_b + motion.angular);
            seen.arm_w = state.rot_wb * arm_b;
            seen.rolling_w = turning_w.cross(&up);
            seen.turning_w = (foot.radius == T::ZERO).then_some(turning_w);
            let relative = state.rot_wb * (motion.linear + omega_b.cross(&arm_b));
            seen.velocity_w = seen.rolling_w - relative;
            let usable = !blind
                .iter()
                .enumerate()
                .any(|(j, blind)| *blind && model.moves(j, foot.frame.link));
            if evidence.is_nan_number() {
                fault = fault.or(Some(Fault::Evidence(i)));
            } else if usable {
                seen.evidence = math::clamp(*evidence, T::ZERO, T::ONE);
            }
        }
        (seen, fault)
    }

    /// Feet in contact as anchors and speedometers.
    fn correct(&self, state: &mut State<T, F, S>, seen: &[Seen<T>; F], dt: T) {
        let s = &self.settings;
        let velocity = state.filter.get(VELOCITY);
        let majority = consensus(seen, s);
        state.agreed = match majority {
            // Not beyond the limit: sums of small numbers must not end in a stuck float.
            Some(_) => math::min(state.agreed + dt, s.agreement),
            None => T::ZERO,
        };
        let majority = majority.filter(|_| state.agreed >= s.agreement);
        // By half at the gate; from a velocity of which the filter itself is not sure, wider by its variance along three axes.
        let gate = s.slip_gate * s.slip_gate;
        let wide = gate + T::of(3.0) * state.filter.variance(VELOCITY);
        let half = |slip: T, gate: T| gate / (gate + slip * slip);
        for (i, foot) in seen.iter().enumerate() {
            let slip = |from: Vector3<T>, gate| half((foot.velocity_w - from).norm(), gate);
            let own = slip(velocity, wide);
            let fit = majority.map_or(own, |m| math::max(own, slip(m, gate)));
            let confidence = foot.evidence * fit;
            let trusted = confidence >= s.least_confidence;
            if let Some(slot) = state.confidence.get_mut(i) {
                *slot = confidence;
            }
            let Some(anchored) = state.anchored.get_mut(i) else {
                return;
            };
            let fresh = trusted && !*anchored;
            *anchored = trusted;
            if !trusted {
                continue;
            }
            let row = FEET + i;
            let position = s.foot_position * s.foot_position / confidence;
            if fresh {
                state.filter.anchor(row, &foot.arm_w, position);
            } else {
                let drift = s.foot_drift * s.foot_drift * dt / confidence;
                state.filter.walk(row, &(foot.rolling_w * dt), drift);
                state
                    .filter
                    .measure(row, Some(POSITION), &foot.arm_w, position);
            }
            let speed = s.foot_speed * s.foot_speed / (confidence * confidence);
            state
                .filter
                .measure(VELOCITY, None, &foot.velocity_w, speed);
        }
    }

    /// While quasi-static, gravity corrects the tilt, and feet that stand correct the gyroscope's bias.
    fn level(&self, state: &mut State<T, F, S>, seen: &[Seen<T>; F], dt: T) {
        let s = &self.settings;
        let size = state.force_b.norm();
        let rate_b = state.rate_b - state.bias_b;
        let quiet = |x: T, limit: f64| math::abs(x) < T::of(limit);
        let steady = quiet(size - T::of(9.81), 1.0) && quiet(rate_b.norm(), 0.5);
        let stands = state.confidence.iter().any(|c| *c > T::HALF);
        if !steady || !stands || state.coasting > T::ZERO {
            return;
        }
        // Turning the estimate by f × up brings its vertical to the force.
        let up_b = state.rot_wb.inverse() * Vector3::z();
        let error = (state.force_b / size).cross(&up_b);
        let (missing_w, gain) = match turn_of_soles(seen, &state.confidence) {
            // At first the mean of what they have said; nothing with a gain of zero, or of ground that may still give way.
            Some(missing_w) if s.bias_gain > T::ZERO && state.agreed >= s.agreement => {
                state.heard = math::min(state.heard + dt, T::ONE / s.bias_gain);
                (missing_w, T::ONE / state.heard)
            }
            _ => (turn_of_feet(seen, &state.confidence), s.bias_gain),
        };
        let missing_b = state.rot_wb.inverse() * missing_w;
        state.rot_wb *= so3::exp(&(error * (s.tilt_gain * dt)));
        let bias = state.bias_b - missing_b * (gain * dt);
        state.bias_b = bias.map(|x| math::clamp(x, -s.max_bias, s.max_bias));
    }

    /// The estimate for the outside: the base instead of the IMU.
    fn report(&self, state: &State<T, F, S>, fault: Option<Fault>) -> Estimate<T, F> {
        let omega_b = state.rate_b - state.bias_b;
        let arm_b = self.imu.translation;
        let status = if state.coasting > self.settings.max_coasting {
            Status::Lost
        } else if state.coasting > T::ZERO {
            Status::Coasting
        } else {
            Status::Good
        };
        let at = state.filter.get(POSITION) - state.rot_wb * arm_b;
        let velocity_b = state.rot_wb.inverse() * state.filter.get(VELOCITY);
        Estimate {
            base: Transform::new(state.rot_wb, at),
            velocity: Motion::new(velocity_b - omega_b.cross(&arm_b), omega_b),
            confidence: state.confidence,
            status,
            fault,
        }
    }
}

fn gravity<T: Scalar>() -> Vector3<T> {
    Vector3::from(GRAVITY.map(T::of))
}

fn is_finite<T: Scalar>(x: &Vector3<T>) -> bool {
    x.iter().all(|x| x.is_finite_number())
}

#[cfg(test)]
mod tests {
    use super::{Estimator, State};
    use crate::{Foot, Sample, Settings};
    use a1_model::{A1, FEET};
    use nalgebra::Vector3;
    use rbd_core::{Configuration, Transform};

    /// A robot that is let go in motion is followed through its fall, of which the IMU feels nothing.
    #[test]
    fn a_thrown_robot_is_followed_from_the_release() {
        let estimator = Estimator::<f64, 12, 4, 6> {
            feet: FEET.map(|foot| Foot::of(&foot)),
            imu: Transform::IDENTITY,
            settings: Settings::new(),
        };
        let mut start = Configuration::<f64, 12>::NEUTRAL;
        start.base.rotation = so3::exp(&Vector3::new(0.3, -0.2, 0.1));
        let thrown_w = Vector3::new(0.1, 0.5, -0.2);
        let mut state = State::new(&estimator, &A1, &start).moving(thrown_w);
        let falling = Sample {
            specific_force_i: Vector3::zeros(),
            angular_velocity_i: Vector3::zeros(),
            joints: start.joints,
            joint_velocities: [0.0; 12],
            evidence: [0.0; 4],
        };
        let mut estimate = estimator.step(&A1, &mut state, Some(&falling), 1e-3);
        for _ in 1..400 {
            estimate = estimator.step(&A1, &mut state, Some(&falling), 1e-3);
        }
        let gravity_w = Vector3::from(rbd_core::GRAVITY);
        let place_w = thrown_w * 0.4 + gravity_w * (0.5 * 0.4 * 0.4);
        let vel_w = estimate.base.rotation * estimate.velocity.linear;
        assert!((estimate.base.translation - place_w).norm() < 1e-9);
        assert!((vel_w - (thrown_w + gravity_w * 0.4)).norm() < 1e-9);
    }
}
