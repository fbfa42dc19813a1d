//! The estimator against the simulator's truth: A1 and iCub stand, fly and land with noisy sensors.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use a1_model::{A1Geared, FEET, MOTORS, a1};
use contact_sim::{Error, NativeSimulator, Shape, Simulator, Terrain};
use icub_model::{Icub23Cad, SOLES};
use jump_lab::noise::Noise;
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};
use rbd_core::{Configuration, ContactShape, Model, Motion, Tangent, Transform, Tree};
use state_est::{Estimate, Estimator, Fault, Foot, Sample, Settings, State, Status};

/// The same cases on every machine, unless `PROPTEST_RNG_SEED` says otherwise.
fn config(cases: u32, seed: u64) -> Config {
    let mut config = Config::with_cases(cases);
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(seed);
    }
    config.failure_persistence = None;
    config
}

/// Three numbers with this standard deviation, of a noise with that of one.
fn vector(noise: &mut Noise, deviation: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| deviation * noise.sample())
}

/// Standard deviations of the sensors; zero for ideal ones.
struct Sensors {
    noise: Noise,
    scale: f64,
    gyro_bias: Vector3<f64>,
    force_bias: Vector3<f64>,
    imu: Transform<f64>,
    last_w: Vector3<f64>,
}

impl Sensors {
    fn new(seed: u64, scale: f64, imu: Transform<f64>) -> Self {
        let mut noise = Noise::new(seed, 1.0);
        let gyro_bias = vector(&mut noise, 0.01 * scale);
        let force_bias = vector(&mut noise, 0.05 * scale);
        Self {
            noise,
            scale,
            gyro_bias,
            force_bias,
            imu,
            last_w: Vector3::zeros(),
        }
    }

    /// Velocity of the IMU's point.
    fn point_velocity<const N: usize>(
        &self,
        q: &Configuration<f64, N>,
        v: &Tangent<f64, N>,
    ) -> Vector3<f64> {
        q.base.rotation * (v.base.linear + v.base.angular.cross(&self.imu.translation))
    }

    /// What the sensors say of the last millisecond.
    fn sample<const N: usize, const F: usize>(
        &mut self,
        q: &Configuration<f64, N>,
        v: &Tangent<f64, N>,
        evidence: [f64; F],
    ) -> Sample<f64, N, F> {
        let now = self.point_velocity(q, v);
        let force_w = (now - self.last_w) / 1e-3 + Vector3::z() * 9.81;
        self.last_w = now;
        let to_imu = self.imu.rotation.inverse();
        let s = self.scale;
        Sample {
            specific_force_i: to_imu * (q.base.rotation.inverse() * force_w)
                + self.force_bias
                + vector(&mut self.noise, 0.1 * s),
            angular_velocity_i: to_imu * v.base.angular
                + self.gyro_bias
                + vector(&mut self.noise, 0.01 * s),
            joints: q.joints.map(|x| x + 1e-3 * s * self.noise.sample()),
            joint_velocities: v.joints.map(|x| x + 0.05 * s * self.noise.sample()),
            evidence,
        }
    }
}

/// Errors of one estimate: position, velocity, tilt, heading.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    position: f64,
    velocity: f64,
    tilt: f64,
    heading: f64,
}

impl Errors {
    fn of<const N: usize, const F: usize>(
        q: &Configuration<f64, N>,
        v: &Tangent<f64, N>,
        e: &Estimate<f64, F>,
    ) -> Self {
        let turn = so3::log(&(e.base.rotation * q.base.rotation.inverse()));
        let velocity = e.base.rotation * e.velocity.linear - q.base.rotation * v.base.linear;
        Self {
            position: (e.base.translation - q.base.translation).norm(),
            velocity: velocity.norm(),
            tilt: turn.xy().norm(),
            heading: turn.z.abs(),
        }
    }

