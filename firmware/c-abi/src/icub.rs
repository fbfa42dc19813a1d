//! iCub: dynamics.

use icub_model::Icub23GazeboGeared;

use crate::memory::{input, output, status};
use crate::state::{State, effort, tangent};
use crate::{Status, dynamics};

const N: usize = 23;

/// Inverse dynamics of iCub with rotors: effort = M a + h. `acceleration` and `effort` have 29 numbers: 6 of the base, then joints.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_inverse_dynamics(
    state: *const State<23>,
    acceleration: *const f64,
    effort: *mut f64,
) -> Status {
    status((|| {
        let (q, v) = input(state)?.read()?;
        let a = dynamics::split::<N, 29>(input(acceleration.cast())?)?;
        dynamics::inverse::<_, N, 29>(
            &Icub23GazeboGeared,
            &q,
            &v,
            &tangent(&a.0, &a.1),
            output(effort.cast())?,
        );
        Ok(())
    })())
}

/// Forward dynamics of iCub with rotors, free in the air: acceleration = M⁻¹ (effort − h); 29 numbers each.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_forward_dynamics(
    state: *const State<23>,
    given: *const f64,
    acceleration: *mut f64,
) -> Status {
    status((|| {
        let (q, v) = input(state)?.read()?;
        let f = dynamics::split::<N, 29>(input(given.cast())?)?;
        dynamics::forward::<_, N, 29>(
            &Icub23GazeboGeared,
            &q,
            &v,
            &effort(&f.0, &f.1),
            output(acceleration.cast())?,
        );
        Ok(())
    })())
}

/// Mass matrix of iCub with rotors, 29 × 29 numbers, symmetric.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_mass_matrix(state: *const State<23>, mass: *mut f64) -> Status {
    status((|| {
        let (q, _) = input(state)?.read()?;
        dynamics::mass::<_, N, 29>(&Icub23GazeboGeared, &q, output(mass.cast())?);
        Ok(())
    })())
}
