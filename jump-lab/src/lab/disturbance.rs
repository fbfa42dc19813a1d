//! How much differs from the plan: nominal, as the user says, or drawn from the lab's ranges.

use super::keys::{COUNT, GROUNDS, Key, ROWS};
use crate::noise::Noise;
use core::fmt;
use core::str::FromStr;

/// Whose lab.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lab {
    /// That of A1 and of every quadruped.
    A1,
    /// That of iCub.
    Icub,
}

/// What differs: a value per key, `None` where nothing does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disturbance([Option<f64>; COUNT]);

impl Disturbance {
    /// Nothing differs.
    pub const NOMINAL: Self = Self([None; COUNT]);

    /// The lab of this seed, each key drawn evenly from its range; nominal for seed 0.
    #[must_use]
    pub fn draw(lab: Lab, seed: u64) -> Self {
        if seed == 0 {
            return Self::NOMINAL;
        }
        let mut noise = Noise::new(seed, 0.0);
        let mut out = Self::NOMINAL;
        for (value, row) in out.0.iter_mut().zip(&ROWS) {
            let [low, high] = row.lab[lab as usize];
            *value = Some(low + (high - low) * noise.uniform());
        }
        out
    }

    /// What a key was set to.
    #[must_use]
    pub fn set_to(&self, key: Key) -> Option<f64> {
        self.0[key as usize]
    }

    /// The value of a key; zero for one that was not set and whose nominal value is the robot's own.
    #[must_use]
    pub fn get(&self, key: Key) -> f64 {
        self.set_to(key).or(key.row().nominal).unwrap_or(0.0)
    }

    /// The same in seconds, for a key in milliseconds.
    #[must_use]
    pub fn seconds(&self, key: Key) -> f64 {
        1e-3 * self.get(key)
    }

    /// This, with what `over` sets set.
    #[must_use]
    pub fn with(mut self, over: &Self) -> Self {
        for (value, over) in self.0.iter_mut().zip(over.0) {
            *value = over.or(*value);
        }
        self
    }

    /// This, on ground of this friction where nothing else was said.
    #[must_use]
    pub fn on_ground(mut self, friction: f64) -> Self {
        self.0[Key::Friction as usize].get_or_insert(friction);
        self
    }

    fn set(&mut self, item: &str, name: &str, value: &str) -> Result<(), String> {
        let row = ROWS.iter().find(|row| row.name == name).ok_or_else(|| {
            let names: Vec<&str> = ROWS.iter().map(|row| row.name).collect();
            format!(
                "`{item}`: there is no such key; there are lab, noise, {}",
                names.join(", ")
            )
        })?;
        let named = GROUNDS
            .iter()
            .find(|(word, _)| row.key == Key::Ground && *word == value);
        let number = named.map_or_else(|| value.parse().ok(), |(_, ms)| Some(*ms));
        let [low, high] = row.allowed;
        let number = number.filter(|x: &f64| (low..=high).contains(x));
        self.0[row.key as usize] = Some(number.ok_or_else(|| {
            format!(
                "`{item}`: {name} is {}; give a number from {low} to {high}",
                row.what
            )
        })?);
        Ok(())
    }

    /// `KG@X,Y,Z`.
    fn set_payload(&mut self, item: &str, text: &str) -> Result<(), String> {
        let (mass, place) = text.split_once('@').unwrap_or((text, "0,0,0"));
        self.set(item, "payload", mass)?;
        let axes: Vec<&str> = place.split(',').collect();
        if axes.len() != 3 {
            return Err(format!(
                "`{item}`: write payload=KG@X,Y,Z, such as payload=2@0,0,0.05"
            ));
        }
        for (name, x) in ["payload_x", "payload_y", "payload_z"]
            .into_iter()
            .zip(axes)
        {
            self.set(item, name, x)?;
        }
        Ok(())
    }
}

impl fmt::Display for Disturbance {
    /// As `--plant` takes it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let set = ROWS
            .iter()
            .filter_map(|row| Some((row.name, self.set_to(row.key)?)));
        for (i, (name, value)) in set.enumerate() {
            let comma = if i == 0 { "" } else { "," };
            write!(f, "{comma}{name}={value}")?;
        }
        Ok(())
    }
}

/// What `--plant` says: whether the lab is drawn, and what is set in any case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantArgument {
    lab: bool,
    over: Disturbance,
}

impl fmt::Display for PlantArgument {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let comma = if self.over == Disturbance::NOMINAL {
            ""
        } else {
            ","
        };
        let lab = if self.lab { "lab" } else { "" };
        write!(f, "{lab}{}{}", if self.lab { comma } else { "" }, self.over)
    }
}

