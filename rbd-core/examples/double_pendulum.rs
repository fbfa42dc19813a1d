//! A double pendulum follows a motion by computed torque: `rnea` for the torques, `aba` for what they do.
//!
//! `cargo run -p rbd-core --example double_pendulum`

use rbd_core::joint::Kind;
use rbd_core::{
    AbaWorkspace, BaseBody, BaseKind, Body, Configuration, Link, Posture, TableModel, Tangent, aba,
    rnea,
};

const STEP: f64 = 1e-3;

fn main() -> Result<(), rbd_core::TableError> {
    // A rod of 1 kg and 0.4 m; moments of mass are about the joint: ∫dm, ∫r dm, ∫r rᵀdm (xx, yy, zz, xy, xz, yz).
    let upper = Body {
        kind: Kind::RevoluteY,
        mass: 1.0,
        first: [0.0, 0.0, -0.2],
        second: [1e-4, 1e-4, 0.0533, 0.0, 0.0, 0.0],
        ..Body::EMPTY
    };
    let lower = Body {
        parent: Link::Joint(0),
        offset: [0.0, 0.0, -0.4],
        ..upper
    };
    let base = BaseBody {
        mass: 0.0,
        first: [0.0; 3],
        second: [0.0; 6],
    };
    let robot = TableModel::<f64, 2>::new(BaseKind::Fixed, base, &[upper, lower])?;

    let (mut q, mut v) = (Configuration::<f64, 2>::NEUTRAL, Tangent::<f64, 2>::ZERO);
    let mut workspace = AbaWorkspace::new();
    let mut worst: f64 = 0.0;
    for k in 0..2000 {
        let t = f64::from(k) * STEP;
        let wanted = [so3::math::sin(2.0 * t), 0.5 * so3::math::sin(3.0 * t)];
        let rate = [2.0 * so3::math::cos(2.0 * t), 1.5 * so3::math::cos(3.0 * t)];
        let acceleration = [-4.0 * wanted[0], -9.0 * wanted[1]];
        let posture = Posture::new(&robot, &q);
        let asked = Tangent {
            joints: core::array::from_fn(|i| {
                acceleration[i] + 100.0 * (wanted[i] - q.joints[i]) + 20.0 * (rate[i] - v.joints[i])
            }),
            ..Tangent::ZERO
        };
        let torques = rnea(&robot, &posture, &v, &asked);
        let a = aba(&robot, &posture, &v, &torques, &mut workspace);
        for (i, wanted) in wanted.iter().enumerate() {
            v.joints[i] += STEP * a.joints[i];
            q.joints[i] += STEP * v.joints[i];
            if t > 1.0 {
                worst = worst.max((wanted - q.joints[i]).abs());
            }
        }
        if k % 400 == 0 {
            println!("{t:.1} s: torques {:6.3?} N m", torques.joints);
        }
    }
    println!("within {worst:.4} rad of the motion after a second");
    assert!(worst < 0.01);
    Ok(())
}
