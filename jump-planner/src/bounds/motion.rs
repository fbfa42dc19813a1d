//! What time, force and friction let a centre of mass do.

use super::facts::{Facts, longest_leg};
use super::{Body, Impossible, SLACK};

pub(super) fn durations<const P: usize>(problem: &Body<P>, _: &Facts) -> Option<Impossible> {
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
            format!("the longest total duration would have to be at least {shortest:.3} s"),
        ));
    }
    (longest < problem.min_total).then(|| {
        told(
            format!(
                "the phases take at most {longest:.3} s together, the whole must take {:.3} s",
                problem.min_total
            ),
            format!("the shortest total duration would have to be at most {longest:.3} s"),
        )
    })
}

pub(super) fn falling<const P: usize>(problem: &Body<P>, facts: &Facts) -> Option<Impossible> {
    if facts.feet > 0.0 {
        return None;
    }
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

pub(super) fn sideways<const P: usize>(problem: &Body<P>, facts: &Facts) -> Option<Impossible> {
    let way = problem.goal_w - problem.start_w;
    let far = f64::max(way.x.abs(), way.y.abs());
    let push = facts.feet * problem.max_force / problem.mass;
    let coasting = facts.stance * (facts.total - 0.5 * facts.stance);
    let reached = problem.friction * push * coasting;
    (far > reached + SLACK).then(|| Impossible {
        bound: "sideways",
        because: format!(
            "with {:.2} of the ground's friction of {:.3} it pushes the robot at most {reached:.3} m sideways in {:.3} s, the goal is {far:.3} m away",
            facts.friction_share,
            problem.friction / facts.friction_share,
            facts.total
        ),
        relaxation: format!(
            "the ground's friction would have to be at least {:.3}",
            far / (push * coasting * facts.friction_share)
        ),
    })
}

/// Speed sideways is gained only where feet can stand.
///
/// While feet stand, the centre of mass is within the longest leg of each of them, so along an axis between l and h over all stances, and
/// at most a = μ n F/m accelerates it. From the last moment at which it rested it moves one way only, so its speed v at the last foothold
/// is at most √(2 a (h − l)), and after a flight of T it is at most v T farther than h. Reach holds at nodes: between two of them the
/// centre of mass is at most a dt²/8 outside, and T and v count the last interval of the stance too.
pub(super) fn run_up<const P: usize>(problem: &Body<P>, facts: &Facts) -> Option<Impossible> {
    if facts.feet == 0.0 {
        return None;
    }
    let push = problem.friction * facts.feet * problem.max_force / problem.mass;
    let standing = problem.used_phases().iter();
    let standing = standing.filter(|phase| phase.contacts.contains(&true));
    let shortest: f64 = standing.clone().map(|phase| phase.min_duration).sum();
    let flight = facts.flight[1].min(problem.max_total - shortest).max(0.0);
    let way = problem.goal_w - problem.start_w;
    let axis = usize::from(way.y.abs() > way.x.abs());
    let sign = 1.0_f64.copysign(way[axis]);
    let start = sign * problem.start_w[axis];
    let (mut low, mut high) = (start, start);
    for phase in standing {
        let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
        for (foot, _) in problem
            .feet
            .iter()
            .zip(phase.contacts)
            .filter(|(_, on)| *on)
        {
            let (at, leg) = (sign * foot.pos_wf[axis], longest_leg(problem, foot));
            (near, far) = (near.max(at - leg), far.min(at + leg));
        }
        (low, high) = (low.min(near), high.max(far));
    }
    let dt = facts.interval;
    let outside = 0.125 * push * dt * dt;
    let speed = so3::math::sqrt(2.0 * push * (high - low + 2.0 * outside)) + push * dt;
    let reached = high + outside + speed * (flight + dt) - start;
    let far = way[axis].abs();
    (far > reached + SLACK).then(|| Impossible {
        bound: "run-up",
        because: format!(
            "as long as its feet stand the robot gets to at most {speed:.1} m/s sideways, and with a flight of at most {flight:.3} s \
             to {reached:.3} m, the goal is {far:.3} m away"
        ),
        relaxation: format!("the goal would have to be at least {:.3} m nearer", far - reached),
    })
}

/// A flight that ends low takes time.
///
/// While feet stand, p_z is between h₋ and h₊ ([`Facts::heights`]). The ground only pushes, so p̈_z ≥ −g. From the last moment at which
/// p_z rested (at the start it rests) to the take-off at height z it falls all the time, so ṗ_z² ≤ 2 g (h₊ − z), and after a flight of T
/// the height is at least z − T √(2 g (h₊ − z)) − g T²/2 = h₊ − (√(h₊ − z) + T √(g/2))² ≥ h₊ − (√(h₊ − h₋) + T √(g/2))². The
/// heights hold at nodes: T counts the last interval of the stance too, and a moment of rest between nodes is at most g dt²/8 higher.
pub(super) fn free_fall<const P: usize>(problem: &Body<P>, facts: &Facts) -> Option<Impossible> {
    if facts.feet == 0.0 || facts.hops {
        return None;
    }
    let g = problem.gravity;
    let high = facts.heights[0] + 0.125 * g * facts.interval * facts.interval;
    let high = high.max(problem.start_w.z);
    let low = facts.heights[1].min(problem.start_w.z);
    let fall = so3::math::sqrt(0.5 * g);
    let before = so3::math::sqrt((high - low).max(0.0));
    let reach = before + (facts.flight[1] + facts.interval) * fall;
    let lowest = high - reach * reach;
    let missing = lowest - problem.goal_w.z;
    (missing > SLACK).then(|| {
        let needed = (so3::math::sqrt(high - problem.goal_w.z) - before) / fall - facts.interval;
        Impossible {
            bound: "free fall",
            because: format!(
                "in a flight of at most {:.3} s the robot cannot fall as deep as the goal: it would still be {missing:.3} m above it",
                facts.flight[1]
            ),
            relaxation: format!(
                "the flight would have to last at least {needed:.3} s, or the landing to be {missing:.3} m higher"
            ),
        }
    })
}

/// What lifts the robot: force over the time of the stance. A robot heavier than its feet can push only sinks.
pub(super) fn impulse<const P: usize>(problem: &Body<P>, facts: &Facts) -> Option<Impossible> {
    if facts.feet == 0.0 || facts.hops {
        return None;
    }
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

/// Highest that the centre of mass is when the last foot leaves the ground, m, and fastest upwards, m/s: force over the length of the legs.
fn take_off<const P: usize>(problem: &Body<P>, facts: &Facts) -> [f64; 2] {
    let rise = (facts.feet * problem.max_force / problem.mass - problem.gravity).max(0.0);
    let [high, low] = facts.heights;
    let high = high + 0.125 * rise * facts.interval * facts.interval;
    // The last interval of the stance is only held back by the force.
    let low = low.min(problem.start_w.z);
    let span = (high - low).max(0.0);
    let speed = so3::math::sqrt(2.0 * rise * span) + rise * facts.interval;
    [high.max(problem.start_w.z) + speed * facts.interval, speed]
}

/// What lifts the robot: force over the length of the legs.
pub(super) fn force<const P: usize>(problem: &Body<P>, facts: &Facts) -> Option<Impossible> {
    if facts.hops {
        return None;
    }
    let [height, speed] = take_off(problem, facts);
    let apex = height + 0.5 * speed * speed / problem.gravity;
    let missing = problem.goal_w.z - apex;
    (missing > SLACK).then(|| Impossible {
        bound: "force",
        because: format!(
            "{:.0} feet of {:.0} N lift the centre of mass to {apex:.3} m at most",
            facts.feet, problem.max_force
        ),
        relaxation: format!("the goal would have to be at least {missing:.3} m lower"),
    })
}

/// A flight that ends high is short.
pub(super) fn hanging<const P: usize>(problem: &Body<P>, facts: &Facts) -> Option<Impossible> {
    if facts.hops {
        return None;
    }
    let g = problem.gravity;
    let [height, speed] = take_off(problem, facts);
    let time = facts.flight[0].max(speed / g);
    let reached = height + (speed - 0.5 * g * time) * time;
    let missing = problem.goal_w.z - reached;
    (missing > SLACK).then(|| {
        let drop = (height - problem.goal_w.z).max(-0.5 * speed * speed / g);
        let longest = (speed + so3::math::sqrt(speed * speed + 2.0 * g * drop)) / g;
        Impossible {
            bound: "hanging",
            because: format!(
                "no push keeps the robot in the air for {time:.3} s: it would end at least {missing:.3} m too low"
            ),
            relaxation: format!("the flight would have to be allowed to last only {longest:.3} s"),
        }
    })
}
