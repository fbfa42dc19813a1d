//! How large a description may be: what follows takes time by the square of the number of links, and goes down into bodies by calling
//! itself.

use roxmltree::Document;

use crate::error::ImportError;

/// Most elements that become links, joints or shapes: humanoids with hands have some hundreds.
const MOST_PARTS: usize = 8192;
/// Most elements around one another.
const DEEPEST: usize = 256;
/// Longest text of a description with everything that it includes, bytes.
pub(crate) const LONGEST: u64 = 64 << 20;
/// Largest mass (kg), moment of inertia (kg m²) and coordinate of a place (m) of a robot.
pub(crate) const LARGEST: f64 = 1e9;

/// Names of elements that become parts of the robot, in both formats.
const PARTS: [&str; 8] = [
    "link",
    "joint",
    "body",
    "freejoint",
    "geom",
    "frame",
    "default",
    "include",
];

/// Refuses a document that is no robot's by its size.
pub(crate) fn check(document: &Document<'_>) -> Result<(), ImportError> {
    let too_large = |what, most| Err(ImportError::TooLarge { what, most });
    let parts = document
        .descendants()
        .filter(|node| PARTS.contains(&node.tag_name().name()));
    if parts.count() > MOST_PARTS {
        return too_large("links, joints and shapes", MOST_PARTS);
    }
    let mut depth = 0_usize;
    let mut node = document.root();
    loop {
        if let Some(inside) = node.first_child() {
            depth += 1;
            if depth > DEEPEST {
                return too_large("elements around one another", DEEPEST);
            }
            node = inside;
            continue;
        }
        // Upwards to the next one that is beside or behind.
        loop {
            if let Some(next) = node.next_sibling() {
                node = next;
                break;
            }
            let Some(above) = node.parent() else {
                return Ok(());
            };
            depth -= 1;
            node = above;
        }
    }
}
