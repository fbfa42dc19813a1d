//! Finds identical limbs, and writes a robot's structure in the words of `rbd_core::tree!`.

use rbd_core::joint::Kind;
use rbd_core::model::{Body, Link};

/// A run of identical limbs side by side.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limbs {
    /// How many there are.
    pub count: usize,
    /// Joint kinds from the root of the limb to its last joint before it branches.
    pub chain: Vec<Kind>,
    /// What the last joint carries.
    pub branches: Vec<Limbs>,
}

/// The structure of a robot: its limbs in table order, equal neighbours taken together.
#[must_use]
pub fn structure(bodies: &[Body<f64>]) -> Vec<Limbs> {
    let roots = children(bodies, Link::Base);
    limbs(bodies, &roots)
}

/// As the `tree!` macro wants it: `4 * [RevoluteX, RevoluteY, RevoluteY]`.
#[must_use]
pub fn expression(limbs: &[Limbs]) -> String {
    let texts: Vec<String> = limbs
        .iter()
        .map(|l| {
            let mut parts: Vec<String> = l.chain.iter().map(|k| format!("{k:?}")).collect();
            if !l.branches.is_empty() {
                parts.push(format!("{{ {} }}", expression(&l.branches)));
            }
            format!("{} * [{}]", l.count, parts.join(", "))
        })
        .collect();
    texts.join(", ")
}

fn limbs(bodies: &[Body<f64>], roots: &[usize]) -> Vec<Limbs> {
    let mut out: Vec<Limbs> = Vec::new();
    for &root in roots {
        let limb = limb(bodies, root);
        match out.last_mut() {
            Some(last) if last.chain == limb.chain && last.branches == limb.branches => {
                last.count += 1;
            }
            _ => out.push(limb),
        }
    }
    out
}

fn limb(bodies: &[Body<f64>], root: usize) -> Limbs {
    let mut chain = vec![bodies[root].kind];
    let mut last = root;
    loop {
        let below = children(bodies, Link::Joint(last));
        if let [only] = below[..] {
            chain.push(bodies[only].kind);
            last = only;
        } else {
            let branches = limbs(bodies, &below);
            return Limbs {
                count: 1,
                chain,
                branches,
            };
        }
    }
}

fn children(bodies: &[Body<f64>], parent: Link) -> Vec<usize> {
    (0..bodies.len())
        .filter(|&i| bodies[i].parent == parent)
        .collect()
}
