//! The pre-landing posture, turned partly against the tilt of the body.
//!
//! With the body tilted, feet that stay where they are in the base come down under one side of it. Turning all feet about
//! the base's origin, towards where a level body would have them, brings them under the centre of mass again; but the legs'
//! momentum turns a light trunk the other way, so only a share of the tilt is right. Feet that lead the horizontal motion
//! step towards the capture point.

use nalgebra::Vector3;
use rbd_core::{Build, Configuration, Frame, Limbs, Tree};
use so3::{Scalar, math};

use crate::least_squares::solve_damped;

/// Gauss-Newton steps from the level posture that find a turned one to a fraction of a millimetre.
const STEPS: usize = 3;

/// How far legs follow the tilt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreLanding<T, const N: usize, const F: usize> {
    /// The feet; each is the end of a leg of its own.
    pub feet: [Frame<T>; F],
    /// Joint positions for a level landing, rad.
    pub joints: [T; N],
    /// Share of the tilt that the feet follow.
    pub share: T,
    /// Time by which the feet lead the body's horizontal motion, s: towards the capture point, √(h/g) for a full step.
    pub lead: T,
    /// Farthest that they lead, m.
    pub max_lead: T,
    /// Largest tilt that they follow, rad; more is treated as this.
    pub max_tilt: T,
    /// Farthest that a joint goes from its level position, rad.
    pub reach: T,
    /// Tikhonov term on the way of a foot, m²: keeps a stretched leg from jumping about.
    pub damping: T,
}

impl<T: Scalar, const N: usize, const F: usize> PreLanding<T, N, F> {
    /// Half of at most 0.6 rad, joints within 0.5 rad; and, on legs of 0.4 m, 0.12 s of lead up to 12 cm, scaled by
    /// [dynamic similarity](rbd_core::similarity).
    #[must_use]
    pub fn new(build: &Build<T>, feet: [Frame<T>; F], joints: [T; N]) -> Self {
        Self {
            feet,
            joints,
            share: T::HALF,
            lead: build.time(0.12),
            max_lead: build.length(0.12),
            max_tilt: T::of(0.6),
            reach: T::HALF,
            damping: build.area(1e-4),
        }
    }

    /// Joint positions for a body whose up direction is `up_b` (Rᵀ e_z) and which moves with `velocity_b`, both in base axes.
    /// Numbers that are not finite give the level posture.
    #[must_use]
    pub fn joints<M: Tree<T, N>>(
        &self,
        model: &M,
        up_b: &Vector3<T>,
        velocity_b: &Vector3<T>,
    ) -> [T; N] {
        let mut limbs = self.limbs(model, &self.joints);
        let level = limbs.ends.each_ref().map(|end| end.position);
        let Some(wanted) = self.feet(&level, up_b, velocity_b) else {
            return self.joints;
        };
        let mut joints = self.step(&limbs, &wanted, &self.joints);
        for _ in 1..STEPS {
            limbs = self.limbs(model, &joints);
            joints = self.step(&limbs, &wanted, &joints);
        }
        joints
    }

    /// The feet of the level posture, base axes: what [`PreLanding::follow`] turns.
    #[must_use]
    pub fn level_feet<M: Tree<T, N>>(&self, model: &M) -> [Vector3<T>; F] {
        self.limbs(model, &self.joints)
            .ends
            .each_ref()
            .map(|end| end.position)
    }

    /// [`PreLanding::joints`] for every tick of a controller: one Gauss-Newton step from the `last` answer, so that a tick costs
    /// a third and the answer is exact after two or three. Begin with the level posture. `limbs` is storage.
    #[must_use]
    pub fn follow<M: Tree<T, N>>(
        &self,
        model: &M,
        level_feet: &[Vector3<T>; F],
        (up_b, velocity_b): (&Vector3<T>, &Vector3<T>),
        last: &[T; N],
        limbs: &mut Limbs<T, N, F>,
    ) -> [T; N] {
        let Some(wanted) = self.feet(level_feet, up_b, velocity_b) else {
            return self.joints;
        };
        let q = Configuration {
            joints: *last,
            ..Configuration::NEUTRAL
        };
        limbs.update(model, &q, &self.feet);
        self.step(limbs, &wanted, last)
    }

    fn limbs<M: Tree<T, N>>(&self, model: &M, joints: &[T; N]) -> Limbs<T, N, F> {
        let q = Configuration {
            joints: *joints,
            ..Configuration::NEUTRAL
        };
        Limbs::new(model, &q, &self.feet)
    }

    /// Where the feet are to be, base axes; `None` where a number is not finite.
    fn feet(
        &self,
        level: &[Vector3<T>; F],
        up_b: &Vector3<T>,
        velocity_b: &Vector3<T>,
    ) -> Option<[Vector3<T>; F]> {
        let mut numbers = up_b.iter().chain(velocity_b.iter());
        if !numbers.all(|x| x.is_finite_number()) {
            return None;
        }
        let across = (velocity_b - up_b * velocity_b.dot(up_b)) * self.lead;
        let size = math::sqrt(across.norm_squared());
        let lead = if size > self.max_lead {
            across * (self.max_lead / size)
        } else {
            across
        };
        // The rotation that takes e_z to up: axis e_z × up, sine |e_z × up|, cosine e_z · up.
        let axis = Vector3::z().cross(up_b);
        let sine = math::sqrt(axis.norm_squared());
        let tilt = math::min(math::atan2(sine, up_b.z), self.max_tilt);
        let turn = if sine > T::EPSILON {
            so3::exp(&(axis * (self.share * tilt / sine)))
        } else {
            nalgebra::Rotation3::identity()
        };
        Some(level.each_ref().map(|foot| turn * foot + lead))
    }

