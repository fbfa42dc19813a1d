//! Noise, gates and limits.

use so3::Scalar;

/// Settings; [`Settings::new`] suits robots of the size of A1 and iCub with MEMS sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<T> {
    /// Standard deviation of one specific-force sample, with what a wrong tilt adds, m/s².
    pub accelerometer: T,
    /// Random walk of a foot that stands, m/√s.
    pub foot_drift: T,
    /// Standard deviation of a foot's place in the base, m.
    pub foot_position: T,
    /// Standard deviation of the speed of a foot that stands, m/s.
    pub foot_speed: T,
    /// Foot speed at which a foot in contact is believed by half, m/s; more while the filter is not sure of its own velocity.
    pub slip_gate: T,
    /// Confidence below which a foot is no anchor.
    pub least_confidence: T,
    /// Time for which most feet must have agreed before they are believed against the filter, s: ground that gives way at a touchdown takes all of
    /// them along, and they agree for as long as it does.
    pub agreement: T,
    /// Rate at which gravity corrects the tilt while quasi-static, 1/s.
    pub tilt_gain: T,
    /// Rate at which feet that stand correct the gyroscope's bias, 1/s. Until soles have stood for its inverse, the bias is the mean of what they
    /// have told and of none for the time of [`Settings::agreement`].
    pub bias_gain: T,
    /// Largest bias that is believed, rad/s.
    pub max_bias: T,
    /// Range of the accelerometer, m/s²: larger values are a fault. Also the standard deviation of a specific force that was not measured.
    pub max_specific_force: T,
    /// Range of the gyroscope, rad/s.
    pub max_angular_velocity: T,
    /// Longest step, s.
    pub max_dt: T,
    /// Longest time without an IMU sample before the estimate is lost, s.
    pub max_coasting: T,
}

impl<T: Scalar> Settings<T> {
    /// For sampling at 1 kHz, accelerometers of ±32 g and gyroscopes of ±4000 °/s.
    #[must_use]
    pub fn new() -> Self {
        let of = T::of;
        Self {
            accelerometer: of(1.0),
            foot_drift: of(0.02),
            foot_position: of(0.003),
            foot_speed: of(0.1),
            slip_gate: of(0.3),
            least_confidence: of(0.1),
            agreement: of(0.05),
            tilt_gain: of(0.5),
            bias_gain: of(1.0),
            max_bias: of(0.1),
            max_specific_force: of(320.0),
            max_angular_velocity: of(70.0),
            max_dt: of(0.02),
            max_coasting: of(0.02),
        }
    }
}

impl<T: Scalar> Default for Settings<T> {
    fn default() -> Self {
        Self::new()
    }
}
