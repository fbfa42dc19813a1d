//! What a URDF does not say of a robot, written down beside it: one TOML file.
//!
//! Everything but `urdf` may be missing; the rules for a URDF alone then hold. `models/a1.toml` is such a file, of the robot that is also
//! built in: a test holds both against each other.

use super::{Data, JOINTS, RobotError, hardware};
use crate::range::Range::{self, Above, From};
use crate::range::{Unusable, require, within};
use nalgebra::Vector3;
use rbd_core::{Budgets, Build, Motor};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Torques, N m.
const TORQUE: Range = Above(0.0, 1e4);
/// Speeds of joints, rad/s.
const SPEED: Range = Above(0.0, 1e3);
/// Lengths on a robot, m.
const SIZE: Range = Above(0.0, 10.0);
/// Half the thickness of a limb, as a share of the leg: a thicker one stands in the ground.
const LIMB: f64 = 0.5;
/// Inertias, kg m².
const INERTIA: Range = Above(0.0, 1e4);
/// Times, ms.
const TIME: Range = From(0.0, 1e4);

/// A profile as it is written down.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ProfileFile {
    /// Path of the URDF, seen from the file.
    urdf: String,
    /// Joints of the URDF that are locked, `JOINT=VALUE`.
    #[serde(default)]
    lock: Vec<String>,
    motors: Option<MotorsTable>,
    foot: Option<FootTable>,
    trunk: Option<TrunkTable>,
    #[serde(default)]
    limbs: LimbsTable,
    #[serde(default)]
    budgets: BudgetsTable,
    #[serde(default)]
    build: BuildTable,
}

/// Motors of a leg's joints, or one for all.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct MotorsTable {
    all: Option<MotorTable>,
    hip: Option<MotorTable>,
    thigh: Option<MotorTable>,
    calf: Option<MotorTable>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct MotorTable {
    #[serde(default = "one")]
    gear: f64,
    torque_nm: f64,
    corner_speed_rad_s: f64,
    no_load_speed_rad_s: f64,
    #[serde(default)]
    rotor_inertia_kgm2: f64,
}

