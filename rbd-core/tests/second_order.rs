//! The second-order sweep against the other dynamics of this crate, and its derivatives against differences, on random trees.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests"
)]

use crate::common::{CAP, Model, joints, model, rotation, state, vector};
use nalgebra::Vector3;
use proptest::prelude::*;
use rbd_core::joint::Kind;
use rbd_core::second_order::{
    Contacts, EffortJacobian, Gradient, Hessian, Multipliers, PositionTerms, Sweep,
};
use rbd_core::{
    BaseKind, BlockMatrix, Body, BodyMotions, Configuration, DerivativesWorkspace, Force, Frame,
    Kinematics, Link, Motion, Posture, RneaDerivatives, TableModel, Tangent, Transform, Tree,
    forward_accelerations, forward_kinematics, rnea, rnea_derivatives, rnea_with_forces,
};

/// Contacts of every test.
const C: usize = 2;
/// Coordinates of a derivative: q, q̇, q̈ and the forces.
const ALL: usize = 3 * CAP + 3 * C;

/// A matrix by columns.
type Columns = Vec<Vec<f64>>;

/// A point on a body, the arm of its force, and the force.
type Touch = (usize, Vector3<f64>, Vector3<f64>, Vector3<f64>);

fn touches() -> impl Strategy<Value = [Touch; C]> {
    let touch = || (0..CAP, vector(0.3), vector(0.2), vector(20.0));
    [touch(), touch()]
}

/// The joints of a random tree, hanging in the world.
fn hung(model: &Model) -> Model {
    let count = model.joint_count();
    TableModel::new(BaseKind::Fixed, *model.base(), &model.bodies()[..count]).unwrap()
}

/// The touches on bodies that the model has.
fn on(model: &Model, touches: [Touch; C]) -> [Touch; C] {
    touches.map(|(link, offset, arm, force)| (link % model.joint_count(), offset, arm, force))
}

fn still(model: &Model, mut x: [f64; CAP]) -> [f64; CAP] {
    x.iter_mut()
        .skip(model.joint_count())
        .for_each(|x| *x = 0.0);
    x
}

fn contacts(sweep: &Sweep<'_, f64, CAP>, touches: &[Touch; C]) -> Contacts<f64, C> {
    let mut contacts = Contacts::NONE;
    contacts.count = C;
    for (i, (link, offset, arm, force)) in touches.iter().enumerate() {
        contacts.points[i] = sweep.point(*link, offset);
        contacts.points[i].arm = *arm;
        contacts.forces[i] = *force;
    }
    contacts
}

/// Where a derivative is taken: q, q̇, q̈ one after the other, then the forces.
struct Here<'a> {
    model: &'a Model,
    x: Vec<f64>,
    touches: [Touch; C],
}

impl Here<'_> {
    fn look<R>(
        &self,
        see: impl FnOnce(&Sweep<'_, f64, CAP>, &Contacts<f64, C>, &[f64; CAP]) -> R,
    ) -> R {
        let part = |k: usize| -> [f64; CAP] { core::array::from_fn(|i| self.x[k * CAP + i]) };
        let (q, v, a) = (part(0), part(1), part(2));
        let sweep = Sweep::new(self.model.bodies(), [&q, &v, &a], None);
        let mut touches = self.touches;
        for (f, touch) in touches.iter_mut().enumerate() {
            touch.3 = Vector3::from_fn(|i, _| self.x[3 * CAP + 3 * f + i]);
        }
        see(&sweep, &contacts(&sweep, &touches), &a)
    }

    /// Derivatives of `f` by central differences with Richardson's extrapolation: a column per coordinate.
    fn differences(&mut self, f: impl Fn(&Self) -> Vec<f64>) -> Columns {
        let h = 2e-3;
        let columns = (0..ALL).map(|j| {
            let x = self.x[j];
            let [far, near, back, far_back] = [h, h / 2.0, -h / 2.0, -h].map(|h| {
                self.x[j] = x + h;
                f(self)
            });
            self.x[j] = x;
            let slope = |i: usize| {
                let coarse = (far[i] - far_back[i]) / (2.0 * h);
                let fine = (near[i] - back[i]) / h;
                (4.0 * fine - coarse) / 3.0
            };
            (0..far.len()).map(slope).collect()
        });
        columns.collect()
    }
}

fn dense(g: &Gradient<f64, CAP, C>) -> Vec<f64> {
    let parts = g.q.iter().chain(&g.v).chain(&g.a);
    parts.chain(g.force.as_flattened()).copied().collect()
}

