//! Tables of the robot `iCub` in canonical frames; generated, do not edit.
//!
//! - source: `icub_gazebo_v2_5.urdf`, sha256 d33b9feb73699f0da0de38a50b8d3c1655ec65005c4f614a0c5389d8f319d81a
//! - licence of the source: CC-BY-SA-4.0
//! - joints locked: neck_pitch=0.0 neck_roll=0.0 neck_yaw=0.0 r_wrist_prosup=0.0 r_wrist_pitch=0.0 r_wrist_yaw=0.0 l_wrist_prosup=0.0 l_wrist_pitch=0.0 l_wrist_yaw=0.0
//! - tool: model-import 0.1.0

#![allow(clippy::approx_constant, clippy::excessive_precision, reason = "numbers of the source file")]

use rbd_core::joint::Kind;
use rbd_core::model::{BaseBody, Body, Frame, JointLimits, Link, bodies_f32, frames_f32, limits_f32};

/// iCub on a floating base, 23 joints, 33.061673 kg.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AsPublished;

rbd_core::tree! {
    impl Tree<f64, 23> for AsPublished { floating, BASE, BODIES, 2 * [RevoluteY, RevoluteX, RevoluteZ, RevoluteY, RevoluteY, RevoluteX], 1 * [RevoluteY, RevoluteX, RevoluteZ, { 2 * [RevoluteTilted, RevoluteX, RevoluteY, RevoluteTilted] }] }
}

rbd_core::tree! {
    impl Tree<f32, 23> for AsPublished { floating, BASE_F32, BODIES_F32, 2 * [RevoluteY, RevoluteX, RevoluteZ, RevoluteY, RevoluteY, RevoluteX], 1 * [RevoluteY, RevoluteX, RevoluteZ, { 2 * [RevoluteTilted, RevoluteX, RevoluteY, RevoluteTilted] }] }
}

rbd_core::model! {
    impl Model<f64, 23> for AsPublished { NAME, JOINT_NAMES, LIMITS, FRAME_NAMES, FRAMES }
}

rbd_core::model! {
    impl Model<f32, 23> for AsPublished { NAME, JOINT_NAMES, LIMITS_F32, FRAME_NAMES, FRAMES_F32 }
}

/// Name of the robot in the source file.
pub const NAME: &str = "iCub";

/// Number of joints.
pub const JOINTS: usize = 23;

/// Names of the joints, in the order of the joint coordinates.
pub static JOINT_NAMES: [&str; 23] = [
    "l_hip_pitch",
    "l_hip_roll",
    "l_hip_yaw",
    "l_knee",
    "l_ankle_pitch",
    "l_ankle_roll",
    "r_hip_pitch",
    "r_hip_roll",
    "r_hip_yaw",
    "r_knee",
    "r_ankle_pitch",
    "r_ankle_roll",
    "torso_pitch",
    "torso_roll",
    "torso_yaw",
    "l_shoulder_pitch",
    "l_shoulder_roll",
    "l_shoulder_yaw",
    "l_elbow",
    "r_shoulder_pitch",
    "r_shoulder_roll",
    "r_shoulder_yaw",
    "r_elbow",
];

/// Index of each joint.
pub mod joint {
    /// `l_hip_pitch`, which moves the link `l_hip_1`.
    pub const L_HIP_PITCH: usize = 0;
    /// `l_hip_roll`, which moves the link `l_hip_2`.
    pub const L_HIP_ROLL: usize = 1;
    /// `l_hip_yaw`, which moves the link `l_upper_leg`.
    pub const L_HIP_YAW: usize = 2;
    /// `l_knee`, which moves the link `l_lower_leg`.
    pub const L_KNEE: usize = 3;
    /// `l_ankle_pitch`, which moves the link `l_ankle_1`.
    pub const L_ANKLE_PITCH: usize = 4;
    /// `l_ankle_roll`, which moves the link `l_ankle_2`.
    pub const L_ANKLE_ROLL: usize = 5;
    /// `r_hip_pitch`, which moves the link `r_hip_1`.
    pub const R_HIP_PITCH: usize = 6;
    /// `r_hip_roll`, which moves the link `r_hip_2`.
    pub const R_HIP_ROLL: usize = 7;
    /// `r_hip_yaw`, which moves the link `r_upper_leg`.
    pub const R_HIP_YAW: usize = 8;
    /// `r_knee`, which moves the link `r_lower_leg`.
    pub const R_KNEE: usize = 9;
    /// `r_ankle_pitch`, which moves the link `r_ankle_1`.
    pub const R_ANKLE_PITCH: usize = 10;
    /// `r_ankle_roll`, which moves the link `r_ankle_2`.
    pub const R_ANKLE_ROLL: usize = 11;
    /// `torso_pitch`, which moves the link `torso_1`.
    pub const TORSO_PITCH: usize = 12;
    /// `torso_roll`, which moves the link `torso_2`.
    pub const TORSO_ROLL: usize = 13;
    /// `torso_yaw`, which moves the link `chest`.
    pub const TORSO_YAW: usize = 14;
    /// `l_shoulder_pitch`, which moves the link `l_shoulder_1`.
    pub const L_SHOULDER_PITCH: usize = 15;
    /// `l_shoulder_roll`, which moves the link `l_shoulder_2`.
    pub const L_SHOULDER_ROLL: usize = 16;
    /// `l_shoulder_yaw`, which moves the link `l_shoulder_3`.
    pub const L_SHOULDER_YAW: usize = 17;
    /// `l_elbow`, which moves the link `l_elbow_1`.
    pub const L_ELBOW: usize = 18;
    /// `r_shoulder_pitch`, which moves the link `r_shoulder_1`.
    pub const R_SHOULDER_PITCH: usize = 19;
    /// `r_shoulder_roll`, which moves the link `r_shoulder_2`.
    pub const R_SHOULDER_ROLL: usize = 20;
    /// `r_shoulder_yaw`, which moves the link `r_shoulder_3`.
    pub const R_SHOULDER_YAW: usize = 21;
    /// `r_elbow`, which moves the link `r_elbow_1`.
    pub const R_ELBOW: usize = 22;
}

/// The base: mass, first and second moments of mass.
pub static BASE: BaseBody<f64> = BaseBody {
    mass: 5.09143,
    first: [0.12668547040299996, 0.00052923887420995, -0.22443328925800005],
    second: [0.007785550543114482, 0.015577905012793257, 0.0192277040504662, 2.8714374591973857e-5, -0.007294051546646479, -2.92640471185e-5],
};

/// [`BASE`] in single precision.
pub static BASE_F32: BaseBody<f32> = BASE.to_f32();

/// The bodies, depth first.
pub static BODIES: [Body<f64>; 23] = [
    // 0: l_hip_pitch
    Body {
        kind: Kind::RevoluteY,
        parent: Link::Base,
        subtree_end: 6,
        sign: 1.0,
        offset: [0.006451499999999999, -0.026000000000000023, -0.11991299999999999],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.919725,
        first: [0.00046979552999999247, -0.03503444061749998, -7.633717499999976e-5],
        second: [0.00019967597155672398, 0.001708421422333994, 0.000205109335985525, -1.6931078267418613e-5, -1.0992730289899956e-6, 4.09287857125249e-6],
        rotor_inertia: 0.0,
    },
    // 1: l_hip_roll
    Body {
        kind: Kind::RevoluteX,
        parent: Link::Joint(0),
        subtree_end: 6,
        sign: -1.0,
        offset: [0.0, -0.044099999999999986, 0.0],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.542199,
        first: [0.0005804990752999987, -5.231736510000447e-5, -0.029020072353999976],
        second: [0.00522449427729192, 0.005055973755183173, 0.006948222355425497, 2.0736034017780253e-8, -2.3724762895818897e-5, 4.623873882727577e-6],
        rotor_inertia: 0.0,
    },
    // 2: l_hip_yaw
    Body {
        kind: Kind::RevoluteZ,
        parent: Link::Joint(1),
        subtree_end: 6,
        sign: 1.0,
        offset: [0.0008301999999999962, -7.519999999999749e-5, -0.08869999999999995],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 1.8084,
        first: [-0.006124869959999985, -0.0001840951199999733, -0.14271169440000003],
        second: [0.0007564641264203167, 0.0007268042348610622, 0.01701164300175489, 4.597505976718735e-6, 0.0003465321688837193, -0.00010968316375004546],
        rotor_inertia: 0.0,
    },
    // 3: l_knee
    Body {
        kind: Kind::RevoluteY,
        parent: Link::Joint(2),
        subtree_end: 6,
        sign: 1.0,
        offset: [0.0, 0.0, -0.14582499999999995],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 1.4724,
        first: [-0.0014721055199999927, -0.0051488355599999544, -0.1304060508],
        second: [0.0005960354957370315, 0.0009456544147921246, 0.01519209508155163, -6.246881603095163e-5, -0.00010276286616051633, 0.00021640173761970248],
        rotor_inertia: 0.0,
    },
    // 4: l_ankle_pitch
    Body {
        kind: Kind::RevoluteY,
        parent: Link::Joint(3),
        subtree_end: 6,
        sign: -1.0,
        offset: [0.0, 0.0, -0.20049999999999996],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.6798,
        first: [-0.010301077379999992, -0.0006131796000000095, 2.8551599999990814e-5],
        second: [0.0004284725586652158, 0.00017606113905039715, 0.00013209619349346198, -2.117493878082983e-5, 2.1400130914531508e-6, -1.1580139310053441e-6],
        rotor_inertia: 0.0,
    },
    // 5: l_ankle_roll
    Body {
        kind: Kind::RevoluteX,
        parent: Link::Joint(4),
        subtree_end: 6,
        sign: -1.0,
        offset: [0.0, 0.0, 0.0],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.64809,
        first: [-0.011856442512599995, -0.0020588329871999936, -0.03293628868800002],
        second: [0.006526711308814347, 0.005250331013813659, 0.00677629723724813, 4.104151816212826e-6, 0.00068524705597446, 0.00012172605292211175],
        rotor_inertia: 0.0,
    },
    // 6: r_hip_pitch
    Body {
        kind: Kind::RevoluteY,
        parent: Link::Base,
        subtree_end: 12,
        sign: 1.0,
        offset: [0.006451499999999992, 0.025999999999999968, -0.11991299999999999],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.919978,
        first: [0.0004733286810000137, 0.035028438343399984, -6.531843799998872e-5],
        second: [0.0001997355276063745, 0.0017089672984564569, 0.00020478063760909793, 1.6911581527679904e-5, -8.030803363509932e-7, -3.7555391223809684e-6],
        rotor_inertia: 0.0,
    },
    // 7: r_hip_roll
    Body {
        kind: Kind::RevoluteX,
        parent: Link::Joint(6),
        subtree_end: 12,
        sign: 1.0,
        offset: [0.0, 0.04409999999999998, 0.0],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.539454,
        first: [0.0005186312946000006, -4.073125459998907e-5, -0.02899482859399998],
        second: [0.005221678691447209, 0.005055940600251948, 0.006947539625850086, -1.0955380814429294e-7, -2.497442054219579e-5, 3.4737731294003564e-6],
        rotor_inertia: 0.0,
    },
    // 8: r_hip_yaw
    Body {
        kind: Kind::RevoluteZ,
        parent: Link::Joint(7),
        subtree_end: 12,
        sign: -1.0,
        offset: [0.0009362999999999941, -1.3899999999969492e-5, -0.08869999999999995],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 1.8035,
        first: [-0.006131899999999988, 5.2481850000032465e-5, -0.142393539],
        second: [0.0007556907764802997, 0.0007245378518450995, 0.016985211391712815, -5.660489237393987e-6, 0.00034752494572525694, 0.00012543577760359503],
        rotor_inertia: 0.0,
    },
    // 9: r_knee
    Body {
        kind: Kind::RevoluteY,
        parent: Link::Joint(8),
        subtree_end: 12,
        sign: 1.0,
        offset: [0.0, 0.0, -0.14582499999999995],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 1.472,
        first: [-0.0018199807999999878, 0.005171283200000048, -0.13070476800000005],
        second: [0.0005958983578522308, 0.0009454695358873558, 0.01525208271097623, 4.91708713968346e-5, -0.000102529604088038, -0.00023036437160699403],
        rotor_inertia: 0.0,
    },
    // 10: r_ankle_pitch
    Body {
        kind: Kind::RevoluteY,
        parent: Link::Joint(9),
        subtree_end: 12,
        sign: -1.0,
        offset: [0.0, 0.0, -0.20049999999999996],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.6803,
        first: [-0.010302191079999993, 0.0005909085800000076, 2.8572599999990813e-5],
        second: [0.00042852054306709894, 0.00017663863562827675, 0.00013211176675295195, 2.1186463596970064e-5, 2.1399777155406086e-6, 7.746374473050535e-7],
        rotor_inertia: 0.0,
    },
    // 11: r_ankle_roll
    Body {
        kind: Kind::RevoluteX,
        parent: Link::Joint(10),
        subtree_end: 12,
        sign: 1.0,
        offset: [0.0, 0.0, 0.0],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.647988,
        first: [-0.011827763527799996, 0.0020557634262000015, -0.03293674513800004],
        second: [0.006522355568277865, 0.0052503129861371225, 0.006776472133342197, -4.079878069218663e-6, 0.0006835882947933953, -0.00012170848606710241],
        rotor_inertia: 0.0,
    },
    // 12: torso_pitch
    Body {
        kind: Kind::RevoluteY,
        parent: Link::Base,
        subtree_end: 23,
        sign: -1.0,
        offset: [0.0, 0.027046299999999992, 0.0],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.67144,
        first: [0.0002952993119999981, -0.018190743728695998, 0.0195711196912],
        second: [0.00024703287263741757, 0.0006300641012199047, 0.0007326656053367039, -6.975129091880448e-6, 1.5114458440189705e-5, -0.0005312686543891564],
        rotor_inertia: 0.0,
    },
    // 13: torso_roll
    Body {
        kind: Kind::RevoluteX,
        parent: Link::Joint(12),
        subtree_end: 23,
        sign: 1.0,
        offset: [0.05734460000000001, -0.027046299809264998, 0.032],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.425685,
        first: [-0.024305038465500004, 4.831857178697152e-5, 0.015389576962500002],
        second: [0.001718202267737728, 0.00010604798453523029, 0.0010551311811367813, -2.851334770320462e-6, -0.000878862717123989, 1.7705377665284878e-6],
        rotor_inertia: 0.0,
    },
    // 14: torso_yaw
    Body {
        kind: Kind::RevoluteZ,
        parent: Link::Joint(13),
        subtree_end: 23,
        sign: -1.0,
        offset: [-0.06284210000000001, 0.0, 0.05],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 9.44779,
        first: [0.3631331577617, -0.0005686601846902259, 1.0314377483059998],
        second: [0.061774338573041855, 0.02571634536002872, 0.1910428995156107, -0.00032147266967712533, 0.026942898262610808, 0.00014575790321969613],
        rotor_inertia: 0.0,
    },
    // 15: l_shoulder_pitch
    Body {
        kind: Kind::RevoluteTilted,
        parent: Link::Joint(14),
        subtree_end: 19,
        sign: 1.0,
        offset: [-0.007969299999999999, -0.12001600019073501, 0.09280000000000001],
        tilt: [[-0.9659258492011171, 0.0, -0.2588189595935755], [0.2588189595935755, 0.0, -0.9659258492011171], [0.0, -1.0, 0.0]],
        mass: 0.114882,
        first: [-0.0007204317449833087, 3.791106000000603e-6, -0.0012616663750149029],
        second: [0.00500629762408723, 0.005000000125106497, 0.005012076219865895, 4.4327498507405416e-8, 4.829357271276613e-6, -4.171820269460743e-8],
        rotor_inertia: 0.0,
    },
    // 16: l_shoulder_roll
    Body {
        kind: Kind::RevoluteX,
        parent: Link::Joint(15),
        subtree_end: 19,
        sign: 1.0,
        offset: [0.011768388602136972, 0.0, -0.010999931221107389],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.238162,
        first: [-0.005789090465734442, 0.0037436684780000045, 6.405552839972012e-5],
        second: [0.005134233182158958, 0.005065331072811966, 0.005000017228239439, -7.97674882356712e-5, -2.6862330924168003e-6, 5.803938924185674e-7],
        rotor_inertia: 0.0,
    },
    // 17: l_shoulder_yaw
    Body {
        kind: Kind::RevoluteY,
        parent: Link::Joint(16),
        subtree_end: 19,
        sign: 1.0,
        offset: [-0.011768428049130805, 0.02305400000000002, 1.114953826115664e-7],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 1.105929,
        first: [0.008887940592090339, 0.0749722865496, 0.0025216909455201557],
        second: [0.005346873475509101, 0.01124840390047264, 0.005228020580137737, 0.000632546045114427, 3.18378914951267e-5, 0.00018194575546011464],
        rotor_inertia: 0.0,
    },
    // 18: l_elbow
    Body {
        kind: Kind::RevoluteTilted,
        parent: Link::Joint(17),
        subtree_end: 19,
        sign: 1.0,
        offset: [0.02328870648230237, 0.136006, -0.0289590978863494],
        tilt: [[0.9330127410165553, 0.24999994251134033, 0.25881895959357565], [0.2588189794466173, -0.9659258438815123, 0.0], [0.24999992195795961, 0.06698725898344433, -0.965925849201117]],
        mass: 1.1881092,
        first: [0.01092125763313239, -0.10816608601087958, -0.03549084711088003],
        second: [0.01577988704403842, 0.030641265905870123, 0.01621872413134382, -0.002564538557667438, -0.00019076168255502594, 0.002922839332180435],
        rotor_inertia: 0.0,
    },
    // 19: r_shoulder_pitch
    Body {
        kind: Kind::RevoluteTilted,
        parent: Link::Joint(14),
        subtree_end: 23,
        sign: 1.0,
        offset: [-0.007969299999999999, 0.12001599980926501, 0.09280000000000001],
        tilt: [[0.9659258492011171, 0.0, 0.25881895959357537], [0.25881895959357537, 0.0, -0.9659258492011171], [0.0, 1.0, 0.0]],
        mass: 0.114862,
        first: [0.000720852813347142, -3.675584000000488e-6, 0.001265398405251827],
        second: [0.005006302071057011, 0.0050000001176186875, 0.005012162363677923, 4.0451506654193256e-8, 1.102121875703804e-5, -4.0412604479465004e-8],
        rotor_inertia: 0.0,
    },
    // 20: r_shoulder_roll
    Body {
        kind: Kind::RevoluteX,
        parent: Link::Joint(19),
        subtree_end: 23,
        sign: 1.0,
        offset: [-0.011764072894610731, 0.0, 0.011000052334888455],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.238162,
        first: [0.00579215185871631, -0.003727949785999999, -6.471461155195986e-5],
        second: [0.005135737699883293, 0.005063482296422366, 0.005000017584594382, -8.178138316656961e-5, -2.7018965445556397e-6, 5.946798981310027e-7],
        rotor_inertia: 0.0,
    },
    // 21: r_shoulder_yaw
    Body {
        kind: Kind::RevoluteY,
        parent: Link::Joint(20),
        subtree_end: 23,
        sign: 1.0,
        offset: [0.01176411234160456, -0.023087999999999994, -2.32609163674704e-7],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 1.104234,
        first: [-0.008913952602646415, -0.07474682933040001, -0.0024830779034095236],
        second: [0.0053461793786527545, 0.011221647095640672, 0.005228705438327492, 0.0006341470753635649, 3.2831706307743674e-5, 0.00017938133746352283],
        rotor_inertia: 0.0,
    },
    // 22: r_elbow
    Body {
        kind: Kind::RevoluteTilted,
        parent: Link::Joint(21),
        subtree_end: 23,
        sign: 1.0,
        offset: [-0.020312288446976252, -0.13597199999999998, 0.01785095062053661],
        tilt: [[-0.9330127410165553, -0.2499999425113402, 0.2588189595935756], [-0.25881897944661714, 0.9659258438815124, 0.0], [-0.24999992195795953, -0.06698725898344428, -0.9659258492011171]],
        mass: 1.1871535,
        first: [0.010869885029511838, -0.10814439958526825, 0.022020153856850033],
        second: [0.015774465395538537, 0.03064868999467776, 0.01556731541077673, -0.0025528234824896204, 6.721768660487779e-5, -0.0016969073794980832],
        rotor_inertia: 0.0,
    },
];

