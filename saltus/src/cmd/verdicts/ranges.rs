//! The table of what may differ from the plan, with the lab's ranges.

use jump_lab::lab::keys::ROWS;

/// The table for people: `saltus verdicts --ranges`.
pub(super) fn markdown() -> String {
    let range = |[low, high]: [f64; 2]| {
        if low == high {
            format!("{low}")
        } else {
            format!("{low} to {high}")
        }
    };
    let mut out = String::from(
        "| key | what | nominal | A1's lab | iCub's lab | why |\n|---|---|---|---|---|---|\n",
    );
    for row in &ROWS {
        let nominal = row
            .nominal
            .map_or("the robot's".to_owned(), |x| x.to_string());
        let [a1, icub] = row.lab.map(range);
        out += &format!(
            "| `{}` | {} | {nominal} | {a1} | {icub} | {} |\n",
            row.name, row.what, row.reason
        );
    }
    out
}
