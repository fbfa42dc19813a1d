"""The robots of the peer scripts: a URDF, the joints locked in it, the base, and the frames of interest.

URDF dynamics tags (damping, friction, armature) are zeroed, because they would enter Pinocchio's RNEA and ABA,
and gravity is (0, 0, -9.81).
"""
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pinocchio as pin

ROOT = Path(__file__).resolve().parents[2]
MODELS = ROOT / "models"


@dataclass
class Robot:
    """How to load one robot. `feet` are the contact frames; `contact` is 3 for points, 6 for surfaces."""

    name: str
    urdf: Path
    lock: dict[str, float] = field(default_factory=dict)
    floating: bool = True
    feet: list[str] = field(default_factory=list)
    contact: int = 3
    frames: list[str] = field(default_factory=list)

    def load(self) -> pin.Model:
        root = (pin.JointModelFreeFlyer(),) if self.floating else ()
        model = pin.buildModelFromUrdf(str(self.urdf), *root)
        if self.lock:
            at = pin.neutral(model)
            for joint, value in self.lock.items():
                if not model.existJointName(joint):
                    raise SystemExit(f"{self.name}: no joint `{joint}` to lock in {self.urdf}")
                j = model.joints[model.getJointId(joint)]
                at[j.idx_q : j.idx_q + j.nq] = value if j.nq == 1 else [np.cos(value), np.sin(value)]
            model = pin.buildReducedModel(model, [model.getJointId(j) for j in self.lock], at)
        model.damping[:] = 0
        for attr in ("friction", "lowerDryFrictionLimit", "upperDryFrictionLimit", "armature", "rotorInertia"):
            if hasattr(model, attr):
                getattr(model, attr)[:] = 0
        model.gravity.linear = np.array([0.0, 0.0, -9.81])
        return model


ICUB_LOCKED = ["neck_pitch", "neck_roll", "neck_yaw"] + [
    f"{side}_wrist_{joint}" for side in "lr" for joint in ("prosup", "pitch", "yaw")
]

A1 = Robot(
    "a1",
    MODELS / "a1.urdf",
    feet=["FL_foot", "FR_foot", "RL_foot", "RR_foot"],
    frames=["FL_calf", "imu_link"],
)
ICUB23 = Robot(
    "icub23",
    MODELS / "icub_gazebo_v2_5.urdf",
    lock=dict.fromkeys(ICUB_LOCKED, 0.0),
    feet=["l_sole", "r_sole"],
    contact=6,
    frames=["chest", "l_hand"],
)
ROBOTS = {r.name: r for r in (A1, ICUB23)}


def example_data() -> Path:
    """The robots of pip `example-robot-data`."""
    data = Path(pin.__file__).resolve()
    while not (data / "share" / "example-robot-data").is_dir():
        if data == data.parent:
            raise SystemExit("pip package example-robot-data is not installed")
        data = data.parent
    return data / "share" / "example-robot-data" / "robots"


def every_urdf() -> list[tuple[str, Path]]:
    """Every URDF of pip `example-robot-data`, with a name of its own."""
    data = example_data()
    files = sorted(data.rglob("*.urdf"))
    return [(f.relative_to(data).with_suffix("").as_posix().replace("/", "."), f) for f in files]


def tips(model: pin.Model) -> list[str]:
    """The last two links whose names stand for one frame only."""
    names = [f.name for f in model.frames]
    return [f.name for f in model.frames if f.type == pin.BODY and names.count(f.name) == 1 and " " not in f.name][-2:]


