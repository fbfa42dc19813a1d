//! Which simulator.

use core::str::FromStr;

use contact_sim::Compile;
#[cfg(feature = "mujoco")]
use contact_sim::linked;
#[cfg(not(feature = "mujoco"))]
use contact_sim::{Engine, NoEngine};

/// The simulators.
#[derive(Clone, Copy, Debug)]
pub enum Sim {
    /// Our own contact simulator.
    Native,
    /// MuJoCo, from where this says: [`Sim::MUJOCO`], or an interpreter's package.
    Mujoco(Compile),
}

impl Sim {
    /// All of them, also those that this build does not have.
    pub const ALL: [Self; 2] = [Self::Native, Self::MUJOCO];

    /// The MuJoCo that builds with the feature `mujoco` are linked with; others tell in its place how to get one.
    pub const MUJOCO: Self = Self::Mujoco(linked);

    /// Its name on the command line and in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Native => "native",
            Self::Mujoco(_) => "mujoco",
        }
    }

    /// What it is, in a line.
    #[must_use]
    pub const fn what(self) -> &'static str {
        match self {
            Self::Native => "Our own contact simulator",
            Self::Mujoco(_) => "MuJoCo, in builds with the feature `mujoco`",
        }
    }

    /// Fails where it is not there, before the work that needs it: MuJoCo compiles its smallest model.
    ///
    /// # Errors
    /// How to get it.
    pub fn check(self) -> Result<(), String> {
        match self {
            Self::Native => Ok(()),
            Self::Mujoco(compile) => compile("<mujoco/>")
                .map(|_| ())
                .map_err(|error| error.to_string()),
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
fn linked(_: &str) -> Result<Box<dyn Engine>, NoEngine> {
    let remedy = "this build has no MuJoCo: use `cargo xtask mujoco run --release -p saltus --features mujoco -- run ...`";
    Err(NoEngine::Missing(remedy.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::Sim;

    #[test]
    fn names_are_read_back() {
        for sim in Sim::ALL {
            let read: Result<Sim, String> = sim.name().parse();
            assert_eq!(read.map(Sim::name), Ok(sim.name()));
        }
        assert!("gazebo".parse::<Sim>().is_err());
    }
}
