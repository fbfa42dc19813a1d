//! `<include file="…"/>`: the files that an MJCF is made of.

use std::io;
use std::path::Path;

use roxmltree::Document;

/// Files deep in files that are taken for a ring.
const DEEPEST: usize = 16;

/// The text of an MJCF, every `<include>` replaced by what its file holds; their names are relative to the first file, as
/// MuJoCo takes them.
///
/// # Errors
/// What the file system says, and [`io::ErrorKind::InvalidData`] for files that include each other in a ring. Text that is no
/// XML is returned as it is: reading it says where.
pub fn read(path: &Path) -> io::Result<String> {
    let text = std::fs::read_to_string(path)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    expand(text, folder, 0)
}

fn expand(text: String, folder: &Path, depth: usize) -> io::Result<String> {
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
        let inner = std::fs::read_to_string(&path)
            .map_err(|e| io::Error::new(e.kind(), format!("<include> {}: {e}", path.display())))?;
        out.push_str(&text[done..node.range().start]);
        out.push_str(&inside(&expand(inner, folder, depth + 1)?));
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
