//! Factors over time.

/// A factor over time \[–\].
#[derive(Debug, Clone)]
pub enum Amplitude {
    /// 1 from the start.
    Constant,
    /// From 0 to 1 in a straight line over `duration`, then 1.
    Linear {
        /// \[s\]
        duration: f64,
    },
    /// 10s³ − 15s⁴ + 6s⁵, s = t/`duration`, then 1 (method book, eq. 14.3).
    Smooth {
        /// \[s\]
        duration: f64,
    },
    /// Straight lines through (time \[s\], factor), constant outside; 0 if empty.
    Table(Vec<(f64, f64)>),
}

impl Amplitude {
    /// The factor at time `t` \[s\].
    pub fn at(&self, t: f64) -> f64 {
        match self {
            Amplitude::Constant => 1.0,
            Amplitude::Linear { duration } => (t / duration).clamp(0.0, 1.0),
            Amplitude::Smooth { duration } => {
                let s = (t / duration).clamp(0.0, 1.0);
                s * s * s * (10.0 + s * (6.0 * s - 15.0))
            }
            Amplitude::Table(rows) => interpolate(rows, t),
        }
    }
}

impl Amplitude {
    /// Times \[s\] at which its slope jumps, or it ends.
    pub fn corners(&self) -> Vec<f64> {
        match self {
            Amplitude::Constant => Vec::new(),
            Amplitude::Linear { duration } | Amplitude::Smooth { duration } => vec![*duration],
            Amplitude::Table(rows) => rows.iter().map(|row| row.0).collect(),
        }
    }
}

fn interpolate(rows: &[(f64, f64)], t: f64) -> f64 {
    let after = rows.partition_point(|row| row.0 <= t);
    match after {
        0 => rows.first().map_or(0.0, |row| row.1),
        n if n == rows.len() => rows[n - 1].1,
        n => {
            let ((t0, a0), (t1, a1)) = (rows[n - 1], rows[n]);
            a0 + (a1 - a0) * (t - t0) / (t1 - t0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smooth_amplitude_starts_and_ends_at_rest() {
        let amplitude = Amplitude::Smooth { duration: 2.0 };
        assert_eq!(amplitude.at(0.0), 0.0);
        assert_eq!(amplitude.at(1.0), 0.5);
        assert_eq!(amplitude.at(5.0), 1.0);
        assert!(amplitude.at(2e-3) < 1e-8);
    }

    #[test]
    fn a_table_is_linear_between_its_rows_and_constant_outside() {
        let table = Amplitude::Table(vec![(1.0, 0.0), (2.0, 4.0), (3.0, 2.0)]);
        assert_eq!(table.at(0.0), 0.0);
        assert_eq!(table.at(1.5), 2.0);
        assert_eq!(table.at(2.5), 3.0);
        assert_eq!(table.at(9.0), 2.0);
    }
}
