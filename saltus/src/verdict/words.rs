//! The verdict for people.

use super::Verdict;
use crate::report::Line;

impl Verdict {
    /// Lines of the result: the verdict, and its three parts.
    pub(crate) fn lines(&self) -> Vec<Line> {
        let fails = |part: &str| self.failures.iter().any(|x| x.name.starts_with(part));
        let part = |name: &'static str, value: String| (name, value, Some(!fails(name)));
        let none = || "there was none".to_owned();
        let flight = self.flight.map_or_else(none, |f| {
            format!(
                "{:.3} m and {:.1} deg off the plan at its touchdown, joints {:.0} deg",
                f.position, f.rotation, f.joints
            )
        });
        let stand = self.stand.map_or_else(none, |s| {
            format!(
                "{}; feet {:.3} m off, heading {:.1} deg, height {:.3} m, rotation {:.1} deg",
                if s.upright { "upright" } else { "FELL" },
                s.feet,
                s.heading,
                s.height,
                s.rotation
            )
        });
        let mut lines = vec![
            ("verdict", self.first(), Some(self.on_target())),
            part("flight", flight),
            part("stand", stand),
            part("hardware", self.hardware.words()),
        ];
        let others = self.failures.iter().skip(1);
        lines.extend(others.map(|x| {
            let words = format!("{}: {} at {:.3} s", x.name, x.found, x.time);
            ("then", words, Some(false))
        }));
        lines
    }

    /// On target, or what failed first.
    pub(crate) fn first(&self) -> String {
        self.failures.first().map_or_else(
            || "on target".to_owned(),
            |x| format!("NO: {}: {} at {:.3} s", x.name, x.found, x.time),
        )
    }
}

impl super::hardware::Found {
    /// In one line.
    fn words(&self) -> String {
        let [push_off, flight, landing] = self.saturation.map(|x| 1e3 * x);
        let touched = if self.touched.is_empty() {
            "nothing but feet touched".to_owned()
        } else {
            format!("touched: {}", self.touched.join(", "))
        };
        let limit = self.supply_limit.map_or_else(
            || "no limit known".to_owned(),
            |limit| format!("of {limit:.0}"),
        );
        format!(
            "saturation {push_off:.1}, {flight:.1}, {landing:.1} ms; stops {:.1} ms, {:.1} N m; {:.1} rad/s, {:.1} ms too fast; ground \
             {:.1} weights; heat {:.2}; supply {:.0} W ({limit}), {:.0} J; {touched}",
            1e3 * self.stop_time,
            self.stop_torque,
            self.peak_speed,
            1e3 * self.overspeed,
            self.ground_force,
            self.heat_share,
            self.supply_power,
            self.supply_energy,
        )
    }
}
