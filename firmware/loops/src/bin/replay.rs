//! Replays a flight recorder's file: `replay f64 FILE`.

use saltus_loops::replay::{Error, Replayed, replay};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(scalar), Some(path)) = (arguments.next(), arguments.next()) else {
        return Err("replay f64|f32 FILE".into());
    };
    let run: fn(&[u8]) -> Result<Replayed, Error> = match scalar.as_str() {
        "f64" => replay::<f64>,
        "f32" => replay::<f32>,
        _ => return Err("the scalar is f64 or f32".into()),
    };
    let mut bytes = std::fs::read(path)?;
    let [control, joints] = run(&bytes)?.ticks;
    // A recording in which one bit differs must not replay, or the comparison compares nothing.
    let middle = bytes.len() / 2;
    if let Some(byte) = bytes.get_mut(middle) {
        *byte ^= 1;
    }
    if run(&bytes).is_ok() {
        return Err("a recording with a wrong bit replays".into());
    }
    println!("replay: {control} control ticks and {joints} joint ticks answer the recorded bits");
    Ok(())
}