/// [`BODIES`] in single precision.
pub static BODIES_F32: [Body<f32>; 23] = bodies_f32(&BODIES);

/// Limits and losses of the joints, as the source file has them.
pub static LIMITS: [JointLimits<f64>; 23] = [
    // l_hip_pitch
    JointLimits {
        lower: -0.7853981633974483,
        upper: 2.3387411976724017,
        speed: 5.1,
        effort: 55.5,
        damping: 1.0,
        friction: 0.0,
    },
    // l_hip_roll
    JointLimits {
        lower: -0.3490658503988659,
        upper: 2.0943951023931953,
        speed: 7.64,
        effort: 37.0,
        damping: 1.0,
        friction: 0.0,
    },
    // l_hip_yaw
    JointLimits {
        lower: -1.3962634015954636,
        upper: 1.3962634015954636,
        speed: 7.64,
        effort: 37.0,
        damping: 1.0,
        friction: 0.0,
    },
    // l_knee
    JointLimits {
        lower: -2.1642082724729685,
        upper: 0.06981317007977318,
        speed: 7.64,
        effort: 37.0,
        damping: 1.0,
        friction: 0.0,
    },
    // l_ankle_pitch
    JointLimits {
        lower: -0.6108652381980153,
        upper: 0.6108652381980153,
        speed: 7.64,
        effort: 37.0,
        damping: 1.0,
        friction: 0.0,
    },
    // l_ankle_roll
    JointLimits {
        lower: -0.4363323129985824,
        upper: 0.4363323129985824,
        speed: 7.64,
        effort: 37.0,
        damping: 1.0,
        friction: 0.0,
    },
    // r_hip_pitch
    JointLimits {
        lower: -0.7853981633974483,
        upper: 2.3387411976724017,
        speed: 5.1,
        effort: 55.5,
        damping: 1.0,
        friction: 0.0,
    },
    // r_hip_roll
    JointLimits {
        lower: -0.3490658503988659,
        upper: 2.0943951023931953,
        speed: 7.64,
        effort: 37.0,
        damping: 1.0,
        friction: 0.0,
    },
    // r_hip_yaw
    JointLimits {
        lower: -1.3962634015954636,
        upper: 1.3962634015954636,
        speed: 7.64,
        effort: 37.0,
        damping: 1.0,
        friction: 0.0,
    },
    // r_knee
    JointLimits {
        lower: -2.1642082724729685,
        upper: 0.06981317007977318,
        speed: 7.64,
        effort: 37.0,
        damping: 1.0,
        friction: 0.0,
    },
    // r_ankle_pitch
    JointLimits {
        lower: -0.6108652381980153,
        upper: 0.6108652381980153,
        speed: 7.64,
        effort: 37.0,
        damping: 1.0,
        friction: 0.0,
    },
    // r_ankle_roll
    JointLimits {
        lower: -0.4363323129985824,
        upper: 0.4363323129985824,
        speed: 7.64,
        effort: 37.0,
        damping: 1.0,
        friction: 0.0,
    },
    // torso_pitch
    JointLimits {
        lower: -0.3490658503988659,
        upper: 1.2217304763960306,
        speed: 50000.0,
        effort: 50000.0,
        damping: 1.0,
        friction: 0.0,
    },
    // torso_roll
    JointLimits {
        lower: -0.5235987755982988,
        upper: 0.5235987755982988,
        speed: 50000.0,
        effort: 50000.0,
        damping: 1.0,
        friction: 0.0,
    },
    // torso_yaw
    JointLimits {
        lower: -0.8726646259971648,
        upper: 0.8726646259971648,
        speed: 50000.0,
        effort: 50000.0,
        damping: 1.0,
        friction: 0.0,
    },
    // l_shoulder_pitch
    JointLimits {
        lower: -1.6667894356545847,
        upper: 0.17453292519943295,
        speed: 50000.0,
        effort: 50000.0,
        damping: 1.0,
        friction: 0.0,
    },
    // l_shoulder_roll
    JointLimits {
        lower: 0.0,
        upper: 2.8064894372068823,
        speed: 50000.0,
        effort: 50000.0,
        damping: 1.0,
        friction: 0.0,
    },
    // l_shoulder_yaw
    JointLimits {
        lower: -0.6457718232379019,
        upper: 1.3962634015954636,
        speed: 50000.0,
        effort: 50000.0,
        damping: 1.0,
        friction: 0.0,
    },
    // l_elbow
    JointLimits {
        lower: 0.2617993877991494,
        upper: 1.8500490071139892,
        speed: 50000.0,
        effort: 50000.0,
        damping: 1.0,
        friction: 0.0,
    },
    // r_shoulder_pitch
    JointLimits {
        lower: -1.6667894356545847,
        upper: 0.17453292519943295,
        speed: 50000.0,
        effort: 50000.0,
        damping: 1.0,
        friction: 0.0,
    },
    // r_shoulder_roll
    JointLimits {
        lower: 0.0,
        upper: 2.8064894372068823,
        speed: 50000.0,
        effort: 50000.0,
        damping: 1.0,
        friction: 0.0,
    },
    // r_shoulder_yaw
    JointLimits {
        lower: -0.6457718232379019,
        upper: 1.3962634015954636,
        speed: 50000.0,
        effort: 50000.0,
        damping: 1.0,
        friction: 0.0,
    },
    // r_elbow
    JointLimits {
        lower: 0.2617993877991494,
        upper: 1.8500490071139892,
        speed: 50000.0,
        effort: 50000.0,
        damping: 1.0,
        friction: 0.0,
    },
];

/// [`LIMITS`] in single precision.
pub static LIMITS_F32: [JointLimits<f32>; 23] = limits_f32(&LIMITS);

/// The frame of each link, which is also that of the joint above it.
pub mod frame {
    use super::{Frame, Link};

