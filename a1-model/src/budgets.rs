//! What A1's hardware may be asked for in one jump.

use rbd_core::hardware::Budgets;

use crate::hardware::{RESISTANCE, TORQUE_CONSTANT};
use crate::table1::TORQUE;

/// Budgets of A1.
///
/// | figure | value | source |
/// |---|---|---|
/// | saturation in push-off and flight | 10 ms | on two feet a lean grows e-fold in 0.1 s; a joint without reserve for a tenth of that cannot hold it |
/// | saturation in the landing | 50 ms | a third of the 0.15 m stroke at 1 m/s: longer, and the leg gives way uncontrolled |
/// | at a joint's stop | 10 ms, 33.5 N m | URDF `lower`, `upper`, `effort`: a stop may see a touch, not a load above the motor's own torque |
/// | above 21 rad/s | 5 ms | URDF `velocity`, paper A Table I |
/// | ground force, mean of 10 ms | 10 weights | four knees at 33.5 N m with a lever of 0.10 m (shank of 0.2 m at 60°): 1340 N of 135 N |
/// | heat of a winding | 1400 J | 60 g of copper (0.385 J/(g K)) by 60 K; an estimate, no data sheet is public |
/// | torque constant, resistance | 0.118 N m/A, 0.348 Ω | the model behind [`MOTORS`](crate::MOTORS) |
/// | supply, mean of 10 ms | none | the pack's 4.2 Ah are known, its discharge limit is not; paper A flew barrel rolls that take 2.7 kW by this model |
pub static BUDGETS: Budgets = Budgets {
    saturation: [0.010, 0.010, 0.050],
    stop_time: 0.010,
    stop_torque: TORQUE,
    overspeed: 0.005,
    ground_force: 10.0,
    winding_heat: 1400.0,
    torque_constant: TORQUE_CONSTANT,
    resistance: RESISTANCE,
    supply_power: f64::INFINITY,
};
