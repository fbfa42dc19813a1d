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
//! | *free fall* | see `free_fall` |
//! | *force* | as free fall, upwards with p̈_z ≤ n F/m − g |
//! | *impulse* | p̈_z ≤ a = n F/m − g while feet stand and −g after, from rest, so p_z rises by at most a T_s²/2 + a T_s T_f − g T_f²/2 in a stance of T_s and a flight of T_f |
//! | *power* | the joints' work is at most the sum of their largest torque × speed times T_s; losses only take from it; it must lift m g Δz |
//! | *start* | at the start the velocities vanish: the rotation stays over the first interval and p moves by at most (n F/m + g) dt²/2 |
//! | *goal* | position and rotation at the end are given: the trunk there must be over the ground |
//! | *feet* | a foot that stands is on the ground |

use super::FOOT_COUNT;
use super::task::Task;
use nalgebra::Vector3;
use rbd_core::Model;

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

/// Distance that does not count, m.
const SLACK: f64 = 1e-6;

/// The first bound that the task breaks.
#[must_use]
pub fn impossible(task: &Task) -> Option<Impossible> {
    let facts = Facts::of(task);
    let bounds: [fn(&Task, &Facts) -> Option<Impossible>; 9] = [
        durations, falling, feet, start, goal, sideways, free_fall, impulse, lifting,
    ];
    bounds.iter().find_map(|bound| bound(task, &facts))
}

/// Numbers that several bounds need.
struct Facts {
    /// Longest plan, s.
    total: f64,
    /// Longest time with feet on the ground, s.
    stance: f64,
    /// Longest flight at the end, s.
    flight: f64,
    /// Longest interval with feet on the ground, s.
    interval: f64,
    /// Most feet on the ground.
    feet: f64,
    /// Highest and lowest centre of mass over standing feet, m.
    heights: [f64; 2],
    /// Whether feet stand again after a flight: the last rest may then be in the air.
    hops: bool,
}

impl Facts {
    fn of(task: &Task) -> Self {
        let problem = &task.problem;
        let used = problem.used_phases();
        let stands = |contacts: &[bool; FOOT_COUNT]| contacts.contains(&true);
        let all: f64 = used.iter().map(|phase| phase.max_duration).sum();
        let standing = used.iter().filter(|phase| stands(&phase.contacts));
        let air: f64 = (used.iter().filter(|phase| !stands(&phase.contacts)))
            .map(|phase| phase.min_duration)
            .sum();
        let total = all.min(problem.max_total);
        let stance: f64 = standing.clone().map(|phase| phase.max_duration).sum();
        let last = used
            .iter()
            .rev()
            .take_while(|phase| !stands(&phase.contacts));
        let intervals = standing
            .clone()
            .map(|phase| phase.max_duration / phase.intervals as f64);
        let flags = used.iter().map(|phase| stands(&phase.contacts));
        let hops = flags.skip_while(|on| *on).any(|on| on);
        let heights = standing.clone().map(|phase| height(task, &phase.contacts));
        let high = heights.fold(0.0, f64::max);
        // Over level ground, or jumping up, the trunk stays above the ground, and its centre of mass is inside it.
        let corners = &problem.corners;
        let inside = (0..3)
            .all(|i| corners.iter().any(|c| c[i] > 0.0) && corners.iter().any(|c| c[i] < 0.0));
        let level = problem.edge.is_none_or(|edge| edge.drop <= 0.0);
        let low = if inside && level {
            problem.clearance.max(-high)
        } else {
            -high
        };
        Self {
            total,
            stance: stance.min(total - air).max(0.0),
            flight: last.map(|phase| phase.max_duration).sum(),
            interval: intervals.fold(0.0, f64::max),
            feet: standing
                .map(|phase| phase.contacts.iter().filter(|on| **on).count() as f64)
                .fold(0.0, f64::max),
            heights: [high, low],
            hops,
        }
    }
}