def others() -> list[Robot]:
    """Robots of pip `example-robot-data` that `saltus import` is checked against."""
    data = example_data()
    hands = {f"{side}_{finger}_joint": 0.1 for side in ("left", "right") for finger in
             ("hand_thumb_0", "hand_thumb_1", "hand_thumb_2", "hand_middle_0", "hand_middle_1", "hand_index_0", "hand_index_1")}
    return [
        # quadrupeds
        Robot("go2", data / "go2_description/urdf/go2.urdf", feet=["FL_foot", "FR_foot", "RL_foot", "RR_foot"]),
        Robot("hyq", data / "hyq_description/robots/hyq_no_sensors.urdf", feet=["lf_foot", "rf_foot", "lh_foot", "rh_foot"]),
        Robot("anymal_c", data / "anymal_c_simple_description/urdf/anymal.urdf", frames=["LF_FOOT", "RH_FOOT"]),
        Robot("solo12", data / "solo_description/robots/solo12.urdf", feet=["FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT"]),
        # bipeds and humanoids
        Robot("bolt", data / "bolt_description/robots/bolt.urdf", frames=["FL_FOOT", "FR_FOOT"]),
        Robot("talos", data / "talos_data/robots/talos_reduced.urdf", feet=["left_sole_link", "right_sole_link"], contact=6),
        Robot("g1", data / "g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf", lock=hands,
              frames=["left_ankle_roll_link", "right_wrist_yaw_link"]),
        Robot("romeo", data / "romeo_description/urdf/romeo_small.urdf", frames=["l_sole", "r_sole"]),
        # arms on a fixed base: revolute, prismatic, continuous
        Robot("ur5", data / "ur_description/urdf/ur5_robot.urdf", floating=False, frames=["tool0"]),
        Robot("panda", data / "panda_description/urdf/panda.urdf", floating=False, frames=["panda_leftfinger", "panda_rightfinger"]),
        Robot("kinova", data / "kinova_description/robots/kinova.urdf", floating=False, frames=["j2s6s200_link_6"]),
        Robot("tiago", data / "tiago_description/robots/tiago_no_hand.urdf", floating=False, frames=["head_2_link"]),
    ]


def has_continuous(model: pin.Model) -> bool:
    """A joint kept as (cos, sin) by Pinocchio; Saltus keeps its angle."""
    return any(model.joints[j].nq == 2 for j in range(1, model.njoints))


def as_angles(model: pin.Model, q: np.ndarray) -> np.ndarray:
    """Pinocchio's configuration with one angle for each continuous joint."""
    out = []
    for j in range(1, model.njoints):
        joint = model.joints[j]
        x = q[joint.idx_q : joint.idx_q + joint.nq]
        out += [np.arctan2(x[1], x[0])] if joint.nq == 2 else list(x)
    return np.array(out)


def random_q(model: pin.Model, rng: np.random.Generator) -> np.ndarray:
    """A configuration: base in the unit cube, orientation uniform, joints inside their limits (or +-2 without)."""
    q = pin.neutral(model)
    for j in range(1, model.njoints):
        joint = model.joints[j]
        k = joint.idx_q
        if joint.nq == 7:
            q[k : k + 3] = rng.uniform(-1, 1, 3)
            quat = rng.normal(size=4)
            q[k + 3 : k + 7] = quat / np.linalg.norm(quat)
        elif joint.nq == 2:
            angle = rng.uniform(-np.pi, np.pi)
            q[k : k + 2] = np.cos(angle), np.sin(angle)
        elif joint.nq == 1:
            lo, hi = model.lowerPositionLimit[k], model.upperPositionLimit[k]
            if not (np.isfinite(lo) and np.isfinite(hi) and hi - lo < 100 and lo < hi):
                lo, hi = -2.0, 2.0
            q[k] = rng.uniform(lo, hi)
        else:
            raise SystemExit(f"joint {model.names[j]} ({joint.shortname()}) is not supported")
    return q


def random_state(model: pin.Model, rng: np.random.Generator):
    """(q, v, a, tau): speeds to 2, accelerations to 5, torques to 20, all SI."""
    nv = model.nv
    return random_q(model, rng), rng.uniform(-2, 2, nv), rng.uniform(-5, 5, nv), rng.uniform(-20, 20, nv)


def axis_of(model: pin.Model, j: int) -> np.ndarray:
    """Joint axis in the joint frame (one degree of freedom)."""
    data = model.createData()
    v = np.zeros(model.nv)
    v[model.idx_vs[j]] = 1.0
    pin.forwardKinematics(model, data, pin.neutral(model), v)
    motion = data.v[j]
    return motion.angular.copy() if np.linalg.norm(motion.angular) > 0.5 else motion.linear.copy()
