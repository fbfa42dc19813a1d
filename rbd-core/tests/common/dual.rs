//! An independent oracle: Newton–Euler in world axes, as a first course teaches it, over dual numbers.
//!
//! It shares nothing with the library but the tables: every body has its pose, its angular velocity and the
//! classical acceleration of its centre of mass in world axes; forces and moments are summed over subtrees.
//! Dual numbers (a + b ε, ε² = 0) carry one exact directional derivative along.

use core::ops::{Add, Mul, Neg, Sub};

use rbd_core::{BaseKind, Body, Configuration, Link, Tangent, Tree};

use super::{CAP, Model};

/// A value and its derivative along one direction.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Dual {
    pub(crate) value: f64,
    pub(crate) rate: f64,
}

impl Dual {
    pub(crate) fn new(value: f64, rate: f64) -> Self {
        Self { value, rate }
    }
    fn constant(value: f64) -> Self {
        Self { value, rate: 0.0 }
    }
    fn sin(self) -> Self {
        Self::new(
            so3::math::sin(self.value),
            so3::math::cos(self.value) * self.rate,
        )
    }
    fn cos(self) -> Self {
        Self::new(
            so3::math::cos(self.value),
            -so3::math::sin(self.value) * self.rate,
        )
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self::new(self.value + o.value, self.rate + o.rate)
    }
}
impl Sub for Dual {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}
impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.value, -self.rate)
    }
}
impl Mul for Dual {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self::new(
            self.value * o.value,
            self.value * o.rate + self.rate * o.value,
        )
    }
}

type V = [Dual; 3];
type M = [[Dual; 3]; 3];

fn vector(x: [f64; 3]) -> V {
    x.map(Dual::constant)
}
fn sum(a: V, b: V) -> V {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}
fn scaled(a: V, s: Dual) -> V {
    a.map(|x| x * s)
}
fn dot(a: V, b: V) -> Dual {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
fn cross(a: V, b: V) -> V {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
fn apply(m: &M, v: V) -> V {
    m.map(|row| dot(row, v))
}
fn transposed(m: &M) -> M {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| m[j][i]))
}
fn product(a: &M, b: &M) -> M {
    let columns = transposed(b);
    a.map(|row| columns.map(|column| dot(row, column)))
}

/// Pose, angular velocity and acceleration, classical acceleration of the origin: world axes.
#[derive(Clone, Copy)]
struct Moving {
    rot: M,
    pos: V,
    omega: V,
    alpha: V,
    acc: V,
}

/// Force and moment about the world's origin.
type Wrench = (V, V);

fn add(a: Wrench, b: Wrench) -> Wrench {
    (sum(a.0, b.0), sum(a.1, b.1))
}

/// What moves this body so, gravity included.
fn wrench(m: &Moving, mass: f64, first: [f64; 3], second: [f64; 6]) -> Wrench {
    // Rotational inertia about the centre of mass, body axes.
    let c = first.map(|h| h / mass);
    let [xx, yy, zz, xy, xz, yz] = second;
    let s = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let s = [0, 1, 2].map(|i| [0, 1, 2].map(|j| s[i][j] - mass * c[i] * c[j]));
    let trace = s[0][0] + s[1][1] + s[2][2];
    let inertia = [0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| Dual::constant(if i == j { trace - s[i][j] } else { -s[i][j] }))
    });
    let inertia_w = product(&product(&m.rot, &inertia), &transposed(&m.rot));

    let arm = apply(&m.rot, vector(c));
    let acc_c = sum(
        m.acc,
        sum(cross(m.alpha, arm), cross(m.omega, cross(m.omega, arm))),
    );
    let lift = sum(acc_c, vector([0.0, 0.0, 9.81]));
    let force = scaled(lift, Dual::constant(mass));
    let spin = sum(
        apply(&inertia_w, m.alpha),
        cross(m.omega, apply(&inertia_w, m.omega)),
    );
    (force, sum(spin, cross(sum(m.pos, arm), force)))
}