/// Largest height of the centre of mass while these feet stand: it is within the longest leg of each, wherever the body is turned, so
/// over the middle of the two that are farthest apart.
fn height(task: &Task, contacts: &[bool; FOOT_COUNT]) -> f64 {
    let problem = &task.problem;
    let standing = || {
        problem
            .feet
            .iter()
            .zip(contacts)
            .filter(|(_, on)| **on)
            .map(|(foot, _)| foot)
    };
    let longest = standing().map(|foot| {
        let corner = |bits: usize| {
            Vector3::from_fn(|i, _| {
                let bound = if (bits >> i) & 1 == 0 {
                    problem.reach_lower[i]
                } else {
                    problem.reach_upper[i]
                };
                foot.nominal_b[i] + bound
            })
        };
        (0..8).map(|bits| corner(bits).norm()).fold(0.0, f64::max)
    });
    let longest = longest.fold(0.0, f64::max);
    let apart = standing()
        .flat_map(|a| standing().map(move |b| (a.pos_wf - b.pos_wf).norm()))
        .fold(0.0, f64::max);
    so3::math::sqrt((longest * longest - 0.25 * apart * apart).max(0.0))
}

fn durations(task: &Task, _: &Facts) -> Option<Impossible> {
    let problem = &task.problem;
    let phases = problem.used_phases().iter();
    let shortest: f64 = phases.clone().map(|phase| phase.min_duration).sum();
    let longest: f64 = phases.map(|phase| phase.max_duration).sum();
    let told = |because: String, relaxation: String| Impossible {
        bound: "durations",
        because,
        relaxation,
    };
    if shortest > problem.max_total {
        return Some(told(
            format!(
                "the phases take at least {shortest:.3} s together, the whole may take {:.3} s",
                problem.max_total
            ),
            format!("total.max_s would have to be at least {shortest:.3}"),
        ));
    }
    (longest < problem.min_total).then(|| {
        told(
            format!(
                "the phases take at most {longest:.3} s together, the whole must take {:.3} s",
                problem.min_total
            ),
            format!("total.min_s would have to be at most {longest:.3}"),
        )
    })
}

fn falling(task: &Task, facts: &Facts) -> Option<Impossible> {
    if facts.feet > 0.0 {
        return None;
    }
    let problem = &task.problem;
    let way = problem.goal_w - problem.start_w;
    let sideways = so3::math::hypot(way.x, way.y) > SLACK;
    let (sin, cos) = so3::math::sin_cos(problem.angle);
    let turned = sin.abs() > SLACK || cos < 0.0;
    let deep = 0.5 * problem.gravity * facts.total * facts.total;
    (sideways || turned || way.z > SLACK || -way.z > deep + SLACK).then(|| Impossible {
        bound: "falling",
        because: "no foot ever touches the ground, so the robot only falls".to_owned(),
        relaxation: "a phase with feet on the ground would have to come first".to_owned(),
    })
}

fn feet(task: &Task, _: &Facts) -> Option<Impossible> {
    let problem = &task.problem;
    let edge = problem.edge.filter(|edge| edge.drop != 0.0)?;
    let stands = |i: usize| problem.used_phases().iter().any(|phase| phase.contacts[i]);
    let beyond = (0..FOOT_COUNT).filter(|i| stands(*i)).map(|i| {
        let across = edge.sign * problem.feet[i].pos_wf[edge.axis] - edge.distance;
        (across, i)
    });
    let (most, foot) = beyond.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (most > 0.0).then(|| Impossible {
        bound: "feet",
        because: format!(
            "foot {} stands {most:.3} m beyond the edge of the box, {}",
            task.robot.place(foot),
            if edge.drop > 0.0 {
                "in the air"
            } else {
                "inside it"
            }
        ),
        relaxation: format!("the edge would have to be at least {most:.3} m farther"),
    })
}

