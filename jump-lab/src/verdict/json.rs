//! The verdict as JSON.

use super::{Found, Verdict};
use serde_json::{Value, json};

impl Verdict {
    /// The object `verdict` of `saltus run --json`.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({
            "flight": self.flight.map(|f| json!({
                "position_m": f.position,
                "rotation_deg": f.rotation,
                "joints_deg": f.joints,
            })),
            "stand": self.stand.map(|s| json!({
                "feet_m": s.feet,
                "heading_deg": s.heading,
                "height_m": s.height,
                "rotation_deg": s.rotation,
                "upright": s.upright,
            })),
            "hardware": hardware(&self.hardware),
            "failures": self.failures.iter().map(|failure| json!({
                "time_s": failure.time,
                "name": failure.name,
                "found": failure.found,
            })).collect::<Vec<_>>(),
        })
    }
}

/// Its key `hardware`.
fn hardware(found: &Found) -> Value {
    let [push_off, flight, landing] = found.saturation.map(|x| 1e3 * x);
    json!({
        "within": found.within(),
        "exceeded": found.exceeded.iter().map(|x| x.name.trim_start_matches("hardware.")).collect::<Vec<_>>(),
        "saturation_ms": { "push_off": push_off, "flight": flight, "landing": landing },
        "stop_ms": 1e3 * found.stop_time,
        "stop_torque_nm": found.stop_torque,
        "overspeed_ms": 1e3 * found.overspeed,
        "peak_joint_speed": found.peak_speed,
        "ground_force_10ms_weights": found.ground_force,
        "links_touched": found.touched,
        "heat_share": found.heat_share,
        "supply_power_w": found.supply_power,
        "supply_limit_w": found.supply_limit,
        "supply_energy_j": found.supply_energy,
    })
}
