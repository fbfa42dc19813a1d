//! Which joints stand still, and where.

use crate::error::{ImportError, Warning};
use crate::options::{MimicPolicy, Options};
use crate::urdf::{JointType, Urdf, UrdfJoint};

/// Where each joint of the file is locked, if it is.
pub(crate) fn locked_positions(
    urdf: &Urdf,
    options: &Options,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<Option<f64>>, ImportError> {
    let mut at = vec![None; urdf.joints.len()];
    for (name, value) in &options.locks {
        let movable = |j: &UrdfJoint| j.kind != JointType::Fixed;
        let Some(i) = (urdf.joints.iter()).position(|j| j.name == *name && movable(j)) else {
            let known: Vec<&str> = (urdf.joints.iter().filter(|j| movable(j)))
                .map(|j| j.name.as_str())
                .collect();
            return Err(ImportError::UnknownLock {
                joint: name.clone(),
                known: known.join(", "),
            });
        };
        if !value.is_finite() {
            let text = format!("{name}={value}");
            return Err(ImportError::BadLock { text });
        }
        if at[i].replace(*value).is_some() {
            let joint = name.clone();
            return Err(ImportError::LockedTwice { joint });
        }
        let limits = urdf.joints[i].limits;
        if *value < limits.lower || *value > limits.upper {
            warnings.push(Warning::LockOutsideRange {
                joint: name.clone(),
                value: *value,
                lower: limits.lower,
                upper: limits.upper,
            });
        }
    }
    followers(urdf, options.mimic, &mut at, warnings)?;
    Ok(at)
}

/// Applies the policy for mimic joints that are not locked by name.
fn followers(
    urdf: &Urdf,
    policy: MimicPolicy,
    at: &mut [Option<f64>],
    warnings: &mut Vec<Warning>,
) -> Result<(), ImportError> {
    for (i, joint) in urdf.joints.iter().enumerate() {
        let Some(mimic) = &joint.mimic else { continue };
        if at[i].is_some() || joint.kind == JointType::Fixed {
            continue;
        }
        let (name, above) = (joint.name.clone(), mimic.leader.clone());
        match policy {
            MimicPolicy::Refuse => {
                return Err(ImportError::Mimic {
                    element: joint.element.clone(),
                    joint: name,
                    leader: above,
                });
            }
            // Said by `couplings`, which knows whether the leader moves.
            MimicPolicy::Free => {}
            MimicPolicy::Lock => {
                let leader = urdf.joints.iter().position(|j| j.name == mimic.leader);
                let leader = leader.ok_or_else(|| ImportError::UnknownLeader {
                    element: joint.element.clone(),
                    leader: above.clone(),
                })?;
                let value = mimic.multiplier * at[leader].unwrap_or(0.0) + mimic.offset;
                at[i] = Some(value);
                warnings.push(Warning::MimicLocked {
                    joint: name,
                    leader: above,
                    value,
                });
            }
        }
    }
    Ok(())
}
