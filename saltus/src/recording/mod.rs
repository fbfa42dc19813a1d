//! The log as MCAP, the container of recordings that Foxglove and others open: every number, and the robot in 3D.
//!
//! | topic | schema | every |
//! |---|---|---|
//! | `/log` | `saltus.Log`: the columns of `log.csv` by name | 1 ms |
//! | `/tf` | `foxglove.FrameTransform`: `base` in `world` | 10 ms |
//! | `/scene` | `foxglove.SceneUpdate`: robot, forces on it, ground | 10 ms |
//!
//! Stamps count from the first row, since they cannot be negative; the column `time` is the plan's. Messages are JSON and not
//! compressed: that needs no library in C.

mod schema;

use crate::report::{FRAME, round};
use jump_lab::log::Log;
use mcap::records::MessageHeader;
use mcap::{WriteOptions, Writer};
use nalgebra::{UnitQuaternion, Vector3};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::io::Cursor;

/// Limbs of a drawn robot, and points of a limb from the body to its end.
pub(crate) const LIMBS: usize = 4;
/// See [`LIMBS`].
pub(crate) const POINTS: usize = 4;
/// Length of a force's arrow, m/N.
const ARROW: f64 = 1.0 / 400.0;
/// Least force that is drawn, N.
const FELT: f64 = 2.0;
/// Half the side of the ground that is drawn, m.
const GROUND: f64 = 2.0;

/// What does not move, and sizes.
pub(crate) struct Scene {
    /// The trunk as a box, m.
    pub(crate) trunk: [f64; 3],
    pub(crate) foot_radius: f64,
    /// Height of the ground, m.
    pub(crate) floor: f64,
    /// Lower and upper corner of a box on it, m.
    pub(crate) block: Option<[[f64; 3]; 2]>,
}

/// The robot at one time.
pub(crate) struct Frame {
    pub(crate) position: Vector3<f64>,
    pub(crate) orientation: UnitQuaternion<f64>,
    /// World axes.
    pub(crate) limbs: [[Vector3<f64>; POINTS]; LIMBS],
    /// Force of the ground on the end of each limb, N, world axes.
    pub(crate) forces_w: [Vector3<f64>; LIMBS],
}

/// The recording; `frame` draws the robot at a row.
pub(crate) fn mcap(
    task: &str,
    log: &Log,
    scene: &Scene,
    frame: impl Fn(usize) -> Frame,
) -> Result<Vec<u8>, String> {
    write(task, log, scene, frame).map_err(|error| format!("log.mcap: {error}"))
}

fn write(
    task: &str,
    log: &Log,
    scene: &Scene,
    frame: impl Fn(usize) -> Frame,
) -> mcap::McapResult<Vec<u8>> {
    let options = WriteOptions::new()
        .compression(None)
        .library(concat!("saltus ", env!("CARGO_PKG_VERSION")));
    let mut writer = options.create(Cursor::new(Vec::new()))?;
    writer.write_metadata(&mcap::records::Metadata {
        name: "saltus".to_owned(),
        metadata: BTreeMap::from([("task".to_owned(), task.to_owned())]),
    })?;
    let mut channel = |topic: &str, name: &str, schema: &Value| {
        let schema = writer.add_schema(name, "jsonschema", schema.to_string().as_bytes())?;
        writer.add_channel(schema, topic, "json", &BTreeMap::new())
    };
    let channels = [
        channel("/log", "saltus.Log", &schema::log(&log.columns))?,
        channel("/tf", "foxglove.FrameTransform", &schema::frame_transform())?,
        channel("/scene", "foxglove.SceneUpdate", &schema::scene_update())?,
    ];
    let begin = log.rows.first().map_or(0.0, |row| row.time);
    let mut sequence = [0; 3];
    let mut say = |writer: &mut Writer<_>, topic: usize, nanoseconds: u64, message: &Value| {
        let header = MessageHeader {
            channel_id: channels[topic],
            sequence: sequence[topic],
            log_time: nanoseconds,
            publish_time: nanoseconds,
        };
        sequence[topic] += 1;
        writer.write_to_known_channel(&header, message.to_string().as_bytes())
    };
    for (k, row) in log.rows.iter().enumerate() {
        let nanoseconds = ((row.time - begin) * 1e9).round() as u64;
        let mut fields = Map::new();
        fields.insert("time".to_owned(), json!(round(row.time, 4)));
        fields.insert("phase".to_owned(), json!(row.phase));
        let numbers = log.columns.iter().zip(&row.numbers);
        fields.extend(numbers.map(|(name, x)| (name.clone(), json!(round(*x, 6)))));
        say(&mut writer, 0, nanoseconds, &Value::Object(fields))?;
        if !k.is_multiple_of(FRAME) {
            continue;
        }
        let stamp = stamp(nanoseconds);
        let frame = frame(k);
        let transform = json!({
            "timestamp": stamp,
            "parent_frame_id": "world",
            "child_frame_id": "base",
            "translation": xyz(&frame.position),
            "rotation": quaternion(&frame.orientation),
        });
        say(&mut writer, 1, nanoseconds, &transform)?;
        let mut entities = vec![robot(&stamp, scene, &frame)];
        if k == 0 {
            entities.push(ground(&stamp, scene));
        }
        let update = json!({ "deletions": [], "entities": entities });
        say(&mut writer, 2, nanoseconds, &update)?;
    }
    writer.finish()?;
    Ok(writer.into_inner().into_inner())
}

