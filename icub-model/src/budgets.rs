//! What iCub's hardware may be asked for in one jump.

use rbd_core::hardware::Budgets;

/// Budgets of iCub, fixed before any jump was measured by them.
///
/// | figure | value | source |
/// |---|---|---|
/// | saturation in push-off and flight | 20 ms | the rule of A1: a lean grows e-fold in √(0.45 m/g) = 0.2 s; a joint without reserve for a tenth of that cannot hold it |
/// | saturation in the landing | 30 ms | the rule of A1: a third of the way of 0.08 m from the landing posture to the squat, at 0.89 m/s (paper B's take-off speed) |
/// | at a joint's stop | 10 ms, 37 N m | the rule of A1: a touch, not a load above what the leg joints give themselves (URDF `effort`; 37 N m for all but the hip pitch) |
/// | above 7.64 rad/s, hip pitch 5.1 | 5 ms | URDF `velocity`: 7300 turns a minute at the input of the harmonic drive; speed "for zero torque" in robotology/community issue 256 |
/// | ground force, mean of 10 ms | 12 weights | the six-axis sensors in both feet measure 2000 N along z (icub-tech-iit.github.io, F/T Sensors): 4000 N of 324 N |
/// | heat of a winding, its resistance | not counted | no data sheet of the MOOG C2900584 is public, and nobody knows the copper |
/// | torque constant | 0.034 N m/A | 16.9 N m nominal behind 1:100 (issue 256) at `motorNominalCurrents` 5 A of robots-configuration, `iCubGenova04/hardware/motorControl/left_leg-eb6-j0_3-mc.xml` |
/// | supply, mean of 10 ms | 1840 W | 40 V and 46 A: all that the Xantrex XFR 60-46 of older iCubs gives at the motors' voltage; IIT sets it to 20 A for iCub 1. Without the windings' heat what is compared is motion alone |
///
/// Paper B reports "hardware faults due to excessive peak currents": `motorPeakCurrents` were 6 to 10 A, which is 20 to 34 N m here, until
/// the authors raised them "to the maximum value", which they do not name. The torque limits of [`LIMITS`](crate::LIMITS) are what
/// stands for it.
pub static BUDGETS: Budgets = Budgets {
    saturation: [0.020, 0.020, 0.030],
    stop_time: 0.010,
    stop_torque: 37.0,
    overspeed: 0.005,
    ground_force: 12.0,
    winding_heat: f64::INFINITY,
    torque_constant: 0.034,
    resistance: 0.0,
    supply_power: 1840.0,
};
