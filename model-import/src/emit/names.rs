//! From names in a URDF to names in Rust.

use std::collections::BTreeSet;

/// Strict and reserved keywords of all editions (The Rust Reference, "Keywords").
const KEYWORDS: [&str; 52] = [
    "Self", "abstract", "as", "async", "await", "become", "box", "break", "const", "continue",
    "crate", "do", "dyn", "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if",
    "impl", "in", "let", "loop", "macro", "match", "mod", "move", "mut", "override", "priv", "pub",
    "ref", "return", "self", "static", "struct", "super", "trait", "true", "try", "type", "typeof",
    "unsafe", "unsized", "use", "virtual", "where", "while", "yield",
];

/// `FL_hip-joint` to `FL_HIP_JOINT`: an upper-case identifier.
#[must_use]
pub fn constant(name: &str) -> String {
    let word = |c: char| {
        if c.is_ascii_alphanumeric() {
            c.to_ascii_uppercase()
        } else {
            '_'
        }
    };
    let text: String = name.chars().map(word).collect();
    match text.chars().next() {
        Some(c) if c.is_ascii_alphabetic() => text,
        _ => format!("N{text}"),
    }
}

/// `iCub-23 arm` to `ICub23Arm`: a camel-case identifier.
#[must_use]
pub fn type_name(name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric());
    let text: String = words
        .filter(|w| !w.is_empty())
        .map(|w| w[..1].to_ascii_uppercase() + &w[1..])
        .collect();
    match text.chars().next() {
        // `Self` is the one keyword that is written like a type.
        Some(c) if c.is_ascii_alphabetic() && text != "Self" => text,
        _ => format!("Robot{text}"),
    }
}

/// Whether a word belongs to Rust, of whichever edition, so that no crate of that name can be used.
#[must_use]
pub fn is_keyword(word: &str) -> bool {
    KEYWORDS.contains(&word)
}

/// One identifier per name; names that would collide get a number.
pub(super) fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut taken = BTreeSet::new();
    names
        .map(|name| {
            let first = constant(name);
            let mut candidate = first.clone();
            let mut n = 2;
            while !taken.insert(candidate.clone()) {
                candidate = format!("{first}_{n}");
                n += 1;
            }
            candidate
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{constant, distinct, is_keyword, type_name};

    #[test]
    fn names_become_identifiers() {
        assert_eq!(constant("FL_hip-joint"), "FL_HIP_JOINT");
        assert_eq!(constant("1st"), "N1ST");
        assert_eq!(constant("_x"), "N_X");
        assert_eq!(type_name("icub-23 arm_v2"), "Icub23ArmV2");
        assert_eq!(type_name("7dof"), "Robot7dof");
        assert_eq!(type_name("self"), "RobotSelf");
        for word in ["fn", "self", "gen", "typeof"] {
            assert!(is_keyword(word), "{word}");
        }
        assert!(!is_keyword("robot") && !is_keyword("fn-model"));
        let names = distinct(["a-b", "a_b", "a.b"].into_iter());
        assert_eq!(names, ["A_B", "A_B_2", "A_B_3"]);
    }
}
