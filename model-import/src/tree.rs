//! What links and joints form together: one tree, or an error that names where it is none.

use std::collections::BTreeMap;

use crate::error::ImportError;
use crate::urdf::Urdf;

/// Who hangs on whom, by index into the URDF's links and joints.
#[derive(Clone, Debug)]
pub(crate) struct LinkTree {
    /// The link without a parent.
    pub(crate) root: usize,
    /// Joints below each link, in the order in which they are numbered.
    pub(crate) joints_below: Vec<Vec<usize>>,
    /// Link below each joint.
    pub(crate) child: Vec<usize>,
}

impl LinkTree {
    pub(crate) fn new(urdf: &Urdf) -> Result<Self, ImportError> {
        let index: BTreeMap<&str, usize> = urdf
            .links
            .iter()
            .enumerate()
            .map(|(i, l)| (l.name.as_str(), i))
            .collect();
        let mut joints_below = vec![Vec::new(); urdf.links.len()];
        let mut above: Vec<Option<usize>> = vec![None; urdf.links.len()];
        let mut parents = vec![0; urdf.links.len()];
        let mut child = Vec::with_capacity(urdf.joints.len());
        for (j, joint) in urdf.joints.iter().enumerate() {
            let find = |link: &String| {
                index
                    .get(link.as_str())
                    .copied()
                    .ok_or_else(|| ImportError::UnknownLink {
                        element: joint.element.clone(),
                        link: link.clone(),
                    })
            };
            let (parent, below) = (find(&joint.parent)?, find(&joint.child)?);
            if let Some(first) = above[below] {
                return Err(ImportError::TwoParents {
                    link: joint.child.clone(),
                    first: urdf.joints[first].name.clone(),
                    second: joint.name.clone(),
                });
            }
            above[below] = Some(j);
            parents[below] = parent;
            joints_below[parent].push(j);
            child.push(below);
        }
        for joints in joints_below.iter_mut().filter(|_| urdf.sorted) {
            joints.sort_by(|&a, &b| urdf.joints[a].name.cmp(&urdf.joints[b].name));
        }
        let mut roots = (0..urdf.links.len()).filter(|&l| above[l].is_none());
        let Some(root) = roots.next() else {
            return Err(ring_above(urdf, &parents, 0));
        };
        if let Some(other) = roots.next() {
            return Err(ImportError::SeveralRoots {
                first: urdf.links[root].name.clone(),
                second: urdf.links[other].name.clone(),
            });
        }
        let tree = Self {
            root,
            joints_below,
            child,
        };
        match tree.first_unreached(urdf.links.len()) {
            None => Ok(tree),
            Some(link) => Err(ring_above(urdf, &parents, link)),
        }
    }

    /// A link that does not hang on the root, if there is one: it is part of a ring or hangs on one.
    fn first_unreached(&self, links: usize) -> Option<usize> {
        let mut reached = vec![false; links];
        let mut stack = vec![self.root];
        while let Some(link) = stack.pop() {
            reached[link] = true;
            stack.extend(self.joints_below[link].iter().map(|&j| self.child[j]));
        }
        reached.iter().position(|&r| !r)
    }
}

/// Names a link of the ring that `link` hangs on: going up once per link of the file ends inside it.
fn ring_above(urdf: &Urdf, parents: &[usize], link: usize) -> ImportError {
    let inside = parents.iter().fold(link, |at, _| parents[at]);
    ImportError::Loop {
        link: urdf.links[inside].name.clone(),
    }
}