/// How far the trunk is below what it must keep over the ground, in one pose.
fn trunk_below(task: &Task, pos_w: &Vector3<f64>, rot_wb: &nalgebra::Matrix3<f64>) -> f64 {
    let problem = &task.problem;
    let below = problem.corners.iter().map(|corner| {
        let point = pos_w + rot_wb * corner;
        let ground = problem.edge.map_or(0.0, |edge| edge.ground(&point).height);
        ground + problem.clearance - point.z
    });
    below.fold(f64::NEG_INFINITY, f64::max)
}

fn start(task: &Task, facts: &Facts) -> Option<Impossible> {
    let problem = &task.problem;
    let first = problem.used_phases().first()?;
    let dt = first.max_duration / first.intervals as f64;
    let moved = 0.5 * (facts.feet * problem.max_force / problem.mass + problem.gravity) * dt * dt;
    // Sideways motion of a corner near a smoothed edge changes the ground under it by slope times way.
    let slope = problem
        .edge
        .map_or(0.0, |edge| 0.5 * edge.drop.abs() / edge.width);
    let below = trunk_below(task, &problem.start_w, &nalgebra::Matrix3::identity());
    (below > moved * (1.0 + slope * problem.friction.max(1.0)) + SLACK).then(|| Impossible {
        bound: "start",
        because: format!(
            "at the start the trunk is {below:.3} m lower than the ground and the clearance allow"
        ),
        relaxation: match problem.edge {
            Some(_) => {
                format!("the box would have to be at least {below:.3} m lower, or its edge farther")
            }
            None => format!("limits.clearance_m would have to be at least {below:.3} less"),
        },
    })
}

fn goal(task: &Task, _: &Facts) -> Option<Impossible> {
    let problem = &task.problem;
    let turn = so3::rotation_about(&nalgebra::Unit::new_unchecked(problem.axis), problem.angle);
    let below = trunk_below(task, &problem.goal_w, turn.matrix());
    (below > SLACK).then(|| Impossible {
        bound: "goal",
        because: format!(
            "at the goal the trunk is {below:.3} m lower than the ground and the clearance allow"
        ),
        relaxation: format!(
            "the goal would have to be at least {below:.3} m higher, or the box that much lower"
        ),
    })
}

fn sideways(task: &Task, facts: &Facts) -> Option<Impossible> {
    let problem = &task.problem;
    let way = problem.goal_w - problem.start_w;
    let far = f64::max(way.x.abs(), way.y.abs());
    let push = facts.feet * problem.max_force / problem.mass;
    let coasting = facts.stance * (facts.total - 0.5 * facts.stance);
    let reached = problem.friction * push * coasting;
    (far > reached + SLACK).then(|| Impossible {
        bound: "sideways",
        because: format!(
            "with friction {:.3} the ground pushes the robot at most {reached:.3} m sideways in {:.3} s, the goal is {far:.3} m away",
            problem.friction, facts.total
        ),
        relaxation: format!("friction would have to be at least {:.3}", far / (push * coasting)),
    })
}

/// A flight that ends low takes time.
///
/// While feet stand, p_z is between h₋ and h₊ ([`Facts::heights`]). The ground only pushes, so p̈_z ≥ −g. From the last moment at which
/// p_z rested (at the start it rests) to the take-off at height z it falls all the time, so ṗ_z² ≤ 2 g (h₊ − z), and after a flight of T
/// the height is at least z − T √(2 g (h₊ − z)) − g T²/2 = h₊ − (√(h₊ − z) + T √(g/2))² ≥ h₊ − (√(h₊ − h₋) + T √(g/2))². The
/// heights hold at nodes: T counts the last interval of the stance too, and a moment of rest between nodes is at most g dt²/8 higher.
fn free_fall(task: &Task, facts: &Facts) -> Option<Impossible> {
    let problem = &task.problem;
    if facts.feet == 0.0 || facts.hops {
        return None;
    }
    let g = problem.gravity;
    let high = facts.heights[0] + 0.125 * g * facts.interval * facts.interval;
    let high = high.max(problem.start_w.z);
    let low = facts.heights[1].min(problem.start_w.z);
    let fall = so3::math::sqrt(0.5 * g);
    let before = so3::math::sqrt((high - low).max(0.0));
    let reach = before + (facts.flight + facts.interval) * fall;
    let lowest = high - reach * reach;
    let missing = lowest - problem.goal_w.z;
    (missing > SLACK).then(|| {
        let needed = (so3::math::sqrt(high - problem.goal_w.z) - before) / fall - facts.interval;
        Impossible {
            bound: "free fall",
            because: format!(
                "in a flight of at most {:.3} s the robot cannot fall as deep as the goal: it would still be {missing:.3} m above it",
                facts.flight
            ),
            relaxation: format!(
                "the flight would have to last at least {needed:.3} s, or the landing to be {missing:.3} m higher"
            ),
        }
    })
}

