//! No test file is left out of its crate's program, `tests/all.rs`: cargo would not miss it.

use std::fs;
use std::path::{Path, PathBuf};

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Names of the files in a crate's `tests` that are neither modules of its program nor programs of their own.
fn left_out(tests: &Path, manifest: &str) -> Vec<String> {
    let program = fs::read_to_string(tests.join("all.rs")).unwrap();
    let files = fs::read_dir(tests)
        .unwrap()
        .map(|file| file.unwrap().path());
    let sources = files.filter(|file| file.extension().is_some_and(|end| end == "rs"));
    let names = sources.map(|file| file.file_stem().unwrap().to_str().unwrap().to_owned());
    names
        .filter(|name| {
            let module = format!("mod {name};");
            !program.lines().any(|line| line == module)
                && !manifest.contains(&format!("name = \"{name}\""))
        })
        .collect()
}

#[test]
fn every_test_file_is_in_a_program() {
    let mut programs = 0;
    for folder in fs::read_dir(workspace()).unwrap() {
        let folder = folder.unwrap().path();
        let tests = folder.join("tests");
        if !tests.join("all.rs").exists() {
            continue;
        }
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        assert_eq!(
            left_out(&tests, &manifest),
            Vec::<String>::new(),
            "{}",
            folder.display()
        );
        programs += 1;
    }
    assert_eq!(programs, 17, "crates with one program of tests");
}
