//! `rbd-core`'s conversions to the coordinates of others.

use rbd_core::convert;
use rbd_core::{Force, Motion, Transform};
use so3::Vector3;

use crate::inputs::Stream;
use crate::rbd::transform;
use crate::{Real, Recorder, Subject};

const DRAWS: usize = 4;

pub(crate) fn run<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>) {
    on.name = "convert";
    let mut stream = Stream::new(5);
    for _ in 0..DRAWS {
        let base = transform(&mut stream);
        poses(on, &mut stream, &base);
        mujoco(on, &mut stream, &base);
        mixed(on, &mut stream, &base);
        centre(on, &mut stream, &base);
        orders(on, &mut stream);
    }
}

fn motion<T: Real>(stream: &mut Stream) -> Motion<T> {
    Motion::from_array(stream.array(3.0))
}

fn poses<T: Real, R: Recorder>(
    on: &mut Subject<'_, T, R>,
    stream: &mut Stream,
    base: &Transform<T>,
) {
    on.call("base_to_pinocchio", base, |x| convert::base_to_pinocchio(x));
    on.call("base_to_mujoco", base, |x| convert::base_to_mujoco(x));
    for numbers in [stream.array::<T, 7>(2.0), [T::ZERO; 7], [T::NAN; 7]] {
        let _ = on.call("base_from_pinocchio", &numbers, |x| {
            convert::base_from_pinocchio(x)
        });
        let _ = on.call("base_from_mujoco", &numbers, |x| {
            convert::base_from_mujoco(x)
        });
    }
}

fn mujoco<T: Real, R: Recorder>(
    on: &mut Subject<'_, T, R>,
    stream: &mut Stream,
    base: &Transform<T>,
) {
    let (v, a): (Motion<T>, Motion<T>) = (motion(stream), motion(stream));
    let numbers = stream.array::<T, 6>(3.0);
    let force = Force::from_array(numbers);
    on.call("velocity_to_mujoco", (base, &v), |(x, v)| {
        convert::velocity_to_mujoco(x, v)
    });
    on.call("velocity_from_mujoco", (base, &numbers), |(x, n)| {
        convert::velocity_from_mujoco(x, n)
    });
    on.call("acceleration_to_mujoco", (base, &v, &a), |(x, v, a)| {
        convert::acceleration_to_mujoco(x, v, a)
    });
    on.call(
        "acceleration_from_mujoco",
        (base, &v, &numbers),
        |(x, v, n)| convert::acceleration_from_mujoco(x, v, n),
    );
    on.call("force_to_mujoco", (base, &force), |(x, f)| {
        convert::force_to_mujoco(x, f)
    });
    on.call("force_from_mujoco", (base, &numbers), |(x, n)| {
        convert::force_from_mujoco(x, n)
    });
}

fn mixed<T: Real, R: Recorder>(
    on: &mut Subject<'_, T, R>,
    stream: &mut Stream,
    base: &Transform<T>,
) {
    let (v, a): (Motion<T>, Motion<T>) = (motion(stream), motion(stream));
    let force = Force::from_array(stream.array(30.0));
    on.call("velocity_to_mixed", (base, &v), |(x, v)| {
        convert::velocity_to_mixed(x, v)
    });
    on.call("velocity_from_mixed", (base, &v), |(x, v)| {
        convert::velocity_from_mixed(x, v)
    });
    on.call("acceleration_to_mixed", (base, &v, &a), |(x, v, a)| {
        convert::acceleration_to_mixed(x, v, a)
    });
    on.call("acceleration_from_mixed", (base, &v, &a), |(x, v, a)| {
        convert::acceleration_from_mixed(x, v, a)
    });
    on.call("force_to_mixed", (base, &force), |(x, f)| {
        convert::force_to_mixed(x, f)
    });
    on.call("force_from_mixed", (base, &force), |(x, f)| {
        convert::force_from_mixed(x, f)
    });
}

fn centre<T: Real, R: Recorder>(
    on: &mut Subject<'_, T, R>,
    stream: &mut Stream,
    base: &Transform<T>,
) {
    let com: Vector3<T> = stream.array::<T, 3>(0.3).into();
    let rate: Vector3<T> = stream.array::<T, 3>(1.0).into();
    let v = motion(stream);
    on.call("pose_to_com", (base, &com), |(x, c)| {
        convert::pose_to_com(x, c)
    });
    on.call("pose_from_com", (base, &com), |(x, c)| {
        convert::pose_from_com(x, c)
    });
    on.call("velocity_to_com", (&v, &com, &rate), |(v, c, r)| {
        convert::velocity_to_com(v, c, r)
    });
    on.call("velocity_from_com", (&v, &com, &rate), |(v, c, r)| {
        convert::velocity_from_com(v, c, r)
    });
}

fn orders<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>, stream: &mut Stream) {
    let joints = stream.array::<T, 12>(3.0);
    on.call("swap_unitree_joints", joints, |x| {
        convert::swap_unitree_joints(x)
    });
    let [a, b, c, d, ..] = joints;
    on.call("swap_unitree_legs", [a, b, c, d], |x| {
        convert::swap_unitree_legs(x)
    });
    let ours = ["hip", "thigh", "calf"];
    for theirs in [["calf", "hip", "thigh"], ["calf", "hip", "wing"]] {
        on.call(
            "order_by_names",
            (&ours, &theirs, &joints),
            |(from, to, x)| {
                convert::order_by_names(from, to).map(|order| convert::reordered(x, &order))
            },
        );
    }
}
