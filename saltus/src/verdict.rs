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

/// The verdict as a sentence, for the top of a page.
pub(crate) fn sentence(verdict: &Verdict) -> String {
    let Some(first) = verdict.failures.first() else {
        return "On target: flown as planned, standing where it should, hardware within its budgets.".to_owned();
    };
    let more = match verdict.failures.len() - 1 {
        0 => String::new(),
        1 => " One more measure fails.".to_owned(),
        n => format!(" {n} more measures fail."),
    };
    let (meaning, unit) = meaning(&first.name);
    format!(
        "Not on target: {meaning}: {}{unit} at {:.3} s ({}).{more}",
        first.found, first.time, first.name
    )
}

/// What the name of a failure means, and the unit where what was found has none.
fn meaning(name: &str) -> (&str, &str) {
    match name {
        "flight.position_m" => ("too far from the plan at its touchdown", ""),
        "flight.rotation_deg" => ("turned away from the plan at its touchdown", ""),
        "flight.com_gain_m" => ("the flight is not as high as asked for", ""),
        "flight.sole_clearance_m" => ("the soles do not rise enough", ""),
        "stand.upright" => ("it fell", ""),
        "stand.feet_m" => ("the feet stand too far from the goal", ""),
        "stand.heading_deg" => ("it heads elsewhere in the end", ""),
        "stand.height_m" => ("it stands too low or too high", ""),
        "stand.rotation_deg" => ("it stands askew", ""),
        "hardware.saturation_ms.push_off" => ("motors at their limits in the push-off", " ms"),
        "hardware.saturation_ms.flight" => ("motors at their limits in the flight", " ms"),
        "hardware.saturation_ms.landing" => ("motors at their limits in the landing", " ms"),
        "hardware.stop_ms" => ("joints at their stops", " ms"),
        "hardware.stop_torque_nm" => ("a joint hits its stop", " N m"),
        "hardware.overspeed_ms" => ("joints faster than their motors", " ms"),
        "hardware.ground_force_10ms_weights" => {
            ("the ground pushes too hard", " weights (10 ms mean)")
        }
        "hardware.heat_share" => ("a winding gets too warm", " of what it bears"),
        "hardware.supply_power_w" => ("more power than the supply has", " W"),
        "fault" => ("the machine gave up", ""),
        "no_takeoff" | "no_touchdown" => ("there was no jump", ""),
        _ => {
            let link = name.strip_prefix("hardware.links_touched.");
            (link.unwrap_or(name), "")
        }
    }
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
    let heat = found
        .heat_share
        .map_or_else(|| "unknown".to_owned(), |share| format!("{share:.2}"));
    format!(
        "saturation {push_off:.1}, {flight:.1}, {landing:.1} ms; stops {:.1} ms, {:.1} N m; {:.1} rad/s, {:.1} ms too fast; ground \
         {:.1} weights (10 ms mean); heat {heat}; supply {:.0} W ({limit}), {:.0} J; {touched}",
        1e3 * found.stop_time,
        found.stop_torque,
        found.peak_speed,
        1e3 * found.overspeed,
        found.ground_force,
        found.supply_power,
        found.supply_energy,
    )
}

#[cfg(test)]
mod tests {
    use super::{Found, words};

    /// A reader of forces would take it for the peak, which is higher.
    #[test]
    fn the_force_of_the_ground_is_told_as_the_mean_that_it_is() {
        let found = Found {
            ground_force: 5.1,
            ..Found::default()
        };
        let told = words(&found);
        assert!(told.contains("ground 5.1 weights (10 ms mean);"), "{told}");
    }
}
