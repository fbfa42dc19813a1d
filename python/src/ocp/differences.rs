//! First and second derivatives by central differences, all points in one question.

/// Step of first derivatives, as a share of the number where that is above 1: the cube root of the round-off, rounded.
const FIRST: f64 = 1e-5;
/// Step of second derivatives, likewise: its fourth root.
const SECOND: f64 = 1e-4;

/// What is said at a point, or how that changes.
#[derive(Clone, Debug)]
pub(super) struct Told {
    /// Of the node.
    pub(super) cost: f64,
    /// The next state.
    pub(super) next: Vec<f64>,
    /// Constraint rows.
    pub(super) rows: Vec<f64>,
}

/// Derivatives at a point.
pub(super) struct Found {
    /// By coordinate.
    pub(super) slopes: Vec<Told>,
    /// Hessian of the Lagrangian, by rows.
    pub(super) curvature: Vec<Vec<f64>>,
}

/// cost + λᵀ next + yᵀ rows.
fn lagrangian(told: &Told, (costate, multipliers): (&[f64], &[f64])) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    told.cost + dot(&told.next, costate) + dot(&told.rows, multipliers)
}

/// (a - b) / width.
fn slope(a: &Told, b: &Told, width: f64) -> Told {
    let part = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b) / width).collect();
    Told {
        cost: (a.cost - b.cost) / width,
        next: part(&a.next, &b.next),
        rows: part(&a.rows, &b.rows),
    }
}

/// Derivatives at `point` of what `ask` says, with multipliers of the next state and of the rows; none where `ask` has no answer.
pub(super) fn derive(
    point: &[f64],
    multipliers: (&[f64], &[f64]),
    ask: impl FnOnce(&[Vec<f64>]) -> Option<Vec<Told>>,
) -> Option<Found> {
    let n = point.len();
    let width = |i: usize, share: f64| share * point[i].abs().max(1.0);
    let moved = |by: &[(usize, f64)]| {
        let mut there = point.to_vec();
        for (i, share) in by {
            there[*i] += width(*i, *share);
        }
        there
    };
    let pairs = || (0..n).flat_map(move |i| (0..i).map(move |j| (i, j)));
    let signs = [1.0, -1.0];
    let mut points = vec![point.to_vec()];
    for share in [FIRST, SECOND] {
        points.extend((0..n).flat_map(|i| signs.map(|s| moved(&[(i, s * share)]))));
    }
    points.extend(pairs().flat_map(|(i, j)| signs.map(|s| moved(&[(i, s * SECOND), (j, SECOND)]))));
    points
        .extend(pairs().flat_map(|(i, j)| signs.map(|s| moved(&[(i, s * SECOND), (j, -SECOND)]))));
    let told = ask(&points)?;
    let (here, others) = told.split_first()?;
    let (first, others) = others.split_at_checked(2 * n)?;
    let (second, mixed) = others.split_at_checked(2 * n)?;
    let (up, down) = mixed.split_at_checked(mixed.len() / 2)?;
    let slopes = first.chunks_exact(2).enumerate();
    let slopes = slopes.map(|(i, pair)| slope(&pair[0], &pair[1], 2.0 * width(i, FIRST)));
    let at = |told: &Told| lagrangian(told, multipliers);
    let mut curvature = vec![vec![0.0; n]; n];
    for (i, pair) in second.chunks_exact(2).enumerate() {
        let h = width(i, SECOND);
        curvature[i][i] = (at(&pair[0]) - 2.0 * at(here) + at(&pair[1])) / (h * h);
    }
    let corners = up.chunks_exact(2).zip(down.chunks_exact(2));
    for ((i, j), (up, down)) in pairs().zip(corners) {
        let twist = at(&up[0]) - at(&up[1]) - at(&down[0]) + at(&down[1]);
        let x = twist / (4.0 * width(i, SECOND) * width(j, SECOND));
        (curvature[i][j], curvature[j][i]) = (x, x);
    }
    Some(Found {
        slopes: slopes.collect(),
        curvature,
    })
}
