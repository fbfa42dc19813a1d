//! What a run asked of the robot's hardware, at every tick of the plant, beside the robot's budgets.

use super::Failure;
use crate::lab;
use rbd_core::{Budgets, JointLimits, Motor};

/// Where the jump is, as far as budgets differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Feet push.
    PushOff,
    /// None does.
    Flight,
    /// From the touchdown on.
    Landing,
}

const STAGES: [&str; 3] = ["push_off", "flight", "landing"];

/// Length of the means of force and power, s.
const WINDOW: f64 = 0.010;
/// Least force that counts as a touch, N: a link that grazes something.
const TOUCH: f64 = 1.0;

/// One tick of the plant, as it was.
pub struct Tick<'a, const N: usize> {
    /// Its end, s.
    pub time: f64,
    /// Its length, s.
    pub dt: f64,
    /// Of the jump.
    pub stage: Stage,
    /// What the motors were asked for, N m.
    pub asked: &'a [f64; N],
    /// What they gave, N m.
    pub given: &'a [f64; N],
    /// How fast the joints were, rad/s.
    pub speeds: &'a [f64; N],
    /// Torques of the joints' stops, N m.
    pub stops: &'a [f64; N],
    /// Force of the ground on the whole robot, N.
    pub ground: f64,
    /// Power of the supply, W.
    pub power: f64,
    /// Links that touch something they should not, with the force, N.
    pub touches: &'a [(&'static str, f64)],
}

/// A mean over the last [`WINDOW`] with its largest value.
struct Window {
    values: Vec<f64>,
    next: usize,
    sum: f64,
    peak: f64,
}

impl Window {
    fn new(tick: f64) -> Self {
        let length = (WINDOW / tick).round().max(1.0) as usize;
        Self {
            values: vec![0.0; length],
            next: 0,
            sum: 0.0,
            peak: 0.0,
        }
    }

    fn add(&mut self, value: f64) {
        self.sum += value - self.values[self.next];
        self.values[self.next] = value;
        self.next = (self.next + 1) % self.values.len();
        self.peak = self.peak.max(self.sum / self.values.len() as f64);
    }
}

/// A total that may not exceed its budget, with the time at which it did.
#[derive(Clone, Copy, Default)]
struct Total {
    value: f64,
    exceeded: Option<f64>,
}

impl Total {
    fn add(&mut self, more: f64, most: f64, time: f64) {
        self.reach(self.value + more, most, time);
    }

    fn reach(&mut self, value: f64, most: f64, time: f64) {
        self.value = self.value.max(value);
        // A sum of ticks is not exact.
        if self.exceeded.is_none() && self.value > most * (1.0 + 1e-9) {
            self.exceeded = Some(time);
        }
    }
}

/// The account of one run.
pub struct Hardware<const N: usize> {
    budgets: Budgets,
    motors: [Motor<f64>; N],
    /// Speed limits of the joints, rad/s.
    speeds: [f64; N],
    weight: f64,
    saturation: [Total; 3],
    stop_time: Total,
    stop_torque: Total,
    overspeed: Total,
    peak_speed: f64,
    force: Window,
    ground: Total,
    heat: [f64; N],
    heat_share: Total,
    supply: Window,
    power: Total,
    /// What the supply gave, J.
    energy: f64,
    /// Links that touched, each with the time of its first touch.
    touched: Vec<(&'static str, f64)>,
}

impl<const N: usize> Hardware<N> {
    /// Nothing asked yet; `weight` in N, `tick` of the plant in s.
    #[must_use]
    pub fn new(
        budgets: Budgets,
        motors: [Motor<f64>; N],
        limits: &[JointLimits<f64>; N],
        weight: f64,
        tick: f64,
    ) -> Self {
        Self {
            budgets,
            motors,
            speeds: core::array::from_fn(|i| limits[i].speed),
            weight,
            saturation: [Total::default(); 3],
            stop_time: Total::default(),
            stop_torque: Total::default(),
            overspeed: Total::default(),
            peak_speed: 0.0,
            force: Window::new(tick),
            ground: Total::default(),
            heat: [0.0; N],
            heat_share: Total::default(),
            supply: Window::new(tick),
            power: Total::default(),
            energy: 0.0,
            touched: Vec::new(),
        }
    }

