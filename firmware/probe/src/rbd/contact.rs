//! Dynamics in contact, and impacts.

use rbd_core::{ContactRow, ContactWorkspace, MassFactors, Tangent, contact_dynamics, impact};

use super::kinematics::Place;
use super::state::State;
use crate::{Real, Recorder, Subject};

/// Room for a surface contact and a point of it: three rows more than the contact has directions, so that the solve
/// is rank deficient.
const ROWS: usize = 9;

pub(super) fn run<T: Real, R: Recorder, const N: usize>(
    on: &mut Subject<'_, T, R>,
    mass: &MassFactors<T, N>,
    free: &Tangent<T, N>,
    state: &State<T, N>,
    place: &Place<'_, T, N>,
) {
    let Place { jacobian, bias, .. } = place;
    let point = (jacobian, &bias.linear);
    let point = on.call("ContactRow::point", point, |(j, bias)| {
        ContactRow::point(j, bias)
    });
    let surface = (jacobian, bias);
    let surface = on.call("ContactRow::surface", surface, |(j, bias)| {
        ContactRow::surface(j, bias)
    });
    let mut rows = [ContactRow::ZERO; ROWS];
    for (row, from) in rows.iter_mut().zip(surface.iter().chain(&point)) {
        *row = *from;
    }
    let mut ws = ContactWorkspace::<T, N, ROWS>::new();
    for rows in [&rows[..], &surface[..], &point[..], &[]] {
        let input = (mass, free, rows, &mut ws);
        on.call("contact_dynamics", input, |(mass, free, rows, ws)| {
            contact_dynamics(mass, free, rows, ws)
        });
        let input = (mass, &state.velocity, T::of(0.2), rows, &mut ws);
        on.call(
            "impact",
            input,
            |(mass, velocity, restitution, rows, ws)| impact(mass, velocity, restitution, rows, ws),
        );
    }
}