impl PlantArgument {
    /// Nothing is named: the nominal plant, whatever the seed.
    pub const NOTHING: Self = Self {
        lab: false,
        over: Disturbance::NOMINAL,
    };

    /// The plant of a seed. A seed alone means the lab; with `--plant` only what is named there differs, unless it names the lab too.
    #[must_use]
    pub fn plant(argument: Option<&Self>, lab: Lab, seed: u64) -> Disturbance {
        match argument {
            None => Disturbance::draw(lab, seed),
            Some(given) if given.lab => Disturbance::draw(lab, seed.max(1)).with(&given.over),
            Some(given) => given.over,
        }
    }
}

impl FromStr for PlantArgument {
    type Err = String;

    /// `lab`, `noise` and `KEY=VALUE`, separated by commas.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut out = Self::NOTHING;
        let all = items(text);
        let name = |item: &String| item.split('=').next().unwrap_or_default().to_owned();
        for (i, item) in all.iter().enumerate() {
            if all[..i].iter().any(|before| name(before) == name(item)) {
                return Err(format!(
                    "`{item}`: {} is given twice: say it once",
                    name(item)
                ));
            }
            match item.split_once('=') {
                None if item == "lab" => out.lab = true,
                None if item == "noise" => {
                    for key in [
                        Key::EncoderNoise,
                        Key::SpeedNoise,
                        Key::GyroNoise,
                        Key::AccelerometerNoise,
                        Key::ImuBias,
                    ] {
                        out.over.0[key as usize] = Some(key.row().lab[Lab::A1 as usize][1]);
                    }
                }
                Some(("payload", place)) => out.over.set_payload(item, place)?,
                split => {
                    let (name, value) = split.unwrap_or((item, ""));
                    out.over.set(item, name, value)?;
                }
            }
        }
        Ok(out)
    }
}

/// The items between the commas; the commas of a payload's place belong to it.
fn items(text: &str) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for part in text.split(',').filter(|part| !part.is_empty()) {
        match out.last_mut() {
            Some(last) if last.starts_with("payload=") && part.parse::<f64>().is_ok() => {
                *last += ",";
                *last += part;
            }
            _ => out.push(part.to_owned()),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{Disturbance, Lab, PlantArgument};
    use crate::lab::Key;
    use crate::lab::keys::ROWS;

    fn plant(text: &str) -> Disturbance {
        PlantArgument::plant(Some(&text.parse().unwrap()), Lab::A1, 7)
    }

    #[test]
    fn plants_are_read_and_mistakes_named() {
        let read = plant("mass=0.9,payload=2@0,-0.1,0.05,ground=soft,com_x=-0.02,noise");
        for (key, value) in [
            (Key::Mass, 0.9),
            (Key::Payload, 2.0),
            (Key::PayloadY, -0.1),
            (Key::PayloadZ, 0.05),
            (Key::Ground, 20.0),
            (Key::ComX, -0.02),
            (Key::ImuBias, 0.1),
        ] {
            assert_eq!(read.get(key), value, "{key:?}");
        }
        assert_eq!(read.set_to(Key::JointFriction), None);
        assert_eq!(plant(""), Disturbance::NOMINAL);
        for nothing in ["", ",,"] {
            assert_eq!(nothing.parse(), Ok(PlantArgument::NOTHING));
        }
        for wrong in [
            "mass",
            "mass=x",
            "mass=0",
            "friction=-1",
            "wind=3",
            "noise=1",
            "payload=1@2",
            "ground=mud",
            "loss=nan",
            "mass=1,mass=2",
            "payload=1@0,0,0,payload=2",
            "lab,lab",
        ] {
            let error = wrong.parse::<PlantArgument>().unwrap_err();
            let last = wrong.rsplit(',').next().unwrap();
            assert!(error.contains(last), "{wrong}: {error}");
        }
    }

    #[test]
    fn what_is_printed_is_read_back() {
        let drawn = Disturbance::draw(Lab::A1, 42);
        assert_eq!(plant(&drawn.to_string()), drawn);
    }

    #[test]
    fn the_lab_is_drawn_within_its_ranges_and_what_is_named_stands() {
        for seed in 1..200 {
            let drawn = Disturbance::draw(Lab::Icub, seed);
            for row in &ROWS {
                let [low, high] = row.lab[1];
                let value = drawn.set_to(row.key).unwrap();
                assert!(low <= value && value <= high, "{}", row.name);
            }
        }
        let mixed = plant("lab,ground=hard");
        assert_eq!(mixed.get(Key::Ground), 2.0);
        assert_eq!(
            mixed.get(Key::Mass),
            Disturbance::draw(Lab::A1, 7).get(Key::Mass)
        );
    }
}
