//! What the program must refuse, in time and by name.

use crate::command::saltus;
use core::time::Duration;
use std::path::Path;
use std::time::Instant;

/// Runs what must be refused, within this time and by name; what it said.
pub(crate) fn refused(
    limit: Duration,
    folder: &Path,
    arguments: &[&str],
    words: &[&str],
) -> String {
    let clock = Instant::now();
    let output = saltus(folder, arguments);
    let said = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    for word in words {
        assert!(
            said.contains(word),
            "{arguments:?} does not say `{word}`: {said}"
        );
    }
    assert!(clock.elapsed() < limit, "{arguments:?}");
    said
}
