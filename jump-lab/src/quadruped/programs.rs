//! The landing's quadratic programs of a run, kept for other solvers: `tests/peers/landing_qp.py`.
//!
//! Little-endian f64: variables, rows, number of programs; then per program H, g, A, l, u, and the bounds of the variables.

use landing::{Program, Workspace};

use super::{FOOT_COUNT, JOINTS};

const VARIABLES: usize = 3 * FOOT_COUNT;
const ROWS: usize = 4 * FOOT_COUNT + JOINTS;

/// Programs in the order of their ticks.
#[derive(Debug, Default)]
pub struct Programs {
    numbers: Vec<f64>,
    sizes: [usize; 3],
}

impl Programs {
    /// Adds the program of the last tick.
    pub fn add(&mut self, workspace: &Workspace<f64, JOINTS, FOOT_COUNT>) {
        let program = Program::<f64, VARIABLES, ROWS>::of(workspace);
        let p = program.problem();
        let (Some(lower), Some(upper)) = (p.lower, p.upper) else {
            return;
        };
        let matrices = p.hessian.iter().chain([p.gradient]).chain(p.rows);
        self.numbers.extend(matrices.flatten());
        self.numbers.extend(p.row_lower.iter().chain(p.row_upper));
        self.numbers.extend(lower.iter().chain(upper));
        self.sizes = [VARIABLES, ROWS, self.sizes[2] + 1];
    }

    /// The file.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        let sizes = self.sizes.map(|x| x as f64);
        let numbers = sizes.iter().chain(&self.numbers);
        numbers.flat_map(|x| x.to_le_bytes()).collect()
    }
}