    /// Link `root_link`, the root.
    pub const ROOT_LINK: Frame<f64> = Frame {
        link: Link::Base,
        offset: [0.0, 0.0, 0.0],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `base_link`, joint `base_link_fixed_joint`.
    pub const BASE_LINK: Frame<f64> = Frame {
        link: Link::Base,
        offset: [0.0, 0.0, 0.0],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `l_hip_1`, joint `l_hip_pitch`.
    pub const L_HIP_1: Frame<f64> = Frame {
        link: Link::Joint(0),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `l_hip_2`, joint `l_hip_roll`.
    pub const L_HIP_2: Frame<f64> = Frame {
        link: Link::Joint(1),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `l_hip_3`, joint `l_leg_ft_sensor`.
    pub const L_HIP_3: Frame<f64> = Frame {
        link: Link::Joint(1),
        offset: [0.0008301999999999962, -7.519999999999749e-5, -0.07429999999999995],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_upper_leg`, joint `l_hip_yaw`.
    pub const L_UPPER_LEG: Frame<f64> = Frame {
        link: Link::Joint(2),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `l_lower_leg`, joint `l_knee`.
    pub const L_LOWER_LEG: Frame<f64> = Frame {
        link: Link::Joint(3),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `l_ankle_1`, joint `l_ankle_pitch`.
    pub const L_ANKLE_1: Frame<f64> = Frame {
        link: Link::Joint(4),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `l_ankle_2`, joint `l_ankle_roll`.
    pub const L_ANKLE_2: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `l_foot_ft_gyro_3b13`, joint `l_foot_ft_gyro_3b13_fixed_joint`.
    pub const L_FOOT_FT_GYRO_3B13: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.0040001999999999885, 0.008600000000000003, -0.045282000000000044],
        rotation: [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `l_foot`, joint `l_foot_ft_sensor`.
    pub const L_FOOT: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [0.003500000000000003, 0.0, -0.0605],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_foot_dh_frame`, joint `l_foot_dh_frame_fixed_joint`.
    pub const L_FOOT_DH_FRAME: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [0.003500000000000003, 0.0, -0.0645],
        rotation: [[3.6732051033465735e-6, 0.0, -0.9999999999932537], [0.0, 1.0, 0.0], [0.9999999999932537, 0.0, 3.6732051033465735e-6]],
    };
    /// Link `l_foot_ft`, joint `l_foot_ft_fixed_joint`.
    pub const L_FOOT_FT: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [0.003500000000000003, 0.0, -0.0605],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole`, joint `l_sole_fixed_joint`.
    pub const L_SOLE: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [0.0, 0.0, -0.0645],
        rotation: [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `l_sole_skin_0`, joint `l_sole_skin_0_fixed_joint`.
    pub const L_SOLE_SKIN_0: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.046636089999999984, -0.006414799999999998, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_10`, joint `l_sole_skin_10_fixed_joint`.
    pub const L_SOLE_SKIN_10: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.08970879999999998, 0.032367999999999994, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_11`, joint `l_sole_skin_11_fixed_joint`.
    pub const L_SOLE_SKIN_11: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.07535119999999998, 0.019439899999999996, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_12`, joint `l_sole_skin_12_fixed_joint`.
    pub const L_SOLE_SKIN_12: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.07936809999999997, 0.0005426000000000042, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_13`, joint `l_sole_skin_13_fixed_joint`.
    pub const L_SOLE_SKIN_13: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.09774249999999998, -0.005428100000000005, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_14`, joint `l_sole_skin_14_fixed_joint`.
    pub const L_SOLE_SKIN_14: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.05697679999999998, 0.02541059999999999, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_15`, joint `l_sole_skin_15_fixed_joint`.
    pub const L_SOLE_SKIN_15: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.04261922999999998, 0.012482499999999994, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_17`, joint `l_sole_skin_17_fixed_joint`.
    pub const L_SOLE_SKIN_17: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [0.041219100000000015, 0.004538500000000001, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_18`, joint `l_sole_skin_18_fixed_joint`.
    pub const L_SOLE_SKIN_18: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [0.055576699999999986, -0.008389699999999986, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_19`, joint `l_sole_skin_19_fixed_joint`.
    pub const L_SOLE_SKIN_19: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [0.051559799999999996, -0.027286999999999978, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_1`, joint `l_sole_skin_1_fixed_joint`.
    pub const L_SOLE_SKIN_1: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.06501049999999998, -0.012385499999999994, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_20`, joint `l_sole_skin_20_fixed_joint`.
    pub const L_SOLE_SKIN_20: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [0.03318539999999998, -0.03325779999999999, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_21`, joint `l_sole_skin_21_fixed_joint`.
    pub const L_SOLE_SKIN_21: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.024244799999999983, 0.0184533, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_22`, joint `l_sole_skin_22_fixed_joint`.
    pub const L_SOLE_SKIN_22: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.03227849999999999, -0.019342899999999996, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_24`, joint `l_sole_skin_24_fixed_joint`.
    pub const L_SOLE_SKIN_24: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [0.0004534000000000066, -0.02630029999999997, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_25`, joint `l_sole_skin_25_fixed_joint`.
    pub const L_SOLE_SKIN_25: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.013904099999999992, -0.013372199999999987, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_26`, joint `l_sole_skin_26_fixed_joint`.
    pub const L_SOLE_SKIN_26: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.009887299999999988, 0.005525100000000005, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_27`, joint `l_sole_skin_27_fixed_joint`.
    pub const L_SOLE_SKIN_27: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [0.008487100000000004, 0.011495900000000003, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_28`, joint `l_sole_skin_28_fixed_joint`.
    pub const L_SOLE_SKIN_28: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [0.022844700000000003, -0.0014322999999999975, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_29`, joint `l_sole_skin_29_fixed_joint`.
    pub const L_SOLE_SKIN_29: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [0.0188279, -0.020329600000000003, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_2`, joint `l_sole_skin_2_fixed_joint`.
    pub const L_SOLE_SKIN_2: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.06902739999999999, -0.031282799999999986, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_3`, joint `l_sole_skin_3_fixed_joint`.
    pub const L_SOLE_SKIN_3: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.08740179999999999, -0.03725379999999999, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_4`, joint `l_sole_skin_4_fixed_joint`.
    pub const L_SOLE_SKIN_4: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.10175929999999997, -0.024325399999999983, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_8`, joint `l_sole_skin_8_fixed_joint`.
    pub const L_SOLE_SKIN_8: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.11209999999999998, 0.007499500000000006, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_sole_skin_9`, joint `l_sole_skin_9_fixed_joint`.
    pub const L_SOLE_SKIN_9: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [-0.10808319999999996, 0.02639729999999999, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_lower_leg_ems_gyro_eb7`, joint `l_lower_leg_ems_gyro_eb7_fixed_joint`.
    pub const L_LOWER_LEG_EMS_GYRO_EB7: Frame<f64> = Frame {
        link: Link::Joint(3),
        offset: [-0.04450335399999999, -0.011818499999999968, -0.08830099999999996],
        rotation: [[-0.2164399916100446, 0.0, -0.976295923392003], [0.0, 1.0, 0.0], [0.976295923392003, 0.0, -0.2164399916100446]],
    };
    /// Link `l_upper_leg_back_contact`, joint `l_upper_leg_back_contact_fixed_joint`.
    pub const L_UPPER_LEG_BACK_CONTACT: Frame<f64> = Frame {
        link: Link::Joint(2),
        offset: [0.051256699999999995, 0.0, 0.014599999999999946],
        rotation: [[0.0, 0.0, -1.0], [0.0, -1.0, 0.0], [-1.0, 0.0, 0.0]],
    };
    /// Link `l_upper_leg_dh_frame`, joint `l_upper_leg_dh_frame_fixed_joint`.
    pub const L_UPPER_LEG_DH_FRAME: Frame<f64> = Frame {
        link: Link::Joint(2),
        offset: [0.0, 0.0, -0.14582499999999995],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
    };
    /// Link `l_upper_leg_ems_gyro_eb10`, joint `l_upper_leg_ems_gyro_eb10_fixed_joint`.
    pub const L_UPPER_LEG_EMS_GYRO_EB10: Frame<f64> = Frame {
        link: Link::Joint(2),
        offset: [0.013079, -0.04040679999999998, -0.035654999999999964],
        rotation: [[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]],
    };
    /// Link `l_upper_leg_ems_gyro_eb6`, joint `l_upper_leg_ems_gyro_eb6_fixed_joint`.
    pub const L_UPPER_LEG_EMS_GYRO_EB6: Frame<f64> = Frame {
        link: Link::Joint(2),
        offset: [0.013081000000000016, 0.04040720000000002, -0.087979],
        rotation: [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]],
    };
    /// Link `l_leg_ft`, joint `l_leg_ft_fixed_joint`.
    pub const L_LEG_FT: Frame<f64> = Frame {
        link: Link::Joint(1),
        offset: [0.0008301999999999962, -7.519999999999749e-5, -0.07429999999999995],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `l_upper_leg_ft_gyro_3b12`, joint `l_upper_leg_ft_gyro_3b12_fixed_joint`.
    pub const L_UPPER_LEG_FT_GYRO_3B12: Frame<f64> = Frame {
        link: Link::Joint(1),
        offset: [-0.006669999999999995, 0.008524799999999999, -0.059281999999999946],
        rotation: [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `r_hip_1`, joint `r_hip_pitch`.
    pub const R_HIP_1: Frame<f64> = Frame {
        link: Link::Joint(6),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `r_hip_2`, joint `r_hip_roll`.
    pub const R_HIP_2: Frame<f64> = Frame {
        link: Link::Joint(7),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `r_hip_3`, joint `r_leg_ft_sensor`.
    pub const R_HIP_3: Frame<f64> = Frame {
        link: Link::Joint(7),
        offset: [0.0009362999999999941, -1.3899999999969492e-5, -0.07429999999999995],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_upper_leg`, joint `r_hip_yaw`.
    pub const R_UPPER_LEG: Frame<f64> = Frame {
        link: Link::Joint(8),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `r_lower_leg`, joint `r_knee`.
    pub const R_LOWER_LEG: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `r_ankle_1`, joint `r_ankle_pitch`.
    pub const R_ANKLE_1: Frame<f64> = Frame {
        link: Link::Joint(10),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `r_ankle_2`, joint `r_ankle_roll`.
    pub const R_ANKLE_2: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `r_foot_ft_gyro_3b14`, joint `r_foot_ft_gyro_3b14_fixed_joint`.
    pub const R_FOOT_FT_GYRO_3B14: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.0040000999999999926, 0.00860000000000001, -0.045282000000000044],
        rotation: [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `r_foot`, joint `r_foot_ft_sensor`.
    pub const R_FOOT: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [0.003500000000000003, 0.0, -0.0605],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_foot_dh_frame`, joint `r_foot_dh_frame_fixed_joint`.
    pub const R_FOOT_DH_FRAME: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [0.003500000000000003, 0.0, -0.0645],
        rotation: [[3.6732051033465735e-6, 0.0, -0.9999999999932537], [0.0, 1.0, 0.0], [0.9999999999932537, 0.0, 3.6732051033465735e-6]],
    };
    /// Link `r_foot_ft`, joint `r_foot_ft_fixed_joint`.
    pub const R_FOOT_FT: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [0.003500000000000003, 0.0, -0.0605],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole`, joint `r_sole_fixed_joint`.
    pub const R_SOLE: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [0.0, 0.0, -0.0645],
        rotation: [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `r_sole_skin_0`, joint `r_sole_skin_0_fixed_joint`.
    pub const R_SOLE_SKIN_0: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.11209999999999998, -0.007499999999999993, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_10`, joint `r_sole_skin_10_fixed_joint`.
    pub const R_SOLE_SKIN_10: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.05697669999999999, -0.0254106, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_11`, joint `r_sole_skin_11_fixed_joint`.
    pub const R_SOLE_SKIN_11: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.07535119999999998, -0.019440400000000004, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_12`, joint `r_sole_skin_12_fixed_joint`.
    pub const R_SOLE_SKIN_12: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.07936799999999998, -0.0005426000000000042, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_13`, joint `r_sole_skin_13_fixed_joint`.
    pub const R_SOLE_SKIN_13: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.06501049999999997, 0.012385000000000007, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_14`, joint `r_sole_skin_14_fixed_joint`.
    pub const R_SOLE_SKIN_14: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.08970869999999999, -0.032368, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_15`, joint `r_sole_skin_15_fixed_joint`.
    pub const R_SOLE_SKIN_15: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.10808309999999997, -0.0263978, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_17`, joint `r_sole_skin_17_fixed_joint`.
    pub const R_SOLE_SKIN_17: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [0.03318549999999999, 0.03325689999999999, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_18`, joint `r_sole_skin_18_fixed_joint`.
    pub const R_SOLE_SKIN_18: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [0.051559900000000006, 0.027286999999999978, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_19`, joint `r_sole_skin_19_fixed_joint`.
    pub const R_SOLE_SKIN_19: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [0.05557670000000001, 0.008389200000000013, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_1`, joint `r_sole_skin_1_fixed_joint`.
    pub const R_SOLE_SKIN_1: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.09774239999999998, 0.005427600000000005, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_20`, joint `r_sole_skin_20_fixed_joint`.
    pub const R_SOLE_SKIN_20: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [0.04121920000000001, -0.004538399999999984, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_21`, joint `r_sole_skin_21_fixed_joint`.
    pub const R_SOLE_SKIN_21: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.03227849999999999, 0.01934240000000001, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_22`, joint `r_sole_skin_22_fixed_joint`.
    pub const R_SOLE_SKIN_22: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.024244799999999993, -0.018453200000000003, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_24`, joint `r_sole_skin_24_fixed_joint`.
    pub const R_SOLE_SKIN_24: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [0.0084872, -0.011495800000000007, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_25`, joint `r_sole_skin_25_fixed_joint`.
    pub const R_SOLE_SKIN_25: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.009887199999999999, -0.005525599999999992, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_26`, joint `r_sole_skin_26_fixed_joint`.
    pub const R_SOLE_SKIN_26: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.013904099999999989, 0.0133722, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_27`, joint `r_sole_skin_27_fixed_joint`.
    pub const R_SOLE_SKIN_27: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [0.0004535000000000164, 0.026299799999999998, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_28`, joint `r_sole_skin_28_fixed_joint`.
    pub const R_SOLE_SKIN_28: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [0.018827899999999995, 0.020329600000000003, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_29`, joint `r_sole_skin_29_fixed_joint`.
    pub const R_SOLE_SKIN_29: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [0.0228448, 0.001431799999999997, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_2`, joint `r_sole_skin_2_fixed_joint`.
    pub const R_SOLE_SKIN_2: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.10175929999999997, 0.024325399999999997, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_3`, joint `r_sole_skin_3_fixed_joint`.
    pub const R_SOLE_SKIN_3: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.08740169999999997, 0.03725289999999999, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_4`, joint `r_sole_skin_4_fixed_joint`.
    pub const R_SOLE_SKIN_4: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.06902729999999997, 0.03128289999999999, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_8`, joint `r_sole_skin_8_fixed_joint`.
    pub const R_SOLE_SKIN_8: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.04663603999999998, 0.006414799999999998, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_sole_skin_9`, joint `r_sole_skin_9_fixed_joint`.
    pub const R_SOLE_SKIN_9: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [-0.04261918999999999, -0.012483000000000008, -0.06800000000000006],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_lower_leg_ems_gyro_eb9`, joint `r_lower_leg_ems_gyro_eb9_fixed_joint`.
    pub const R_LOWER_LEG_EMS_GYRO_EB9: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.04450330799999999, -0.014343499999999974, -0.08830099999999996],
        rotation: [[-0.2164399916100446, 0.0, -0.976295923392003], [0.0, 1.0, 0.0], [0.976295923392003, 0.0, -0.2164399916100446]],
    };
    /// Link `r_lower_leg_skin_0`, joint `r_lower_leg_skin_0_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_0: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.05441169999999998, 0.03121489999999999, -0.002634000000000025],
        rotation: [[0.12280420123486427, 0.609243303674039, -0.7834166995203828], [-0.09434997226686824, 0.7929833522390226, 0.6018932511708396], [0.9879358333881347, 3.239344590899586e-7, 0.15486377596967896]],
    };
    /// Link `r_lower_leg_skin_10`, joint `r_lower_leg_skin_10_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_10: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.06446069999999998, -0.00034239999999997883, -0.021204999999999974],
        rotation: [[-0.09967250538055958, -0.00043002162632183125, -0.9950202041931426], [-4.286134038313577e-5, 0.9999999075406961, -0.00042788024563542737], [0.9950202961920264, 3.5746872540090185e-12, -0.09967251459621242]],
    };
    /// Link `r_lower_leg_skin_11`, joint `r_lower_leg_skin_11_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_11: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.060710799999999975, 0.016091600000000025, -0.030884999999999996],
        rotation: [[-0.23145972782014268, 0.26879128158035936, -0.934974674172415], [0.06459153562412809, 0.963198446295661, 0.26091509457933215], [0.9706978561443012, -1.1319896609237698e-7, -0.24030329185603083]],
    };
    /// Link `r_lower_leg_skin_14`, joint `r_lower_leg_skin_14_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_14: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.05504769999999998, 0.031175900000000006, -0.02190000000000003],
        rotation: [[-0.08378567781310123, 0.6083917456569563, -0.7892017764867744], [0.06422912574825815, 0.7936368715076649, 0.6049918475394035], [0.9944116751119798, -8.812522844639091e-8, -0.10557187315274176]],
    };
    /// Link `r_lower_leg_skin_15`, joint `r_lower_leg_skin_15_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_15: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.05917079999999998, 0.016178800000000007, 0.0072429999999999994],
        rotation: [[0.301732224290463, 0.2702027930602656, -0.9143019826332879], [-0.0846787767723818, 0.9628034330134129, 0.2565912199236752], [0.9496247519884172, 1.339689764123797e-7, 0.3133892633944551]],
    };
    /// Link `r_lower_leg_skin_16`, joint `r_lower_leg_skin_16_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_16: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.027287599999999978, 0.050286899999999995, -0.004549000000000025],
        rotation: [[0.014585836988852945, 0.9241394222273968, -0.38177687416152917], [-0.035282460813106216, 0.38205539949718725, 0.9234656570084326], [0.9992709348911867, 5.080640253507532e-7, 0.03817851072836181]],
    };
    /// Link `r_lower_leg_skin_17`, joint `r_lower_leg_skin_17_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_17: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.027874999999999976, 0.05031190000000001, -0.023882000000000014],
        rotation: [[-0.0027159811072926493, 0.9246810217642472, -0.38073301857817987], [0.0065966249628517295, 0.380742705759398, 0.9246574914800139], [0.9999745536691043, -2.0065695838099553e-7, -0.007133863906427285]],
    };
    /// Link `r_lower_leg_skin_19`, joint `r_lower_leg_skin_19_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_19: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.03575341, -0.041062799999999997, 0.006064999999999987],
        rotation: [[0.07508377775118744, -0.8321400713715003, -0.5494591230805481], [0.11266539099330505, 0.5545655070573899, -0.8244777789937735], [0.9907920750545677, -1.2061794735229765e-7, 0.13539225978263847]],
    };
    /// Link `r_lower_leg_skin_20`, joint `r_lower_leg_skin_20_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_20: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.0234419, -0.047990799999999986, -0.004952000000000012],
        rotation: [[0.02063959594261554, -0.9562896033743978, -0.2916919634775058], [0.06749733782768459, 0.2924212620142144, -0.9539045627882224], [0.9975059480852738, -2.2625669560127906e-7, 0.07058245911306733]],
    };
    /// Link `r_lower_leg_skin_21`, joint `r_lower_leg_skin_21_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_21: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.024270400000000004, -0.04853779999999998, -0.024276999999999993],
        rotation: [[0.004582133863866285, -0.9543559433983708, -0.29863646352958856], [0.014640274424455214, 0.29867161448668256, -0.954243642402031], [0.9998823262834633, 3.5232900746916687e-7, 0.015340586228877042]],
    };
    /// Link `r_lower_leg_skin_28`, joint `r_lower_leg_skin_28_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_28: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.04087215999999998, 0.0424399, -0.03275600000000001],
        rotation: [[-0.028859596009275238, 0.8014362370952434, -0.5973835297267563], [0.03867133196485434, 0.5980802269514474, 0.8005026984425283], [0.9988351474604032, 5.676929862227766e-7, -0.04825296050432828]],
    };
    /// Link `r_lower_leg_skin_29`, joint `r_lower_leg_skin_29_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_29: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.03846637999999998, 0.04351590000000001, -0.05242000000000002],
        rotation: [[-0.022238519909089257, 0.7928361941375461, -0.6090289135153966], [0.028930163539213908, 0.6094347949250056, 0.7923081953206786], [0.9993340251736891, 4.555076633065159e-7, -0.036489808576438625]],
    };
    /// Link `r_lower_leg_skin_31`, joint `r_lower_leg_skin_31_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_31: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.03914639999999998, 0.042270899999999986, 0.006327000000000027],
        rotation: [[0.09023557494895011, 0.8034473279462667, -0.5884980307780447], [-0.12177086814539514, 0.5953758403025724, 0.7941658922763698], [0.9884479736863996, -9.9784706220074e-8, 0.15156055989353184]],
    };
    /// Link `r_lower_leg_skin_32`, joint `r_lower_leg_skin_32_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_32: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.045983029999999994, -0.03258469999999997, -0.080733],
        rotation: [[-0.03864467137121261, -0.6019516276802529, -0.7975969077846937], [-0.029131062630623598, 0.7985325528324312, -0.6012463249425574], [0.9988282988405073, -1.2116588681317699e-7, -0.048394518649984036]],
    };
    /// Link `r_lower_leg_skin_35`, joint `r_lower_leg_skin_35_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_35: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.04774867999999998, 0.031231900000000007, -0.08011299999999999],
        rotation: [[-0.04557660243717679, 0.5154447050635292, -0.85570995631245], [0.027414995126982263, 0.8569228413467986, 0.5147151270560416], [0.9985845939891478, -3.1756818187376475e-7, -0.05318654573694442]],
    };
    /// Link `r_lower_leg_skin_36`, joint `r_lower_leg_skin_36_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_36: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.05322409999999998, 0.015601800000000027, -0.088362],
        rotation: [[-0.0537195369556195, 0.2059212370061379, -0.9770929615441593], [0.011304389481272163, 0.9785685689566398, 0.2056107162299909], [0.9984920741436707, -1.269277164708208e-7, -0.05489606426925664]],
    };
    /// Link `r_lower_leg_skin_37`, joint `r_lower_leg_skin_37_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_37: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.055257199999999985, -0.0009643999999999764, -0.078318],
        rotation: [[-0.04759362277682368, -0.007535271291023955, -0.9988383586734884], [-0.000358125250911598, 0.9999716094401401, -0.00752675627349644], [0.9988667172437382, -5.16360993808927e-7, -0.04759497013814907]],
    };
    /// Link `r_lower_leg_skin_38`, joint `r_lower_leg_skin_38_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_38: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.04880468999999998, 0.03126290000000001, -0.060757000000000005],
        rotation: [[-0.047145988184869196, 0.5159870921769925, -0.8552979460426664], [0.028398896753017593, 0.8565963580979217, 0.5152049902287328], [0.9984842304519804, 3.303193757932161e-7, -0.055038545934710775]],
    };
    /// Link `r_lower_leg_skin_3`, joint `r_lower_leg_skin_3_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_3: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.05157878999999999, -0.030420499999999996, -0.0028429999999999844],
        rotation: [[0.09423282791750368, -0.743091139257193, -0.6625222508717101], [0.10463927403251837, 0.669190226137118, -0.7356867971987131], [0.9900357551485793, 0.0, 0.1408162047755241]],
    };
    /// Link `r_lower_leg_skin_41`, joint `r_lower_leg_skin_41_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_41: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.05660089999999998, 0.015912900000000008, -0.049853999999999954],
        rotation: [[-0.15824505230891373, 0.24569095604245555, -0.956344319551642], [0.04010889472880179, 0.9693482109742259, 0.24239497198725374], [0.9865849076401803, -1.0861584374522152e-7, -0.16324895104289383]],
    };
    /// Link `r_lower_leg_skin_42`, joint `r_lower_leg_skin_42_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_42: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.05701059999999998, -0.000796199999999983, -0.059079999999999966],
        rotation: [[-0.13513092207890748, -0.0068764581941268355, -0.9908038898898253], [-0.0009296392652768134, 0.9999763568817742, -0.006813328723250997], [0.9908273157664461, 3.988074309732954e-7, -0.1351341197880841]],
    };
    /// Link `r_lower_leg_skin_43`, joint `r_lower_leg_skin_43_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_43: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.04712543999999999, -0.03236529999999998, -0.06136200000000003],
        rotation: [[-0.026257812174638243, -0.5844635785006046, -0.8109949769918857], [-0.018913379371199763, 0.8114199439293233, -0.584157477632954], [0.9994762685429617, -4.166011158738333e-8, -0.032360293871282586]],
    };
    /// Link `r_lower_leg_skin_46`, joint `r_lower_leg_skin_46_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_46: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.05581569999999999, -0.01721639999999998, -0.05018],
        rotation: [[-0.13521021229101302, -0.31988722725717117, -0.9377581566320488], [-0.04565029402995077, 0.9474556252603928, -0.3166131532602792], [0.9897647443444317, -3.9608721172806377e-7, -0.14270862220848773]],
    };
    /// Link `r_lower_leg_skin_47`, joint `r_lower_leg_skin_47_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_47: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.052641649999999984, -0.017638799999999975, -0.08886],
        rotation: [[-0.052017514554910445, -0.25962842241218215, -0.964306621596726], [-0.013984951278412403, 0.9657085907641783, -0.25925149731873365], [0.9985482458635988, 1.625853211254561e-7, -0.05386465151380314]],
    };
    /// Link `r_lower_leg_skin_49`, joint `r_lower_leg_skin_49_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_49: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.04113139, -0.03243849999999996, -0.138859],
        rotation: [[-0.06018330000827227, -0.6666959073438117, -0.7428960475942283], [-0.05383347302902501, 0.7453298378107108, -0.6645189162474556], [0.996734632478348, -2.6695615939395915e-7, -0.08074696538063336]],
    };
    /// Link `r_lower_leg_skin_4`, joint `r_lower_leg_skin_4_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_4: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.05831029999999999, -0.016783599999999996, 0.007272000000000001],
        rotation: [[0.28690405187779433, -0.37339735116332257, -0.8821907294685872], [0.11548193563501619, 0.9276715033589238, -0.355090839642174], [0.950973179200178, -9.236027154191363e-8, 0.3092733619985685]],
    };
    /// Link `r_lower_leg_skin_50`, joint `r_lower_leg_skin_50_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_50: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.04301696299999999, -0.03252729999999997, -0.11946899999999999],
        rotation: [[-0.055054430033341685, -0.640985913466346, -0.7655756451660527], [-0.045976330785827454, 0.7675526423234397, -0.639334903059248], [0.9974242761940257, 1.4041537904987293e-7, -0.07172735363028684]],
    };
    /// Link `r_lower_leg_skin_51`, joint `r_lower_leg_skin_51_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_51: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.05141583999999999, -0.01775899999999997, -0.10820600000000002],
        rotation: [[-0.06209535708371255, -0.2687390460633785, -0.9612093901692761], [-0.01732452249752307, 0.9632130216732364, -0.2681800436261916], [0.9979198502629754, -2.4186687592150035e-7, -0.06446683217796927]],
    };
    /// Link `r_lower_leg_skin_52`, joint `r_lower_leg_skin_52_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_52: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.052998339999999984, -0.001266399999999973, -0.11689500000000003],
        rotation: [[-0.0675540940391622, -0.010872522732794132, -0.997656370013229], [-0.0007344585438187243, 0.9999408923778546, -0.010847687367693723], [0.9977153426449828, -6.844779322298069e-8, -0.06755808649451131]],
    };
    /// Link `r_lower_leg_skin_53`, joint `r_lower_leg_skin_53_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_53: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.05207313999999998, 0.015433900000000028, -0.10765399999999997],
        rotation: [[-0.06335519999659961, 0.20983806300590205, -0.9756813547195222], [0.013596922012449606, 0.9777361542430116, 0.2093970782935457], [0.9978984128382901, 1.3048486869115688e-7, -0.0647978213739069]],
    };
    /// Link `r_lower_leg_skin_54`, joint `r_lower_leg_skin_54_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_54: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.045127099999999976, 0.03074890000000001, -0.11878700000000003],
        rotation: [[-0.061490682989086706, 0.5439352920620194, -0.8368711334219512], [0.03985883468755348, 0.8391271644091267, 0.542472925820311], [0.997311470506023, 3.225499280285938e-7, -0.07327912934123901]],
    };
    /// Link `r_lower_leg_skin_55`, joint `r_lower_leg_skin_55_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_55: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.04350267899999998, 0.030488900000000027, -0.13814300000000007],
        rotation: [[-0.06677271382930793, 0.5623487728012673, -0.8241997709395327], [0.04540967230801351, 0.8269001497936886, 0.5605123584115287], [0.9967343509424906, 2.897912995203632e-7, -0.08075044056330492]],
    };
    /// Link `r_lower_leg_skin_56`, joint `r_lower_leg_skin_56_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_56: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.049268409999999985, 0.015121000000000037, -0.1462179999999999],
        rotation: [[-0.07748807166789912, 0.22162542987841186, -0.9720482331553305], [0.017611567139504458, 0.9751318725337277, 0.22092456602142896], [0.9968377157050596, -2.741159837916941e-7, -0.07946425956267134]],
    };
    /// Link `r_lower_leg_skin_5`, joint `r_lower_leg_skin_5_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_5: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.06365039999999998, -0.00030939999999998746, -0.0019720000000000293],
        rotation: [[0.18323304518555827, -0.0001209555178718977, -0.9830694973000584], [2.216304803378936e-5, 0.9999999926848813, -0.00011890768101981852], [0.9830695044913286, 0.0, 0.18323304652592975]],
    };
    /// Link `r_lower_leg_skin_60`, joint `r_lower_leg_skin_60_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_60: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.04836967999999999, -0.018055999999999968, -0.14693799999999996],
        rotation: [[-0.07716647207452723, -0.2983398214766278, -0.9513352124823642], [-0.024120197996767023, 0.9544597167619429, -0.29736318724298816], [0.9967264176473742, -7.439800740950167e-8, -0.08084830464410803]],
    };
    /// Link `r_lower_leg_skin_61`, joint `r_lower_leg_skin_61_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_61: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.051619539999999985, -0.0014265999999999723, -0.13616899999999993],
        rotation: [[-0.07469918315965798, -0.013202683672332398, -0.9971187096725888], [-0.0009861931434749375, 0.9999128407735512, -0.013165799605437019], [0.99720562546466, -1.228414602090387e-7, -0.07470569283275055]],
    };
    /// Link `r_lower_leg_skin_6`, joint `r_lower_leg_skin_6_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_6: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.05208553999999999, -0.03044339999999999, -0.022148999999999974],
        rotation: [[-0.06878235540055175, -0.7429696245113031, -0.665781589291177], [-0.07634982336336996, 0.6693251355308668, -0.7390362422905721], [0.9947058319211436, -3.4673015330542516e-7, -0.10276335894639384]],
    };
    /// Link `r_lower_leg_skin_9`, joint `r_lower_leg_skin_9_fixed_joint`.
    pub const R_LOWER_LEG_SKIN_9: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [-0.05982139999999998, -0.01679719999999999, -0.03096199999999999],
        rotation: [[-0.2104614663514041, -0.3702657535897254, -0.9047702707869272], [-0.08388886232755392, 0.9289258698726247, -0.3606374731760086], [0.9739962166038457, -1.4274177970645538e-7, -0.22656427353264263]],
    };
    /// Link `r_upper_leg_back_contact`, joint `r_upper_leg_back_contact_fixed_joint`.
    pub const R_UPPER_LEG_BACK_CONTACT: Frame<f64> = Frame {
        link: Link::Joint(8),
        offset: [0.051199800000000004, 0.0, 0.014599999999999946],
        rotation: [[0.0, 0.0, -1.0], [0.0, -1.0, 0.0], [-1.0, 0.0, 0.0]],
    };
    /// Link `r_upper_leg_dh_frame`, joint `r_upper_leg_dh_frame_fixed_joint`.
    pub const R_UPPER_LEG_DH_FRAME: Frame<f64> = Frame {
        link: Link::Joint(8),
        offset: [0.0, 0.0, -0.14582499999999995],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
    };
    /// Link `r_upper_leg_ems_gyro_eb11`, joint `r_upper_leg_ems_gyro_eb11_fixed_joint`.
    pub const R_UPPER_LEG_EMS_GYRO_EB11: Frame<f64> = Frame {
        link: Link::Joint(8),
        offset: [0.013081000000000016, 0.040406899999999996, -0.087979],
        rotation: [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]],
    };
    /// Link `r_upper_leg_ems_gyro_eb8`, joint `r_upper_leg_ems_gyro_eb8_fixed_joint`.
    pub const R_UPPER_LEG_EMS_GYRO_EB8: Frame<f64> = Frame {
        link: Link::Joint(8),
        offset: [0.013078999999999993, -0.04040709999999999, -0.035654999999999964],
        rotation: [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]],
    };
    /// Link `r_leg_ft`, joint `r_leg_ft_fixed_joint`.
    pub const R_LEG_FT: Frame<f64> = Frame {
        link: Link::Joint(7),
        offset: [0.0009362999999999941, -1.3899999999969492e-5, -0.07429999999999995],
        rotation: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `r_upper_leg_ft_gyro_3b11`, joint `r_upper_leg_ft_gyro_3b11_fixed_joint`.
    pub const R_UPPER_LEG_FT_GYRO_3B11: Frame<f64> = Frame {
        link: Link::Joint(7),
        offset: [-0.006563800000000002, 0.008586100000000013, -0.059281999999999946],
        rotation: [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `root_link_ems_gyro_eb5`, joint `root_link_ems_gyro_eb5_fixed_joint`.
    pub const ROOT_LINK_EMS_GYRO_EB5: Frame<f64> = Frame {
        link: Link::Base,
        offset: [0.0493308, -0.012577100000000023, -0.11569100000000002],
        rotation: [[-0.2756369727060986, 0.0, 0.9612618057935192], [0.0, 1.0, 0.0], [-0.9612618057935192, 0.0, -0.2756369727060986]],
    };
    /// Link `torso_1`, joint `torso_pitch`.
    pub const TORSO_1: Frame<f64> = Frame {
        link: Link::Joint(12),
        offset: [0.0, 0.0, 0.0],
        rotation: [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };
    /// Link `torso_2`, joint `torso_roll`.
    pub const TORSO_2: Frame<f64> = Frame {
        link: Link::Joint(13),
        offset: [0.0, 0.0, 0.0],
        rotation: [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };
    /// Link `chest`, joint `torso_yaw`.
    pub const CHEST: Frame<f64> = Frame {
        link: Link::Joint(14),
        offset: [0.0, 0.0, 0.0],
        rotation: [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };
    /// Link `chest_ems_gyro_eb1`, joint `chest_ems_gyro_eb1_fixed_joint`.
    pub const CHEST_EMS_GYRO_EB1: Frame<f64> = Frame {
        link: Link::Joint(14),
        offset: [0.0635258, -0.069201600190735, 0.06454800000000001],
        rotation: [[-0.25881896910646823, -7.316047201270778e-5, 0.9659258438815117], [-0.965925805291554, -0.00027303859285320476, -0.2588189794466194], [0.00028267035191611425, -0.9999999600487353, -2.0715837804386773e-11]],
    };
    /// Link `chest_ems_gyro_eb2`, joint `chest_ems_gyro_eb2_fixed_joint`.
    pub const CHEST_EMS_GYRO_EB2: Frame<f64> = Frame {
        link: Link::Joint(14),
        offset: [0.0653479, -0.016037100190735, 0.08755899999999998],
        rotation: [[0.25881897943826515, -2.0792007499024717e-6, 0.9659258438815125], [0.965925843850344, -7.75968848312864e-6, -0.2588189794466167], [8.033420262478083e-6, 0.9999999999677321, -9.150784018300184e-13]],
    };
    /// Link `chest_ems_gyro_eb3`, joint `chest_ems_gyro_eb3_fixed_joint`.
    pub const CHEST_EMS_GYRO_EB3: Frame<f64> = Frame {
        link: Link::Joint(14),
        offset: [0.0770785, 0.018641699809265, 0.064521],
        rotation: [[0.25814392408617276, -0.0004671043112506147, 0.9661063586743205], [-0.9661064254510782, 0.00018426102260473833, 0.2581440310176006], [-0.000298595935406204, -0.999999873930711, -0.0004037066130238011]],
    };
    /// Link `chest_ems_gyro_eb4`, joint `chest_ems_gyro_eb4_fixed_joint`.
    pub const CHEST_EMS_GYRO_EB4: Frame<f64> = Frame {
        link: Link::Joint(14),
        offset: [0.0518054, 0.06657839980926501, 0.08755899999999998],
        rotation: [[-0.25881897943828264, 2.0756077679877497e-6, 0.9659258438815155], [0.9659258438503642, -7.757562224187627e-6, 0.25881897944660537], [8.030436522103835e-6, 0.9999999999677561, 2.9211529972776122e-9]],
    };
    /// Link `l_shoulder_1`, joint `l_shoulder_pitch`.
    pub const L_SHOULDER_1: Frame<f64> = Frame {
        link: Link::Joint(15),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-0.2588189595935755, 0.0, 0.9659258492011171], [0.0, -1.0, 0.0], [0.9659258492011171, 0.0, 0.2588189595935755]],
    };
    /// Link `l_shoulder_2`, joint `l_shoulder_roll`.
    pub const L_SHOULDER_2: Frame<f64> = Frame {
        link: Link::Joint(16),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-0.2588189595935755, 0.0, 0.9659258492011171], [0.9659258492011171, 6.118486717276994e-9, 0.2588189595935754], [-5.910004485798481e-9, 1.0, -1.5835803224284462e-9]],
    };
    /// Link `l_shoulder_3`, joint `l_shoulder_yaw`.
    pub const L_SHOULDER_3: Frame<f64> = Frame {
        link: Link::Joint(17),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-0.2499999425113396, -0.25881895959357565, 0.9330127410165556], [0.9659258438815125, 0.0, 0.25881897944661664], [-0.06698725898344443, 0.965925849201117, 0.2499999219579596]],
    };
    /// Link `l_arm_ft`, joint `l_arm_ft_fixed_joint`.
    pub const L_ARM_FT: Frame<f64> = Frame {
        link: Link::Joint(17),
        offset: [0.014488887738016761, 0.05674600000000001, 0.0038822843939036304],
        rotation: [[0.9659258492011172, 0.2588189595935758, 0.0], [0.0, 0.0, 1.0], [0.2588189595935758, -0.965925849201117, 0.0]],
    };
    /// Link `l_arm_ft_imu`, joint `l_arm_ft_imu_fixed_joint`.
    pub const L_ARM_FT_IMU: Frame<f64> = Frame {
        link: Link::Joint(17),
        offset: [0.014488887738016761, 0.05674600000000001, 0.0038822843939036304],
        rotation: [[0.9659258492011172, 0.2588189595935758, 0.0], [0.0, 0.0, 1.0], [0.2588189595935758, -0.965925849201117, 0.0]],
    };
    /// Link `l_upper_arm`, joint `l_arm_ft_sensor`.
    pub const L_UPPER_ARM: Frame<f64> = Frame {
        link: Link::Joint(17),
        offset: [0.014488887738016761, 0.05674600000000001, 0.0038822843939036304],
        rotation: [[0.9659258492011172, 0.2588189595935758, 0.0], [0.0, 0.0, 1.0], [0.2588189595935758, -0.965925849201117, 0.0]],
    };
    /// Link `l_elbow_1`, joint `l_elbow`.
    pub const L_ELBOW_1: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [0.0, 0.0, 0.0],
        rotation: [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]],
    };
    /// Link `l_forearm`, joint `l_wrist_prosup`.
    pub const L_FOREARM: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [-0.0052231681940338075, -0.03846242990265739, -0.03399990000000003],
        rotation: [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]],
    };
    /// Link `l_forearm_dh_frame`, joint `l_forearm_dh_frame_fixed_joint`.
    pub const L_FOREARM_DH_FRAME: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [0.022341053117030867, -0.14133353227603848, -0.03400690000000005],
        rotation: [[0.0, 0.2588189794466165, -0.9659258438815125], [0.0, -0.9659258438815125, -0.2588189794466165], [-1.0, 0.0, 0.0]],
    };
    /// Link `l_forearm_skin_0`, joint `l_forearm_skin_0_fixed_joint`.
    pub const L_FOREARM_SKIN_0: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [-0.011509728573048026, -0.08391175856448706, -0.0016830000000000317],
        rotation: [[0.2677208422339059, 0.9564496507347255, -0.1163168785816978], [-0.9609452840202024, 0.25627954560255495, -0.10442679553199274], [-0.07006933532509599, 0.13973138557664597, 0.9877071570723429]],
    };
    /// Link `l_forearm_skin_10`, joint `l_forearm_skin_10_fixed_joint`.
    pub const L_FOREARM_SKIN_10: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [-0.0373700764806275, -0.09269095099141046, -0.04154590000000004],
        rotation: [[0.3224385220253301, -0.18839200467370137, -0.9276539506136676], [-0.9464980894627617, -0.050479555845692345, -0.3187368524111443], [0.013219915183641389, 0.9807957315448746, -0.19458922587309818]],
    };
    /// Link `l_forearm_skin_11`, joint `l_forearm_skin_11_fixed_joint`.
    pub const L_FOREARM_SKIN_11: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [-0.03736629413920906, -0.0926865211050243, -0.022716700000000034],
        rotation: [[0.3231927743251551, 0.19013476463241064, -0.927035706918664], [-0.946236752144088, 0.0509464745033578, -0.31943773356866684], [-0.013507017280555172, 0.9804352237725125, 0.19637803459227884]],
    };
    /// Link `l_forearm_skin_12`, joint `l_forearm_skin_12_fixed_joint`.
    pub const L_FOREARM_SKIN_12: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [-0.039242286190124376, -0.07606189328949402, -0.013544300000000009],
        rotation: [[0.29057766996521933, 0.507096378651559, -0.8114295289648135], [-0.9566338120871943, 0.13587632284882212, -0.25766135616464714], [-0.020405079982851446, 0.8511115600481276, 0.5245881671019048]],
    };
    /// Link `l_forearm_skin_13`, joint `l_forearm_skin_13_fixed_joint`.
    pub const L_FOREARM_SKIN_13: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [-0.04711506911488423, -0.06131751674317612, -0.022712100000000027],
        rotation: [[0.2672941824854555, 0.18447141362199235, -0.9457928512976486], [-0.963613458953842, 0.04942883363596146, -0.2626897259665879], [-0.0017093075921571464, 0.9815941564423112, 0.1909711766363268]],
    };
    /// Link `l_forearm_skin_14`, joint `l_forearm_skin_14_fixed_joint`.
    pub const L_FOREARM_SKIN_14: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [-0.028247124045105727, -0.10723275753905806, -0.01460000000000003],
        rotation: [[0.3781476160805915, 0.5356052870152516, -0.7550704317968459], [-0.9218902677535061, 0.14351458325925898, -0.3598915095043085], [-0.08439617689169421, 0.8321841989086496, 0.5480389989889722]],
    };
    /// Link `l_forearm_skin_15`, joint `l_forearm_skin_15_fixed_joint`.
    pub const L_FOREARM_SKIN_15: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [-0.014017222749473774, -0.10184107186882727, -0.004615600000000025],
        rotation: [[0.28574454961439943, 0.9321596270668557, -0.22232517183675882], [-0.9520927147946241, 0.24977103478037652, -0.17644798842645582], [-0.10894730286090967, 0.26209322740452534, 0.9588731017960682]],
    };
    /// Link `l_forearm_skin_16`, joint `l_forearm_skin_16_fixed_joint`.
    pub const L_FOREARM_SKIN_16: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [0.01541378216644012, -0.07638725177263243, -0.001273100000000027],
        rotation: [[0.24820286095429098, 0.9566423673015769, 0.1524162750422003], [-0.9659216987905102, 0.2563315120676352, -0.035908602406314216], [-0.07342078465775131, -0.1383095694619664, 0.9876638352068409]],
    };
    /// Link `l_forearm_skin_17`, joint `l_forearm_skin_17_fixed_joint`.
    pub const L_FOREARM_SKIN_17: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [0.02510595582382848, -0.09277948478479485, -0.004035300000000033],
        rotation: [[0.22855491337498035, 0.9304632690054475, 0.28635774235010913], [-0.9676858032655594, 0.2493168706294848, -0.03775293601575755], [-0.10652153646302875, -0.26847570290664485, 0.9573786916462779]],
    };
    /// Link `l_forearm_skin_19`, joint `l_forearm_skin_19_fixed_joint`.
    pub const L_FOREARM_SKIN_19: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [0.015467437199011023, -0.07658904061642664, -0.06305390000000002],
        rotation: [[0.249892557143413, -0.9566374181938261, 0.14966148467717655], [-0.9662638532157432, -0.25633042485325186, -0.025077465247037634], [0.0623528335602406, -0.1383458109449002, -0.9884192231745632]],
    };
    /// Link `l_forearm_skin_1`, joint `l_forearm_skin_1_fixed_joint`.
    pub const L_FOREARM_SKIN_1: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [-0.025068854965129322, -0.07183532348522775, -0.0029337000000000113],
        rotation: [[0.2710103752374092, 0.9206744515946804, -0.28091267449959106], [-0.9617225853446472, 0.24669381591754996, -0.11929723394130282], [-0.04053449582376254, 0.3024908517110435, 0.9522899974689647]],
    };
    /// Link `l_forearm_skin_22`, joint `l_forearm_skin_22_fixed_joint`.
    pub const L_FOREARM_SKIN_22: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [0.025380583466816358, -0.09287982494478536, -0.060482900000000034],
        rotation: [[0.23218955059183508, -0.9277870089984097, 0.2920604021940435], [-0.9684029449675987, -0.24860017021058742, -0.019841661960357124], [0.09101510190096909, -0.2782251270195626, -0.95619403361499]],
    };
    /// Link `l_forearm_skin_24`, joint `l_forearm_skin_24_fixed_joint`.
    pub const L_FOREARM_SKIN_24: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [0.04484594051997926, -0.1084969618590626, -0.04147690000000004],
        rotation: [[0.03880755192649538, -0.23256387231070602, 0.9718065749979891], [-0.9977450912336049, -0.062315296836055085, 0.024930637767212133], [0.05476044952991133, -0.9705827368524973, -0.23445776611406596]],
    };
    /// Link `l_forearm_skin_25`, joint `l_forearm_skin_25_fixed_joint`.
    pub const L_FOREARM_SKIN_25: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [0.04024664431048758, -0.09206235153215021, -0.04998390000000005],
        rotation: [[0.1365523001850664, -0.5298109552457416, 0.8370506681293327], [-0.9873073990031587, -0.14196240330550466, 0.07120938085212317], [0.08110221444439726, -0.8361501227347397, -0.5424715688982188]],
    };
    /// Link `l_forearm_skin_28`, joint `l_forearm_skin_28_fixed_joint`.
    pub const L_FOREARM_SKIN_28: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [0.04012886920294682, -0.0920483571174157, -0.014347700000000019],
        rotation: [[0.13359370035937976, 0.5425403556171506, 0.8293387038786408], [-0.9873086319670904, 0.14537347144137797, 0.06393918238729077], [-0.08587425963326042, -0.8273551331368523, 0.5550757562752501]],
    };
    /// Link `l_forearm_skin_29`, joint `l_forearm_skin_29_fixed_joint`.
    pub const L_FOREARM_SKIN_29: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [0.04478793542925648, -0.1084980104057911, -0.022806300000000043],
        rotation: [[0.038304282699467264, 0.24589667870744966, 0.9685389023304766], [-0.9975682497838185, 0.06588765646882441, 0.022724518659262793], [-0.05822687480990453, -0.9670541040322881, 0.24782249882563176]],
    };
    /// Link `l_forearm_skin_2`, joint `l_forearm_skin_2_fixed_joint`.
    pub const L_FOREARM_SKIN_2: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [-0.02123490203109415, -0.053161322887883763, -0.0004815000000000236],
        rotation: [[0.2609587366578695, 0.9533745845109811, -0.15158311043926603], [-0.9652518063319125, 0.25545619108349005, -0.05505528866598894], [-0.013765468931666414, 0.16068302973752213, 0.98691006470674]],
    };
    /// Link `l_forearm_skin_3`, joint `l_forearm_skin_3_fixed_joint`.
    pub const L_FOREARM_SKIN_3: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [-0.011553177487540273, -0.08402972352466355, -0.06265090000000004],
        rotation: [[0.26649793329738913, -0.95642589224681, -0.11928270699524661], [-0.961983876981884, -0.25627365596890894, -0.09439721226409548], [0.059714922549759034, 0.13990470290959783, -0.9883626875437242]],
    };
    /// Link `l_forearm_skin_4`, joint `l_forearm_skin_4_fixed_joint`.
    pub const L_FOREARM_SKIN_4: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [-0.014221010774693663, -0.10199506320227489, -0.05987690000000004],
        rotation: [[0.283466429806304, -0.9299517386026119, -0.23417204581855414], [-0.954207350981236, -0.24917941470964647, -0.16552326307299003], [0.09557779295547676, 0.2703689759475693, -0.9580007841013611]],
    };
    /// Link `l_forearm_skin_5`, joint `l_forearm_skin_5_fixed_joint`.
    pub const L_FOREARM_SKIN_5: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [-0.02833650437310631, -0.10728362409945391, -0.04970890000000003],
        rotation: [[0.3761404070059856, -0.5235933949342092, -0.7644398936467409], [-0.9230805968321179, -0.14029621264101003, -0.3581049908485632], [0.08025338603094886, 0.8403373902783677, -0.5360899780174125]],
    };
    /// Link `l_forearm_skin_6`, joint `l_forearm_skin_6_fixed_joint`.
    pub const L_FOREARM_SKIN_6: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [-0.025055726537327763, -0.0718572735281311, -0.061307900000000054],
        rotation: [[0.2695120885741871, -0.921261609556763, -0.28042874472717977], [-0.962334099910687, -0.24685102261647582, -0.11391950132566389], [0.03572554074422594, 0.3005688263777239, -0.9530907964871185]],
    };
    /// Link `l_forearm_skin_7`, joint `l_forearm_skin_7_fixed_joint`.
    pub const L_FOREARM_SKIN_7: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [-0.02115581646435719, -0.053184855910084344, -0.0637019],
        rotation: [[0.26093719153265177, -0.9538049738410566, -0.14888873010108544], [-0.9652559699717801, -0.2555705378714118, -0.05444825622511078], [0.01388144476955705, 0.15792331065482043, -0.9873538035795127]],
    };
    /// Link `l_forearm_skin_8`, joint `l_forearm_skin_8_fixed_joint`.
    pub const L_FOREARM_SKIN_8: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [-0.047108314568984455, -0.06131529275808449, -0.041545900000000024],
        rotation: [[0.26731455644889374, -0.18536590997724917, -0.9456121865378202], [-0.9636077845604634, -0.04966851326127693, -0.2626653314103135], [0.0017220467492696822, 0.9814135306835344, -0.1918971504381256]],
    };
    /// Link `l_forearm_skin_9`, joint `l_forearm_skin_9_fixed_joint`.
    pub const L_FOREARM_SKIN_9: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [-0.0392395053126802, -0.07606570337094205, -0.050714900000000035],
        rotation: [[0.2891336591423639, -0.5064916284416988, -0.8123225698387454], [-0.9570913330720728, -0.13571411702902697, -0.2560426890136762], [0.019439838200712913, 0.8514974508226713, -0.5239982671089881]],
    };
    /// Link `l_wrist_1`, joint `l_wrist_pitch`.
    pub const L_WRIST_1: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [0.02026431255268562, -0.14188999308184871, -0.03400690000000005],
        rotation: [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]],
    };
    /// Link `l_hand`, joint `l_wrist_yaw`.
    pub const L_HAND: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [0.022630830870195323, -0.1412558865822045, -0.014507000000000048],
        rotation: [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]],
    };
    /// Link `l_hand_dh_frame`, joint `l_hand_dh_frame_fixed_joint`.
    pub const L_HAND_DH_FRAME: Frame<f64> = Frame {
        link: Link::Joint(18),
        offset: [0.03632466317852584, -0.19891018442504815, -0.008950200000000061],
        rotation: [[0.2588189794466164, -0.9659258438815125, 0.0], [-0.9659258438815125, -0.2588189794466164, 0.0], [0.0, 0.0, -1.0]],
    };
    /// Link `neck_1`, joint `neck_pitch`.
    pub const NECK_1: Frame<f64> = Frame {
        link: Link::Joint(14),
        offset: [-0.005311800000000002, 0.014299999809265, 0.17279699999999998],
        rotation: [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };
    /// Link `neck_2`, joint `neck_roll`.
    pub const NECK_2: Frame<f64> = Frame {
        link: Link::Joint(14),
        offset: [-0.02611177, 0.0, 0.182297],
        rotation: [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };
    /// Link `head`, joint `neck_yaw`.
    pub const HEAD: Frame<f64> = Frame {
        link: Link::Joint(14),
        offset: [-0.005311800000000002, 0.0, 0.15995299999999998],
        rotation: [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };
    /// Link `head_imu_0`, joint `head_imu_0_fixed_joint`.
    pub const HEAD_IMU_0: Frame<f64> = Frame {
        link: Link::Joint(14),
        offset: [-0.014611799999999998, -0.009500000190735, 0.293397],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `imu_frame`, joint `imu_frame_fixed_joint`.
    pub const IMU_FRAME: Frame<f64> = Frame {
        link: Link::Joint(14),
        offset: [-0.014611799999999998, -0.009500000190735, 0.293397],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `r_shoulder_1`, joint `r_shoulder_pitch`.
    pub const R_SHOULDER_1: Frame<f64> = Frame {
        link: Link::Joint(19),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-0.25881923511858407, 0.0, -0.9659257753743975], [0.0, -1.0, 0.0], [-0.9659257753743975, 0.0, 0.25881923511858407]],
    };
    /// Link `r_shoulder_2`, joint `r_shoulder_roll`.
    pub const R_SHOULDER_2: Frame<f64> = Frame {
        link: Link::Joint(20),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-0.2588189595935755, 0.0, -0.9659258492011169], [0.965925849201117, -6.118487147488416e-9, -0.2588189595935755], [-5.9100049021321155e-9, -1.0, 1.5835804334507486e-9]],
    };
    /// Link `r_shoulder_3`, joint `r_shoulder_yaw`.
    pub const R_SHOULDER_3: Frame<f64> = Frame {
        link: Link::Joint(21),
        offset: [0.0, 0.0, 0.0],
        rotation: [[-0.2499999425113396, 0.2588189595935756, -0.9330127410165554], [0.9659258438815123, 0.0, -0.2588189794466168], [-0.06698725898344485, -0.965925849201117, -0.24999992195795948]],
    };
    /// Link `r_arm_ft`, joint `r_arm_ft_fixed_joint`.
    pub const R_ARM_FT: Frame<f64> = Frame {
        link: Link::Joint(21),
        offset: [-0.01448888773801676, -0.05671200000000001, -0.0038822843939036065],
        rotation: [[-0.965925849201117, 0.2588189595935756, 0.0], [0.0, 0.0, -1.0], [-0.25881895959357565, -0.965925849201117, 0.0]],
    };
    /// Link `r_arm_ft_imu`, joint `r_arm_ft_imu_fixed_joint`.
    pub const R_ARM_FT_IMU: Frame<f64> = Frame {
        link: Link::Joint(21),
        offset: [-0.01448888773801676, -0.05671200000000001, -0.0038822843939036065],
        rotation: [[-0.965925849201117, 0.2588189595935756, 0.0], [0.0, 0.0, -1.0], [-0.25881895959357565, -0.965925849201117, 0.0]],
    };
    /// Link `r_upper_arm`, joint `r_arm_ft_sensor`.
    pub const R_UPPER_ARM: Frame<f64> = Frame {
        link: Link::Joint(21),
        offset: [-0.01448888773801676, -0.05671200000000001, -0.0038822843939036065],
        rotation: [[-0.965925849201117, 0.2588189595935756, 0.0], [0.0, 0.0, -1.0], [-0.25881895959357565, -0.965925849201117, 0.0]],
    };
    /// Link `r_elbow_1`, joint `r_elbow`.
    pub const R_ELBOW_1: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [0.0, 0.0, 0.0],
        rotation: [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };
    /// Link `r_forearm`, joint `r_wrist_prosup`.
    pub const R_FOREARM: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [-0.0052231681940338075, -0.0384624299026574, 0.022499900000000017],
        rotation: [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };
    /// Link `r_forearm_dh_frame`, joint `r_forearm_dh_frame_fixed_joint`.
    pub const R_FOREARM_DH_FRAME: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [0.022341053117030867, -0.1413335322760385, 0.022506900000000038],
        rotation: [[0.0, -0.25881897944661664, 0.9659258438815124], [0.0, 0.9659258438815124, 0.25881897944661664], [-1.0, 0.0, 0.0]],
    };
    /// Link `r_forearm_skin_0`, joint `r_forearm_skin_0_fixed_joint`.
    pub const R_FOREARM_SKIN_0: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [-0.011509728573048026, -0.08391175856448704, 0.05257690000000001],
        rotation: [[0.26772084223390585, 0.9564496507347255, -0.11631687858169822], [-0.9609452840202024, 0.25627954560255495, -0.10442679553199222], [-0.07006933532509536, 0.13973138557664624, 0.987707157072343]],
    };
    /// Link `r_forearm_skin_10`, joint `r_forearm_skin_10_fixed_joint`.
    pub const R_FOREARM_SKIN_10: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [-0.0373700764806275, -0.09269095099141048, 0.012713800000000025],
        rotation: [[0.32243852202533, -0.1883920046737018, -0.9276539506136675], [-0.9464980894627617, -0.05047955584569212, -0.31873685241114424], [0.013219915183641733, 0.9807957315448745, -0.19458922587309851]],
    };
    /// Link `r_forearm_skin_11`, joint `r_forearm_skin_11_fixed_joint`.
    pub const R_FOREARM_SKIN_11: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [-0.03736629413920906, -0.09268652110502432, 0.031542900000000026],
        rotation: [[0.32319277432515486, 0.19013476463241066, -0.9270357069186641], [-0.9462367521440881, 0.05094647450335826, -0.3194377335686665], [-0.013507017280554685, 0.9804352237725124, 0.196378034592279]],
    };
    /// Link `r_forearm_skin_12`, joint `r_forearm_skin_12_fixed_joint`.
    pub const R_FOREARM_SKIN_12: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [-0.039242286190124376, -0.076061893289494, 0.04071590000000003],
        rotation: [[0.2905776699652193, 0.507096378651559, -0.8114295289648135], [-0.9566338120871943, 0.1358763228488225, -0.2576613561646468], [-0.020405079982850963, 0.8511115600481275, 0.5245881671019049]],
    };
    /// Link `r_forearm_skin_13`, joint `r_forearm_skin_13_fixed_joint`.
    pub const R_FOREARM_SKIN_13: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [-0.04711506911488423, -0.06131751674317613, 0.031547900000000004],
        rotation: [[0.26729418248545533, 0.18447141362199235, -0.9457928512976486], [-0.963613458953842, 0.0494288336359617, -0.2626897259665877], [-0.001709307592156889, 0.9815941564423112, 0.19097117663632687]],
    };
    /// Link `r_forearm_skin_14`, joint `r_forearm_skin_14_fixed_joint`.
    pub const R_FOREARM_SKIN_14: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [-0.028247124045105727, -0.10723275753905807, 0.039659900000000026],
        rotation: [[0.2912589358839965, 0.5873979436929064, -0.7550707834455436], [-0.9329944288895103, -1.223745689504785e-7, -0.35989081074837315], [-0.21139921458902897, 0.8092982489449301, 0.5480389733639494]],
    };
    /// Link `r_forearm_skin_15`, joint `r_forearm_skin_15_fixed_joint`.
    pub const R_FOREARM_SKIN_15: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [-0.014017222749473774, -0.10184107186882728, 0.04964490000000002],
        rotation: [[0.2857445496143994, 0.9321596270668557, -0.22232517183675882], [-0.9520927147946241, 0.24977103478037657, -0.1764479884264553], [-0.10894730286090917, 0.26209322740452523, 0.9588731017960682]],
    };
    /// Link `r_forearm_skin_16`, joint `r_forearm_skin_16_fixed_joint`.
    pub const R_FOREARM_SKIN_16: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [0.01541378216644012, -0.07638725177263242, 0.05298690000000003],
        rotation: [[0.24820286095429098, 0.9566423673015769, 0.1524162750422003], [-0.9659216987905103, 0.25633151206763516, -0.035908602406313564], [-0.07342078465775068, -0.13830956946196657, 0.987663835206841]],
    };
    /// Link `r_forearm_skin_17`, joint `r_forearm_skin_17_fixed_joint`.
    pub const R_FOREARM_SKIN_17: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [0.02510595582382848, -0.09277948478479484, 0.050224900000000045],
        rotation: [[0.22855491337498035, 0.9304632690054475, 0.28635774235010913], [-0.9676858032655594, 0.24931687062948463, -0.037752936015756966], [-0.10652153646302816, -0.26847570290664496, 0.9573786916462778]],
    };
    /// Link `r_forearm_skin_19`, joint `r_forearm_skin_19_fixed_joint`.
    pub const R_FOREARM_SKIN_19: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [0.015467437199011023, -0.07658904061642666, -0.008794199999999974],
        rotation: [[0.24989255714341288, -0.9566374181938261, 0.14966148467717655], [-0.966263853215743, -0.25633042485325186, -0.02507746524703828], [0.062352833560241204, -0.13834581094490003, -0.9884192231745631]],
    };
    /// Link `r_forearm_skin_1`, joint `r_forearm_skin_1_fixed_joint`.
    pub const R_FOREARM_SKIN_1: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [-0.025068854965129322, -0.07183532348522775, 0.051325900000000035],
        rotation: [[0.27101037523740934, 0.9206744515946804, -0.280912674499591], [-0.9617225853446472, 0.24669381591755019, -0.11929723394130265], [-0.040534495823762305, 0.3024908517110435, 0.9522899974689648]],
    };
    /// Link `r_forearm_skin_22`, joint `r_forearm_skin_22_fixed_joint`.
    pub const R_FOREARM_SKIN_22: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [0.025380583466816358, -0.09287982494478539, -0.006222399999999989],
        rotation: [[0.2321895505918351, -0.9277870089984098, 0.29206040219404333], [-0.9684029449675987, -0.24860017021058758, -0.019841661960357554], [0.09101510190096948, -0.27822512701956237, -0.9561940336149901]],
    };
    /// Link `r_forearm_skin_24`, joint `r_forearm_skin_24_fixed_joint`.
    pub const R_FOREARM_SKIN_24: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [0.04484594051997926, -0.10849696185906262, 0.012783500000000031],
        rotation: [[0.03880755192649537, -0.23256387231070585, 0.9718065749979892], [-0.9977450912336049, -0.06231529683605536, 0.02493063776721207], [0.054760449529911624, -0.9705827368524974, -0.2344577661140658]],
    };
    /// Link `r_forearm_skin_25`, joint `r_forearm_skin_25_fixed_joint`.
    pub const R_FOREARM_SKIN_25: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [0.04024664431048758, -0.09206235153215023, 0.004276100000000005],
        rotation: [[0.13655230018506637, -0.5298109552457416, 0.8370506681293327], [-0.9873073990031586, -0.14196240330550514, 0.07120938085212283], [0.08110221444439782, -0.8361501227347394, -0.5424715688982189]],
    };
    /// Link `r_forearm_skin_28`, joint `r_forearm_skin_28_fixed_joint`.
    pub const R_FOREARM_SKIN_28: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [0.04012886920294682, -0.09204835711741569, 0.03991190000000003],
        rotation: [[0.05313568689071264, 0.5562143423885344, 0.8293384134959277], [-0.9979538070094293, -2.3292102008937166e-7, 0.06393902623071986], [0.03556399659823237, -0.8310388711253139, 0.5550762081234657]],
    };
    /// Link `r_forearm_skin_29`, joint `r_forearm_skin_29_fixed_joint`.
    pub const R_FOREARM_SKIN_29: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [0.04478793542925648, -0.10849801040579111, 0.031453900000000035],
        rotation: [[0.038304282699467264, 0.24589667870744972, 0.9685389023304766], [-0.9975682497838186, 0.06588765646882384, 0.02272451865926294], [-0.058226874809903954, -0.9670541040322882, 0.24782249882563182]],
    };
    /// Link `r_forearm_skin_2`, joint `r_forearm_skin_2_fixed_joint`.
    pub const R_FOREARM_SKIN_2: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [-0.02123490203109415, -0.05316132288788376, 0.05377889999999999],
        rotation: [[0.2609587366578698, 0.9533745845109811, -0.1515831104392656], [-0.9652518063319124, 0.25545619108349044, -0.055055288665988474], [-0.01376546893166603, 0.16068302973752158, 0.9869100647067401]],
    };
    /// Link `r_forearm_skin_3`, joint `r_forearm_skin_3_fixed_joint`.
    pub const R_FOREARM_SKIN_3: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [-0.011553177487540273, -0.08402972352466356, -0.008391099999999985],
        rotation: [[0.2664979332973891, -0.9564258922468101, -0.11928270699524576], [-0.9619838769818839, -0.2562736559689089, -0.09439721226409546], [0.059714922549759235, 0.139904702909597, -0.9883626875437242]],
    };
    /// Link `r_forearm_skin_4`, joint `r_forearm_skin_4_fixed_joint`.
    pub const R_FOREARM_SKIN_4: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [-0.014221010774693663, -0.10199506320227493, -0.005616399999999994],
        rotation: [[0.03930305382442277, -0.9714003530787438, -0.23417221013298353], [-0.9862059066935551, 1.5952535882546304e-8, -0.16552313917619685], [0.16078923957410027, 0.23744758166486224, -0.9580007653434788]],
    };
    /// Link `r_forearm_skin_5`, joint `r_forearm_skin_5_fixed_joint`.
    pub const R_FOREARM_SKIN_5: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [-0.02833650437310631, -0.10728362409945393, 0.004551600000000017],
        rotation: [[0.3761404070059855, -0.5235933949342093, -0.764439893646741], [-0.9230805968321179, -0.1402962126410094, -0.3581049908485634], [0.08025338603094949, 0.8403373902783677, -0.5360899780174122]],
    };
    /// Link `r_forearm_skin_6`, joint `r_forearm_skin_6_fixed_joint`.
    pub const R_FOREARM_SKIN_6: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [-0.025055726537327763, -0.07185727352813112, -0.007047999999999985],
        rotation: [[0.2695120885741871, -0.921261609556763, -0.2804287447271802], [-0.962334099910687, -0.24685102261647565, -0.1139195013256645], [0.03572554074422643, 0.30056882637772453, -0.9530907964871185]],
    };
    /// Link `r_forearm_skin_7`, joint `r_forearm_skin_7_fixed_joint`.
    pub const R_FOREARM_SKIN_7: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [-0.02115581646435719, -0.053184855910084365, -0.009442299999999987],
        rotation: [[0.2609371915326517, -0.9538049738410566, -0.1488887301010848], [-0.9652559699717801, -0.2555705378714118, -0.054448256225110805], [0.013881444769557258, 0.15792331065481982, -0.9873538035795129]],
    };
    /// Link `r_forearm_skin_8`, joint `r_forearm_skin_8_fixed_joint`.
    pub const R_FOREARM_SKIN_8: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [-0.047108314568984455, -0.0613152927580845, 0.012713700000000008],
        rotation: [[0.26731455644889357, -0.18536590997724917, -0.9456121865378203], [-0.9636077845604635, -0.04966851326127661, -0.2626653314103134], [0.0017220467492699678, 0.9814135306835344, -0.19189715043812555]],
    };
    /// Link `r_forearm_skin_9`, joint `r_forearm_skin_9_fixed_joint`.
    pub const R_FOREARM_SKIN_9: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [-0.0392395053126802, -0.07606570337094207, 0.0035449000000000036],
        rotation: [[0.28913365914236394, -0.5064916284416988, -0.8123225698387454], [-0.9570913330720728, -0.13571411702902658, -0.2560426890136765], [0.019439838200713377, 0.8514974508226713, -0.5239982671089879]],
    };
    /// Link `r_wrist_1`, joint `r_wrist_pitch`.
    pub const R_WRIST_1: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [0.019974534799521163, -0.1419676387756827, 0.022506900000000038],
        rotation: [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };
    /// Link `r_hand`, joint `r_wrist_yaw`.
    pub const R_HAND: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [0.022341053117030867, -0.14133353227603848, 0.0030070000000000374],
        rotation: [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };
    /// Link `r_hand_dh_frame`, joint `r_hand_dh_frame_fixed_joint`.
    pub const R_HAND_DH_FRAME: Frame<f64> = Frame {
        link: Link::Joint(22),
        offset: [0.03603488542536138, -0.19898783011888213, -0.0025497999999999493],
        rotation: [[0.2588189794466164, -0.9659258438815125, 0.0], [-0.9659258438815125, -0.2588189794466164, 0.0], [0.0, 0.0, -1.0]],
    };
}

