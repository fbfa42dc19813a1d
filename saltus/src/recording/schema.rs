//! JSON schemas of the messages: Foxglove knows its own by their names, and reads bytes and numbers by the schemas.

use serde_json::{Map, Value, json};

/// Kinds of primitives of an entity.
pub(super) const PRIMITIVES: [&str; 8] = [
    "arrows",
    "cubes",
    "spheres",
    "cylinders",
    "lines",
    "triangles",
    "texts",
    "models",
];

fn object<'a>(fields: impl IntoIterator<Item = (&'a str, Value)>) -> Value {
    let fields = fields.into_iter();
    let properties: Map<String, Value> = fields.map(|(k, v)| (k.to_owned(), v)).collect();
    json!({ "type": "object", "properties": properties })
}

fn list(items: &Value) -> Value {
    json!({ "type": "array", "items": items })
}

fn of(kind: &str) -> Value {
    json!({ "type": kind })
}

fn numbers<const N: usize>(names: [&str; N]) -> Value {
    object(names.map(|name| (name, of("number"))))
}

fn time() -> Value {
    object(["sec", "nsec"].map(|name| (name, of("integer"))))
}

fn xyz() -> Value {
    numbers(["x", "y", "z"])
}

fn quaternion() -> Value {
    numbers(["x", "y", "z", "w"])
}

fn pose() -> Value {
    object([("position", xyz()), ("orientation", quaternion())])
}

fn color() -> Value {
    numbers(["r", "g", "b", "a"])
}

/// `saltus.Log` with these columns.
pub(super) fn log(columns: &[String]) -> Value {
    let first = [("time", of("number")), ("phase", of("string"))];
    let rest = columns.iter().map(|name| (name.as_str(), of("number")));
    let mut schema = object(first.into_iter().chain(rest));
    schema["title"] = json!("saltus.Log");
    schema
}

/// `foxglove.FrameTransform`.
pub(super) fn frame_transform() -> Value {
    let mut schema = object([
        ("timestamp", time()),
        ("parent_frame_id", of("string")),
        ("child_frame_id", of("string")),
        ("translation", xyz()),
        ("rotation", quaternion()),
    ]);
    schema["title"] = json!("foxglove.FrameTransform");
    schema
}

/// `foxglove.SceneUpdate`, with the primitives that are used.
pub(super) fn scene_update() -> Value {
    let primitive = |kind: &str| {
        let mut fields = vec![("pose", pose()), ("color", color())];
        match kind {
            "arrows" => fields.extend(
                [
                    "shaft_length",
                    "shaft_diameter",
                    "head_length",
                    "head_diameter",
                ]
                .map(|name| (name, of("number"))),
            ),
            "cubes" | "spheres" => fields.push(("size", xyz())),
            "lines" => fields.extend([
                ("type", of("integer")),
                ("thickness", of("number")),
                ("scale_invariant", of("boolean")),
                ("points", list(&xyz())),
                ("colors", list(&color())),
                ("indices", list(&of("integer"))),
            ]),
            _ => {}
        }
        object(fields)
    };
    let pair = object(["key", "value"].map(|name| (name, of("string"))));
    let mut fields = vec![
        ("timestamp", time()),
        ("frame_id", of("string")),
        ("id", of("string")),
        ("lifetime", time()),
        ("frame_locked", of("boolean")),
        ("metadata", list(&pair)),
    ];
    fields.extend(PRIMITIVES.map(|kind| (kind, list(&primitive(kind)))));
    let deletion = object([
        ("timestamp", time()),
        ("type", of("integer")),
        ("id", of("string")),
    ]);
    let mut schema = object([
        ("deletions", list(&deletion)),
        ("entities", list(&object(fields))),
    ]);
    schema["title"] = json!("foxglove.SceneUpdate");
    schema
}
