//! The golden files agree with themselves: what one quantity says follows from others.

use saltus_tests::golden::{Golden, Matrix};

fn times(m: &Matrix, x: &[f64]) -> Vec<f64> {
    (0..m.rows)
        .map(|i| (0..m.cols).map(|j| m.at(i, j) * x[j]).sum())
        .collect()
}

fn close(what: &str, a: &[f64], b: &[f64], tolerance: f64) {
    assert_eq!(a.len(), b.len(), "{what}");
    let scale = b.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
    for (x, y) in a.iter().zip(b) {
        assert!(
            (x - y).abs() <= tolerance * scale,
            "{what}: {x} against {y}"
        );
    }
}

fn add(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(x, y)| x + y).collect()
}

#[test]
fn quantities_agree_with_each_other() {
    for (robot, nv, feet) in [
        ("a1", 18, &["FL_foot", "FR_foot", "RL_foot", "RR_foot"][..]),
        ("icub23", 29, &["l_sole", "r_sole"]),
    ] {
        let golden = Golden::load(robot);
        assert_eq!((golden.nv(), golden.joints.len()), (nv, nv - 6));
        assert!(golden.states.len() >= 32);
        for state in &golden.states {
            let mass = state.get("mass_matrix_lower").symmetric(nv);
            let bias = state.values("nonlinear_effects");
            close(
                "RNEA",
                &add(&times(&mass, state.values("a")), bias),
                state.values("rnea"),
                1e-12,
            );
            close(
                "ABA",
                &add(&times(&mass, state.values("aba")), bias),
                state.values("tau"),
                1e-10,
            );
            let (map, v) = (state.get("centroidal.map"), state.values("v"));
            close(
                "momentum",
                &times(map, v),
                state.values("centroidal.momentum"),
                1e-13,
            );
            let rate = add(
                &times(map, state.values("a")),
                state.values("centroidal.bias"),
            );
            close(
                "momentum rate",
                &rate,
                state.values("centroidal.momentum_rate"),
                1e-12,
            );
            let kinetic = 0.5
                * times(&mass, v)
                    .iter()
                    .zip(v)
                    .map(|(p, v)| p * v)
                    .sum::<f64>();
            close("energy", &[kinetic], state.values("energy.kinetic"), 1e-13);
            if let Some(inverse) = state.find("mass_matrix_inverse_lower") {
                let inverse = inverse.symmetric(nv);
                for j in 0..nv {
                    let column: Vec<f64> = (0..nv).map(|i| mass.at(i, j)).collect();
                    let unit: Vec<f64> = (0..nv).map(|i| f64::from(i == j)).collect();
                    close("inverse", &times(&inverse, &column), &unit, 1e-9);
                }
                let jacobian = state.get(&format!("{}.jacobian_a", feet[0]));
                let velocity = state.values(&format!("{}.velocity_a", feet[0]));
                close("Jacobian", &times(jacobian, v), velocity, 1e-13);
            }
        }
    }
}
