//! What serde says of a JSON text, with the key at which it stands: files of numbers have lines, or one line, that tell a person little.

use serde_json::Error;

/// The error with its key, such as `tasks.spin.N`.
pub(crate) fn named(text: &str, error: &Error) -> String {
    match path(text, error.line(), error.column()) {
        Some(path) => format!("{path}: {error}"),
        None => error.to_string(),
    }
}

/// The keys that are open where a parser stopped.
fn path(text: &str, line: usize, column: usize) -> Option<String> {
    let begin: usize = text
        .split_inclusive('\n')
        .take(line.saturating_sub(1))
        .map(str::len)
        .sum();
    let read = text.as_bytes().get(..begin.saturating_add(column))?;
    let mut keys: Vec<&str> = Vec::new();
    let (mut depth, mut string, mut last) = (0_usize, None, "");
    for (i, byte) in read.iter().enumerate() {
        match (string, byte) {
            (Some(from), b'"') if !is_escaped(read, i) => {
                (last, string) = (text.get(from..i)?, None);
            }
            (Some(_), _) => {}
            (None, b'"') => string = Some(i + 1),
            (None, b':') => {
                keys.truncate(depth.saturating_sub(1));
                keys.push(last);
            }
            (None, b'{') => depth += 1,
            (None, b'}') => {
                depth = depth.saturating_sub(1);
                keys.truncate(depth);
            }
            _ => {}
        }
    }
    (!keys.is_empty()).then(|| keys.join("."))
}

/// Whether an odd number of backslashes stands before this byte.
fn is_escaped(text: &[u8], i: usize) -> bool {
    let before = text.iter().take(i).rev();
    before.take_while(|byte| **byte == b'\\').count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::named;
    use serde::Deserialize;
    use std::collections::BTreeMap;

    #[derive(Deserialize)]
    struct File {
        #[serde(rename = "tasks")]
        _tasks: BTreeMap<String, BTreeMap<String, Vec<usize>>>,
    }

    #[test]
    fn an_error_has_its_key() {
        for (text, told) in [
            (
                r#"{"tasks": {"a\"b": {}, "spin": {"T": [1], "N": [1, -2]}}}"#,
                "tasks.spin.N: ",
            ),
            (
                "{\"tasks\": {\"spin\":\n {\"N\": [1.5]}}}",
                "tasks.spin.N: ",
            ),
            (r#"{"tasks": {"spin": 7}}"#, "tasks.spin: "),
            (r#"{"tasks": 7}"#, "tasks: "),
            ("[", "EOF"),
            ("", "EOF"),
        ] {
            let said = serde_json::from_str::<File>(text)
                .map(|_| ())
                .map_err(|error| named(text, &error));
            assert!(
                matches!(&said, Err(said) if said.starts_with(told)),
                "{text}: {said:?}"
            );
        }
    }
}