fn whole(h: &Hessian<f64, CAP, C>) -> Columns {
    let mut out = vec![vec![0.0; ALL]; ALL];
    let blocks = [
        (0, 0, &h.qq),
        (1, 0, &h.vq),
        (1, 1, &h.vv),
        (2, 0, &h.aq),
        (2, 1, &h.av),
        (2, 2, &h.aa),
    ];
    for (r, c, block) in blocks {
        for (i, row) in block.iter().enumerate() {
            for (j, x) in row.iter().enumerate() {
                out[r * CAP + i][c * CAP + j] = *x;
                out[c * CAP + j][r * CAP + i] = *x;
            }
        }
    }
    for (i, row) in h.force.as_flattened().iter().enumerate() {
        for (j, x) in dense(row).iter().enumerate() {
            out[3 * CAP + i][j] = *x;
            out[j][3 * CAP + i] = *x;
        }
    }
    out
}

/// Largest entry of a matrix.
fn largest(m: &Columns) -> f64 {
    m.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()))
}

/// Largest entry of the difference of two matrices of one size.
fn apart(a: &Columns, b: &Columns) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.fold(0.0, |m: f64, (x, y)| m.max((x - y).abs()))
}

fn close(ours: &Columns, theirs: &Columns, bound: f64) -> Result<(), TestCaseError> {
    let off = apart(ours, theirs) / largest(theirs).max(1.0);
    prop_assert!(off < bound, "{off}");
    Ok(())
}

