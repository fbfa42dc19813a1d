//! `--plant`: how the simulated robot differs from the planned one, in words.

use crate::jump::plant::Disturbance;
use core::str::FromStr;

impl FromStr for Disturbance {
    type Err = String;

    /// `mass=1.1,friction=0.4,rotors=0.8,joint-friction=1.3,latency=2,noise`: what is not named is nominal.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut out = Self::NOMINAL;
        for item in text.split(',').filter(|item| !item.is_empty()) {
            let (name, value) = item.split_once('=').unwrap_or((item, ""));
            let number = || {
                let x = value.parse::<f64>().ok();
                x.filter(|x| x.is_finite() && *x >= 0.0)
                    .ok_or_else(|| format!("`{item}`: a number ≥ 0 is needed after `{name}=`"))
            };
            match name {
                "mass" => out.mass = number()?,
                "friction" => out.friction = number()?,
                "rotors" => out.rotors = number()?,
                "joint-friction" => out.joint_friction = number()?,
                "latency" => {
                    out.latency_ms = value.parse().map_err(|_| {
                        format!("`{item}`: a whole number of milliseconds is needed")
                    })?;
                }
                "noise" if value.is_empty() => {
                    let noisy = Self::draw(1);
                    (out.encoder, out.imu) = (noisy.encoder, noisy.imu);
                }
                _ => {
                    return Err(format!(
                        "`{item}`: give mass=, friction=, rotors=, joint-friction=, latency= or noise"
                    ));
                }
            }
        }
        if out.mass == 0.0 {
            return Err("a robot without mass cannot jump: mass must be positive".into());
        }
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use crate::jump::plant::Disturbance;

    #[test]
    fn plants_are_read_and_mistakes_named() {
        let plant: Disturbance = "mass=0.9,friction=0.4,latency=2,noise".parse().unwrap();
        assert_eq!(
            (plant.mass, plant.friction, plant.latency_ms),
            (0.9, 0.4, 2)
        );
        assert!(plant.imu.is_some() && plant.encoder.0 > 0.0 && plant.rotors == 1.0);
        assert_eq!("".parse(), Ok(Disturbance::NOMINAL));
        for wrong in [
            "mass",
            "mass=x",
            "mass=0",
            "friction=-1",
            "latency=0.5",
            "wind=3",
            "noise=1",
        ] {
            let error = wrong.parse::<Disturbance>().unwrap_err();
            assert!(!error.is_empty(), "{wrong}");
        }
    }
}
