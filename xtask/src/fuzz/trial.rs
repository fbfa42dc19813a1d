//! One command line with its files, run in a folder of its own under limits, and what must hold of every answer.

use core::time::Duration;
use std::ffi::OsStr;
use std::fs;
use std::io::Read;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::Instant;

use anyhow::{Context, Result};
use wait_timeout::ChildExt;

/// Processor time of one answer, s. The clock has five times as much: machines are shared.
const SECONDS: u64 = 60;
/// Address space, KiB: threads' stacks count.
const MEMORY: u64 = 8 << 20;
/// Longest refusal, bytes.
const LONGEST: usize = 16_000;

/// A command line, and the files that it names.
#[derive(Clone)]
pub(super) struct Trial {
    pub(super) arguments: Vec<Vec<u8>>,
    pub(super) files: Vec<(String, Vec<u8>)>,
}

/// What came out.
pub(super) struct Answer {
    /// What does not hold, if so.
    pub(super) complaint: Option<String>,
    pub(super) code: Option<i32>,
    pub(super) seconds: f64,
}

impl Trial {
    /// Writes the files, and the command with one argument in a line: a case to keep.
    pub(super) fn write(&self, folder: &Path) -> Result<()> {
        fs::create_dir_all(folder)?;
        for (name, bytes) in &self.files {
            fs::write(folder.join(name), bytes)?;
        }
        Ok(fs::write(
            folder.join("command"),
            self.arguments.join(&b'\n'),
        )?)
    }

    /// Runs the command in a folder that holds its files and nothing else.
    pub(super) fn run(&self, program: &Path, folder: &Path) -> Result<Answer> {
        crate::run::remove_folder(folder)?;
        self.write(folder)?;
        let limits = format!("ulimit -t {SECONDS} -v {MEMORY} -c 0; exec \"$0\" \"$@\"");
        let start = Instant::now();
        let mut child = Command::new("bash")
            .args(["-c", &limits])
            .arg(program)
            .args(self.arguments.iter().map(|word| OsStr::from_bytes(word)))
            .current_dir(folder)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .context("bash")?;
        let mut pipes: [Box<dyn Read + Send>; 2] = [
            Box::new(child.stdout.take().context("no pipe")?),
            Box::new(child.stderr.take().context("no pipe")?),
        ];
        let readers = pipes.each_mut().map(|pipe| {
            let mut pipe = core::mem::replace(pipe, Box::new(std::io::empty()));
            thread::spawn(move || {
                let mut said = Vec::new();
                let _ = pipe.read_to_end(&mut said);
                said
            })
        });
        let status = child.wait_timeout(Duration::from_secs(5 * SECONDS))?;
        if status.is_none() {
            child.kill()?;
            child.wait()?;
        }
        let said = readers.map(|reader| reader.join().unwrap_or_default());
        let code = status.and_then(|status| status.code());
        let complaint = match status {
            None => Some(format!("no answer within {} s", 5 * SECONDS)),
            Some(status) => match status.signal() {
                Some(signal) => Some(format!("ended by signal {signal}")),
                None => self.complaint(code, &said, folder),
            },
        };
        let complaint = complaint.map(|what| {
            let text = String::from_utf8_lossy(&said[1]);
            format!("{what}\n{}", text.chars().take(600).collect::<String>())
        });
        let seconds = start.elapsed().as_secs_f64();
        Ok(Answer {
            complaint,
            code,
            seconds,
        })
    }

    /// What does not hold of an answer that came by itself.
    fn complaint(&self, code: Option<i32>, said: &[Vec<u8>; 2], folder: &Path) -> Option<String> {
        let [out, err] = said;
        if !matches!(code, Some(0..=2)) {
            return Some(format!("exit code {code:?}"));
        }
        if String::from_utf8_lossy(err).contains("panicked") {
            return Some("a panic".to_owned());
        }
        let is_quiet = self
            .arguments
            .iter()
            .any(|word| word == b"-q" || word == b"--quiet");
        if code != Some(0) && out.is_empty() && err.is_empty() && !is_quiet {
            return Some("a refusal without a word".to_owned());
        }
        let length = out.len().max(err.len());
        if code != Some(0) && length > LONGEST && !self.arguments.iter().any(|x| x == b"--trace") {
            return Some(format!("a refusal of {length} bytes"));
        }
        half_made(folder)
    }
}

/// A folder or file that is there and not whole.
fn half_made(folder: &Path) -> Option<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries {
        let (path, name) = (entry.path(), entry.file_name());
        let name = name.to_string_lossy();
        if name.starts_with(".saltus-") {
            return Some(format!("{name} is left"));
        }
        if path.is_symlink() || !path.is_dir() {
            continue;
        }
        let has = |file: &str| path.join(file).is_file();
        let begun = fs::read_dir(&path).into_iter().flatten().flatten();
        let empty = begun.count() == 0;
        let plan = has("plan.bin") == has("plan.json");
        // A gallery keeps of a run its report and its picture alone.
        let kept = has("report.html") && has("strip.svg");
        let run =
            has("log.csv") == has("result.json") && (kept || has("log.csv") == has("report.html"));
        let model = has("Cargo.toml") == has("src/lib.rs");
        if empty || !(plan && run && model) {
            return Some(format!("the folder {name} is half made"));
        }
        if let Some(found) = half_made(&path) {
            return Some(found);
        }
    }
    None
}