/// A random motion of a tree with forces on it.
fn here(model: &Model, [q, v, a]: [[f64; CAP]; 3], touches: [Touch; C]) -> Here<'_> {
    let touches = on(model, touches);
    let moving = [q, v, a].map(|x| still(model, x));
    let forces = touches.iter().flat_map(|touch| touch.3.iter().copied());
    let x = moving.as_flattened().iter().copied().chain(forces);
    Here {
        model,
        x: x.collect(),
        touches,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn values_and_first_derivatives_are_the_trees(
        model in model(), (q, [v, a]) in state(), touches in touches(),
    ) {
        let model = hung(&model);
        let n = model.joint_count();
        let touches = on(&model, touches);
        let [q, v, a] = [q.joints, v.joints, a.joints].map(|x| still(&model, x));
        let configuration = Configuration { joints: q, ..Configuration::NEUTRAL };
        let tangent = |joints| Tangent { base: Motion::ZERO, joints };
        let posture = Posture::new(&model, &configuration);
        let (mut poses, mut motions) = (Kinematics::IDENTITY, BodyMotions::ZERO);
        forward_kinematics(&model, &posture, &mut poses);
        forward_accelerations(&model, &posture, &tangent(v), &tangent(a), &mut motions);

        let sweep = Sweep::new(model.bodies(), [&q, &v, &a], None);
        let contacts = contacts(&sweep, &touches);
        let mut forces = [Force::ZERO; CAP];
        for ((link, offset, arm, force), point) in touches.iter().zip(&contacts.points) {
            let frame = Frame { link: Link::Joint(*link), offset: (*offset).into(), ..Frame::IDENTITY };
            let pose = poses.frame(&frame);
            prop_assert!((pose.translation - sweep.place(*link, offset)).norm() < 1e-11);
            let back = pose.rotation.inverse();
            let moved = back * point.velocity - motions.frame_velocity(&frame).linear;
            prop_assert!(moved.norm() < 1e-9);
            let turned = motions.frame_classical_acceleration(&frame);
            let slip = turned.linear + turned.angular.cross(&(back * arm));
            prop_assert!((back * sweep.slip_rate(point) - slip).norm() < 1e-8 * slip.norm().max(1.0));
            let link_pose = poses.link(Link::Joint(*link));
            let lever = point.pos + arm - link_pose.translation;
            forces[*link] += Force::new(back * force, back * lever.cross(force));
        }
        let mut effort = [0.0; CAP];
        sweep.effort(&a, &contacts, &mut effort);
        let wanted = rnea_with_forces(&model, &posture, &tangent(v), &tangent(a), &Force::ZERO, &forces);
        let size = wanted.joints.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
        for (x, y) in effort.iter().zip(&wanted.joints) {
            prop_assert!((x - y).abs() < 1e-10 * size, "{x} {y}");
        }

        let (mut ws, mut d) = (DerivativesWorkspace::new(), RneaDerivatives::ZERO);
        rnea_derivatives(&model, &posture, &tangent(v), &tangent(a), &mut ws, &mut d);
        let mut ours = EffortJacobian::<f64, CAP, 0>::ZERO;
        sweep.differentiate(&Contacts::NONE, &mut ours);
        let matrix = |m: &[[f64; CAP]; CAP]| -> Columns { m[..n].iter().map(|row| row[..n].to_vec()).collect() };
        let theirs = |m: &BlockMatrix<f64, CAP>| matrix(&m.joints);
        close(&matrix(&ours.by_q), &theirs(&d.by_position), 1e-10)?;
        close(&matrix(&ours.by_v), &theirs(&d.by_velocity), 1e-10)?;
        close(&matrix(&ours.by_a), &matrix(&d.by_acceleration.joints), 1e-10)?;
    }

    #[test]
    fn first_derivatives_are_differences(
        model in model(), (q, [v, a]) in state(), touches in touches(), along in vector(1.0),
    ) {
        let model = hung(&model);
        let mut here = here(&model, [q.joints, v.joints, a.joints], touches);
        let rows = here.look(|sweep, contacts, _| {
            let mut d = EffortJacobian::ZERO;
            sweep.differentiate(contacts, &mut d);
            let mut rows: Vec<_> = (0..CAP).map(|i| dense(&d.row(i))).collect();
            for point in &contacts.points {
                rows.extend(sweep.acceleration_gradients(point).iter().map(dense));
                rows.push(dense(&sweep.position_gradient(point.link, &point.pos, &along)));
            }
            rows
        });
        let found = here.differences(|here| here.look(|sweep, contacts, a| {
            let mut effort = [0.0; CAP];
            sweep.effort(a, contacts, &mut effort);
            let mut values = effort.to_vec();
            for point in &contacts.points {
                values.extend(&sweep.slip_rate(point));
                values.push(along.dot(&point.pos));
            }
            values
        }));
        let columns: Columns = (0..ALL).map(|j| rows.iter().map(|row| row[j]).collect()).collect();
        close(&columns, &found, 1e-7)?;
    }

    #[test]
    fn second_derivatives_are_differences_of_the_first(
        model in model(), (q, [v, a]) in state(), touches in touches(),
        lambda in joints(1.0), mu in [vector(1.0), vector(1.0)], nu in [vector(1.0), vector(1.0)], spread in rotation(),
    ) {
        let model = hung(&model);
        let mut here = here(&model, [q.joints, v.joints, a.joints], touches);
        let held = here.touches[0].0;
        let ours = here.look(|sweep, contacts, _| {
            let mut positions = PositionTerms::new();
            for (point, nu) in contacts.points.iter().zip(&nu) {
                positions.add(point.link, &point.pos, nu);
            }
            // Three unit masses on the axes of the body, pulled along those of the rotation.
            let rot = sweep.joints[held].rot;
            positions.add_spread(held, &(spread.matrix() * rot.transpose()));
            let multipliers = Multipliers { effort: &lambda, acceleration: &mu };
            let mut hessian = Hessian::ZERO;
            sweep.curvature(contacts, &multipliers, &positions, &mut hessian);
            whole(&hessian)
        });
        let found = here.differences(|here| here.look(|sweep, contacts, _| {
            let mut sum = Gradient::ZERO;
            let mut d = EffortJacobian::ZERO;
            sweep.differentiate(contacts, &mut d);
            for (i, lambda) in lambda.iter().enumerate() {
                sum.add(*lambda, &d.row(i));
            }
            for ((point, mu), nu) in contacts.points.iter().zip(&mu).zip(&nu) {
                for (row, mu) in sweep.acceleration_gradients(point).iter().zip(mu) {
                    sum.add(*mu, row);
                }
                sum.add(1.0, &sweep.position_gradient(point.link, &point.pos, nu));
            }
            // The masses again, as differences of two points each.
            let (link, origin) = (held, sweep.place(held, &Vector3::zeros()));
            for i in 0..3 {
                let tip = sweep.place(link, &Vector3::ith(i, 1.0));
                let pull = spread.matrix().column(i).into_owned();
                sum.add(1.0, &sweep.position_gradient(link, &tip, &pull));
                sum.add(-1.0, &sweep.position_gradient(link, &origin, &pull));
            }
            dense(&sum)
        }));
        close(&ours, &found, 1e-6)?;
    }

    #[test]
    fn a_base_seen_from_its_rotation_takes_the_efforts_of_a_floating_one(
        model in model(), (q, [v, a]) in state(),
    ) {
        const N: usize = CAP + 6;
        let count = model.joint_count();
        let free = Model::new(BaseKind::Floating, *model.base(), &model.bodies()[..count]).unwrap();
        let [v, a] = [v, a].map(|mut x| {
            x.joints = still(&free, x.joints);
            x
        });
        let wanted = rnea(&free, &Posture::new(&free, &q), &v, &a);

        let mut bodies = [Body::EMPTY; N];
        let kinds = [
            Kind::PrismaticX, Kind::PrismaticY, Kind::PrismaticZ,
            Kind::RevoluteX, Kind::RevoluteY, Kind::RevoluteZ,
        ];
        for (i, (body, kind)) in bodies.iter_mut().zip(kinds).enumerate() {
            body.kind = kind;
            body.parent = i.checked_sub(1).map_or(Link::Base, Link::Joint);
        }
        let base = free.base();
        (bodies[5].mass, bodies[5].first, bodies[5].second) = (base.mass, base.first, base.second);
        for (slot, body) in bodies[6..].iter_mut().zip(free.bodies()) {
            *slot = *body;
            slot.parent = match body.parent {
                Link::Base => Link::Joint(5),
                Link::Joint(p) => Link::Joint(p + 6),
            };
        }
        let rot = q.base.rotation;
        let omega = v.base.angular;
        let linear = rot * v.base.linear;
        let lifted = rot * a.base.to_classical(&v.base).linear;
        // At zero angles the joints about x, y and z turn as the body does, but their axes turn with those before them.
        let turned = a.base.angular
            + Vector3::new(-omega.y * omega.z, omega.x * omega.z, -omega.x * omega.y);
        let spread = |base: [Vector3<f64>; 2], joints: &[f64; CAP]| -> [f64; N] {
            core::array::from_fn(|i| match i {
                0..3 => base[0][i],
                3..6 => base[1][i - 3],
                _ => joints[i - 6],
            })
        };
        let q_all = spread([q.base.translation, Vector3::zeros()], &q.joints);
        let v_all = spread([linear, omega], &v.joints);
        let a_all = spread([lifted, turned], &a.joints);
        let sweep = Sweep::new(&bodies, [&q_all, &v_all, &a_all], Some((2, &rot)));
        let mut effort = [0.0; N];
        sweep.effort(&a_all, &Contacts::<f64, 0>::NONE, &mut effort);
        let force = rot * wanted.base.linear;
        let all = spread([force, wanted.base.angular], &wanted.joints);
        let size = all.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
        for (i, (x, y)) in effort.iter().zip(&all).enumerate() {
            prop_assert!((x - y).abs() < 1e-10 * size, "{i}: {x} {y}");
        }
        let pose = Transform::new(rot, q.base.translation);
        let tip = Vector3::new(0.1, -0.2, 0.3);
        prop_assert!((sweep.place(5, &tip) - (pose.rotation * tip + pose.translation)).norm() < 1e-12);
    }
}

