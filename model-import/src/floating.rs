//! A floating joint at the root of a URDF.
//!
//! Some tools want the motion of the base written down: a link without mass that stands for the world, and a joint of type `floating` to the
//! trunk. That says what a floating base says, so the joint and its link above are left out, and the link below is the base.

use crate::error::ImportError;
use crate::urdf::{Urdf, attribute, named, required};
use roxmltree::Node;

/// Leaves out the floating joint that only says that the base floats.
///
/// # Errors
/// Any other floating joint, by name.
pub(crate) fn settle(urdf: &mut Urdf, joints: &[Node<'_, '_>]) -> Result<(), ImportError> {
    for node in joints {
        let (_, element) = named(*node)?;
        let end = |tag: &'static str| {
            required(*node, tag, &element, tag)
                .and_then(|end| attribute(end, "link", &element, tag))
        };
        let [parent, child] = [end("parent")?, end("child")?];
        if let Some(link) = [parent, child]
            .into_iter()
            .find(|end| urdf.links.iter().all(|link| link.name != *end))
        {
            let link = link.to_owned();
            return Err(ImportError::UnknownLink { element, link });
        }
        let carries = |name: &str| {
            let ends = urdf.joints.iter().flat_map(|j| [&j.parent, &j.child]);
            ends.into_iter().any(|end| end == name)
        };
        let weighs = |name: &str| {
            let mut links = urdf.links.iter().filter(|link| link.name == name);
            links.any(|link| link.inertia.is_some())
        };
        if joints.len() > 1 || parent == child || carries(parent) || weighs(parent) {
            let kind = "floating".to_owned();
            return Err(ImportError::UnsupportedJoint { element, kind });
        }
        urdf.links.retain(|link| link.name != parent);
    }
    Ok(())
}
