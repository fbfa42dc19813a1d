//! Everything that may differ from the plan, with the ranges of the lab: one table.

/// What differs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// Every mass, relative.
    Mass,
    /// Mass bolted to the trunk, kg; payload=KG@X,Y,Z puts it there.
    Payload,
    /// Where it is bolted, base axes, m.
    PayloadX,
    /// Where it is bolted to the left, m.
    PayloadY,
    /// Where it is bolted upwards, m.
    PayloadZ,
    /// The centre of mass is farther forward, m.
    ComX,
    /// The centre of mass is farther to the left, m.
    ComY,
    /// Coulomb coefficient of the ground.
    Friction,
    /// Coulomb friction of every joint, N m.
    JointFriction,
    /// Rotor inertias, relative.
    Rotor,
    /// Torque over what was asked for.
    TorqueGain,
    /// Time constant of the torque, ms.
    CurrentLag,
    /// Share of the supply voltage that is lost at 2 kW.
    Sag,
    /// Age of a measurement when it arrives, or of both ways with --interface joint-pd, ms.
    Latency,
    /// Up to so much more, drawn for every packet, ms.
    Jitter,
    /// Share of packets that never arrive.
    Loss,
    /// Largest constant error of a joint's position, rad.
    EncoderOffset,
    /// Standard deviation of a joint's position, rad.
    EncoderNoise,
    /// Standard deviation of a joint's speed, rad/s.
    SpeedNoise,
    /// Reading of the foot sensors over the force.
    FootGain,
    /// Standard deviation of the foot sensors, N.
    FootNoise,
    /// Largest constant error of a foot sensor, N.
    FootBias,
    /// Standard deviation of a gyroscope's sample, rad/s.
    GyroNoise,
    /// Standard deviation of an accelerometer's sample, m/s².
    AccelerometerNoise,
    /// Standard deviation of the accelerometer's bias, m/s²; of the gyroscope's a fifth of the number, rad/s.
    ImuBias,
    /// Time constant of the ground, ms, or hard (2), firm (10), soft (20).
    Ground,
    /// The landing's ground is so much higher than known, m.
    GroundHeight,
}

/// One line of the table.
pub struct Row {
    /// Which.
    pub key: Key,
    /// Its name in `--plant` and in results; the unit stands in it where it is not SI.
    pub name: &'static str,
    /// What it is, with its unit.
    pub what: &'static str,
    /// Value of a nominal run; `None` where that is the robot's own.
    pub nominal: Option<f64>,
    /// What `--plant` takes.
    pub allowed: [f64; 2],
    /// What `--plant lab` draws from, evenly: A1, iCub.
    pub lab: [[f64; 2]; 2],
    /// Why this range.
    pub reason: &'static str,
}

/// Softness of the ground by name: time constant in ms, in which a contact that is pressed in comes back (MuJoCo's `solref`).
pub const GROUNDS: [(&str, f64); 3] = [("hard", 2.0), ("firm", 10.0), ("soft", 20.0)];

const BIG: f64 = 1e3;

macro_rules! rows {
    ($($key:ident $name:literal, $what:literal, $nominal:expr, $allowed:expr, $a1:expr, $icub:expr, $reason:literal;)*) => {
        /// All keys, in the order of [`Key`].
        pub const ROWS: [Row; COUNT] = [$(Row {
            key: Key::$key, name: $name, what: $what, nominal: $nominal, allowed: $allowed, lab: [$a1, $icub], reason: $reason,
        }),*];
    };
}

/// Number of keys.
pub const COUNT: usize = 27;