const fn one() -> f64 {
    1.0
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct FootTable {
    radius_m: f64,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TrunkTable {
    size_m: [f64; 3],
    #[serde(default)]
    centre_m: [f64; 3],
}

/// Half the thickness of the limbs' capsules.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LimbsTable {
    pub(crate) shank_radius_m: Option<f64>,
    pub(crate) thigh_radius_m: Option<f64>,
    pub(crate) hip_radius_m: Option<f64>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct BudgetsTable {
    saturation_ms: Option<[f64; 3]>,
    stop_ms: Option<f64>,
    stop_torque_nm: Option<f64>,
    overspeed_ms: Option<f64>,
    ground_force_weights: Option<f64>,
    winding_heat_j: Option<f64>,
    torque_constant_nm_a: Option<f64>,
    resistance_ohm: Option<f64>,
    supply_power_w: Option<f64>,
}

/// What the controllers' gains follow from, where it is not what the tables of the robot say.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct BuildTable {
    mass_kg: Option<f64>,
    leg_length_m: Option<f64>,
    inertia_kgm2: Option<[f64; 3]>,
}

impl MotorTable {
    fn motor(&self, joint: &str) -> Result<Motor<f64>, Unusable> {
        let key = |name: &str| format!("motors.{joint}.{name}");
        within(self.gear, Above(0.0, 1e4), &key("gear"))?;
        within(self.torque_nm, TORQUE, &key("torque_nm"))?;
        let (corner, no_load) = (self.corner_speed_rad_s, self.no_load_speed_rad_s);
        within(corner, SPEED, &key("corner_speed_rad_s"))?;
        within(no_load, SPEED, &key("no_load_speed_rad_s"))?;
        require(
            no_load > corner,
            &key("no_load_speed_rad_s"),
            &format!("must be above corner_speed_rad_s, {corner}, not {no_load}"),
        )?;
        let rotor = self.rotor_inertia_kgm2;
        within(rotor, From(0.0, 1e3), &key("rotor_inertia_kgm2"))?;
        Ok(Motor {
            gear: self.gear,
            torque: self.torque_nm,
            corner_speed: corner,
            no_load_speed: no_load,
            rotor_inertia: rotor,
        })
    }
}

impl MotorsTable {
    /// The motor of every joint.
    fn motors(&self) -> Result<[Motor<f64>; JOINTS], Unusable> {
        let leg = match (self.all, self.hip, self.thigh, self.calf) {
            (Some(all), None, None, None) => [all.motor("all")?; 3],
            (None, Some(hip), Some(thigh), Some(calf)) => [
                hip.motor("hip")?,
                thigh.motor("thigh")?,
                calf.motor("calf")?,
            ],
            _ => {
                let what = "give either [motors.all] or all of hip, thigh and calf";
                return Err(("motors".to_owned(), what.to_owned()));
            }
        };
        Ok(core::array::from_fn(|i| leg[i % 3]))
    }
}

impl BudgetsTable {
    /// Budgets by rule, and what is written down instead.
    fn over(&self, rule: Budgets) -> Result<Budgets, Unusable> {
        let number = |key: &str, x: Option<f64>, range: Range, rule: f64| match x {
            Some(x) => within(x, range, &format!("budgets.{key}")).map(|()| x),
            None => Ok(rule),
        };
        let time = |key: &str, x: Option<f64>, rule: f64| {
            number(key, x, TIME, 1e3 * rule).map(|milliseconds| 1e-3 * milliseconds)
        };
        let mut saturation = rule.saturation;
        for (slot, x) in saturation
            .iter_mut()
            .zip(self.saturation_ms.iter().flatten())
        {
            *slot = time("saturation_ms", Some(*x), 0.0)?;
        }
        let any = Above(0.0, f64::INFINITY);
        let is_known = self.resistance_ohm.is_some() && self.torque_constant_nm_a.is_some();
        if self.winding_heat_j.is_some() && !is_known {
            let what = "is a budget of what motors lose in their windings: give resistance_ohm and torque_constant_nm_a too";
            return Err(("budgets.winding_heat_j".to_owned(), what.to_owned()));
        }
        Ok(Budgets {
            saturation,
            stop_time: time("stop_ms", self.stop_ms, rule.stop_time)?,
            stop_torque: number(
                "stop_torque_nm",
                self.stop_torque_nm,
                TORQUE,
                rule.stop_torque,
            )?,
            overspeed: time("overspeed_ms", self.overspeed_ms, rule.overspeed)?,
            ground_force: number(
                "ground_force_weights",
                self.ground_force_weights,
                Above(0.0, 1e3),
                rule.ground_force,
            )?,
            winding_heat: number(
                "winding_heat_j",
                self.winding_heat_j,
                any,
                rule.winding_heat,
            )?,
            torque_constant: number(
                "torque_constant_nm_a",
                self.torque_constant_nm_a,
                any,
                rule.torque_constant,
            )?,
            resistance: number("resistance_ohm", self.resistance_ohm, any, rule.resistance)?,
            supply_power: number(
                "supply_power_w",
                self.supply_power_w,
                any,
                rule.supply_power,
            )?,
        })
    }
}

impl ProfileFile {
    /// The profile in a file, and the path of its URDF.
    pub(crate) fn load(path: &Path) -> Result<(Self, PathBuf), RobotError> {
        let text = crate::file::read_text(path)?;
        let file: Self =
            toml::from_str(&text).map_err(|error| RobotError::Toml(Box::new(error)))?;
        let urdf = path.parent().unwrap_or(Path::new("")).join(&file.urdf);
        Ok((file, urdf))
    }

    /// Joints that it locks.
    pub(crate) fn locks(&self) -> &[String] {
        &self.lock
    }

    /// Puts what is written down in the place of what rules say; before shapes are made of it.
    pub(crate) fn apply(&self, data: &mut Data) -> Result<(), RobotError> {
        if let Some(table) = &self.motors {
            let motors = table.motors()?;
            for (limit, motor) in data.limits.iter_mut().zip(&motors) {
                // A joint gives what its motor gives, whatever the URDF says.
                limit.effort = motor.torque;
                // Nor faster than its motor, where the URDF has a placeholder or no speed limit.
                if !(limit.speed > 0.0 && limit.speed <= motor.no_load_speed) {
                    limit.speed = motor.no_load_speed;
                }
            }
            data.table = hardware::geared(&data.table, &motors)?;
            data.motors = Some(motors);
        }
        if let Some(foot) = self.foot {
            within(foot.radius_m, SIZE, "foot.radius_m")?;
            data.foot_radius = foot.radius_m;
        }
        if let Some(trunk) = self.trunk {
            for (size, centre) in trunk.size_m.iter().zip(trunk.centre_m) {
                within(*size, SIZE, "trunk.size_m")?;
                within(centre, From(-10.0, 10.0), "trunk.centre_m")?;
            }
            let half = Vector3::from(trunk.size_m) * 0.5;
            let centre = Vector3::from(trunk.centre_m);
            data.corners = hardware::corners(&half).map(|corner| centre + corner);
        }
        let thickest = Above(0.0, LIMB * data.leg_length);
        for (key, radius) in [
            ("limbs.shank_radius_m", self.limbs.shank_radius_m),
            ("limbs.thigh_radius_m", self.limbs.thigh_radius_m),
            ("limbs.hip_radius_m", self.limbs.hip_radius_m),
        ] {
            radius.map_or(Ok(()), |radius| within(radius, thickest, key))?;
        }
        data.limbs = self.limbs;
        let strongest = data.limits.iter().map(|limit| limit.effort);
        let strongest = strongest.fold(0.0, f64::max);
        data.budgets = self.budgets.over(hardware::budgets(strongest))?;
        data.build = self.build.known()?;
        Ok(())
    }
}

impl BuildTable {
    /// What is written down, looked at.
    fn known(&self) -> Result<KnownBuild, Unusable> {
        for (key, x, range) in [
            ("build.mass_kg", self.mass_kg, Above(0.0, 1e4)),
            ("build.leg_length_m", self.leg_length_m, SIZE),
        ] {
            x.map_or(Ok(()), |x| within(x, range, key))?;
        }
        for inertia in self.inertia_kgm2.iter().flatten() {
            within(*inertia, INERTIA, "build.inertia_kgm2")?;
        }
        Ok(KnownBuild {
            mass: self.mass_kg,
            leg_length: self.leg_length_m,
            inertia_b: self.inertia_kgm2,
        })
    }
}

/// What is known of a robot's build; the rest follows from its tables.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct KnownBuild {
    mass: Option<f64>,
    leg_length: Option<f64>,
    inertia_b: Option<[f64; 3]>,
}