/// What lifts the robot: force over the time of the stance. A robot heavier than its feet can push only sinks.
fn impulse(task: &Task, facts: &Facts) -> Option<Impossible> {
    if facts.feet == 0.0 || facts.hops {
        return None;
    }
    let problem = &task.problem;
    let g = problem.gravity;
    let shortest = |stands: bool| -> f64 {
        let phases = problem.used_phases().iter();
        phases
            .filter(|phase| phase.contacts.contains(&true) == stands)
            .map(|phase| phase.min_duration)
            .sum()
    };
    // The highest rise with a constant acceleration `a` of the stance: longest where it lifts, shortest where it sinks.
    let rise = |a: f64| {
        let stance = if a > 0.0 {
            facts.stance
        } else {
            shortest(true)
        };
        let flight = shortest(false).max(a * stance / g);
        0.5 * a * stance * stance + (a * stance - 0.5 * g * flight) * flight
    };
    let most = facts.feet * problem.max_force / problem.mass - g;
    let wanted = problem.goal_w.z - problem.start_w.z;
    let missing = wanted - rise(most);
    (missing > SLACK).then(|| {
        let (mut low, mut high) = (most, 100.0 * g);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if rise(middle) < wanted {
                low = middle;
            } else {
                high = middle;
            }
        }
        let force = (low + g) * problem.mass / facts.feet;
        Impossible {
            bound: "impulse",
            because: format!(
                "{:.0} feet of {:.1} N carry {:.1} N of weight: the centre of mass ends at least {missing:.3} m too low",
                facts.feet,
                problem.max_force,
                problem.mass * g
            ),
            relaxation: format!(
                "the legs would have to push with at least {force:.1} N per foot, or the goal to be {missing:.3} m lower"
            ),
        }
    })
}

/// What lifts the robot: force over the length of the legs, and power over the time of the stance.
fn lifting(task: &Task, facts: &Facts) -> Option<Impossible> {
    if facts.hops {
        return None;
    }
    let problem = &task.problem;
    let g = problem.gravity;
    let rise = facts.feet * problem.max_force / problem.mass - g;
    let [high, low] = facts.heights;
    let high = high + 0.125 * rise.max(0.0) * facts.interval * facts.interval;
    // The last interval of the stance is only held back by the force.
    let low = low.min(problem.start_w.z);
    let span = (high - low).max(0.0);
    let speed = so3::math::sqrt(2.0 * rise.max(0.0) * span) + rise.max(0.0) * facts.interval;
    let apex = high.max(problem.start_w.z) + speed * facts.interval + 0.5 * speed * speed / g;
    let missing = problem.goal_w.z - apex;
    if missing > SLACK {
        return Some(Impossible {
            bound: "force",
            because: format!(
                "{:.0} feet of {:.0} N lift the centre of mass to {apex:.3} m at most",
                facts.feet, problem.max_force
            ),
            relaxation: format!("the goal would have to be at least {missing:.3} m lower"),
        });
    }
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

#[cfg(test)]
mod tests;
