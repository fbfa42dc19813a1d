//! The pre-landing posture: feet where the body can come to rest over them.
//!
//! A body that moves with v along the ground comes to rest over its capture point, v √(h/g) from where it touches down. Forces of the feet
//! can stop it there as long as that is between them, and a tilt moves the feet from below the centre of mass. Where the capture point lies
//! outside the box of the feet the body would topple over those in front, so all feet are moved after it until it is on the edge. Not farther,
//! and not at all where it is inside: what swings legs one way turns the body the other, by half of the angle on A1, and a body that is turned
//! comes down on one side.
//!
//! Source of the capture point: Pratt et al., *Capture Point: A Step toward Humanoid Push Recovery*, 2006.

use nalgebra::Vector3;
use rbd_core::{Build, Configuration, Frame, Limbs, Tree};
use so3::{Scalar, math};

use crate::least_squares::solve_damped;

/// Gauss-Newton steps from the level posture that find a moved one to a fraction of a millimetre.
const STEPS: usize = 3;

/// How legs wait for the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreLanding<T, const N: usize, const F: usize> {
    /// The feet; each is the end of a leg of its own.
    pub feet: [Frame<T>; F],
    /// Joint positions for a level landing, rad.
    pub joints: [T; N],
    /// Time to the capture point, √(h/g), s.
    pub capture: T,
    /// Farthest that the feet are moved, m.
    pub most: T,
    /// Farthest that a joint goes from its level position, rad.
    pub reach: T,
    /// Tikhonov term on the way of a foot, m²: keeps a stretched leg from jumping about.
    pub damping: T,
}

