//! `<include file="…"/>`: the files that an MJCF is made of.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use roxmltree::Document;

use crate::size::LONGEST;

/// Files deep in files that are taken for a ring.
const DEEPEST: usize = 16;
/// Most files that are read.
const MOST_FILES: usize = 1024;

/// The text of an MJCF, every `<include>` replaced by what its file holds; their names are relative to the first file, as
/// MuJoCo takes them.
///
/// # Errors
/// What the file system says, [`io::ErrorKind::InvalidData`] for files that include each other in a ring, and [`io::ErrorKind::FileTooLarge`]
/// for more than 64 MiB or 1024 files. Text that is no
/// XML is returned as it is: reading it says where.
pub fn read(path: &Path) -> io::Result<String> {
    let mut budget = Budget {
        bytes: LONGEST,
        files: MOST_FILES,
    };
    let text = budget.read(path)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    expand(text, folder, 0, &mut budget)
}

/// What may still be read: files that include others many times grow by powers.
struct Budget {
    bytes: u64,
    files: usize,
}

impl Budget {
    fn read(&mut self, path: &Path) -> io::Result<String> {
        if self.files == 0 {
            let what = format!("more than {MOST_FILES} files that are included");
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, what));
        }
        self.files -= 1;
        let mut bytes = Vec::new();
        let mut file = File::open(path)?.take(self.bytes + 1);
        file.read_to_end(&mut bytes)?;
        let Some(left) = self.bytes.checked_sub(bytes.len() as u64) else {
            let what = format!(
                "longer than {} MiB with what it includes, the most that is read",
                LONGEST >> 20
            );
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, what));
        };
        self.bytes = left;
        let what = |_| io::Error::new(io::ErrorKind::InvalidData, "not UTF-8 text");
        String::from_utf8(bytes).map_err(what)
    }
}

fn expand(text: String, folder: &Path, depth: usize, budget: &mut Budget) -> io::Result<String> {
    if depth > DEEPEST {
        let what = format!("<include>s more than {DEEPEST} deep: do files include each other?");
        return Err(io::Error::new(io::ErrorKind::InvalidData, what));
    }
    let Ok(document) = Document::parse(&text) else {
        return Ok(text);
    };
    let mut out = String::new();
    let mut done = 0;
    for node in document.descendants().filter(|n| n.has_tag_name("include")) {
        let Some(file) = node.attribute("file") else {
            continue;
        };
        let path = folder.join(file);
        let inner = budget
            .read(&path)
            .map_err(|e| io::Error::new(e.kind(), format!("<include> {}: {e}", path.display())))?;
        out.push_str(&text[done..node.range().start]);
        out.push_str(&inside(&expand(inner, folder, depth + 1, budget)?));
        done = node.range().end;
    }
    out.push_str(&text[done..]);
    Ok(out)
}

/// What stands in the root element.
fn inside(text: &str) -> String {
    let Ok(document) = Document::parse(text) else {
        return String::new();
    };
    let children = document.root_element().children();
    children.map(|c| &text[c.range()]).collect()
}
