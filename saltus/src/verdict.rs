//! The verdict for people.

use crate::report::Line;
use jump_lab::verdict::{Found, Verdict};

/// Lines of the result: the verdict, and its three parts.
pub(crate) fn lines(verdict: &Verdict) -> Vec<Line> {
    let fails = |part: &str| verdict.failures.iter().any(|x| x.name.starts_with(part));
    let part = |name: &'static str, value: String| (name, value, Some(!fails(name)));
    let none = || "there was none".to_owned();
    let flight = verdict.flight.map_or_else(none, |f| {
        format!(
            "{:.3} m and {:.1} deg off the plan at its touchdown, joints {:.0} deg",
            f.position, f.rotation, f.joints
        )
    });
    let stand = verdict.stand.map_or_else(none, |s| {
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
        ("verdict", verdict.first(), Some(verdict.on_target())),
        part("flight", flight),
        part("stand", stand),
        part("hardware", words(&verdict.hardware)),
    ];
    let others = verdict.failures.iter().skip(1);
    lines.extend(others.map(|x| {
        let words = format!("{}: {} at {:.3} s", x.name, x.found, x.time);
        ("then", words, Some(false))
    }));
    lines
}

/// In one line.
fn words(found: &Found) -> String {
    let [push_off, flight, landing] = found.saturation.map(|x| 1e3 * x);
    let touched = if found.touched.is_empty() {
        "nothing but feet touched".to_owned()
    } else {
        format!("touched: {}", found.touched.join(", "))
    };
    let limit = found.supply_limit.map_or_else(
        || "no limit known".to_owned(),
        |limit| format!("of {limit:.0}"),
    );
    format!(
        "saturation {push_off:.1}, {flight:.1}, {landing:.1} ms; stops {:.1} ms, {:.1} N m; {:.1} rad/s, {:.1} ms too fast; ground \
         {:.1} weights; heat {:.2}; supply {:.0} W ({limit}), {:.0} J; {touched}",
        1e3 * found.stop_time,
        found.stop_torque,
        found.peak_speed,
        1e3 * found.overspeed,
        found.ground_force,
        found.heat_share,
        found.supply_power,
        found.supply_energy,
    )
}
