//! Why a command ends without an answer, and with which exit code.

use jump_planner::task::file::TaskError;
use serde_json::json;
use std::process::ExitCode;

/// Most characters of a value that an error shows.
const VALUE: usize = 80;
/// Most characters of a line, and lines, of an error.
const LINE: usize = 600;
const LINES: usize = 40;

/// Why there is no answer.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The command line is refused, or a file or folder that it names, or there is no such jump: the same command fails again.
    Refused(String),
    /// A reason outside, such as a full disk: the same command may do later.
    Outside(String),
}

impl Failure {
    /// The exit code: 2 and 1.
    pub(crate) fn code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Refused(_) => 2,
            Self::Outside(_) => 1,
        })
    }

    /// What is told, with long values cut.
    pub(crate) fn message(&self) -> String {
        match self {
            Self::Refused(text) | Self::Outside(text) => brief(text),
        }
    }

    /// Tells it: with `json` as an object on standard output too.
    pub(crate) fn tell(&self, json: bool) -> ExitCode {
        let message = self.message();
        if json {
            say!("{}", json!({ "status": "Error", "error": message }));
        }
        tell!("saltus: {message}");
        self.code()
    }
}

/// What the libraries refuse is refused here.
impl From<String> for Failure {
    fn from(message: String) -> Self {
        Self::Refused(message)
    }
}

impl From<&str> for Failure {
    fn from(message: &str) -> Self {
        Self::Refused(message.to_owned())
    }
}

impl From<TaskError> for Failure {
    fn from(error: TaskError) -> Self {
        Self::Refused(error.to_string())
    }
}

/// A message whose quoted values, lines and number of lines have an end: what was given may be megabytes of anything.
pub(crate) fn brief(text: &str) -> String {
    let values = cut_values(text);
    let mut lines: Vec<String> = values.lines().take(LINES).map(cut_line).collect();
    if values.lines().nth(LINES).is_some() {
        lines.push("…".to_owned());
    }
    lines.join("\n")
}

/// Cuts what stands between quotes.
fn cut_values(text: &str) -> String {
    let mut out = String::with_capacity(text.len().min(LINE * LINES));
    let mut rest = text;
    while let Some(begin) = rest.find(['`', '"', '\'']) {
        let (before, quoted) = rest.split_at(begin);
        out += before;
        let quote = quoted.chars().next().unwrap_or('`');
        let inside = quoted.get(1..).unwrap_or_default();
        // An apostrophe, or a quote that nothing closes, opens no value.
        let opens = quote != '\'' || before.is_empty() || before.ends_with([' ', '(', '\n']);
        let end = inside.find(quote).filter(|_| opens);
        let Some(end) = end else {
            out.push(quote);
            rest = inside;
            continue;
        };
        let (value, after) = inside.split_at(end);
        out.push(quote);
        out += &cut(value, VALUE);
        out.push(quote);
        rest = after.get(1..).unwrap_or_default();
    }
    out + rest
}

/// The first `most` characters.
fn cut(text: &str, most: usize) -> String {
    match text.char_indices().nth(most) {
        Some((end, _)) => format!("{}…", text.get(..end).unwrap_or_default()),
        None => text.to_owned(),
    }
}

/// A line's beginning, and its end, where the remedy stands.
fn cut_line(line: &str) -> String {
    if line.chars().nth(LINE).is_none() {
        return line.trim_end().to_owned();
    }
    let tail: Vec<char> = line.chars().rev().take(LINE / 4).collect();
    let tail: String = tail.into_iter().rev().collect();
    format!("{}{}", cut(line, LINE / 2), tail.trim_end())
}

#[cfg(test)]
mod tests {
    use super::{LINE, LINES, brief};

    #[test]
    fn long_values_are_cut_and_the_rest_stays() {
        let short = "my.toml: it isn't `a`, nor \"b\", it's 'c': give one";
        assert_eq!(brief(short), short);
        for quote in ['`', '"', '\''] {
            let long = format!(
                "key: {quote}{}{quote}: must be a number",
                "ä".repeat(10_000)
            );
            let told = brief(&long);
            assert!(told.chars().count() < 120 && told.contains('…'), "{told}");
            assert!(told.ends_with("must be a number"), "{told}");
        }
        let line = format!(
            "1 | {}\n{}^\nsay why",
            "x".repeat(1_000_000),
            " ".repeat(1_000_000)
        );
        let told = brief(&line);
        assert!(told.len() < 3 * LINE && told.ends_with("say why"), "{told}");
        assert_eq!(brief(&"a\n".repeat(100)).lines().count(), LINES + 1);
    }
}