#[test]
fn outer_products_and_products_are_what_they_say() {
    let mut g = Gradient::<f64, CAP, C>::ZERO;
    for i in [3, 7] {
        (g.q[i], g.v[i], g.a[i]) = (1.0 + i as f64, 2.0 - i as f64, 0.5 * i as f64);
    }
    g.force[1] = [1.0, -2.0, 3.0];
    let mut h = Hessian::ZERO;
    // An index that is no coordinate ends the list.
    h.add_outer(0.5, &g, [3, 7, CAP].into_iter());
    let x = dense(&g);
    let product = |a: &[f64], b: &[f64], factor: f64| -> Columns {
        let column = |b: &f64| a.iter().map(|a| factor * a * b).collect();
        b.iter().map(column).collect()
    };
    assert!(apart(&whole(&h), &product(&x, &x, 0.5)) < 1e-15);

    let mut h = Hessian::ZERO;
    h.add_product(3, 2.0, &g);
    h.add_product(CAP, 2.0, &g);
    let unit: Vec<f64> = (0..ALL).map(|i| f64::from(u8::from(i == 3))).collect();
    let mut wanted = product(&x, &unit, 2.0);
    for (row, other) in wanted.iter_mut().zip(product(&unit, &x, 2.0)) {
        row.iter_mut().zip(other).for_each(|(x, y)| *x += y);
    }
    assert!(apart(&whole(&h), &wanted) < 1e-14);
}