    /// Books one tick.
    pub fn add(&mut self, tick: &Tick<'_, N>) {
        let b = &self.budgets;
        let (time, dt) = (tick.time, tick.dt);
        if saturated(tick.asked, tick.speeds, &self.motors) {
            let stage = tick.stage as usize;
            self.saturation[stage].add(dt, b.saturation[stage], time);
        }
        let stop = tick
            .stops
            .iter()
            .fold(0.0, |most, x| f64::max(most, x.abs()));
        if stop > 0.0 {
            self.stop_time.add(dt, b.stop_time, time);
            self.stop_torque.reach(stop, b.stop_torque, time);
        }
        let mut over = false;
        for (speed, limit) in tick.speeds.iter().zip(&self.speeds) {
            self.peak_speed = self.peak_speed.max(speed.abs());
            over |= speed.abs() > *limit;
        }
        if over {
            self.overspeed.add(dt, b.overspeed, time);
        }
        self.force.add(tick.ground / self.weight);
        self.ground.reach(self.force.peak, b.ground_force, time);
        self.supply.add(tick.power);
        self.power.reach(self.supply.peak, b.supply_power, time);
        self.energy += dt * tick.power;
        let joints = self.heat.iter_mut().zip(tick.given).zip(&self.motors);
        for ((heat, torque), motor) in joints {
            *heat += dt * lab::copper_loss(*torque, motor.gear, b.torque_constant, b.resistance);
            self.heat_share.reach(*heat / b.winding_heat, 1.0, time);
        }
        for (name, force) in tick.touches {
            if *force > TOUCH && !self.touched.iter().any(|(known, _)| known == name) {
                self.touched.push((name, time));
            }
        }
    }

    /// What was found; `allowed` links may touch.
    #[must_use]
    pub fn found(&self, allowed: &[&str]) -> Found {
        let b = &self.budgets;
        let mut exceeded = Vec::new();
        let mut check = |total: &Total, name: &str, most: f64, unit: f64| {
            if let Some(time) = total.exceeded {
                let found = format!("{:.1} of {:.1}", unit * total.value, unit * most);
                exceeded.push(Failure::new(time, format!("hardware.{name}"), found));
            }
        };
        for (i, stage) in STAGES.iter().enumerate() {
            check(
                &self.saturation[i],
                &format!("saturation_ms.{stage}"),
                b.saturation[i],
                1e3,
            );
        }
        check(&self.stop_time, "stop_ms", b.stop_time, 1e3);
        check(&self.stop_torque, "stop_torque_nm", b.stop_torque, 1.0);
        check(&self.overspeed, "overspeed_ms", b.overspeed, 1e3);
        check(
            &self.ground,
            "ground_force_10ms_weights",
            b.ground_force,
            1.0,
        );
        check(&self.heat_share, "heat_share", 1.0, 1.0);
        check(&self.power, "supply_power_w", b.supply_power, 1.0);
        for (name, time) in &self.touched {
            if !allowed.contains(name) {
                exceeded.push(Failure::new(
                    *time,
                    format!("hardware.links_touched.{name}"),
                    "touched",
                ));
            }
        }
        Found {
            saturation: self.saturation.map(|total| total.value),
            stop_time: self.stop_time.value,
            stop_torque: self.stop_torque.value,
            overspeed: self.overspeed.value,
            peak_speed: self.peak_speed,
            ground_force: self.ground.value,
            heat_share: b.winding_heat.is_finite().then_some(self.heat_share.value),
            supply_power: self.power.value,
            supply_limit: Some(b.supply_power).filter(|limit| limit.is_finite()),
            supply_energy: self.energy,
            touched: self.touched.iter().map(|(name, _)| *name).collect(),
            exceeded,
        }
    }
}

/// Whether a motor is asked for all that it can give at this speed.
fn saturated<const N: usize>(
    asked: &[f64; N],
    speeds: &[f64; N],
    motors: &[Motor<f64>; N],
) -> bool {
    asked
        .iter()
        .zip(speeds)
        .zip(motors)
        .any(|((tau, qd), motor)| {
            let [low, high] = motor.torque_range(*qd);
            *tau <= low + 1e-9 || *tau >= high - 1e-9
        })
}

/// The account of a run that has ended; s, N m, rad/s, weights, W, J.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// Time in which a motor was asked for all that it has: push-off, flight, landing.
    pub saturation: [f64; 3],
    /// Time in which a joint pressed on its stop.
    pub stop_time: f64,
    /// Largest torque of a stop.
    pub stop_torque: f64,
    /// Time in which a joint was beyond its speed limit.
    pub overspeed: f64,
    /// Of any joint.
    pub peak_speed: f64,
    /// Largest mean over 10 ms.
    pub ground_force: f64,
    /// Of the hottest winding, over its budget; none where nobody has published what a winding bears.
    pub heat_share: Option<f64>,
    /// Largest mean over 10 ms.
    pub supply_power: f64,
    /// None where nobody has published one: the power is then measured and not judged.
    pub supply_limit: Option<f64>,
    /// Of the whole run.
    pub supply_energy: f64,
    /// Links that touched something.
    pub touched: Vec<&'static str>,
    /// Budgets that were exceeded, and links that touched and may not.
    pub exceeded: Vec<Failure>,
}

