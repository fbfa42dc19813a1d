//! What [`MujocoSimulator`](crate::MujocoSimulator) asks of MuJoCo, whoever calls its library: a program that is linked with it, or an
//! interpreter whose package it is.

use core::fmt;
use std::boxed::Box;
use std::string::String;

/// A model that MuJoCo has compiled, with its state. Arrays are MuJoCo's own, in its order and conventions.
pub trait Engine: fmt::Debug {
    /// The id of the geom of this name.
    fn geom_id(&self, name: &str) -> Option<usize>;

    /// Forgets everything (`mj_resetData`), and puts the positions `qpos`, of `nq`, and the velocities `qvel`, of `nv`, in place.
    fn reset(&mut self, qpos: &[f64], qvel: &[f64]);

    /// Computes what follows from the state (`mj_forward`), with the generalised forces `applied`, N and N m, of `nv`; none where the slice
    /// is shorter.
    ///
    /// # Errors
    /// [`EngineFailed`], of which the engine has told its user more.
    fn forward(&mut self, applied: &[f64]) -> Result<(), EngineFailed>;

    /// Takes one time step (`mj_step`), with generalised forces as in [`forward`](Self::forward).
    ///
    /// # Errors
    /// [`EngineFailed`], of which the engine has told its user more.
    fn step(&mut self, applied: &[f64]) -> Result<(), EngineFailed>;

    /// Positions, `nq`.
    fn qpos(&self) -> &[f64];

    /// Velocities, `nv`.
    fn qvel(&self) -> &[f64];

    /// Accelerations of the last call, `nv`.
    fn qacc(&self) -> &[f64];

    /// What the sensors tell, one behind the other.
    fn sensordata(&self) -> &[f64];

    /// Contacts of the last step.
    fn contacts(&self) -> &[ContactPoint];
}

/// A contact between two geoms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// Ids of the geoms; negative for what is none.
    pub geoms: [i32; 2],
    /// Axes of the contact in the world, one behind the other: the normal, from the first geom to the second, and two tangents.
    pub frame: [f64; 9],
    /// Force on the second geom along these axes, N, and its torque, N m (`mj_contactForce`).
    pub force: [f64; 6],
}

/// Compiles a text in MuJoCo's format (MJCF): where MuJoCo comes from.
///
/// # Errors
/// [`NoEngine`]: why there is none.
pub type Compile = fn(mjcf: &str) -> Result<Box<dyn Engine>, NoEngine>;

/// MuJoCo stopped in a call with an error of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EngineFailed;

/// Why a model has no engine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoEngine {
    /// There is no MuJoCo: a sentence that names the remedy.
    Missing(String),
    /// MuJoCo refused the model, in its own words.
    Refused(String),
}

impl fmt::Display for NoEngine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing(remedy) => f.write_str(remedy),
            Self::Refused(words) => write!(f, "MuJoCo refused the model: {words}"),
        }
    }
}

impl core::error::Error for NoEngine {}
