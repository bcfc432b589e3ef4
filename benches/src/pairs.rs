//! The table of pairs of benchmarks: the time of the first over that of the second.

use crate::estimates::{Estimate, folders_with, is_measured, median, read, time};
use anyhow::Result;
use mtled_benches::notes::{BodySize, Note, PAIRS, Pair};
use std::path::Path;

/// A Markdown table of the pairs under Criterion's folder whose benchmarks were both measured.
pub fn table(criterion: &Path) -> Result<String> {
    let mut text = String::from(
        "| first over second | points | neighbours | first | second | ratio |\n\
         |---|--:|--:|--:|--:|--:|\n",
    );
    for group in folders_with(PAIRS, criterion)? {
        for pair in read::<Vec<Pair>>(&group.join(PAIRS))? {
            let [first, second] = [&pair.first, &pair.second].map(|name| group.join(name));
            if is_measured(&first) && is_measured(&second) {
                let size = read(&first.join(BodySize::FILE))?;
                text += &row(&pair.label, &size, &median(&first)?, &median(&second)?);
            }
        }
    }
    Ok(text)
}

fn row(label: &str, size: &BodySize, first: &Estimate, second: &Estimate) -> String {
    format!(
        "| {label} | {} | {:.1} | {} | {} | {:.2} ± {:.1} % |\n",
        size.points,
        size.neighbours,
        time(first.point_estimate),
        time(second.point_estimate),
        first.point_estimate / second.point_estimate,
        100.0 * first.half_width().hypot(second.half_width()),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimates::Interval;

    #[test]
    fn a_ratio_has_the_spread_of_both_times() {
        let size = BodySize { nodes: 7, points: 10, neighbours: 30.0, bytes: None, peak: None };
        let estimate = |median: f64, half: f64| Estimate {
            point_estimate: median,
            confidence_interval: Interval {
                lower_bound: median - half,
                upper_bound: median + half,
            },
        };
        let row =
            row("plain loop over solver", &size, &estimate(300.0, 9.0), &estimate(100.0, 4.0));
        let expected =
            "| plain loop over solver | 10 | 30.0 | 300.0 ns | 100.0 ns | 3.00 ± 5.0 % |\n";
        assert_eq!(row, expected);
    }
}