impl KnownBuild {
    /// All of it.
    pub(crate) const fn all(build: &Build<f64>) -> Self {
        Self {
            mass: Some(build.mass),
            leg_length: Some(build.leg_length),
            inertia_b: Some(build.inertia_b),
        }
    }

    /// The build with what is known in the place of what the tables say.
    pub(crate) fn over(&self, rule: Build<f64>) -> Build<f64> {
        Build {
            mass: self.mass.unwrap_or(rule.mass),
            leg_length: self.leg_length.unwrap_or(rule.leg_length),
            inertia_b: self.inertia_b.unwrap_or(rule.inertia_b),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::super::{LEGS, Quadruped, State};
    use super::JOINTS;
    use rbd_core::Model;
    use std::path::{Path, PathBuf};

    fn models() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../models")
    }

    /// The built-in robot and the file say the same.
    #[test]
    fn the_file_of_a1_is_the_built_in_robot() {
        let built_in = Quadruped::a1().unwrap();
        let read = Quadruped::load(&models().join("a1.toml"), &[]).unwrap();
        let [read_motor, motor] = [&read, &built_in].map(|robot| robot.drives()[0]);
        assert_eq!(read.drives(), [read_motor; JOINTS]);
        assert_eq!(
            (read_motor.gear, read_motor.torque),
            (motor.gear, motor.torque)
        );
        assert_eq!(read_motor.rotor_inertia, motor.rotor_inertia);
        assert!((read_motor.corner_speed - motor.corner_speed).abs() < 1e-3);
        assert!((read_motor.no_load_speed - motor.no_load_speed).abs() < 1e-3);
        let [a, b] = [read.budgets, built_in.budgets].map(|budgets| format!("{budgets:.4?}"));
        assert_eq!(a, b);
        assert_eq!(read.foot_radius, built_in.foot_radius);
        let standing = State {
            joints: built_in.seed,
            ..State::NEUTRAL
        };
        assert_eq!(read.build(&standing), built_in.build(&standing));
        assert!((read.mass() - built_in.mass()).abs() < 1e-12);
        let limits = [&read, &built_in].map(|robot| *Model::<f64, JOINTS>::limits(robot));
        assert_eq!(limits[0], limits[1]);
        for leg in 0..LEGS {
            assert_eq!(read.shapes[leg], built_in.shapes[leg], "foot {leg}");
            for kind in 1..4 {
                let i = kind * LEGS + leg;
                assert_eq!(read.shapes[i].radius, built_in.shapes[i].radius, "{i}");
            }
        }
    }

    /// Errors name the key, what it was and what it may be.
    #[test]
    fn a_value_that_cannot_be_is_named() {
        let text = std::fs::read_to_string(models().join("a1.toml")).unwrap();
        let folder = std::env::temp_dir().join(format!("profile-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::copy(models().join("a1.urdf"), folder.join("a1.urdf")).unwrap();
        for (from, to, words) in [
            (
                "torque_nm = 33.5",
                "torque_nm = -1.0",
                ["motors.all.torque_nm", "-1"],
            ),
            (
                "torque_nm = 33.5",
                "torque_nm = nan",
                ["motors.all.torque_nm", "NaN"],
            ),
            ("[motors.all]", "[motors.hip]", ["motors", "thigh"]),
            (
                "radius_m = 0.02\n",
                "radius_m = 0\n",
                ["foot.radius_m", "above 0"],
            ),
            (
                "hip_radius_m = 0.041",
                "hip_radius_m = 0.21",
                ["limbs.hip_radius_m", "up to 0.2"],
            ),
            (
                "stop_ms = 10",
                "stop_ms = -1",
                ["budgets.stop_ms", "from 0"],
            ),
            (
                "resistance_ohm",
                "# resistance_ohm",
                ["budgets.winding_heat_j", "give resistance_ohm"],
            ),
            ("mass_kg", "mass", ["mass_kg", "line"]),
            (
                "urdf = \"a1.urdf\"",
                "urdf = \"none.urdf\"",
                ["none.urdf", ""],
            ),
        ] {
            assert!(text.contains(from), "{from}");
            let path = folder.join("bad.toml");
            std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
            let error = Quadruped::load(&path, &[])
                .map(|_| ())
                .unwrap_err()
                .to_string();
            for word in words {
                assert!(error.contains(word), "{to}: {error}");
            }
        }
        std::fs::remove_dir_all(folder).unwrap();
    }
}