    fn worst(self, other: Self) -> Self {
        Self {
            position: self.position.max(other.position),
            velocity: self.velocity.max(other.velocity),
            tilt: self.tilt.max(other.tilt),
            heading: self.heading.max(other.heading),
        }
    }
}

/// A robot that holds one posture, stands for 0.5 s, is then set flying (its whole state is replaced by one that
/// moves), lands and settles.
struct Flight<const N: usize> {
    posture: [f64; N],
    gains: (f64, f64),
    /// Velocity given to the base, base axes.
    toss: Motion<f64>,
    /// Time in the air, and time after the toss, ms.
    air: usize,
    after: usize,
    /// A foot whose sensor reads full contact from the toss on.
    stuck: Option<usize>,
}

/// The worst errors while standing, in the air, and in the last 0.2 s.
fn fly<M, P, const N: usize, const F: usize, const C: usize, const S: usize>(
    model: &M,
    plant: &mut P,
    estimator: &Estimator<f64, N, F, S>,
    feet_of: impl Fn(&P) -> [f64; F],
    start: &Configuration<f64, N>,
    flight: &Flight<N>,
    mut sensors: Sensors,
) -> [Errors; 3]
where
    M: Tree<f64, N>,
    P: Simulator<f64, N, C, Error = Error>,
{
    plant.reset(start, &Tangent::ZERO);
    let mut state = State::new(estimator, model, start);
    let mut worst = [Errors::default(); 3];
    let hold = 500;
    for k in 0..hold + flight.after {
        if k == hold {
            // The toss is an impulse between two samples; one very short sample tells the estimator.
            let q = *plant.configuration();
            let mut v = *plant.velocity();
            let before = sensors.point_velocity(&q, &v);
            v.base = flight.toss;
            plant.reset(&q, &v);
            sensors.last_w = sensors.point_velocity(&q, &v);
            let mut kick = sensors.sample(&q, &v, [0.0; F]);
            let force_w = (sensors.last_w - before) / 1e-6;
            kick.specific_force_i =
                sensors.imu.rotation.inverse() * (q.base.rotation.inverse() * force_w);
            let mut unlimited = *estimator;
            unlimited.settings.max_specific_force = f64::INFINITY;
            let _ = unlimited.step(model, &mut state, Some(&kick), 1e-6);
        }
        for _ in 0..10 {
            let (q, v) = (plant.configuration().joints, plant.velocity().joints);
            let (kp, kd) = flight.gains;
            let torque = core::array::from_fn(|i| kp * (flight.posture[i] - q[i]) - kd * v[i]);
            plant.step(&torque).unwrap();
        }
        let (q, v) = (*plant.configuration(), *plant.velocity());
        let mut evidence = feet_of(plant).map(|f| if f > 15.0 { 1.0 } else { 0.0 });
        if let (Some(foot), true) = (flight.stuck, k >= hold) {
            evidence[foot] = 1.0;
        }
        let sample = sensors.sample(&q, &v, evidence);
        let estimate = estimator.step(model, &mut state, Some(&sample), 1e-3);
        // A sole that lands flat and stiff shakes the sensor beyond its range for a moment: that is named, and only that.
        let range = estimator.settings.max_specific_force;
        let beyond = sample.specific_force_i.iter().any(|f| f.abs() > range);
        let said = (estimate.status, estimate.fault);
        let expected = if beyond {
            (Status::Coasting, Some(Fault::Accelerometer))
        } else {
            (Status::Good, None)
        };
        assert_eq!(said, expected, "{:?}", sample.specific_force_i);
        let errors = Errors::of(&q, &v, &estimate);
        let phase = if k < hold {
            0
        } else if k < hold + flight.air {
            1
        } else if k + 200 >= hold + flight.after {
            2
        } else {
            continue;
        };
        worst[phase] = worst[phase].worst(errors);
    }
    worst
}

fn a1_estimator(imu: Transform<f64>) -> Estimator<f64, 12, 4, 6> {
    Estimator {
        feet: FEET.map(|foot| Foot::of(&foot)),
        imu,
        settings: Settings::new(),
    }
}

