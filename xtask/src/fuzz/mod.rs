//! `cargo xtask fuzz`: hostile files and command lines, made of the repository's own, until the time is over.
//!
//! Every answer must come within a minute of processor time and 8 GiB, with a documented exit code, a word where it is a refusal, no panic,
//! and nothing half made. What breaks that is written to `target/fuzz`, as a folder that `saltus/tests/kept` takes as it is.

mod mutate;
mod trial;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, ensure};

use crate::random::Random;
use crate::run;
use mutate::{VALUES, mutate};
use trial::Trial;

/// Arguments of `cargo xtask fuzz`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// How long.
    #[arg(long, default_value_t = 1.0)]
    minutes: f64,
    /// What is drawn: the same seed gives the same trials, as many as there is time for.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The program, instead of one that is built here with overflow checks.
    #[arg(long)]
    program: Option<PathBuf>,
}

/// Files of the repository that are changed, by the kind that stands in [`COMMANDS`].
const SEEDS: &[(&str, &str)] = &[
    ("TASK", "jump-planner/tasks/a1/lateral.toml"),
    ("TASK", "jump-planner/tasks/a1/lateral-down.toml"),
    ("TASK", "jump-planner/tasks/a1/spin-90.toml"),
    ("TASK", "jump-planner/tasks/a1/barrel-roll-box.toml"),
    ("PROBLEM", "reference-problems/data/a1-jumps.json"),
    ("SRB", "reference-problems/data/srb/spin.json"),
    ("ROBOT", "models/a1.urdf"),
    ("EXPECTED", "jump-planner/tasks/expected.toml"),
];

/// An MJCF: the repository has none.
const MJCF: &str = r#"<mujoco model="arm"><compiler angle="degree"/>
<default><joint damping="0.5"/><default class="stiff"><joint armature="0.1" range="-90 45"/></default></default>
<worldbody><geom type="plane" size="1 1 1"/>
<body name="trunk" pos="0 0 1"><freejoint name="root"/>
<geom name="hull" type="box" size="0.1 0.2 0.3" density="500"/>
<body name="upper" pos="0.1 0 0" childclass="stiff">
<joint name="shoulder" axis="0 1 0" frictionloss="2"/>
<joint name="reach" type="slide" axis="0 0 1" range="0 0.5" pos="0 0 0.1"/>
<inertial pos="0 0 0" mass="2" diaginertia="0.1 0.1 0.1"/>
</body></body></worldbody></mujoco>
"#;

/// Command lines: words in capitals are files. Those that would work for minutes when nothing is wrong have a target that is taken.
const COMMANDS: &[&str] = &[
    "plan TASK",
    "plan TASK --json --out new",
    "plan a1/lateral --robot ROBOT",
    "plan --problem PROBLEM --reference spin",
    "plan --problem PROBLEM --reference spin --stage whole-body",
    "plan --problem PROBLEM --reference lateral_down --solution new.json",
    "plan --reference spin --stage whole-body --srb SRB",
    "verify PLAN",
    "verify PLAN --json",
    "verify PLAN --robot ROBOT",
    "run TASK --out TASK",
    "run PLAN --out PLAN",
    "run PLAN --task TASK --out PLAN",
    "import ROBOT",
    "import ROBOT --out new",
    "import MJCF --out new --base fixed",
    "import MJCF --json",
    "verdicts --expect EXPECTED TASK",
    "watch TASK",
    "watch TASK ROBOT --no-open --out new",
    "reproduce --quick --expect EXPECTED --out EXPECTED",
    "envelope TASK --out TASK",
    "completions bash",
];