/// The body behind a joint.
fn next(p: &Moving, body: &Body<f64>, q: Dual, qd: Dual, qdd: Dual) -> (Moving, V) {
    let sign = Dual::constant(body.sign);
    let (q, qd, qdd) = (q * sign, qd * sign, qdd * sign);
    let tilt = body.tilt.map(vector);
    let frame = product(&p.rot, &tilt);
    let k = body.kind.axis();
    let axis = transposed(&frame)[k];
    let revolute = body.kind.is_revolute();
    let zero = Dual::default();
    let (turn, slide) = if revolute { (q, zero) } else { (zero, q) };

    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    let mut plane = [[zero; 3]; 3];
    plane[k][k] = Dual::constant(1.0);
    plane[i][i] = turn.cos();
    plane[j][j] = turn.cos();
    plane[i][j] = -turn.sin();
    plane[j][i] = turn.sin();

    let arm = sum(apply(&p.rot, vector(body.offset)), scaled(axis, slide));
    let carried = sum(
        p.acc,
        sum(cross(p.alpha, arm), cross(p.omega, cross(p.omega, arm))),
    );
    let mut m = Moving {
        rot: product(&frame, &plane),
        pos: sum(p.pos, arm),
        omega: p.omega,
        alpha: p.alpha,
        acc: carried,
    };
    if revolute {
        m.omega = sum(p.omega, scaled(axis, qd));
        m.alpha = sum(
            sum(p.alpha, scaled(axis, qdd)),
            cross(p.omega, scaled(axis, qd)),
        );
    } else {
        let coriolis = scaled(cross(p.omega, axis), qd + qd);
        m.acc = sum(carried, sum(scaled(axis, qdd), coriolis));
    }
    (m, axis)
}

/// Inverse dynamics and its derivative when configuration, velocity and acceleration change by `dq`, `dv`,
/// `da` times ε: base wrench in base axes first, then joints.
pub(crate) fn inverse_dynamics(
    model: &Model,
    q: &Configuration<f64, CAP>,
    [v, a]: [&Tangent<f64, CAP>; 2],
    [dq, dv, da]: [&Tangent<f64, CAP>; 3],
) -> Vec<Dual> {
    let pair = |x: [f64; 3], dx: [f64; 3]| [0, 1, 2].map(|i| Dual::new(x[i], dx[i]));
    // Base pose on the manifold: R (1 + ε hat(w)), p + ε R v.
    let r = q.base.rotation.matrix();
    let dr = r * dq.base.angular.cross_matrix();
    let rot = [0, 1, 2].map(|i| [0, 1, 2].map(|j| Dual::new(r[(i, j)], dr[(i, j)])));
    let pos = pair(q.base.translation.into(), (r * dq.base.linear).into());
    let body = |x: &Tangent<f64, CAP>, dx: &Tangent<f64, CAP>| {
        (
            pair(x.base.linear.into(), dx.base.linear.into()),
            pair(x.base.angular.into(), dx.base.angular.into()),
        )
    };
    let ((v_b, w_b), (a_b, alpha_b)) = (body(v, dv), body(a, da));
    let base = Moving {
        rot,
        pos,
        omega: apply(&rot, w_b),
        alpha: apply(&rot, alpha_b),
        // The coordinates of the base velocity are in base axes: their derivative lacks ω × v.
        acc: apply(&rot, sum(a_b, cross(w_b, v_b))),
    };

    let n = model.joint_count();
    let mut moving = vec![];
    let mut wrenches = vec![];
    for (i, row) in model.bodies().iter().enumerate().take(n) {
        let parent: &Moving = match row.parent {
            Link::Base => &base,
            Link::Joint(p) => &moving[p],
        };
        let coordinate =
            |x: &Tangent<f64, CAP>, dx: &Tangent<f64, CAP>| Dual::new(x.joints[i], dx.joints[i]);
        let angle = Dual::new(q.joints[i], dq.joints[i]);
        let (m, axis) = next(parent, row, angle, coordinate(v, dv), coordinate(a, da));
        wrenches.push((wrench(&m, row.mass, row.first, row.second), axis, m.pos));
        moving.push(m);
    }

    let b = model.base();
    let mut total = wrench(&base, b.mass, b.first, b.second);
    for (w, _, _) in &wrenches {
        total = add(total, *w);
    }
    let down = transposed(&base.rot);
    let about_base = sum(total.1, cross(total.0, base.pos));
    let mut tau: Vec<Dual> = apply(&down, total.0)
        .into_iter()
        .chain(apply(&down, about_base))
        .collect();
    if model.base_kind() == BaseKind::Fixed {
        tau.iter_mut().for_each(|x| *x = Dual::default());
    }
    for (i, row) in model.bodies().iter().enumerate().take(n) {
        let zero = ([Dual::default(); 3], [Dual::default(); 3]);
        let subtree = wrenches[i..row.subtree_end]
            .iter()
            .fold(zero, |s, (w, _, _)| add(s, *w));
        let (_, axis, pos) = wrenches[i];
        let along = if row.kind.is_revolute() {
            dot(axis, sum(subtree.1, cross(subtree.0, pos)))
        } else {
            dot(axis, subtree.0)
        };
        let rotor = Dual::constant(row.rotor_inertia) * Dual::new(a.joints[i], da.joints[i]);
        tau.push(along * Dual::constant(row.sign) + rotor);
    }
    tau
}