const CROUCH: [f64; 12] = [
    0.1, 0.8, -1.6, -0.1, 0.8, -1.6, 0.1, 0.8, -1.6, -0.1, 0.8, -1.6,
];

fn fly_a1(seed: u64, scale: f64, stuck: Option<usize>, imu: Transform<f64>) -> [Errors; 3] {
    let spheres: [Shape<f64>; 4] = core::array::from_fn(|i| Shape::of(&FEET[i], i).unwrap());
    let mut plant = NativeSimulator::<f64, _, 12, 4, 4>::new(
        A1Geared,
        spheres,
        Terrain::FLAT,
        contact_sim::Settings::new(&a1::LIMITS, &MOTORS),
    );
    let mut start = Configuration {
        joints: CROUCH,
        ..Configuration::NEUTRAL
    };
    start.base.translation = Vector3::new(0.3, -0.2, 0.30);
    start.base.rotation = Rotation3::from_euler_angles(0.0, 0.0, 0.7);
    let flight = Flight {
        posture: CROUCH,
        gains: (100.0, 3.0),
        toss: Motion::from_array([0.5, 0.4, 2.2, 0.4, -0.5, 1.0]),
        air: 300,
        after: 1500,
        stuck,
    };
    fly(
        &A1Geared,
        &mut plant,
        &a1_estimator(imu),
        |plant: &NativeSimulator<f64, A1Geared, 12, 4, 4>| {
            plant.contact_forces_w().map(|f| f.norm())
        },
        &start,
        &flight,
        Sensors::new(seed, scale, imu),
    )
}

/// An IMU off the base's origin and turned.
fn mounted() -> Transform<f64> {
    Transform::new(
        Rotation3::from_euler_angles(3.1, 0.1, -1.6),
        Vector3::new(-0.05, 0.02, 0.04),
    )
}

#[test]
fn ideal_sensors_follow_a1_through_flight_and_impact() {
    for imu in [Transform::IDENTITY, mounted()] {
        let [stand, air, end] = fly_a1(1, 0.0, None, imu);
        println!("{stand:?}\n{air:?}\n{end:?}");
        assert!(stand.position < 3e-3 && stand.velocity < 0.03 && stand.tilt < 0.012);
        assert!(air.position < 6e-3 && air.velocity < 0.03 && air.tilt < 8e-3);
        assert!(end.position < 0.015 && end.velocity < 0.01 && end.tilt < 6e-3);
    }
}

/// Where an IMU may sit: where [`mounted`] says, at the origin, or anywhere in the trunk and turned anyhow, by half a turn too.
fn mounts() -> impl Strategy<Value = Transform<f64>> {
    let axis = prop::array::uniform3(-1.0..1.0_f64).prop_map(|axis| {
        let axis = Vector3::from(axis).try_normalize(1e-3);
        axis.unwrap_or_else(Vector3::z)
    });
    let angle = prop_oneof![2 => -3.0..3.0_f64, 1 => Just(core::f64::consts::PI)];
    let turn = (axis, angle).prop_map(|(axis, angle)| so3::exp(&(axis * angle)));
    let place = prop::array::uniform3(-0.05..0.05_f64).prop_map(Vector3::from);
    let anyhow = (turn, place).prop_map(|(turn, place)| Transform::new(turn, place));
    prop_oneof![2 => Just(mounted()), 1 => Just(Transform::IDENTITY), 3 => anyhow]
}

proptest! {
    #![proptest_config(config(10, 1))]

    /// The landing slides and rolls, which costs centimetres of place.
    #[test]
    fn noisy_sensors_follow_a1_through_flight_and_impact(noise: u64, imu in mounts()) {
        let [stand, air, end] = fly_a1(noise, 1.0, None, imu);
        println!("{stand:?}\n{air:?}\n{end:?}");
        prop_assert!(stand.position < 0.01 && stand.velocity < 0.05 && stand.tilt < 0.015, "{stand:?}");
        prop_assert!(air.position < 0.03 && air.velocity < 0.10 && air.tilt < 0.02, "{air:?}");
        prop_assert!(end.position < 0.04 && end.velocity < 0.05 && end.tilt < 0.02, "{end:?}");
        prop_assert!(end.heading < 0.03, "{end:?}");
    }
}

