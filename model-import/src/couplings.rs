//! Which movable joints follow others.

use rbd_core::reduction::{Coupling, Reduction, ReductionError};
use so3::Scalar;

use crate::error::Warning;
use crate::robot::{JointInfo, Robot};
use crate::urdf::{JointType, Urdf};

/// A movable joint that follows an independent one: position = `ratio` × leader + `offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointCoupling {
    /// Index of the joint that is followed in the end, itself independent.
    pub leader: usize,
    /// Rate per rate of the leader.
    pub ratio: f64,
    /// Position where the leader is at zero, rad or m.
    pub offset: f64,
}

/// The coupling of each movable joint, chains of followers resolved; `None` for an independent joint.
pub(crate) fn couplings(
    urdf: &Urdf,
    joints: &[JointInfo],
    warnings: &mut Vec<Warning>,
) -> Vec<Option<JointCoupling>> {
    let mut out = vec![None; joints.len()];
    for (slot, joint) in out.iter_mut().zip(joints) {
        let mut at = joint.name.as_str();
        let (mut ratio, mut offset) = (1.0, 0.0);
        let mut first = None;
        // One step per joint of the file suffices, or the followers form a ring.
        for _ in 0..=urdf.joints.len() {
            let found = urdf.joints.iter().find(|j| j.name == at);
            let Some(mimic) = found.and_then(|j| j.mimic.as_ref()) else {
                break;
            };
            offset += ratio * mimic.offset;
            ratio *= mimic.multiplier;
            at = mimic.leader.as_str();
            first.get_or_insert(at);
        }
        let Some(leader) = first else { continue };
        let (joint, leader) = (joint.name.clone(), leader.to_owned());
        match whose(urdf, joints, at) {
            Ok(independent) => {
                *slot = Some(JointCoupling {
                    leader: independent,
                    ratio,
                    offset,
                });
                warnings.push(Warning::MimicFreed { joint, leader });
            }
            Err(why) => warnings.push(Warning::MimicLost { joint, leader, why }),
        }
    }
    out
}

/// Index of the independent joint `name`, or why there is none.
fn whose(urdf: &Urdf, joints: &[JointInfo], name: &str) -> Result<usize, &'static str> {
    let Some(joint) = urdf.joints.iter().find(|j| j.name == name) else {
        return Err("is not in the file");
    };
    if joint.mimic.is_some() {
        return Err("follows it in a ring");
    }
    let movable = joints.iter().position(|j| j.name == name);
    movable.ok_or(if joint.kind == JointType::Fixed {
        "is a fixed joint"
    } else {
        "is locked"
    })
}

impl Robot {
    /// Indices of the joints that follow no other, in order: the coordinates of [`Robot::reduction`].
    #[must_use]
    pub fn independent(&self) -> Vec<usize> {
        let free = |i: &usize| self.couplings[*i].is_none();
        (0..self.joints.len()).filter(free).collect()
    }

    /// q = G q_r + g: the joints as functions of the independent ones, for a run-time model of the same capacity `CAP`. `R` may
    /// exceed their number: coordinates beyond it move nothing.
    ///
    /// # Errors
    /// [`ReductionError::NoSuchCoordinate`] if `R` or `CAP` is too small.
    pub fn reduction<T: Scalar, const CAP: usize, const R: usize>(
        &self,
    ) -> Result<Reduction<T, CAP, R>, ReductionError> {
        let independent = self.independent();
        let mut rows = [Coupling::STILL; CAP];
        for (joint, coupling) in self.couplings.iter().enumerate() {
            let (leader, ratio, offset) = match coupling {
                None => (joint, 1.0, 0.0),
                Some(c) => (c.leader, c.ratio, c.offset),
            };
            match (independent.binary_search(&leader), rows.get_mut(joint)) {
                (Ok(coordinate), Some(row)) if coordinate < R => {
                    *row = Coupling {
                        coordinate,
                        ratio: T::of(ratio),
                        offset: T::of(offset),
                    };
                }
                _ => return Err(ReductionError::NoSuchCoordinate { joint }),
            }
        }
        Ok(Reduction { rows })
    }
}
