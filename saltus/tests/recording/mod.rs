//! What `log.mcap` of a run must hold, read back with the library that other programs read it with.

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// A value is what its schema says, to the last field.
fn conforms(value: &Value, schema: &Value) -> bool {
    match (schema["type"].as_str().unwrap(), value) {
        ("object", Value::Object(fields)) => {
            let known = schema["properties"].as_object().unwrap();
            known.len() == fields.len()
                && fields
                    .iter()
                    .all(|(name, field)| known.get(name).is_some_and(|s| conforms(field, s)))
        }
        ("array", Value::Array(items)) => items.iter().all(|x| conforms(x, &schema["items"])),
        ("number", Value::Number(_)) | ("string", Value::String(_)) => true,
        ("boolean", Value::Bool(_)) => true,
        ("integer", Value::Number(x)) => x.is_i64() || x.is_u64(),
        _ => false,
    }
}

/// The recording in a folder has every number of `log.csv`, and draws the robot where it is; how many forces are drawn.
pub(crate) fn agrees_with_csv(folder: &Path) -> usize {
    let bytes = std::fs::read(folder.join("log.mcap")).unwrap();
    let mut topics: BTreeMap<String, Vec<(u64, Value)>> = BTreeMap::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let schema = message.channel.schema.clone().unwrap();
        assert_eq!(message.channel.message_encoding, "json");
        assert_eq!(schema.encoding, "jsonschema");
        let known = serde_json::from_slice::<Value>(&schema.data).unwrap();
        let value = serde_json::from_slice::<Value>(&message.data).unwrap();
        let topic = format!("{} {}", message.channel.topic, schema.name);
        assert!(conforms(&value, &known), "{topic}: {value}\n{known}");
        let of_topic = topics.entry(topic).or_default();
        assert_eq!(message.sequence as usize, of_topic.len());
        of_topic.push((message.log_time, value));
    }
    let names: Vec<&str> = topics.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        [
            "/log saltus.Log",
            "/scene foxglove.SceneUpdate",
            "/tf foxglove.FrameTransform"
        ]
    );

    let csv = std::fs::read_to_string(folder.join("log.csv")).unwrap();
    let mut lines = csv.lines();
    let columns: Vec<&str> = lines.next().unwrap().split(',').collect();
    let log = &topics["/log saltus.Log"];
    assert_eq!(lines.clone().count(), log.len());
    let begin = log[0].1["time"].as_f64().unwrap();
    for (line, (stamp, row)) in lines.zip(log) {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), columns.len());
        for (name, cell) in columns.iter().zip(cells) {
            match row[*name].as_f64() {
                Some(x) => assert!((x - cell.parse::<f64>().unwrap()).abs() < 1.1e-6, "{name}"),
                None => assert_eq!(row[*name], cell, "{name}"),
            }
        }
        let time = row["time"].as_f64().unwrap() - begin;
        assert!((*stamp as f64 * 1e-9 - time).abs() < 1e-7, "{time}");
    }

    // Every tenth row has its transform and its drawing.
    let (scene, tf) = (&topics[names[1]], &topics[names[2]]);
    let mut arrows = 0;
    assert_eq!(
        (scene.len(), tf.len()),
        (log.len().div_ceil(10), log.len().div_ceil(10))
    );
    for (k, (stamp, update)) in scene.iter().enumerate() {
        let (time, row) = &log[10 * k];
        assert_eq!((stamp, &tf[k].0), (time, time));
        let robot = &update["entities"][0];
        let place = &robot["cubes"][0]["pose"]["position"];
        assert_eq!(&tf[k].1["translation"], place);
        for axis in ["x", "y", "z"] {
            let gap = place[axis].as_f64().unwrap() - row[axis].as_f64().unwrap();
            assert!(gap.abs() < 1e-5);
        }
        assert_eq!(robot["lines"].as_array().unwrap().len(), 4);
        arrows += robot["arrows"].as_array().unwrap().len();
    }
    assert_eq!(scene[0].1["entities"][1]["id"], "ground");
    arrows
}