proptest! {
    #![proptest_config(config(1, 3))]

    /// A sensor that is stuck on in the air anchors nothing.
    #[test]
    fn a_stuck_foot_sensor_does_not_hold_the_flying_robot(noises: [u64; 4], imus in [mounts(), mounts(), mounts(), mounts()]) {
        for (foot, (noise, imu)) in noises.into_iter().zip(imus).enumerate() {
            let [_, air, end] = fly_a1(noise, 1.0, Some(foot), imu);
            println!("{air:?} {end:?}");
            prop_assert!(air.velocity < 0.2 && air.position < 0.05, "{air:?}");
            prop_assert!(end.velocity < 0.05 && end.tilt < 0.03, "{end:?}");
        }
    }
}

proptest! {
    #![proptest_config(config(3, 5))]

    /// iCub: soles, 23 joints, IMU at the root.
    #[test]
    fn icub_is_followed_through_a_hop(noise: u64, imu in mounts()) {
        let [stand, air, end] = hop_icub(noise, imu);
        println!("{stand:?}\n{air:?}\n{end:?}");
        prop_assert!(stand.position < 0.02 && stand.velocity < 0.05 && stand.tilt < 0.015, "{stand:?}");
        prop_assert!(air.position < 0.04 && air.velocity < 0.10 && air.tilt < 0.02, "{air:?}");
        // Held stiffly, it lands rocking on the edges of its soles, whose middles are then poor anchors.
        prop_assert!(end.position < 0.08 && end.velocity < 0.3 && end.tilt < 0.05, "{end:?}");
    }
}

fn hop_icub(noise: u64, imu: Transform<f64>) -> [Errors; 3] {
    let spheres: [Shape<f64>; 8] = core::array::from_fn(|i| {
        let sole = &SOLES[i / 4];
        let ContactShape::Rectangle { x, y } = sole.shape else {
            unreachable!()
        };
        let corner = Vector3::new(x[i & 1], y[(i >> 1) & 1], 0.005);
        let center = sole.frame.placement().point(&corner).into();
        Shape::ball(sole.frame.link, center, 0.005, i)
    });
    let limits = Model::<f64, 23>::limits(&Icub23Cad);
    let motors = Model::<f64, 23>::motors(&Icub23Cad).unwrap();
    let mut plant = NativeSimulator::<f64, _, 23, 8, 8>::new(
        Icub23Cad,
        spheres,
        Terrain::FLAT,
        contact_sim::Settings::new(limits, motors),
    );
    let mut start = Configuration::NEUTRAL;
    let mut poses = rbd_core::Kinematics::IDENTITY;
    rbd_core::forward_kinematics(
        &Icub23Cad,
        &rbd_core::Posture::new(&Icub23Cad, &start),
        &mut poses,
    );
    start.base.translation.z = -poses.frame(&SOLES[0].frame).translation.z;
    let estimator = Estimator::<f64, 23, 2, 4> {
        feet: SOLES.map(|sole| Foot::of(&sole)),
        imu,
        settings: Settings::new(),
    };
    let flight = Flight {
        posture: [0.0; 23],
        gains: (300.0, 8.0),
        // Paper B's own take-off speed. From 1.6 m/s the straight legs on concrete shake the sensor by more than the 32 g of its range.
        toss: Motion::from_array([0.0, 0.0, 0.9, 0.0, 0.0, 0.0]),
        air: 160,
        after: 700,
        stuck: None,
    };
    fly(
        &Icub23Cad,
        &mut plant,
        &estimator,
        |plant: &NativeSimulator<f64, Icub23Cad, 23, 8, 8>| {
            let f = plant.contact_forces_w();
            [0, 4].map(|k| f[k..k + 4].iter().map(|f| f.z).sum())
        },
        &start,
        &flight,
        Sensors::new(noise, 1.0, imu),
    )
}

