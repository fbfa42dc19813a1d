//! A study as a picture.

use core::fmt::Write;
use jump_lab::quadruped::envelope::{BINS, PICTURE, Sample, grid};

/// Cells of ground and torque as a picture: darker is better, with the rate and the number of samples. Of a cell without samples nothing is
/// known, and nothing is drawn.
pub(super) fn picture(samples: &[Sample], title: &str) -> String {
    let side = 90;
    let (left, top) = (90, 50);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <text x=\"10\" y=\"20\">{}</text>\n",
        left + side * BINS + 20,
        top + side * BINS + 60,
        title.trim_start_matches("# ")
    );
    for (i, j, cell) in grid(samples).filter(|(_, _, cell)| !cell.is_empty()) {
        let good = cell.iter().filter(|s| s.good()).count();
        let rate = good as f64 / cell.len() as f64;
        let (x, y) = (left + side * i, top + side * (BINS - 1 - j));
        let light = (235.0 - 150.0 * rate) as u8;
        let _ = writeln!(
            out,
            "<rect x=\"{x}\" y=\"{y}\" width=\"{side}\" height=\"{side}\" fill=\"#{light:02x}e0{light:02x}\" stroke=\"#888\"/>\
             <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{:.0} % of {}</text>",
            x + side / 2,
            y + side / 2 + 5,
            100.0 * rate,
            cell.len()
        );
    }
    for k in 0..=BINS {
        let at = |[low, high]: [f64; 2]| low + (high - low) * k as f64 / BINS as f64;
        let _ = writeln!(
            out,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{:.2}</text><text x=\"{}\" y=\"{}\" text-anchor=\"end\">{:.3}</text>",
            left + side * k,
            top + side * BINS + 20,
            at(PICTURE[0].row().lab[0]),
            left - 6,
            top + side * (BINS - k) + 5,
            at(PICTURE[1].row().lab[0])
        );
    }
    let _ = writeln!(
        out,
        "<text x=\"{left}\" y=\"{}\">{}</text><text x=\"10\" y=\"{}\">{}</text>\n</svg>",
        top + side * BINS + 44,
        PICTURE[0].row().name,
        top - 10,
        PICTURE[1].row().name
    );
    out
}
