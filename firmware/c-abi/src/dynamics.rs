//! Dynamics of any robot over flat vectors: 6 numbers of the base, then the joints.

use rbd_core::{
    AbaWorkspace, Configuration, Effort, MassMatrix, Posture, Tangent, Tree, aba, crba, rnea,
};

use crate::Status;

/// Base and joints of a flat vector; an error unless all is finite.
pub(crate) fn split<const N: usize, const V: usize>(
    flat: &[f64; V],
) -> Result<([f64; 6], [f64; N]), Status> {
    const { assert!(V == N + 6, "a flat vector has 6 + N numbers") };
    let (mut base, mut joints) = ([0.0; 6], [0.0; N]);
    for (to, from) in base.iter_mut().chain(&mut joints).zip(flat) {
        if !from.is_finite() {
            return Err(Status::BadData);
        }
        *to = *from;
    }
    Ok((base, joints))
}

fn join<const N: usize, const V: usize>(base: &[f64; 6], joints: &[f64; N], out: &mut [f64; V]) {
    for (to, from) in out.iter_mut().zip(base.iter().chain(joints)) {
        *to = *from;
    }
}

pub(crate) fn inverse<M: Tree<f64, N>, const N: usize, const V: usize>(
    model: &M,
    q: &Configuration<f64, N>,
    v: &Tangent<f64, N>,
    a: &Tangent<f64, N>,
    out: &mut [f64; V],
) {
    let effort = rnea(model, &Posture::new(model, q), v, a);
    join(&effort.base.to_array(), &effort.joints, out);
}

pub(crate) fn forward<M: Tree<f64, N>, const N: usize, const V: usize>(
    model: &M,
    q: &Configuration<f64, N>,
    v: &Tangent<f64, N>,
    effort: &Effort<f64, N>,
    out: &mut [f64; V],
) {
    let mut workspace = AbaWorkspace::new();
    let a = aba(model, &Posture::new(model, q), v, effort, &mut workspace);
    join(&a.base.to_array(), &a.joints, out);
}

pub(crate) fn mass<M: Tree<f64, N>, const N: usize, const V: usize>(
    model: &M,
    q: &Configuration<f64, N>,
    out: &mut [[f64; V]; V],
) {
    let mut mass = MassMatrix::ZERO;
    crba(model, &Posture::new(model, q), &mut mass);
    let dense = mass.to_dense::<V>();
    for (to, from) in out.iter_mut().zip(dense.column_iter()) {
        for (to, from) in to.iter_mut().zip(from.iter()) {
            *to = *from;
        }
    }
}