impl<T: Scalar, const N: usize, const F: usize> PreLanding<T, N, F> {
    /// Joints within 0.8 rad; and, on legs of 0.4 m, 0.15 s to the capture point, which is that of a body at 0.22 m, as far down as a landing
    /// presses it, and up to 12 cm of way, scaled by [dynamic similarity](rbd_core::similarity).
    #[must_use]
    pub fn new(build: &Build<T>, feet: [Frame<T>; F], joints: [T; N]) -> Self {
        Self {
            feet,
            joints,
            capture: build.time(0.15),
            most: build.length(0.12),
            reach: T::of(0.8),
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

    /// The feet of the level posture, base axes: what [`PreLanding::follow`] moves.
    #[must_use]
    pub fn level_feet<M: Tree<T, N>>(&self, model: &M) -> [Vector3<T>; F] {
        self.limbs(model, &self.joints)
            .ends
            .each_ref()
            .map(|end| end.position)
    }

    /// [`PreLanding::joints`] for every tick of a controller: one Gauss-Newton step from the `last` answer, whose legs `limbs` are, so that a
    /// tick costs a third and the answer is exact after two or three. Begin with the level posture. Every foot is raised along `up_b` by its
    /// number in `raised`, m: zeros for the posture itself.
    #[must_use]
    pub fn follow(
        &self,
        level_feet: &[Vector3<T>; F],
        (up_b, velocity_b): (&Vector3<T>, &Vector3<T>),
        raised: &[T; F],
        (last, limbs): (&[T; N], &Limbs<T, N, F>),
    ) -> [T; N] {
        let Some(mut wanted) = self.feet(level_feet, up_b, velocity_b) else {
            return self.joints;
        };
        for (foot, raised) in wanted.iter_mut().zip(raised) {
            *foot += up_b * *raised;
        }
        self.step(limbs, &wanted, last)
    }

    fn limbs<M: Tree<T, N>>(&self, model: &M, joints: &[T; N]) -> Limbs<T, N, F> {
        let q = Configuration {
            joints: *joints,
            ..Configuration::NEUTRAL
        };
        Limbs::new(model, &q, &self.feet)
    }

    /// Where the feet are to be, base axes, under a body whose up direction is `up_b` and which moves with `velocity_b`; `None` where a
    /// number is not finite.
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
        let corner = |pick: fn(T, T) -> T| {
            let feet = level.iter().copied();
            feet.reduce(|a, b| a.zip_map(&b, pick)).unwrap_or_default()
        };
        let (most, least) = (corner(math::max), corner(math::min));
        let half = (most - least) * T::HALF;
        let along = |x: Vector3<T>| x - up_b * x.dot(up_b);
        // In the level posture the feet's middle is below the centre of mass.
        let below = Vector3::z() * ((most.z + least.z) * T::HALF);
        let capture = along(velocity_b * self.capture - below);
        let mut outside = capture.zip_map(&half, |x, half| x - math::clamp(x, -half, half));
        outside.z = T::ZERO;
        let mut way = along(outside);
        let size = math::sqrt(way.norm_squared());
        if size > self.most {
            way *= self.most / size;
        }
        Some(level.each_ref().map(|foot| foot + way))
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
    use rbd_core::{Configuration, Kinematics, Posture, forward_kinematics};

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
    fn feet_follow_a_capture_point_to_the_edge_of_their_box() {
        let posture = PreLanding::new(&BUILD, FEET.map(|foot| foot.frame), LEVEL);
        let level = feet_b(LEVEL);
        let ways = |up_b: &Vector3<f64>, velocity: Vector3<f64>| {
            let feet = feet_b(posture.joints(&A1Geared, up_b, &velocity));
            core::array::from_fn::<_, 4, _>(|i| feet[i] - level[i])
        };
        let half = 0.5 * (level[0] - level[3]).abs();
        let fast = Vector3::new(half.x + 0.03, -half.y - 0.02, 0.0) / posture.capture;
        for way in ways(&Vector3::z(), fast - Vector3::z()) {
            let expected = Vector3::new(0.03, -0.02, 0.0);
            assert!((way - expected).norm() < 2e-3, "{way}");
        }
        // As far as a foot may go.
        for way in ways(&Vector3::z(), Vector3::x() * 9.0) {
            assert!(way.x > 0.05 && way.x < posture.most + 2e-3, "{way}");
        }
        // A tilt of 0.2 rad moves the feet by 6 cm, which alone is inside their box; both together are not.
        let up_b = Vector3::new(0.0, so3::math::sin(-0.2), so3::math::cos(0.2));
        assert_eq!(ways(&up_b, Vector3::zeros()), [Vector3::zeros(); 4]);
        let aside = half.y / posture.capture;
        for way in ways(&up_b, Vector3::y() * aside) {
            assert!((0.04..0.07).contains(&way.y), "{way}");
        }
    }

    #[test]
    fn following_finds_what_starting_anew_finds() {
        let posture = PreLanding::new(&BUILD, FEET.map(|foot| foot.frame), LEVEL);
        let level = posture.level_feet(&A1Geared);
        let up_b = Vector3::new(0.1, 0.2, 0.97);
        let velocity = Vector3::new(1.6, -0.1, -1.0);
        let mut joints = LEVEL;
        let follow = |velocity: Vector3<f64>, last: [f64; 12]| {
            let limbs = posture.limbs(&A1Geared, &last);
            posture.follow(&level, (&up_b, &velocity), &[0.0; 4], (&last, &limbs))
        };
        for _ in 0..super::STEPS {
            joints = follow(velocity, joints);
        }
        assert_eq!(joints, posture.joints(&A1Geared, &up_b, &velocity));
        assert_eq!(follow(velocity * f64::NAN, joints), LEVEL);
        let lost = follow(velocity, [f64::NAN; 12]);
        assert!(
            lost.iter()
                .zip(LEVEL)
                .all(|(q, l)| (q - l).abs() <= posture.reach)
        );
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
        assert!(far.fold(0.0, f64::max) <= posture.reach);
    }

    #[test]
    fn feet_are_raised_along_the_vertical_each_by_its_own() {
        let posture = PreLanding::new(&BUILD, FEET.map(|foot| foot.frame), LEVEL);
        let level = posture.level_feet(&A1Geared);
        let up_b = Vector3::new(0.1, 0.0, 0.995);
        let raised = [0.0, 0.03, 0.05, 0.01];
        let mut joints = LEVEL;
        for _ in 0..5 {
            let limbs = posture.limbs(&A1Geared, &joints);
            let body = (&up_b, &Vector3::zeros());
            joints = posture.follow(&level, body, &raised, (&joints, &limbs));
        }
        for ((foot, level), raised) in feet_b(joints).into_iter().zip(level).zip(raised) {
            let way = foot - level;
            assert!((way - up_b * raised).norm() < 1e-3, "{way}");
        }
    }

    /// However fast, feet are moved by no more than the farthest way.
    #[test]
    fn the_way_of_the_feet_has_a_limit() {
        let posture = PreLanding::new(&BUILD, FEET.map(|foot| foot.frame), LEVEL);
        let joints = |speed: f64| posture.joints(&A1Geared, &Vector3::z(), &(Vector3::x() * speed));
        let level = feet_b(LEVEL);
        let limit = (posture.most + 0.5 * (level[0] - level[3]).x.abs()) / posture.capture;
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
