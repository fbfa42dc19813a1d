//! Limbs abreast compute the same bits as limbs one after the other.

use rbd_core::joint::Kind;
use rbd_core::model::{BaseBody, Body, Link};
use rbd_core::nalgebra::{Rotation3, Vector3};
use rbd_core::{
    AbaWorkspace, Configuration, Effort, Force, MassMatrix, Motion, Posture, Tangent, Transform,
    Tree, aba, centroidal_state, crba, rnea,
};

const N: usize = 12;

/// Four legs that the walk takes abreast.
struct Abreast;

/// The same legs, which look like four different ones.
struct Apart;

static BASE: BaseBody<f64> = BaseBody {
    mass: 5.0,
    first: [0.1, -0.05, 0.2],
    second: [0.3, 0.2, 0.4, 0.01, -0.02, 0.03],
};

static BODIES: [Body<f64>; N] = bodies();

rbd_core::tree! {
    impl Tree<f64, 12> for Abreast { floating, BASE, BODIES, 4 * [RevoluteX, RevoluteY, PrismaticZ] }
}

rbd_core::tree! {
    impl Tree<f64, 12> for Apart { floating, BASE, BODIES,
        1 * [RevoluteX, RevoluteY, PrismaticZ], 1 * [RevoluteX, RevoluteY, PrismaticZ],
        1 * [RevoluteX, RevoluteY, PrismaticZ], 1 * [RevoluteX, RevoluteY, PrismaticZ] }
}

/// Legs at four places, each body a little different from all others.
const fn bodies() -> [Body<f64>; N] {
    let kinds = [Kind::RevoluteX, Kind::RevoluteY, Kind::PrismaticZ];
    let mut out = [Body::<f64>::EMPTY; N];
    let mut i = 0;
    while i < N {
        let x = i as f64 / N as f64;
        let joint = i % 3;
        out[i] = Body {
            kind: kinds[joint],
            parent: if joint == 0 {
                Link::Base
            } else {
                Link::Joint(i - 1)
            },
            subtree_end: i + 3 - joint,
            sign: if i % 2 == 0 { 1.0 } else { -1.0 },
            offset: [0.3 - x, 0.1 + x, -0.2],
            mass: 1.0 + x,
            first: [0.02 * x, -0.03, 0.1 - 0.05 * x],
            second: [0.04, 0.05 + 0.01 * x, 0.06, 0.003, -0.002 * x, 0.001],
            rotor_inertia: 0.01 * x,
            ..Body::<f64>::EMPTY
        };
        i += 1;
    }
    out
}

/// Numbers without a pattern, in [−1, 1].
fn numbers<const K: usize>(phase: f64) -> [f64; K] {
    core::array::from_fn(|i| so3::math::sin(phase + 2.3 * i as f64))
}

fn tangent(phase: f64) -> Tangent<f64, N> {
    Tangent {
        base: Motion::from_array(numbers(phase)),
        joints: numbers(phase + 0.5),
    }
}

/// Inverse dynamics, forward dynamics and mass matrix of one state.
fn dynamics<M: Tree<f64, N>>(model: &M) -> (Effort<f64, N>, Tangent<f64, N>, MassMatrix<f64, N>) {
    let configuration = Configuration {
        base: Transform::new(
            Rotation3::new(Vector3::new(0.3, -0.8, 0.5)),
            Vector3::zeros(),
        ),
        joints: numbers(0.7),
    };
    let posture = Posture::new(model, &configuration);
    let effort = Effort {
        base: Force::from_array(numbers(1.1)),
        joints: numbers(1.9),
    };
    let (velocity, mut mass) = (tangent(0.2), MassMatrix::ZERO);
    crba(model, &posture, &mut mass);
    (
        rnea(model, &posture, &velocity, &tangent(0.9)),
        aba(
            model,
            &posture,
            &velocity,
            &effort,
            &mut AbaWorkspace::new(),
        ),
        mass,
    )
}

/// What is added up over all bodies of one state: momentum and energies.
fn sums<M: Tree<f64, N>>(model: &M, phase: f64) -> [f64; 8] {
    let configuration = Configuration {
        joints: numbers(phase),
        ..Configuration::NEUTRAL
    };
    let posture = Posture::new(model, &configuration);
    let state = centroidal_state(model, &posture, &tangent(phase));
    let [x, y, z, a, b, c] = state.momentum_w.to_array();
    [
        x,
        y,
        z,
        a,
        b,
        c,
        state.kinetic_energy,
        state.potential_energy,
    ]
}

#[test]
fn sums_over_limbs_abreast_are_those_of_limbs_apart() {
    for phase in 0..100 {
        let phase = 0.1 * f64::from(phase);
        assert_eq!(sums(&Abreast, phase), sums(&Apart, phase), "{phase}");
    }
}

#[test]
fn limbs_abreast_compute_the_bits_of_limbs_apart() {
    assert_eq!(dynamics(&Abreast), dynamics(&Apart));
}
