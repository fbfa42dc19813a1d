//! What the force on a foot may be: inside the friction pyramid, below the largest normal force, and within the torques of its leg.
//!
//! Every limit is a row nᵀf ≤ d with d ≥ 0, so zero force keeps them all. Rows of a foot are numbered: ±f_x − μ f_z ≤ 0,
//! ±f_y − μ f_z ≤ 0, f_z ≤ f_max, −f_z ≤ 0, then two per joint of the robot, of which only those of the foot's own leg are its rows.
//! That feet do not pull follows from the first four unless μ = 0, and is a row of its own only then.

use nalgebra::Vector3;
use rbd_core::Limbs;
use so3::{Scalar, math};

use crate::face::Face;

/// The row −f_z ≤ 0.
const PULL: usize = 5;

/// Rows before those of the joints.
const TORQUES: usize = 6;

/// A row nᵀf ≤ d.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<T: Scalar> {
    pub(crate) normal: Vector3<T>,
    pub(crate) most: T,
}

/// The torque τ = nᵀf + τ_0 of one joint: −(its column of the foot's Jacobian) and room for it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Torque<T: Scalar> {
    pub(crate) normal: Vector3<T>,
    pub(crate) least: T,
    pub(crate) most: T,
    /// 1/max |n|: what makes a violation a force.
    per_force: T,
}

/// The limits of all feet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits<T: Scalar, const N: usize, const F: usize> {
    pub(crate) friction: T,
    /// Largest normal force.
    pub(crate) top: T,
    /// Only those of legs on the ground are up to date.
    pub(crate) torques: [Torque<T>; N],
    /// First joint of each foot's leg, and the one after its last.
    pub(crate) legs: [[usize; 2]; F],
}

/// The most violated row of a foot, and by how much, N (negative where all rows hold).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Violation<T> {
    pub(crate) row: usize,
    pub(crate) force: T,
}

impl<T: Scalar, const N: usize, const F: usize> Limits<T, N, F> {
    pub(crate) const NONE: Self = Self {
        friction: T::ZERO,
        top: T::ZERO,
        torques: [Torque {
            normal: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
            least: T::ZERO,
            most: T::ZERO,
            per_force: T::ZERO,
        }; N],
        legs: [[0; 2]; F],
    };

    /// Writes the limits of a tick; `other` are the torques that joints carry beside −Jᵀf.
    pub(crate) fn write(
        &mut self,
        (friction, top): (T, T),
        limbs: &Limbs<T, N, F>,
        contacts: &[bool; F],
        (other, max_torques): (&[T; N], &[T; N]),
    ) {
        (self.friction, self.top) = (friction, top);
        let rot_wb = limbs.posture.base().rotation.matrix();
        let ends = limbs.ends.iter().zip(contacts);
        for (leg, (end, on)) in self.legs.iter_mut().zip(ends) {
            *leg = [0; 2];
            if !*on {
                continue;
            }
            for (j, column) in end.columns() {
                *leg = if leg[1] == 0 {
                    [j, j + 1]
                } else {
                    [leg[0], j + 1]
                };
                let most = other.get(j).zip(max_torques.get(j));
                let (Some(torque), Some((other, most))) = (self.torques.get_mut(j), most) else {
                    continue;
                };
                let normal = rot_wb * -column;
                let size = normal.amax();
                *torque = Torque {
                    normal,
                    // Where the other torques alone use up the joint, zero force must remain possible.
                    least: math::min(-*most - *other, T::ZERO),
                    most: math::max(*most - *other, T::ZERO),
                    per_force: if size > T::ZERO {
                        T::ONE / size
                    } else {
                        T::ZERO
                    },
                };
            }
        }
    }

    /// The torques of a foot's leg with the joints' numbers.
    #[inline(always)]
    fn leg(&self, foot: usize) -> impl Iterator<Item = (usize, &Torque<T>)> {
        let [first, last] = self.legs.get(foot).copied().unwrap_or_default();
        let torques = self.torques.get(first..last).unwrap_or(&[]);
        torques.iter().enumerate().map(move |(i, t)| (first + i, t))
    }

    /// Row number `row`; a row that is none holds everywhere.
    pub(crate) fn row(&self, row: usize) -> Row<T> {
        let (one, zero, mu) = (T::ONE, T::ZERO, -self.friction);
        let (normal, most) = match row {
            0 => (Vector3::new(one, zero, mu), zero),
            1 => (Vector3::new(-one, zero, mu), zero),
            2 => (Vector3::new(zero, one, mu), zero),
            3 => (Vector3::new(zero, -one, mu), zero),
            4 => (Vector3::new(zero, zero, one), self.top),
            PULL => (Vector3::new(zero, zero, -one), zero),
            _ => match self.torques.get((row - TORQUES) / 2) {
                Some(torque) if row % 2 == TORQUES % 2 => (torque.normal, torque.most),
                Some(torque) => (-torque.normal, -torque.least),
                None => (Vector3::zeros(), T::INFINITY),
            },
        };
        Row { normal, most }
    }

    /// The row that `force` violates most.
    #[inline]
    pub(crate) fn most_violated(&self, foot: usize, force: &Vector3<T>) -> Violation<T> {
        let side = self.friction * force.z;
        let mut worst = Violation {
            row: 4,
            force: force.z - self.top,
        };
        if self.friction == T::ZERO && -force.z > worst.force {
            worst = Violation {
                row: PULL,
                force: -force.z,
            };
        }
        for (row, along) in [(0, force.x), (2, force.y)] {
            let excess = math::abs(along) - side;
            if excess > worst.force {
                let row = if along < T::ZERO { row + 1 } else { row };
                worst = Violation { row, force: excess };
            }
        }
        for (j, torque) in self.leg(foot) {
            let value = torque.normal.dot(force);
            let (above, below) = (value - torque.most, torque.least - value);
            let (excess, row) = if above > below {
                (above, TORQUES + 2 * j)
            } else {
                (below, TORQUES + 2 * j + 1)
            };
            let force = excess * torque.per_force;
            if force > worst.force {
                worst = Violation { row, force };
            }
        }
        worst
    }

    /// Brings a force inside: first under the largest normal force and into the pyramid, then shorter until the joints can give it.
    /// Zero force keeps every row, so some length does. Torques that are round-off of the force's count as none: where a joint has no
    /// room left, they would take the whole force with them.
    pub(crate) fn shorten(&self, foot: usize, force: &mut Vector3<T>) {
        force.z = math::clamp(force.z, T::ZERO, self.top);
        let side = self.friction * force.z;
        force.x = math::clamp(force.x, -side, side);
        force.y = math::clamp(force.y, -side, side);
        for (_, torque) in self.leg(foot) {
            let value = torque.normal.dot(force);
            if math::abs(value) * torque.per_force <= force.amax() * T::of(4096.0) * T::EPSILON {
                continue;
            }
            if value > torque.most {
                *force *= torque.most / value;
            } else if value < torque.least {
                *force *= torque.least / value;
            }
        }
    }

    /// The face with its rows as they are now; a row that has come to depend on the others is left out.
    pub(crate) fn rebuild(&self, face: &mut Face<T>) {
        self.remove(face, usize::MAX);
    }

    /// The face without its row `k`.
    pub(crate) fn remove(&self, face: &mut Face<T>, k: usize) {
        let old = *face;
        *face = Face::FREE;
        for (row, multiplier) in old.without(k) {
            let Row { normal, most } = self.row(row);
            let split = face.split(&normal);
            if split.is_independent(&normal) {
                face.push(row, most, &split, multiplier);
            }
        }
    }
}