    /// One Gauss-Newton step of the legs towards feet at `wanted`, from `joints`, whose `limbs` these are.
    fn step(&self, limbs: &Limbs<T, N, F>, wanted: &[Vector3<T>; F], joints: &[T; N]) -> [T; N] {
        let mut next = *joints;
        for (end, wanted) in limbs.ends.iter().zip(wanted) {
            let missing = wanted - end.position;
            end.add_tr_mul(&solve_damped(end, self.damping, &missing), &mut next);
        }
        for (q, level) in next.iter_mut().zip(&self.joints) {
            *q = math::clamp(*q, *level - self.reach, *level + self.reach);
        }
        if next.iter().all(|q| q.is_finite_number()) {
            next
        } else {
            self.joints
        }
    }
}

#[cfg(test)]
mod tests {
    use super::PreLanding;
    use a1_model::{A1Geared, BUILD, FEET};
    use nalgebra::Vector3;
    use rbd_core::{Configuration, Kinematics, Limbs, Posture, forward_kinematics};

    const LEVEL: [f64; 12] = [
        0.14, 0.77, -1.54, -0.14, 0.77, -1.54, 0.14, 0.77, -1.54, -0.14, 0.77, -1.54,
    ];

    fn feet_b(joints: [f64; 12]) -> [Vector3<f64>; 4] {
        let q = Configuration {
            joints,
            ..Configuration::NEUTRAL
        };
        let mut poses = Kinematics::IDENTITY;
        forward_kinematics(&A1Geared, &Posture::new(&A1Geared, &q), &mut poses);
        FEET.map(|foot| poses.frame(&foot.frame).translation)
    }

    #[test]
    fn feet_turn_by_the_share_of_the_tilt_and_lead_the_motion() {
        let posture = PreLanding::new(&BUILD, FEET.map(|foot| foot.frame), LEVEL);
        let tilt: f64 = 0.2;
        let up_b = Vector3::new(0.0, so3::math::sin(tilt), so3::math::cos(tilt));
        let velocity = Vector3::new(0.3, 0.0, 0.0);
        let feet = feet_b(posture.joints(&A1Geared, &up_b, &velocity));
        let turn = so3::exp(&Vector3::new(-0.5 * tilt, 0.0, 0.0));
        for (foot, level) in feet.iter().zip(feet_b(LEVEL)) {
            let expected = turn * level + velocity * 0.12;
            assert!((foot - expected).norm() < 2e-3, "{foot} {expected}");
        }
    }

    #[test]
    fn following_finds_what_starting_anew_finds() {
        let posture = PreLanding::new(&BUILD, FEET.map(|foot| foot.frame), LEVEL);
        let level = posture.level_feet(&A1Geared);
        let up_b = Vector3::new(0.1, 0.2, 0.97);
        let velocity = Vector3::new(0.3, -0.1, -1.0);
        let (mut joints, mut limbs) = (LEVEL, Limbs::ZERO);
        for _ in 0..super::STEPS {
            joints = posture.follow(&A1Geared, &level, (&up_b, &velocity), &joints, &mut limbs);
        }
        assert_eq!(joints, posture.joints(&A1Geared, &up_b, &velocity));
        let mut follow = |velocity: Vector3<f64>, last| {
            posture.follow(&A1Geared, &level, (&up_b, &velocity), last, &mut limbs)
        };
        assert_eq!(follow(velocity * f64::NAN, &joints), LEVEL);
        let lost = follow(velocity, &[f64::NAN; 12]);
        assert!(lost.iter().zip(LEVEL).all(|(q, l)| (q - l).abs() <= 0.5));
    }

    #[test]
    fn level_and_at_rest_nothing_changes_and_bad_numbers_change_nothing() {
        let posture = PreLanding::new(&BUILD, FEET.map(|foot| foot.frame), LEVEL);
        let joints = |up_b: Vector3<f64>, v: Vector3<f64>| posture.joints(&A1Geared, &up_b, &v);
        assert_eq!(joints(Vector3::z(), Vector3::zeros()), LEVEL);
        for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
            assert_eq!(joints(Vector3::z() * bad, Vector3::zeros()), LEVEL);
            assert_eq!(joints(Vector3::z(), Vector3::x() * bad), LEVEL);
        }
        // However fast and tilted, joints stay within reach of the level posture.
        let wild = joints(Vector3::new(1.0, 1.0, -1.0), Vector3::new(9.0, -9.0, 1.0));
        let far = wild.iter().zip(LEVEL).map(|(q, l)| (q - l).abs());
        assert!(far.fold(0.0, f64::max) <= 0.5);
    }

    /// However fast, feet lead by no more than the largest lead.
    #[test]
    fn the_lead_has_a_limit() {
        let posture = PreLanding::new(&BUILD, FEET.map(|foot| foot.frame), LEVEL);
        let joints = |speed: f64| posture.joints(&A1Geared, &Vector3::z(), &(Vector3::x() * speed));
        let limit = posture.max_lead / posture.lead;
        let apart = |a: [f64; 12], b: [f64; 12]| {
            a.iter()
                .zip(b)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max)
        };
        assert!(apart(joints(limit), joints(1.5 * limit)) < 1e-12);
        assert!(apart(joints(limit), joints(0.9 * limit)) > 1e-3);
    }
}
