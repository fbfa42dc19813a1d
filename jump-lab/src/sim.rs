//! Which simulator.

use core::str::FromStr;

/// The simulators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sim {
    /// Our own contact simulator.
    Native,
    /// MuJoCo, in builds with the feature `mujoco`.
    Mujoco,
}

impl Sim {
    /// All of them, also those that this build does not have.
    pub const ALL: [Self; 2] = [Self::Native, Self::Mujoco];

    /// Its name on the command line and in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Native => "native",
            Self::Mujoco => "mujoco",
        }
    }

    /// What it is, in a line.
    #[must_use]
    pub const fn what(self) -> &'static str {
        match self {
            Self::Native => "Our own contact simulator",
            Self::Mujoco => "MuJoCo, in builds with the feature `mujoco`",
        }
    }

    /// Fails where this build does not have it, before the work that needs it.
    ///
    /// # Errors
    /// How to get a build that has it.
    pub fn check(self) -> Result<(), String> {
        match self {
            #[cfg(not(feature = "mujoco"))]
            Self::Mujoco => Err(NO_MUJOCO.to_owned()),
            _ => Ok(()),
        }
    }
}

impl FromStr for Sim {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|sim| sim.name() == name);
        found.ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            format!("no simulator `{name}`; there are {names}")
        })
    }
}

/// What a build without MuJoCo says.
#[cfg(not(feature = "mujoco"))]
pub(crate) const NO_MUJOCO: &str = "this build has no MuJoCo: use `cargo xtask mujoco run --release -p saltus --features mujoco -- run ...`";

#[cfg(test)]
mod tests {
    use super::Sim;

    #[test]
    fn names_are_read_back() {
        for sim in Sim::ALL {
            assert_eq!(sim.name().parse(), Ok(sim));
        }
        assert!("gazebo".parse::<Sim>().is_err());
    }
}