fn stamp(nanoseconds: u64) -> Value {
    json!({ "sec": nanoseconds / 1_000_000_000, "nsec": nanoseconds % 1_000_000_000 })
}

fn xyz(v: &Vector3<f64>) -> Value {
    json!({ "x": round(v.x, 5), "y": round(v.y, 5), "z": round(v.z, 5) })
}

fn quaternion(turn: &UnitQuaternion<f64>) -> Value {
    let [x, y, z, w] = so3::quat::to_xyzw(turn).map(|x| round(x, 7));
    json!({ "x": x, "y": y, "z": z, "w": w })
}

fn pose(position: &Vector3<f64>, turn: &UnitQuaternion<f64>) -> Value {
    json!({ "position": xyz(position), "orientation": quaternion(turn) })
}

fn color(r: f64, g: f64, b: f64) -> Value {
    json!({ "r": r, "g": g, "b": b, "a": 1.0 })
}

/// An entity of the scene with its primitives; kinds that are not given have none.
fn entity(id: &str, stamp: &Value, primitives: &[(&str, Vec<Value>)]) -> Value {
    let mut entity = json!({
        "timestamp": stamp,
        "frame_id": "world",
        "id": id,
        "lifetime": { "sec": 0, "nsec": 0 },
        "frame_locked": false,
        "metadata": [],
    });
    for kind in schema::PRIMITIVES {
        entity[kind] = json!([]);
    }
    for (kind, list) in primitives {
        entity[*kind] = json!(list);
    }
    entity
}

fn cube(middle: &Vector3<f64>, turn: &UnitQuaternion<f64>, size: [f64; 3], color: Value) -> Value {
    json!({ "pose": pose(middle, turn), "size": xyz(&size.into()), "color": color })
}

fn robot(stamp: &Value, scene: &Scene, frame: &Frame) -> Value {
    let still = UnitQuaternion::identity();
    let trunk = cube(
        &frame.position,
        &frame.orientation,
        scene.trunk,
        color(0.19, 0.21, 0.24),
    );
    let ends = frame.limbs.iter().map(|limb| &limb[POINTS - 1]);
    let feet = ends.clone().map(|end| {
        let size = Vector3::repeat(2.0 * scene.foot_radius);
        json!({ "pose": pose(end, &still), "size": xyz(&size), "color": color(0.1, 0.5, 0.22) })
    });
    let limbs = frame.limbs.iter().map(|limb| {
        json!({
            "type": 0,
            "pose": pose(&Vector3::zeros(), &still),
            "thickness": 0.02,
            "scale_invariant": false,
            "points": limb.iter().map(xyz).collect::<Vec<_>>(),
            "color": color(0.34, 0.38, 0.42),
            "colors": [],
            "indices": [],
        })
    });
    let pushed = ends.zip(&frame.forces_w);
    let arrows = pushed.filter(|(_, force)| force.norm() > FELT);
    let arrows = arrows.map(|(end, force)| {
        // An arrow lies along the x axis of its pose.
        let turn = UnitQuaternion::rotation_between(&Vector3::x(), force);
        let half = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), core::f64::consts::PI);
        let length = force.norm() * ARROW;
        json!({
            "pose": pose(end, &turn.unwrap_or(half)),
            "shaft_length": round(0.8 * length, 5),
            "shaft_diameter": 0.01,
            "head_length": round(0.2 * length, 5),
            "head_diameter": 0.02,
            "color": color(0.74, 0.3, 0.0),
        })
    });
    entity(
        "robot",
        stamp,
        &[
            ("cubes", vec![trunk]),
            ("spheres", feet.collect()),
            ("lines", limbs.collect()),
            ("arrows", arrows.collect()),
        ],
    )
}

fn ground(stamp: &Value, scene: &Scene) -> Value {
    let still = UnitQuaternion::identity();
    let gray = || color(0.79, 0.82, 0.85);
    let thick = 0.01;
    let below = Vector3::new(0.0, 0.0, scene.floor - 0.5 * thick);
    let side = 2.0 * GROUND;
    let mut cubes = vec![cube(&below, &still, [side, side, thick], gray())];
    cubes.extend(scene.block.map(|[lower, upper]| {
        let (lower, upper) = (Vector3::from(lower), Vector3::from(upper));
        cube(
            &((lower + upper) * 0.5),
            &still,
            (upper - lower).into(),
            gray(),
        )
    }));
    entity("ground", stamp, &[("cubes", cubes)])
}
