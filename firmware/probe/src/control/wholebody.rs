//! The push-off programs of a humanoid on its soles: at the level of torques and of velocities.

use icub_model::{Icub23Geared, profile};
use nalgebra::Vector3;
use rbd_core::{Configuration, Frame, Model, Transform};
use wbc_qp::jump::{
    ComReference, TorqueJump, TorqueJumpSettings, VelocityJump, VelocityJumpSettings,
};
use wbc_qp::task::orientation_error;
use wbc_qp::{Contact, Snapshot, TorqueAnswer, Yielded, anchored};

use super::{motors, moving};
use crate::inputs::Stream;
use crate::{Numbers, Real, Recorder, Subject};

impl<T: Real> Numbers for TorqueAnswer<T, 23, 12> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        (self.torques, self.acceleration, self.forces).visit(take);
        (self.limit_violation, self.contact_violation).visit(take);
        (self.yielded == Yielded::Nothing).visit(take);
        self.capped.visit(take);
        take(f64::from(self.iterations));
    }
}

/// Every joint a little bent, legs more.
fn posture<T: Real>() -> [T; 23] {
    core::array::from_fn(|i| match i {
        0 | 6 => T::of(0.4),
        3 | 9 => T::of(-0.8),
        4 | 10 => T::of(-0.4),
        _ => T::of(0.1),
    })
}

pub(super) fn run<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>)
where
    Icub23Geared: Model<T, 23>,
{
    let model = &Icub23Geared;
    let stream = &mut Stream::new(23);
    let soles = model.contacts();
    let contacts: [Contact<T>; 2] = core::array::from_fn(|i| match soles.get(i) {
        Some(sole) => Contact::new(sole, T::HALF, T::of(1000.0)),
        None => Contact::new(&nothing(), T::HALF, T::ZERO),
    });
    let mut q = Configuration {
        base: Transform::new(
            nalgebra::Rotation3::identity(),
            nalgebra::Vector3::new(T::ZERO, T::ZERO, T::of(0.6)),
        ),
        joints: posture(),
    };
    let mut v = moving(stream);
    let sole = &contacts[0].frame;
    let input = (&q.joints, &v.joints, &q.base);
    (q, v) = on.call("anchored", input, |(q, v, at)| {
        anchored(model, q, v, sole, at)
    });
    let mut snapshot = Snapshot::ZERO;
    on.call("Snapshot::update", (&mut snapshot, &q, &v), |(s, q, v)| {
        s.update(model, q, v);
        (s.com_w(), s.com_velocity_w(), s.locked_angular_velocity_w())
    });
    on.call("tasks", &snapshot, |s| {
        let pose = s.frame_pose(model, &contacts[1].frame);
        (
            (s.com().of(&v), s.linear_momentum().of(&v)),
            (s.angular_momentum().of(&v), pose.of(&v)),
            (
                s.frame_position(model, sole).drift,
                s.frame_orientation(model, sole).drift,
            ),
        )
    });
    on.call("orientation_error", (&q.base, &v), |(base, _)| {
        orientation_error(&base.rotation, &Transform::IDENTITY.rotation)
    });
    let forces: [T; 6] = stream.array(30.0);
    on.call("Contact::wrench_w", (&contacts[0], forces), |(c, f)| {
        c.wrench_w(&snapshot, f)
    });
    push_offs(on, &snapshot, &contacts);
}

/// Ticks of the push-off on both soles: torques, with weights and with strict priorities, and velocities.
fn push_offs<T: Real, R: Recorder>(
    on: &mut Subject<'_, T, R>,
    snapshot: &Snapshot<T, 23>,
    contacts: &[Contact<T>; 2],
) where
    Icub23Geared: Model<T, 23>,
{
    let model = &Icub23Geared;
    let wanted = ComReference {
        position_w: snapshot.com_w() + Vector3::new(T::ZERO, T::ZERO, T::of(0.02)),
        velocity_w: Vector3::zeros(),
        acceleration_w: Vector3::zeros(),
    };
    let (limits, motors) = (model.limits(), &motors(model));
    for strict in [false, true] {
        let mut settings = TorqueJumpSettings {
            posture_weight: [T::ONE; 23],
            ..profile::TORQUE.cast()
        };
        settings.strict = strict;
        let mut jump = TorqueJump::<T, 23, 12, 35, 61>::new(settings, posture());
        for contacts in [contacts, contacts] {
            let input = (&mut jump, snapshot, contacts);
            on.call("TorqueJump::tick", input, |(jump, s, contacts)| {
                let tick = jump.tick(model, s, contacts, (limits, motors), &wanted, T::of(1e-3));
                tick.map(|t| (t.answer, (t.residuals.com, t.residuals.momentum)))
                    .ok()
            });
        }
    }
    let settings = VelocityJumpSettings {
        posture_weight: [T::ONE; 23],
        ..profile::VELOCITY.cast()
    };
    let mut jump = VelocityJump::<T, 23, 29, 12>::new(settings, posture());
    for _ in 0..2 {
        let input = (&mut jump, snapshot, contacts);
        on.call("VelocityJump::tick", input, |(jump, s, contacts)| {
            let tick = jump.tick(model, s, contacts, limits, &wanted, T::of(1e-3));
            tick.map(|t| (t.velocities, T::of(f64::from(t.iterations))))
                .ok()
        });
    }
}

/// A contact that a robot without soles would have.
fn nothing<T: Real>() -> rbd_core::Contact<T> {
    rbd_core::Contact {
        name: "none",
        frame: Frame::IDENTITY,
        shape: rbd_core::ContactShape::Rectangle {
            x: [T::ZERO; 2],
            y: [T::ZERO; 2],
        },
    }
}
