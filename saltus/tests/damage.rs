//! Stored plans whose checksum was mended after a word was changed: values are looked at, not only bytes.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use jump_control::container::{Header, PREFIX, PlanNode};

/// Bytes of a node of A1.
const NODE: usize = PlanNode::<12, 4>::BYTES;
/// Its numbers; the phase stands before them.
const WORDS: usize = NODE / 4 - 1;

fn saltus(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_saltus"));
    let output = command
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    let said = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
    (output.status.code(), said)
}

/// CRC-32 (ISO-HDLC) of everything but the checksum.
fn mend(bytes: &mut [u8]) {
    let mut sum = u32::MAX;
    for (i, byte) in bytes.iter().enumerate() {
        if (20..PREFIX).contains(&i) {
            continue;
        }
        sum ^= u32::from(*byte);
        for _ in 0..8 {
            sum = (sum >> 1) ^ if sum & 1 == 1 { 0xedb8_8320 } else { 0 };
        }
    }
    bytes[20..PREFIX].copy_from_slice(&(!sum).to_le_bytes());
}

struct Plan {
    folder: PathBuf,
    bytes: Vec<u8>,
    nodes: usize,
}

impl Plan {
    fn new(test: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("damage-{test}"));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        let (code, said) = saltus(&folder, &["plan", "a1/lateral", "--out", "plan"]);
        assert_eq!(code, Some(0), "{said}");
        let bytes = fs::read(folder.join("plan/plan.bin")).unwrap();
        let nodes = (bytes.len() - PREFIX - Header::<12>::BYTES) / NODE;
        Self {
            folder,
            bytes,
            nodes,
        }
    }

    /// Where number `word` of a node stands.
    fn node_word(&self, node: usize, word: usize) -> usize {
        self.bytes.len() - (self.nodes - node) * NODE + 4 * (1 + word)
    }

    /// The plan with one word changed.
    fn write(&self, at: usize, change: impl FnOnce(f32) -> f32) {
        let mut bytes = self.bytes.clone();
        let word: [u8; 4] = bytes[at..at + 4].try_into().unwrap();
        let changed = change(f32::from_le_bytes(word));
        bytes[at..at + 4].copy_from_slice(&changed.to_le_bytes());
        mend(&mut bytes);
        fs::write(self.folder.join("damaged.bin"), bytes).unwrap();
    }

    fn refuses(&self, command: &str, what: &str) {
        let (code, said) = saltus(&self.folder, &[command, "damaged.bin"]);
        assert_eq!(code, Some(2), "{command}, {what}: {said}");
        assert!(
            !said.contains("checksum does not fit"),
            "{what}: the test does not mend"
        );
    }
}

/// By how much a word of a node is changed: what it means decides what shows.
fn much(word: usize) -> f32 {
    match word {
        // Time, place, rotation; velocities of the base; joints; their velocities.
        0 => 0.05,
        1..4 => 2e-4,
        4..13 => 0.01,
        13..19 => 0.05,
        19..31 => 5e-4,
        31..43 => 0.05,
        // Torques, forces; feet; their velocities.
        43..55 => 0.1,
        55..67 => 1.0,
        67..79 => 5e-4,
        _ => 5e-3,
    }
}

#[test]
fn damage_of_a_node_under_a_mended_checksum_is_refused() {
    let plan = Plan::new("nodes");
    // As it is, it passes, so that what follows is the change's doing.
    plan.write(plan.node_word(5, 0), |x| x);
    assert_eq!(saltus(&plan.folder, &["verify", "damaged.bin"]).0, Some(0));
    // Nothing sums up what stands behind a plan.
    fs::write(
        plan.folder.join("damaged.bin"),
        [&plan.bytes[..], b"more"].concat(),
    )
    .unwrap();
    for command in ["verify", "run"] {
        plan.refuses(command, "bytes behind it");
    }
    let (_, said) = saltus(&plan.folder, &["verify", "damaged.bin"]);
    assert!(said.contains("4 bytes stand behind"), "{said}");
    for i in 0..100 {
        let (node, word) = (i * (plan.nodes - 1) / 99, i * 37 % WORDS);
        let at = plan.node_word(node, word);
        for (name, bad) in [("NaN", f32::NAN), ("1e30", 1e30), ("more", much(word))] {
            plan.write(at, |x| if name == "more" { x + bad } else { bad });
            plan.refuses("verify", &format!("{name} in word {word} of node {node}"));
        }
    }
    // What is refused is not executed either.
    plan.write(plan.node_word(20, 45), |_| 1e6);
    plan.refuses("run", "a torque of a million");
    assert!(!plan.folder.join("out/a1-lateral").exists());
}

/// Where each word of the header stands, as the container's own description says, and by how much it is changed. What only the task knows
/// is compared with it.
const HEADER: [(&str, usize, f32); 21] = [
    ("takeoff", 348, 0.01),
    ("posing", 352, -0.01),
    ("touchdown", 356, 0.01),
    ("duration of a phase", 364, 0.01),
    ("duration of the flight", 372, 0.01),
    ("duration of no phase", 380, 0.01),
    ("drop", 428, 0.01),
    ("edge", 432, 0.01),
    ("friction", 436, 0.1),
    ("share of friction", 440, 0.01),
    ("largest force", 444, 1.0),
    ("share of torque", 448, 0.05),
    ("share of speed", 452, 0.05),
    ("weight", 456, 0.1),
    ("goal", 460, 0.01),
    ("goal", 464, 0.01),
    ("goal", 468, 0.01),
    ("heading", 472, 0.01),
    ("landing posture", 476, 0.01),
    ("landing posture", 484, 0.01),
    ("landing posture", 520, -0.01),
];

/// Bytes of the header: name of the robot, what torques do between nodes, phases and nodes in use, feet of both phases, and what has no meaning.
const BYTES: [usize; 11] = [280, 281, 344, 345, 346, 360, 361, 368, 424, 425, 426];

#[test]
fn damage_of_the_header_under_a_mended_checksum_is_refused() {
    let plan = Plan::new("header");
    for (name, at, more) in HEADER {
        plan.write(at, |x| x + more);
        plan.refuses("verify", name);
        plan.refuses("run", name);
    }
    for at in BYTES {
        let mut bytes = plan.bytes.clone();
        bytes[at] ^= 1;
        mend(&mut bytes);
        fs::write(plan.folder.join("damaged.bin"), bytes).unwrap();
        plan.refuses("verify", &format!("byte {at}"));
    }
    assert!(!plan.folder.join("out/a1-lateral").exists());
}

/// A plan whose task is not here passes, and says what it was not compared with.
#[test]
fn a_plan_without_its_task_is_told() {
    let plan = Plan::new("alone");
    let mut bytes = plan.bytes.clone();
    bytes[25] = b'b';
    mend(&mut bytes);
    fs::write(plan.folder.join("damaged.bin"), bytes).unwrap();
    let (code, said) = saltus(&plan.folder, &["verify", "damaged.bin"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(
        said.contains("not compared") && said.contains("b1/lateral"),
        "{said}"
    );
}
