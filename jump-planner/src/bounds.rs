//! What no plan can do: closed-form bounds, before anything is solved.
//!
//! Each is a necessary condition of problem (2) of paper A as it is posed here, so a task that breaks one has no plan, whatever a solver
//! does. Notation: centre of mass p, weight m g, durations T, friction μ, largest normal force F per foot, n feet on the ground. Between
//! nodes forces are constant, so the planned centre of mass is a true motion under forces that keep their bounds, and the laws below
//! hold for it exactly.
//!
//! | bound | proof |
//! |---|---|
//! | *durations* | T_i ≥ T_i,min, so Σ T ≥ Σ T_min; likewise from above |
//! | *falling* | without contact p̈ = −g ẑ from rest: no sideways motion, no turn, p_z falls by g T²/2 |
//! | *sideways* | every axis of a friction pyramid gives at most μ n F, so \|p̈\| ≤ a = μ n F/m while feet stand, for at most T_s; farthest is a at first and coasting then, a T_s (T − T_s/2) |
//! | *run-up* | see `run_up` |
//! | *free fall* | see `free_fall` |
//! | *force* | as free fall, upwards with p̈_z ≤ n F/m − g |
//! | *hanging* | after that, p_z ends at most as in free flight for the shortest time there is |
//! | *impulse* | p̈_z ≤ a = n F/m − g while feet stand and −g after, from rest, so p_z rises by at most a T_s²/2 + a T_s T_f − g T_f²/2 in a stance of T_s and a flight of T_f |
//! | *power* | the joints' work is at most the sum of their largest torque × speed times T_s; losses only take from it; it must lift m g Δz |
//! | *start* | at the start the velocities vanish: the rotation stays over the first interval and p moves by at most (max(μ, 1) n F/m + g) dt²/2 along an axis |
//! | *reach* | neither then can a foot that the second node's stance needs come into its leg's box |
//! | *goal* | position and rotation at the end are given: the trunk there must be over the ground |
//! | *feet* | a foot that stands is on the ground |
//! | *landing* | position, rotation and joints at the end are given, within tolerances: the feet there are beyond the edge of a box |

mod facts;
mod motion;
mod places;

use self::facts::Facts;
use super::FOOT_COUNT;
use super::task::Task;
use rbd_core::Model;
use srb_opt::Problem;

/// A problem on the rigid body.
type Body<const P: usize> = Problem<f64, FOOT_COUNT, P>;

/// A proof that a task has no plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Impossible {
    /// Name of the bound.
    pub bound: &'static str,
    /// What blocks.
    pub because: String,
    /// The smallest change that would satisfy the bound.
    pub relaxation: String,
}

impl core::fmt::Display for Impossible {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{} ({} bound)", self.because, self.bound)
    }
}

/// Distance that does not count, m.
const SLACK: f64 = 1e-6;

/// The first bound that the task breaks.
#[must_use]
pub fn impossible(task: &Task) -> Option<Impossible> {
    let places = core::array::from_fn(|foot| task.robot.place(foot));
    rigid_body(&task.problem, places, task.limits.friction_share)
        .or_else(|| places::landing(task))
        .or_else(|| power(task))
}

/// The first bound that a problem on the rigid body breaks, whose feet have these names, and whose friction is this share of the ground's.
#[must_use]
pub fn rigid_body<const P: usize>(
    problem: &Body<P>,
    places: [&'static str; FOOT_COUNT],
    friction_share: f64,
) -> Option<Impossible> {
    let facts = Facts {
        friction_share,
        ..Facts::of(problem, places)
    };
    let bounds: [fn(&Body<P>, &Facts) -> Option<Impossible>; 12] = [
        motion::durations,
        motion::falling,
        places::feet,
        places::start,
        places::reach,
        places::goal,
        motion::sideways,
        motion::run_up,
        motion::free_fall,
        motion::impulse,
        motion::force,
        motion::hanging,
    ];
    bounds.iter().find_map(|bound| bound(problem, &facts))
}

/// What lifts the robot: power over the time of the stance.
fn power(task: &Task) -> Option<Impossible> {
    let problem = &task.problem;
    let facts = Facts::of(problem, [""; FOOT_COUNT]);
    if facts.hops {
        return None;
    }
    let g = problem.gravity;
    let torque_share = task.limits.torque_shares.into_iter().fold(0.0, f64::max);
    let power: f64 = (0..super::JOINTS)
        .map(|i| joint_power(task, i, torque_share))
        .sum();
    let gained = power * facts.stance;
    let needed = problem.mass
        * g
        * (problem.goal_w.z - problem.start_w.z - super::whole_body::GOAL_TOLERANCE[2]);
    (needed > gained).then(|| {
        let lower = (needed - gained) / (problem.mass * g);
        Impossible {
            bound: "power",
            because: format!(
                "torque times speed of all joints gives at most {gained:.1} J in {:.3} s of stance, lifting takes {needed:.1} J",
                facts.stance
            ),
            relaxation: format!("the goal would have to be at least {lower:.3} m lower"),
        }
    })
}

/// Largest mechanical power of a joint within what the plan may use, W.
fn joint_power(task: &Task, i: usize, torque_share: f64) -> f64 {
    let limit = &Model::limits(&task.robot)[i];
    let torque = torque_share * limit.effort;
    let Some(motors) = Model::motors(&task.robot) else {
        return torque * limit.speed;
    };
    let motor = &motors[i];
    let (corner, top) = (
        motor.corner_speed * task.limits.speed_share,
        motor.no_load_speed * task.limits.speed_share,
    );
    // On the falling part τ ω = c (ω₀ − ω) ω is largest at half the no-load speed.
    let slope = motor.torque / (top - corner);
    let at = f64::max(0.5 * top, top - torque / slope);
    (slope * (top - at) * at).max(torque.min(motor.torque) * (top - torque / slope).max(0.0))
}