/// Names of the links, depth first.
pub static FRAME_NAMES: [&str; 213] = [
    "root_link",
    "base_link",
    "l_hip_1",
    "l_hip_2",
    "l_hip_3",
    "l_upper_leg",
    "l_lower_leg",
    "l_ankle_1",
    "l_ankle_2",
    "l_foot_ft_gyro_3b13",
    "l_foot",
    "l_foot_dh_frame",
    "l_foot_ft",
    "l_sole",
    "l_sole_skin_0",
    "l_sole_skin_10",
    "l_sole_skin_11",
    "l_sole_skin_12",
    "l_sole_skin_13",
    "l_sole_skin_14",
    "l_sole_skin_15",
    "l_sole_skin_17",
    "l_sole_skin_18",
    "l_sole_skin_19",
    "l_sole_skin_1",
    "l_sole_skin_20",
    "l_sole_skin_21",
    "l_sole_skin_22",
    "l_sole_skin_24",
    "l_sole_skin_25",
    "l_sole_skin_26",
    "l_sole_skin_27",
    "l_sole_skin_28",
    "l_sole_skin_29",
    "l_sole_skin_2",
    "l_sole_skin_3",
    "l_sole_skin_4",
    "l_sole_skin_8",
    "l_sole_skin_9",
    "l_lower_leg_ems_gyro_eb7",
    "l_upper_leg_back_contact",
    "l_upper_leg_dh_frame",
    "l_upper_leg_ems_gyro_eb10",
    "l_upper_leg_ems_gyro_eb6",
    "l_leg_ft",
    "l_upper_leg_ft_gyro_3b12",
    "r_hip_1",
    "r_hip_2",
    "r_hip_3",
    "r_upper_leg",
    "r_lower_leg",
    "r_ankle_1",
    "r_ankle_2",
    "r_foot_ft_gyro_3b14",
    "r_foot",
    "r_foot_dh_frame",
    "r_foot_ft",
    "r_sole",
    "r_sole_skin_0",
    "r_sole_skin_10",
    "r_sole_skin_11",
    "r_sole_skin_12",
    "r_sole_skin_13",
    "r_sole_skin_14",
    "r_sole_skin_15",
    "r_sole_skin_17",
    "r_sole_skin_18",
    "r_sole_skin_19",
    "r_sole_skin_1",
    "r_sole_skin_20",
    "r_sole_skin_21",
    "r_sole_skin_22",
    "r_sole_skin_24",
    "r_sole_skin_25",
    "r_sole_skin_26",
    "r_sole_skin_27",
    "r_sole_skin_28",
    "r_sole_skin_29",
    "r_sole_skin_2",
    "r_sole_skin_3",
    "r_sole_skin_4",
    "r_sole_skin_8",
    "r_sole_skin_9",
    "r_lower_leg_ems_gyro_eb9",
    "r_lower_leg_skin_0",
    "r_lower_leg_skin_10",
    "r_lower_leg_skin_11",
    "r_lower_leg_skin_14",
    "r_lower_leg_skin_15",
    "r_lower_leg_skin_16",
    "r_lower_leg_skin_17",
    "r_lower_leg_skin_19",
    "r_lower_leg_skin_20",
    "r_lower_leg_skin_21",
    "r_lower_leg_skin_28",
    "r_lower_leg_skin_29",
    "r_lower_leg_skin_31",
    "r_lower_leg_skin_32",
    "r_lower_leg_skin_35",
    "r_lower_leg_skin_36",
    "r_lower_leg_skin_37",
    "r_lower_leg_skin_38",
    "r_lower_leg_skin_3",
    "r_lower_leg_skin_41",
    "r_lower_leg_skin_42",
    "r_lower_leg_skin_43",
    "r_lower_leg_skin_46",
    "r_lower_leg_skin_47",
    "r_lower_leg_skin_49",
    "r_lower_leg_skin_4",
    "r_lower_leg_skin_50",
    "r_lower_leg_skin_51",
    "r_lower_leg_skin_52",
    "r_lower_leg_skin_53",
    "r_lower_leg_skin_54",
    "r_lower_leg_skin_55",
    "r_lower_leg_skin_56",
    "r_lower_leg_skin_5",
    "r_lower_leg_skin_60",
    "r_lower_leg_skin_61",
    "r_lower_leg_skin_6",
    "r_lower_leg_skin_9",
    "r_upper_leg_back_contact",
    "r_upper_leg_dh_frame",
    "r_upper_leg_ems_gyro_eb11",
    "r_upper_leg_ems_gyro_eb8",
    "r_leg_ft",
    "r_upper_leg_ft_gyro_3b11",
    "root_link_ems_gyro_eb5",
    "torso_1",
    "torso_2",
    "chest",
    "chest_ems_gyro_eb1",
    "chest_ems_gyro_eb2",
    "chest_ems_gyro_eb3",
    "chest_ems_gyro_eb4",
    "l_shoulder_1",
    "l_shoulder_2",
    "l_shoulder_3",
    "l_arm_ft",
    "l_arm_ft_imu",
    "l_upper_arm",
    "l_elbow_1",
    "l_forearm",
    "l_forearm_dh_frame",
    "l_forearm_skin_0",
    "l_forearm_skin_10",
    "l_forearm_skin_11",
    "l_forearm_skin_12",
    "l_forearm_skin_13",
    "l_forearm_skin_14",
    "l_forearm_skin_15",
    "l_forearm_skin_16",
    "l_forearm_skin_17",
    "l_forearm_skin_19",
    "l_forearm_skin_1",
    "l_forearm_skin_22",
    "l_forearm_skin_24",
    "l_forearm_skin_25",
    "l_forearm_skin_28",
    "l_forearm_skin_29",
    "l_forearm_skin_2",
    "l_forearm_skin_3",
    "l_forearm_skin_4",
    "l_forearm_skin_5",
    "l_forearm_skin_6",
    "l_forearm_skin_7",
    "l_forearm_skin_8",
    "l_forearm_skin_9",
    "l_wrist_1",
    "l_hand",
    "l_hand_dh_frame",
    "neck_1",
    "neck_2",
    "head",
    "head_imu_0",
    "imu_frame",
    "r_shoulder_1",
    "r_shoulder_2",
    "r_shoulder_3",
    "r_arm_ft",
    "r_arm_ft_imu",
    "r_upper_arm",
    "r_elbow_1",
    "r_forearm",
    "r_forearm_dh_frame",
    "r_forearm_skin_0",
    "r_forearm_skin_10",
    "r_forearm_skin_11",
    "r_forearm_skin_12",
    "r_forearm_skin_13",
    "r_forearm_skin_14",
    "r_forearm_skin_15",
    "r_forearm_skin_16",
    "r_forearm_skin_17",
    "r_forearm_skin_19",
    "r_forearm_skin_1",
    "r_forearm_skin_22",
    "r_forearm_skin_24",
    "r_forearm_skin_25",
    "r_forearm_skin_28",
    "r_forearm_skin_29",
    "r_forearm_skin_2",
    "r_forearm_skin_3",
    "r_forearm_skin_4",
    "r_forearm_skin_5",
    "r_forearm_skin_6",
    "r_forearm_skin_7",
    "r_forearm_skin_8",
    "r_forearm_skin_9",
    "r_wrist_1",
    "r_hand",
    "r_hand_dh_frame",
];

