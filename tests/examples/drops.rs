//! The table of drops: `cargo run --release -p saltus-tests --example drops`, and with MuJoCo
//! `cargo xtask mujoco run --release -p saltus-tests --features mujoco --example drops`.
#![allow(missing_docs, reason = "a program")]

use saltus_tests::drops::{Drop, End, Plant, Wrong, eighteen, native, run};

fn good(plant: &mut Plant, drops: impl Iterator<Item = Drop>) -> Result<String, String> {
    let ends: Vec<(Drop, End)> = drops
        .map(|drop| run(plant, &drop).map(|end| (drop, end)))
        .collect::<Result<_, _>>()
        .map_err(|e| e.to_string())?;
    let good = ends.iter().filter(|(_, end)| end.good()).count();
    let bad: Vec<String> = ends
        .iter()
        .filter(|(_, end)| !end.good())
        .map(|(drop, end)| {
            format!(
                "roll {:.0} pitch {:.0} sideways {} {:?}: upright {} trunk {} rest {}",
                drop.roll.to_degrees(),
                drop.pitch.to_degrees(),
                drop.sideways,
                drop.fault,
                end.upright,
                end.trunk_touched,
                end.at_rest
            )
        })
        .collect();
    Ok(format!(
        "{good} of {}{}",
        ends.len(),
        bad.iter().map(|b| format!("\n    {b}")).collect::<String>()
    ))
}

fn main() -> Result<(), String> {
    let heights: Vec<f64> = std::env::args()
        .skip(1)
        .filter_map(|a| a.parse().ok())
        .collect();
    let heights = if heights.is_empty() {
        vec![0.3, 0.5, 0.8, 1.0]
    } else {
        heights
    };
    let mut plants: Vec<(&str, Plant)> = vec![("native", native())];
    #[cfg(feature = "mujoco")]
    plants.push((
        "mujoco",
        saltus_tests::drops::mujoco().map_err(|e| e.to_string())?,
    ));
    for (name, plant) in &mut plants {
        for height in &heights {
            println!("{name} {height} m: {}", good(plant, eighteen(*height))?);
            for wrong in [Wrong::Dead, Wrong::Stuck, Wrong::Chattering] {
                // Each drop with one bad foot, in turn.
                let drops = eighteen(*height).enumerate().map(|(i, drop)| Drop {
                    fault: Some((i % 4, wrong)),
                    ..drop
                });
                println!(
                    "{name} {height} m, one foot {wrong:?}: {}",
                    good(plant, drops)?
                );
            }
        }
    }
    Ok(())
}
