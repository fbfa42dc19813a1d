//! Numbers from a seed.

/// Normally distributed numbers from a seed (SplitMix64 and Box–Muller).
pub struct Noise {
    state: u64,
    deviation: f64,
}

impl Noise {
    /// Numbers with this standard deviation.
    #[must_use]
    pub fn new(seed: u64, deviation: f64) -> Self {
        Self {
            state: seed,
            deviation,
        }
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Normal with mean zero.
    pub fn sample(&mut self) -> f64 {
        if self.deviation == 0.0 {
            return 0.0;
        }
        let radius = so3::math::sqrt(-2.0 * so3::math::log(1.0 - self.uniform()));
        self.deviation * radius * so3::math::cos(2.0 * core::f64::consts::PI * self.uniform())
    }
}

/// A seed for sample `index` of a study with this seed.
#[must_use]
pub fn mix(seed: u64, index: u64) -> u64 {
    let mut z = seed
        .wrapping_mul(0xff51_afd7_ed55_8ccd)
        .wrapping_add(index.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