/// The frame of each link, in the order of [`FRAME_NAMES`].
pub static FRAMES: [Frame<f64>; 213] = [
    frame::ROOT_LINK,
    frame::BASE_LINK,
    frame::L_HIP_1,
    frame::L_HIP_2,
    frame::L_HIP_3,
    frame::L_UPPER_LEG,
    frame::L_LOWER_LEG,
    frame::L_ANKLE_1,
    frame::L_ANKLE_2,
    frame::L_FOOT_FT_GYRO_3B13,
    frame::L_FOOT,
    frame::L_FOOT_DH_FRAME,
    frame::L_FOOT_FT,
    frame::L_SOLE,
    frame::L_SOLE_SKIN_0,
    frame::L_SOLE_SKIN_10,
    frame::L_SOLE_SKIN_11,
    frame::L_SOLE_SKIN_12,
    frame::L_SOLE_SKIN_13,
    frame::L_SOLE_SKIN_14,
    frame::L_SOLE_SKIN_15,
    frame::L_SOLE_SKIN_17,
    frame::L_SOLE_SKIN_18,
    frame::L_SOLE_SKIN_19,
    frame::L_SOLE_SKIN_1,
    frame::L_SOLE_SKIN_20,
    frame::L_SOLE_SKIN_21,
    frame::L_SOLE_SKIN_22,
    frame::L_SOLE_SKIN_24,
    frame::L_SOLE_SKIN_25,
    frame::L_SOLE_SKIN_26,
    frame::L_SOLE_SKIN_27,
    frame::L_SOLE_SKIN_28,
    frame::L_SOLE_SKIN_29,
    frame::L_SOLE_SKIN_2,
    frame::L_SOLE_SKIN_3,
    frame::L_SOLE_SKIN_4,
    frame::L_SOLE_SKIN_8,
    frame::L_SOLE_SKIN_9,
    frame::L_LOWER_LEG_EMS_GYRO_EB7,
    frame::L_UPPER_LEG_BACK_CONTACT,
    frame::L_UPPER_LEG_DH_FRAME,
    frame::L_UPPER_LEG_EMS_GYRO_EB10,
    frame::L_UPPER_LEG_EMS_GYRO_EB6,
    frame::L_LEG_FT,
    frame::L_UPPER_LEG_FT_GYRO_3B12,
    frame::R_HIP_1,
    frame::R_HIP_2,
    frame::R_HIP_3,
    frame::R_UPPER_LEG,
    frame::R_LOWER_LEG,
    frame::R_ANKLE_1,
    frame::R_ANKLE_2,
    frame::R_FOOT_FT_GYRO_3B14,
    frame::R_FOOT,
    frame::R_FOOT_DH_FRAME,
    frame::R_FOOT_FT,
    frame::R_SOLE,
    frame::R_SOLE_SKIN_0,
    frame::R_SOLE_SKIN_10,
    frame::R_SOLE_SKIN_11,
    frame::R_SOLE_SKIN_12,
    frame::R_SOLE_SKIN_13,
    frame::R_SOLE_SKIN_14,
    frame::R_SOLE_SKIN_15,
    frame::R_SOLE_SKIN_17,
    frame::R_SOLE_SKIN_18,
    frame::R_SOLE_SKIN_19,
    frame::R_SOLE_SKIN_1,
    frame::R_SOLE_SKIN_20,
    frame::R_SOLE_SKIN_21,
    frame::R_SOLE_SKIN_22,
    frame::R_SOLE_SKIN_24,
    frame::R_SOLE_SKIN_25,
    frame::R_SOLE_SKIN_26,
    frame::R_SOLE_SKIN_27,
    frame::R_SOLE_SKIN_28,
    frame::R_SOLE_SKIN_29,
    frame::R_SOLE_SKIN_2,
    frame::R_SOLE_SKIN_3,
    frame::R_SOLE_SKIN_4,
    frame::R_SOLE_SKIN_8,
    frame::R_SOLE_SKIN_9,
    frame::R_LOWER_LEG_EMS_GYRO_EB9,
    frame::R_LOWER_LEG_SKIN_0,
    frame::R_LOWER_LEG_SKIN_10,
    frame::R_LOWER_LEG_SKIN_11,
    frame::R_LOWER_LEG_SKIN_14,
    frame::R_LOWER_LEG_SKIN_15,
    frame::R_LOWER_LEG_SKIN_16,
    frame::R_LOWER_LEG_SKIN_17,
    frame::R_LOWER_LEG_SKIN_19,
    frame::R_LOWER_LEG_SKIN_20,
    frame::R_LOWER_LEG_SKIN_21,
    frame::R_LOWER_LEG_SKIN_28,
    frame::R_LOWER_LEG_SKIN_29,
    frame::R_LOWER_LEG_SKIN_31,
    frame::R_LOWER_LEG_SKIN_32,
    frame::R_LOWER_LEG_SKIN_35,
    frame::R_LOWER_LEG_SKIN_36,
    frame::R_LOWER_LEG_SKIN_37,
    frame::R_LOWER_LEG_SKIN_38,
    frame::R_LOWER_LEG_SKIN_3,
    frame::R_LOWER_LEG_SKIN_41,
    frame::R_LOWER_LEG_SKIN_42,
    frame::R_LOWER_LEG_SKIN_43,
    frame::R_LOWER_LEG_SKIN_46,
    frame::R_LOWER_LEG_SKIN_47,
    frame::R_LOWER_LEG_SKIN_49,
    frame::R_LOWER_LEG_SKIN_4,
    frame::R_LOWER_LEG_SKIN_50,
    frame::R_LOWER_LEG_SKIN_51,
    frame::R_LOWER_LEG_SKIN_52,
    frame::R_LOWER_LEG_SKIN_53,
    frame::R_LOWER_LEG_SKIN_54,
    frame::R_LOWER_LEG_SKIN_55,
    frame::R_LOWER_LEG_SKIN_56,
    frame::R_LOWER_LEG_SKIN_5,
    frame::R_LOWER_LEG_SKIN_60,
    frame::R_LOWER_LEG_SKIN_61,
    frame::R_LOWER_LEG_SKIN_6,
    frame::R_LOWER_LEG_SKIN_9,
    frame::R_UPPER_LEG_BACK_CONTACT,
    frame::R_UPPER_LEG_DH_FRAME,
    frame::R_UPPER_LEG_EMS_GYRO_EB11,
    frame::R_UPPER_LEG_EMS_GYRO_EB8,
    frame::R_LEG_FT,
    frame::R_UPPER_LEG_FT_GYRO_3B11,
    frame::ROOT_LINK_EMS_GYRO_EB5,
    frame::TORSO_1,
    frame::TORSO_2,
    frame::CHEST,
    frame::CHEST_EMS_GYRO_EB1,
    frame::CHEST_EMS_GYRO_EB2,
    frame::CHEST_EMS_GYRO_EB3,
    frame::CHEST_EMS_GYRO_EB4,
    frame::L_SHOULDER_1,
    frame::L_SHOULDER_2,
    frame::L_SHOULDER_3,
    frame::L_ARM_FT,
    frame::L_ARM_FT_IMU,
    frame::L_UPPER_ARM,
    frame::L_ELBOW_1,
    frame::L_FOREARM,
    frame::L_FOREARM_DH_FRAME,
    frame::L_FOREARM_SKIN_0,
    frame::L_FOREARM_SKIN_10,
    frame::L_FOREARM_SKIN_11,
    frame::L_FOREARM_SKIN_12,
    frame::L_FOREARM_SKIN_13,
    frame::L_FOREARM_SKIN_14,
    frame::L_FOREARM_SKIN_15,
    frame::L_FOREARM_SKIN_16,
    frame::L_FOREARM_SKIN_17,
    frame::L_FOREARM_SKIN_19,
    frame::L_FOREARM_SKIN_1,
    frame::L_FOREARM_SKIN_22,
    frame::L_FOREARM_SKIN_24,
    frame::L_FOREARM_SKIN_25,
    frame::L_FOREARM_SKIN_28,
    frame::L_FOREARM_SKIN_29,
    frame::L_FOREARM_SKIN_2,
    frame::L_FOREARM_SKIN_3,
    frame::L_FOREARM_SKIN_4,
    frame::L_FOREARM_SKIN_5,
    frame::L_FOREARM_SKIN_6,
    frame::L_FOREARM_SKIN_7,
    frame::L_FOREARM_SKIN_8,
    frame::L_FOREARM_SKIN_9,
    frame::L_WRIST_1,
    frame::L_HAND,
    frame::L_HAND_DH_FRAME,
    frame::NECK_1,
    frame::NECK_2,
    frame::HEAD,
    frame::HEAD_IMU_0,
    frame::IMU_FRAME,
    frame::R_SHOULDER_1,
    frame::R_SHOULDER_2,
    frame::R_SHOULDER_3,
    frame::R_ARM_FT,
    frame::R_ARM_FT_IMU,
    frame::R_UPPER_ARM,
    frame::R_ELBOW_1,
    frame::R_FOREARM,
    frame::R_FOREARM_DH_FRAME,
    frame::R_FOREARM_SKIN_0,
    frame::R_FOREARM_SKIN_10,
    frame::R_FOREARM_SKIN_11,
    frame::R_FOREARM_SKIN_12,
    frame::R_FOREARM_SKIN_13,
    frame::R_FOREARM_SKIN_14,
    frame::R_FOREARM_SKIN_15,
    frame::R_FOREARM_SKIN_16,
    frame::R_FOREARM_SKIN_17,
    frame::R_FOREARM_SKIN_19,
    frame::R_FOREARM_SKIN_1,
    frame::R_FOREARM_SKIN_22,
    frame::R_FOREARM_SKIN_24,
    frame::R_FOREARM_SKIN_25,
    frame::R_FOREARM_SKIN_28,
    frame::R_FOREARM_SKIN_29,
    frame::R_FOREARM_SKIN_2,
    frame::R_FOREARM_SKIN_3,
    frame::R_FOREARM_SKIN_4,
    frame::R_FOREARM_SKIN_5,
    frame::R_FOREARM_SKIN_6,
    frame::R_FOREARM_SKIN_7,
    frame::R_FOREARM_SKIN_8,
    frame::R_FOREARM_SKIN_9,
    frame::R_WRIST_1,
    frame::R_HAND,
    frame::R_HAND_DH_FRAME,
];

/// [`FRAMES`] in single precision.
pub static FRAMES_F32: [Frame<f32>; 213] = frames_f32(&FRAMES);