/// Everything that trials are made of.
struct Material {
    seeds: Vec<(&'static str, Vec<u8>)>,
    /// Subcommands with the options that their help names.
    options: Vec<(String, Vec<String>)>,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let program = match &args.program {
        Some(program) => program.canonicalize().context("--program")?,
        None => build()?,
    };
    let folder = run::root().join("target/fuzz");
    run::remove_folder(&folder)?;
    fs::create_dir_all(&folder)?;
    let material = Material::new(&program, &folder)?;
    let start = Instant::now();
    let (mut trials, mut found, mut slowest) = (0_u64, 0, 0.0_f64);
    let mut codes = [0_u64; 3];
    while start.elapsed().as_secs_f64() < 60.0 * args.minutes {
        let mut random = Random(args.seed.wrapping_mul(1 << 32).wrapping_add(trials));
        let trial = material.draw(&mut random);
        let answer = trial.run(&program, &folder.join("trial"))?;
        slowest = slowest.max(answer.seconds);
        let code = answer.code.and_then(|code| usize::try_from(code).ok());
        if let Some(count) = code.and_then(|code| codes.get_mut(code)) {
            *count += 1;
        }
        if let Some(complaint) = answer.complaint {
            let kept = folder.join(format!("seed-{}-{trials}", args.seed));
            trial.write(&kept)?;
            println!("{}: {complaint}\n  {}", kept.display(), trial.shown());
            found += 1;
        }
        trials += 1;
        if trials.is_multiple_of(100) {
            println!("{trials} trials");
        }
    }
    println!(
        "{trials} trials of seed {} in {:.0} s: exit codes 0, 1, 2 {codes:?} times, slowest {slowest:.1} s, {found} broke a promise",
        args.seed,
        start.elapsed().as_secs_f64()
    );
    ensure!(found == 0, "{found} trials broke a promise: see above");
    Ok(())
}

/// The program of a debug build.
fn build() -> Result<PathBuf> {
    let mut cargo = run::cargo();
    cargo.args(["build", "-p", "saltus", "--message-format=json"]);
    let messages = run::stdout(&mut cargo)?;
    let program = run::executables(&messages).next();
    program.context("cargo built no program")
}

impl Material {
    fn new(program: &Path, folder: &Path) -> Result<Self> {
        let mut seeds = Vec::new();
        for (kind, path) in SEEDS {
            let bytes = fs::read(run::root().join(path)).with_context(|| (*path).to_owned())?;
            seeds.push((*kind, bytes));
        }
        seeds.push(("MJCF", MJCF.as_bytes().to_vec()));
        let saltus = |arguments: &[&str]| {
            let mut command = std::process::Command::new(program);
            run::stdout(command.args(arguments).current_dir(folder))
        };
        saltus(&["plan", "a1/lateral", "--out", "seed-plan"])?;
        seeds.push(("PLAN", fs::read(folder.join("seed-plan/plan.bin"))?));
        let mut options = Vec::new();
        for line in COMMANDS {
            let name = line.split(' ').next().unwrap_or_default();
            if options.iter().any(|(known, _)| known == name) {
                continue;
            }
            let help = saltus(&[name, "--help"])?;
            let words = help.split(|c: char| !c.is_ascii_alphanumeric() && c != '-');
            let long = words.filter(|word| word.starts_with("--") && word.len() > 2);
            options.push((name.to_owned(), long.map(str::to_owned).collect()));
        }
        Ok(Self { seeds, options })
    }

    /// A command line and its files.
    fn draw(&self, random: &mut Random) -> Trial {
        let line = random.of(COMMANDS).copied().unwrap_or_default();
        let mut trial = Trial {
            arguments: Vec::new(),
            files: Vec::new(),
        };
        for word in line.split(' ') {
            let word = self.word(word, &mut trial, random);
            trial.arguments.push(word);
        }
        if random.once_in(3) {
            self.disturb(&mut trial, random);
        }
        trial
    }

    /// A word of a command line; a file is written for one in capitals, once for each.
    fn word(&self, word: &str, trial: &mut Trial, random: &mut Random) -> Vec<u8> {
        let of_kind: Vec<&[u8]> = (self.seeds.iter())
            .filter(|(kind, _)| *kind == word)
            .map(|(_, bytes)| bytes.as_slice())
            .collect();
        let Some(seed) = random.of(&of_kind) else {
            return word.as_bytes().to_vec();
        };
        let ending = match word {
            "TASK" | "EXPECTED" => "toml",
            "PROBLEM" | "SRB" => "json",
            "ROBOT" => "urdf",
            "MJCF" => "xml",
            _ => "bin",
        };
        let name = format!("{}.{ending}", word.to_ascii_lowercase());
        if !trial.files.iter().any(|(known, _)| *known == name) {
            let others: Vec<&[u8]> = self.seeds.iter().map(|(_, x)| x.as_slice()).collect();
            trial
                .files
                .push((name.clone(), mutate(seed, &others, random)));
        }
        name.into_bytes()
    }

    /// A command line with one more option, or with another word. Targets that are taken stay: work that is right may take minutes.
    fn disturb(&self, trial: &mut Trial, random: &mut Random) {
        let taken = trial.taken_target();
        let arguments = &mut trial.arguments;
        let name = arguments.first().cloned().unwrap_or_default();
        let options = self
            .options
            .iter()
            .find(|(known, _)| known.as_bytes() == name);
        let option = options.and_then(|(_, all)| random.of(all)).cloned();
        let value = random.of(VALUES).copied().unwrap_or_default();
        // No argument holds a zero byte.
        let value = value.replace('\0', "\u{1}").into_bytes();
        let at = random.below(arguments.len());
        let may_change = at > 0 && taken != Some(at);
        match random.below(4) {
            0 if may_change => arguments[at] = value,
            1 if may_change => arguments[at] = vec![0xff, b'x'],
            _ => {
                arguments.extend(option.map(String::into_bytes));
                if random.once_in(2) {
                    arguments.push(value);
                }
            }
        }
    }
}

impl Trial {
    /// The place of the argument that names a target which is there already.
    fn taken_target(&self) -> Option<usize> {
        let target = 1 + self.arguments.iter().position(|word| word == b"--out")?;
        let name = self.arguments.get(target)?;
        let is_there = |(file, _): &(String, Vec<u8>)| file.as_bytes() == name;
        self.files.iter().any(is_there).then_some(target)
    }

    /// For people.
    fn shown(&self) -> String {
        let words = self
            .arguments
            .iter()
            .map(|word| String::from_utf8_lossy(word));
        let words: Vec<String> = words.map(|word| format!("{word:?}")).collect();
        format!("saltus {}", words.join(" "))
    }
}
