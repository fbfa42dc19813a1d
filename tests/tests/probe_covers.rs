//! Every public function of the ground floor is called by the probe, so that the link proof, the comparison with
//! boards and the allocation count speak of all of them: a function added without a call in `firmware/probe` fails here.
//!
//! Functions are matched by name, so a name that two types share counts for both.

#![allow(clippy::panic, reason = "tests")]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Functions that fill `static` tables while the compiler runs, and never run on a target.
const COMPILE_TIME: [&str; 6] = [
    "bodies_f32",
    "frames_f32",
    "limits_f32",
    "motors_f32",
    "to_f32",
    "with_rotors",
];

/// Functions that the probe calls only through others.
const INSIDE: [(&str, &str); 5] = [
    ("is_ball", "by the simulator's contacts"),
    ("walk", "by every algorithm on a TableModel"),
    ("row", "hidden; by every const model"),
    ("down", "hidden; by every const model"),
    ("limbs_abreast", "hidden; by every const model"),
];

/// The text of every Rust file below `folder` of the workspace, one after the other.
fn sources(folder: &Path) -> String {
    let entries = fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let paths = entries.flatten().map(|entry| entry.path());
    paths
        .map(|path| match path.extension() {
            None => sources(&path),
            Some(_) => fs::read_to_string(&path).unwrap_or_default(),
        })
        .collect()
}

fn words(text: &str) -> BTreeSet<&str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_')
        .collect()
}

/// Names of the public functions in a crate's text: written out, or made by the door of `so3::math`.
fn public_functions(text: &str) -> BTreeSet<&str> {
    text.lines()
        .map(str::trim)
        .filter_map(|line| {
            let written = ["pub fn ", "pub const fn "]
                .iter()
                .find_map(|x| line.strip_prefix(x));
            let word = match written {
                Some(rest) => rest.split(['(', '<']).next(),
                None => line.split_once(" => libm_").map(|(name, _)| name),
            };
            word.filter(|word| !word.is_empty() && !word.starts_with('$'))
        })
        .collect()
}

#[test]
fn the_probe_calls_every_public_function() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let probe = sources(&root.join("firmware/probe/src"));
    let called = words(&probe);
    for (name, least) in [("so3", 50), ("rbd-core", 80)] {
        let text = sources(&root.join(name).join("src"));
        let public = public_functions(&text);
        assert!(
            public.len() > least,
            "only {} functions found in {name}",
            public.len()
        );
        let missing: Vec<_> = public
            .into_iter()
            .filter(|name| !called.contains(name) && !COMPILE_TIME.contains(name))
            .filter(|name| INSIDE.iter().all(|(inside, _)| inside != name))
            .collect();
        assert!(
            missing.is_empty(),
            "firmware/probe calls none of these of {name}: {missing:?}"
        );
    }
}

#[test]
fn a_function_that_is_not_called_would_be_seen() {
    let text =
        "    pub fn forgotten<T>(x: T) {}\n    sqrt => libm_sqrt;\npub(crate) fn hidden() {}\n";
    assert_eq!(
        public_functions(text),
        BTreeSet::from(["forgotten", "sqrt"])
    );
    assert!(!words("on.call(\"aba\", aba)").contains("forgotten"));
}
