//! A jump in one picture: poses side by side, seen from the side.

use super::report::{moment, scene};
use crate::strip;
use jump_lab::humanoid::execute::Run;
use nalgebra::Vector3;

/// The picture as SVG.
pub(crate) fn svg(run: &Run) -> String {
    let touched = run.touchdown.unwrap_or(run.takeoff + 0.3);
    let shown = strip::spread(&run.samples, |s| s.time, [run.takeoff, touched]);
    let moments: Vec<_> = shown.into_iter().map(moment).collect();
    strip::svg(&scene(), &moments, &Vector3::x())
}
