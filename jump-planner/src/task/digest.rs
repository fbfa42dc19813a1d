//! What tells two tasks of one name apart.

use super::Task;
use core::fmt::{self, Write};
use jump_control::Crc32;

/// Text that is summed up instead of kept.
struct Sum(Crc32);

impl Write for Sum {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0 = self.0.with(text.as_bytes());
        Ok(())
    }
}

impl Task {
    /// CRC-32 of all that is planned, simulated and judged by: every value of the task and of its robot, of its hardware too, but not the task's name. Tasks
    /// with different ones are different tasks, whatever their files are called.
    ///
    /// Numbers are summed up as the shortest decimals that read back as they are, so that the same task has the same digest on every machine.
    #[must_use]
    pub fn digest(&self) -> u32 {
        // Field by field, so that a new one cannot be forgotten.
        let Self {
            name: _,
            robot,
            problem,
            start,
            folding,
            goal,
            heading,
            rot_goal,
            edge,
            trunk_may_touch,
            limits,
            weights,
        } = self;
        let mut sum = Sum(Crc32::START);
        // A sum takes any text.
        let _ = write!(sum, "{robot:?} {problem:?} {start:?} {folding:?}");
        let _ = write!(sum, "{goal:?} {heading:?} {rot_goal:?} {edge:?}");
        let _ = write!(sum, "{trunk_may_touch:?} {limits:?} {weights:?}");
        sum.0.value()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use crate::robot::Quadruped;
    use crate::task::Task;
    use crate::task::file::{BUILT_IN, TaskFile};
    use std::path::Path;

    fn task(name: &str, text: &str) -> Task {
        let file = TaskFile::parse(Path::new(name), text).unwrap();
        Task::from_file(name, &file, Quadruped::a1().unwrap()).unwrap()
    }

    /// What a plan says, what only judges and simulators know, and the robot's hardware; a name and a comment are nothing of it.
    #[test]
    fn a_digest_tells_tasks_apart_by_all_but_their_names() {
        let (name, text) = BUILT_IN[0];
        let known = task(name, text).digest();
        assert_eq!(
            task("other.toml", &format!("# words\n{text}")).digest(),
            known
        );
        let changed = [
            text.replacen("0.3, 0.0]", "0.31, 0.0]", 1),
            format!("trunk_may_touch = true\n{text}"),
            format!("{text}\n[limits]\nfriction = 0.61\nfriction_share = 0.75\n"),
            format!("{text}\n[limits]\nspeed_share = 0.71\n"),
            format!("{text}\n[weights]\nomega = 0.0100001\n"),
        ];
        for other in changed {
            assert_ne!(other, text);
            assert_ne!(task(name, &other).digest(), known, "{other}");
        }
    }

    /// What only judges and simulators know of a robot counts too.
    #[test]
    fn a_digest_tells_robots_apart_by_their_hardware() {
        let (name, text) = BUILT_IN[0];
        let file = TaskFile::parse(Path::new(name), text).unwrap();
        let a1 = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/a1.toml");
        let profile = std::fs::read_to_string(&a1).unwrap();
        let folder = std::env::temp_dir().join(format!("digest-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::copy(a1.with_file_name("a1.urdf"), folder.join("a1.urdf")).unwrap();
        let digest = |from: &str, to: &str| {
            assert!(profile.contains(from), "{from}");
            let path = folder.join("a1.toml");
            std::fs::write(&path, profile.replacen(from, to, 1)).unwrap();
            let robot = Quadruped::load(&path, &[]).unwrap();
            Task::from_file(name, &file, robot).unwrap().digest()
        };
        let known = digest("", "# words\n");
        let hardware = [
            ("ground_force_weights = 10", "ground_force_weights = 11"),
            ("gear = 9.0", "gear = 9.1"),
            ("hip_radius_m = 0.041", "hip_radius_m = 0.04"),
            ("mass_kg = 13.741", "mass_kg = 13.742"),
        ];
        for (from, to) in hardware {
            assert_ne!(digest(from, to), known, "{to}");
        }
        std::fs::remove_dir_all(folder).unwrap();
    }
}
