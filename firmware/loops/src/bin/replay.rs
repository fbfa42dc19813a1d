//! Replays a flight recorder's file: `replay a1-f64 FILE`.

use saltus_loops::control::{Humanoid, Jumper};
use saltus_loops::replay::{Error, Replayed, replay};

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(image), Some(path)) = (arguments.next(), arguments.next()) else {
        return Err("replay a1-f64|a1-f32|icub-f64 FILE".into());
    };
    let run: fn(&[u8]) -> Result<Replayed, Error> = match image.as_str() {
        "a1-f64" => replay::<f64, Jumper<f64>, 12>,
        "a1-f32" => replay::<f32, Jumper<f32>, 12>,
        "icub-f64" => replay::<f64, Humanoid, 23>,
        _ => return Err("the image is a1-f64, a1-f32 or icub-f64".into()),
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