impl Found {
    /// Every budget was kept.
    #[must_use]
    pub fn within(&self) -> bool {
        self.exceeded.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::{Hardware, Stage, Tick};
    use a1_model::{BUDGETS, MOTORS, a1};

    const DT: f64 = 1e-4;
    const REST: [f64; 12] = [0.0; 12];

    fn tick<'a>(k: u32) -> Tick<'a, 12> {
        Tick {
            time: DT * f64::from(k),
            dt: DT,
            stage: Stage::Flight,
            asked: &REST,
            given: &REST,
            speeds: &REST,
            stops: &REST,
            ground: 0.0,
            power: 0.0,
            touches: &[],
        }
    }

    /// What fails when each of `ticks` ticks is changed by `change`.
    fn fails<'a>(ticks: u32, change: impl Fn(&mut Tick<'a, 12>)) -> Vec<String> {
        let budgets = rbd_core::Budgets {
            supply_power: 1000.0,
            ..BUDGETS
        };
        let mut hardware = Hardware::new(budgets, MOTORS, &a1::LIMITS, 100.0, DT);
        for k in 0..ticks {
            let mut one = tick(k);
            change(&mut one);
            hardware.add(&one);
        }
        let found = hardware.found(&["trunk"]);
        assert_eq!(found.within(), found.exceeded.is_empty());
        found
            .exceeded
            .into_iter()
            .map(|failure| failure.name)
            .collect()
    }

    /// Each budget is kept up to its limit and fails just beyond, and nothing else fails with it.
    #[test]
    fn every_budget_can_fail_alone() {
        let full = [33.5; 12];
        let fast = [21.5; 12];
        let stop = [1.0; 12];
        let hard = [34.0; 12];
        assert!(fails(1000, |_| {}).is_empty());
        assert!(fails(100, |t| t.asked = &full).is_empty());
        assert_eq!(
            fails(101, |t| t.asked = &full),
            ["hardware.saturation_ms.flight"]
        );
        assert!(fails(500, |t| (t.asked, t.stage) = (&full, Stage::Landing)).is_empty());
        assert!(
            fails(50, |t| t.speeds = &fast)
                .iter()
                .all(|name| !name.contains("overspeed"))
        );
        assert!(fails(51, |t| t.speeds = &fast).contains(&"hardware.overspeed_ms".to_owned()));
        assert!(fails(100, |t| t.stops = &stop).is_empty());
        assert_eq!(fails(101, |t| t.stops = &stop), ["hardware.stop_ms"]);
        assert_eq!(fails(1, |t| t.stops = &hard), ["hardware.stop_torque_nm"]);
        // A blow of 1 ms with nine times the budget is less than the budget over 10 ms.
        assert!(fails(10, |t| t.ground = 9000.0).is_empty());
        assert_eq!(
            fails(100, |t| t.ground = 1010.0),
            ["hardware.ground_force_10ms_weights"]
        );
        assert_eq!(
            fails(100, |t| t.power = 1010.0),
            ["hardware.supply_power_w"]
        );
        assert_eq!(fails(50_000, |t| t.given = &full), ["hardware.heat_share"]);
    }

    #[test]
    fn a_touch_is_named_unless_it_is_allowed() {
        const TOUCHES: &[(&str, f64)] = &[("trunk", 50.0), ("FL_shank", 2.0), ("FR_hip", 0.5)];
        assert_eq!(
            fails(2, |t| t.touches = TOUCHES),
            ["hardware.links_touched.FL_shank"]
        );
    }
}