/// Standing A1 and its estimator.
fn standing() -> (
    Estimator<f64, 12, 4, 6>,
    State<f64, 4, 6>,
    Sample<f64, 12, 4>,
) {
    let estimator = a1_estimator(Transform::IDENTITY);
    let start = Configuration {
        joints: CROUCH,
        ..Configuration::NEUTRAL
    };
    let state = State::new(&estimator, &A1Geared, &start);
    let sample = Sample {
        specific_force_i: Vector3::new(0.0, 0.0, 9.81),
        angular_velocity_i: Vector3::zeros(),
        joints: CROUCH,
        joint_velocities: [0.0; 12],
        evidence: [1.0; 4],
    };
    (estimator, state, sample)
}

#[test]
fn bad_samples_are_named_and_survived() {
    let (estimator, mut state, good) = standing();
    let mut step = |sample: Option<&Sample<f64, 12, 4>>, dt: f64| {
        estimator.step(&A1Geared, &mut state, sample, dt)
    };
    for _ in 0..20 {
        assert_eq!(step(Some(&good), 1e-3).fault, None);
    }
    for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300] {
        let mut s = good;
        s.specific_force_i.y = bad;
        assert_eq!(step(Some(&s), 1e-3).fault, Some(Fault::Accelerometer));
        let mut s = good;
        s.angular_velocity_i.x = bad;
        assert_eq!(step(Some(&s), 1e-3).fault, Some(Fault::Gyroscope));
        let mut s = good;
        s.joints[4] = bad;
        let e = step(Some(&s), 1e-3);
        assert_eq!(e.fault, Some(Fault::Joint(4)));
        // The leg of that joint is out, the others are not.
        assert_eq!(e.confidence[1], 0.0);
        assert!([0, 2, 3].iter().all(|i| e.confidence[*i] > 0.9));
        let mut s = good;
        s.joint_velocities[0] = bad;
        assert_eq!(step(Some(&s), 1e-3).fault, Some(Fault::Joint(0)));
        if bad.is_nan() {
            let mut s = good;
            s.evidence[2] = bad;
            assert_eq!(step(Some(&s), 1e-3).fault, Some(Fault::Evidence(2)));
        }
        for dt in [bad, 0.0, -1e-3] {
            assert_eq!(step(Some(&good), dt).fault, Some(Fault::Step));
        }
        let e = step(Some(&good), 1e-3);
        assert_eq!((e.fault, e.status), (None, Status::Good));
        assert!(e.velocity.linear.norm() < 0.01 && e.base.translation.norm() < 1e-3);
    }
}

#[test]
fn a_gap_is_coasted_then_lost_and_found_again() {
    let (estimator, mut state, good) = standing();
    let mut step =
        |sample: Option<&Sample<f64, 12, 4>>| estimator.step(&A1Geared, &mut state, sample, 1e-3);
    for _ in 0..100 {
        let _ = step(Some(&good));
    }
    for k in 0..100 {
        let e = step(None);
        assert_eq!(e.fault, Some(Fault::Missing));
        // The limit is 20 ms; rounding may fall on either side of it.
        if !(19..=20).contains(&k) {
            let expected = if k < 19 {
                Status::Coasting
            } else {
                Status::Lost
            };
            assert_eq!(e.status, expected, "after {k} ms");
        }
        assert!(e.base.translation.norm() < 2e-3);
    }
    let mut e = step(Some(&good));
    for _ in 0..200 {
        e = step(Some(&good));
    }
    assert_eq!((e.status, e.fault), (Status::Good, None));
    assert!(e.velocity.linear.norm() < 0.01);
}