rows! {
    Mass "mass", "every mass, relative", Some(1.0), [0.1, 10.0], [0.95, 1.05], [0.97, 1.03],
        "CAD masses are known to a few percent";
    Payload "payload", "mass bolted to the trunk, kg; payload=KG@X,Y,Z puts it there", Some(0.0), [0.0, 50.0], [0.0, 2.0], [0.0, 1.0],
        "a computer, a lidar, a camera: 15 % of A1's weight";
    PayloadX "payload_x", "where it is bolted, base axes, m", Some(0.0), [-2.0, 2.0], [-0.05, 0.05], [-0.05, 0.05],
        "room on the trunk";
    PayloadY "payload_y", "the same", Some(0.0), [-2.0, 2.0], [-0.03, 0.03], [-0.05, 0.05], "room on the trunk";
    PayloadZ "payload_z", "the same", Some(0.0), [-2.0, 2.0], [0.0, 0.08], [0.0, 0.2], "on top of it";
    ComX "com_x", "the centre of mass is farther forward, m", Some(0.0), [-0.2, 0.2], [-0.02, 0.02], [-0.01, 0.01],
        "battery and cables; A1's URDF and paper differ by 1 cm";
    ComY "com_y", "the centre of mass is farther to the left, m", Some(0.0), [-0.2, 0.2], [-0.01, 0.01], [-0.005, 0.005],
        "the same, narrower";
    Friction "friction", "Coulomb coefficient of the ground", Some(0.6), [0.01, 5.0], [0.48, 0.72], [0.48, 0.72],
        "rubber on dry lab floors, a fifth to either side";
    JointFriction "joint_friction", "Coulomb friction of every joint, N m", None, [0.0, BIG], [0.1, 0.5], [0.0, 2.0],
        "gears cold and warm, new and worn; the URDF's 0.2 is a round number";
    Rotor "rotor", "rotor inertias, relative", Some(1.0), [0.0, 10.0], [0.7, 1.3], [0.7, 1.3],
        "nobody has published A1's; iCub's motors share joints";
    TorqueGain "torque_gain", "torque over what was asked for", Some(1.0), [0.1, 10.0], [0.9, 1.1], [0.95, 1.05],
        "torque constants of motors without torque sensors scatter by a tenth; iCub tracks torque by estimates";
    CurrentLag "current_lag_ms", "time constant of the torque, ms", Some(0.0), [0.0, 100.0], [0.2, 1.0], [1.0, 5.0],
        "current loops of motor boards; iCub's torque loop is slower";
    Sag "sag", "share of the supply voltage that is lost at 2 kW", Some(0.0), [0.0, 0.9], [0.0, 0.15], [0.0, 0.0],
        "a used lithium pack; iCub hangs on a cable";
    Latency "latency_ms", "age of a measurement when it arrives, or of both ways with --interface joint-pd, ms", Some(0.0), [0.0, 50.0],
        [1.0, 3.0], [1.0, 2.0], "bus, driver, scheduler";
    Jitter "jitter_ms", "up to so much more, drawn for every packet, ms", Some(0.0), [0.0, 50.0], [0.0, 1.0], [0.0, 1.0],
        "a scheduler without hard deadlines";
    Loss "loss", "share of packets that never arrive", Some(0.0), [0.0, 1.0], [0.0, 0.02], [0.0, 0.0],
        "a busy bus; iCub's is wired point to point";
    EncoderOffset "encoder_offset", "largest constant error of a joint's position, rad", Some(0.0), [0.0, 1.0], [0.0, 0.01], [0.0, 0.005],
        "zeroed against a stop by hand";
    EncoderNoise "encoder_noise", "standard deviation of a joint's position, rad", Some(0.0), [0.0, 1.0], [1e-3, 1e-3], [1e-4, 1e-4],
        "14 bit encoders behind gears with play";
    SpeedNoise "speed_noise", "standard deviation of a joint's speed, rad/s", Some(0.0), [0.0, 10.0], [0.05, 0.05], [0.01, 0.01],
        "differences of positions, filtered";
    FootGain "foot_gain", "reading of the foot sensors over the force", Some(1.0), [0.0, 10.0], [0.9, 1.1], [0.95, 1.05],
        "pressure in a rubber ball is no load cell; six-axis sensors are better";
    FootNoise "foot_noise", "standard deviation of the foot sensors, N", Some(0.0), [0.0, BIG], [0.0, 3.0], [0.0, 2.0],
        "the same";
    FootBias "foot_bias", "largest constant error of a foot sensor, N", Some(0.0), [0.0, BIG], [0.0, 3.0], [0.0, 5.0],
        "drift with temperature; paper B names it";
    GyroNoise "gyro_noise", "standard deviation of a gyroscope's sample, rad/s", Some(0.0), [0.0, 10.0], [0.01, 0.01], [0.01, 0.01],
        "MEMS at 1 kHz";
    AccelerometerNoise "accel_noise", "standard deviation of an accelerometer's sample, m/s²", Some(0.0), [0.0, 100.0], [0.1, 0.1], [0.1, 0.1],
        "MEMS at 1 kHz";
    ImuBias "imu_bias", "standard deviation of the accelerometer's bias, m/s²; of the gyroscope's a fifth of the number, rad/s", Some(0.0),
        [0.0, 10.0], [0.0, 0.1], [0.0, 0.1], "MEMS after a warm-up at rest";
    Ground "ground", "time constant of the ground, ms, or hard (2), firm (10), soft (20)", Some(2.0), [1.0, 100.0], [2.0, 20.0], [2.0, 20.0],
        "concrete to gym mats; 20 is MuJoCo's default";
    GroundHeight "ground_height", "the landing's ground is so much higher than known, m", Some(0.0), [-0.2, 0.2], [-0.02, 0.02], [-0.01, 0.01],
        "floors and boxes are measured by a finger's breadth";
}

impl Key {
    /// Its line.
    #[must_use]
    pub const fn row(self) -> &'static Row {
        &ROWS[self as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::{COUNT, ROWS};

    #[test]
    fn rows_stand_in_the_order_of_the_keys_and_ranges_are_allowed() {
        assert_eq!(ROWS.len(), COUNT);
        for (i, row) in ROWS.iter().enumerate() {
            assert_eq!(row.key as usize, i, "{}", row.name);
            let [low, high] = row.allowed;
            for [from, to] in row.lab {
                assert!(low <= from && from <= to && to <= high, "{}", row.name);
            }
            assert!(
                row.nominal.is_none_or(|x| low <= x && x <= high),
                "{}",
                row.name
            );
        }
    }
}
