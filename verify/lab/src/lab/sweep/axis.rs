//! Ranges of settings as they are written on the command line and in plans.

use mtled_case::scene::{Knob, Level, Setting, nearest};

/// More levels than this on one axis are taken for a typing error.
const MOST_LEVELS: usize = 1000;

/// More runs than this of one case are taken for a typing error.
const MOST_RUNS: f64 = 1e5;

/// One knob and its levels.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// What is changed.
    pub knob: Knob,
    /// Its values.
    pub levels: Vec<Level>,
}

/// What is wrong with a range.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AxisError {
    /// No setting has this name.
    #[error("there is no setting `{name}`; {}", meant(name))]
    Unknown {
        /// The name.
        name: String,
    },
    /// The text is neither a list nor a range.
    #[error("{knob}: `{text}` is neither a list such as 1.4,1.8 nor a range such as 1.4..2.6:0.2")]
    Range {
        /// Name of the setting.
        knob: &'static str,
        /// The text.
        text: String,
    },
    /// The range is too long.
    #[error("{knob}: `{text}` has {count} levels; at most {MOST_LEVELS} are allowed")]
    TooMany {
        /// Name of the setting.
        knob: &'static str,
        /// The text.
        text: String,
        /// Number of its levels.
        count: f64,
    },
    /// The combinations of all ranges on all clouds are none, or too many.
    #[error(
        "{combinations} combinations on {clouds} clouds each are {} runs; it must be 1 to {MOST_RUNS}: \
             use shorter ranges or fewer clouds",
        combinations * clouds
    )]
    Runs {
        /// Number of combinations of levels.
        combinations: f64,
        /// Clouds per combination.
        clouds: f64,
    },
}

/// Refuses ranges whose combinations, on so many clouds each, are no runs or too many.
pub(crate) fn refuse_too_many_runs(axes: &[Axis], clouds: usize) -> Result<(), AxisError> {
    let combinations: f64 = axes.iter().map(|axis| axis.levels.len() as f64).product();
    let clouds = clouds as f64;
    if (1.0..=MOST_RUNS).contains(&(combinations * clouds)) {
        Ok(())
    } else {
        Err(AxisError::Runs { combinations, clouds })
    }
}

/// What could have been meant.
fn meant(name: &str) -> String {
    let names: Vec<&str> = Knob::ALL.iter().map(|knob| knob.name()).collect();
    match nearest(name, names.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("the settings are {}", names.join(", ")),
    }
}

impl Axis {
    /// The axis of a knob by its name.
    pub(crate) fn named(name: &str, text: &str) -> Result<Axis, AxisError> {
        let knob = Knob::named(&name.replace('-', "_"))
            .ok_or_else(|| AxisError::Unknown { name: name.into() })?;
        Axis::parse(knob, text)
    }

    /// `1.4`, `1.4,1.8`, `linear,quadratic`, or `1.4..2.6:0.2` with both ends included; a
    /// level that is repeated counts once.
    pub fn parse(knob: Knob, text: &str) -> Result<Axis, AxisError> {
        let refused = || AxisError::Range { knob: knob.name(), text: text.into() };
        let mut levels = Vec::new();
        for part in text.split(',').map(str::trim) {
            match part.split_once("..") {
                Some((first, rest)) => {
                    let (last, step) = rest.split_once(':').ok_or_else(refused)?;
                    let [first, last, step] = [first, last, step].map(|n| n.trim().parse::<f64>());
                    let (Ok(first), Ok(last), Ok(step)) = (first, last, step) else {
                        return Err(refused());
                    };
                    levels.extend(range(first, last, step, knob, text)?);
                }
                None if part.is_empty() => return Err(refused()),
                None => levels.push(match part.parse::<f64>() {
                    Ok(number) if number.is_finite() => Level::Number(number),
                    Ok(_) => return Err(refused()),
                    Err(_) => Level::Word(part.to_string()),
                }),
            }
            if levels.len() > MOST_LEVELS {
                let (text, count) = (text.into(), levels.len() as f64);
                return Err(AxisError::TooMany { knob: knob.name(), text, count });
            }
        }
        let mut different: Vec<Level> = Vec::with_capacity(levels.len());
        for level in levels {
            if !different.iter().any(|known| equal(known, &level)) {
                different.push(level);
            }
        }
        Ok(Axis { knob, levels: different })
    }
}

/// Whether two levels are the same, however their numbers are written.
pub(crate) fn equal(a: &Level, b: &Level) -> bool {
    let words = |level: &Level| matches!(level, Level::Word(_));
    a == b || words(a) && words(b) && number_of(a).is_some() && number_of(a) == number_of(b)
}

/// From `first` to `last`, both included, rounded to nine digits, so that 1.4 + 0.2 is
/// 1.6.
fn range(
    first: f64,
    last: f64,
    step: f64,
    knob: Knob,
    text: &str,
) -> Result<Vec<Level>, AxisError> {
    let count = ((last - first) / step + 1e-9).floor() + 1.0;
    if !(step != 0.0 && step.is_finite() && count.is_finite() && count >= 1.0) {
        return Err(AxisError::Range { knob: knob.name(), text: text.into() });
    }
    if count > MOST_LEVELS as f64 {
        return Err(AxisError::TooMany { knob: knob.name(), text: text.into(), count });
    }
    let at = |n: usize| format!("{:.8e}", first + n as f64 * step);
    Ok((0..count as usize).map(|n| Level::Number(at(n).parse().unwrap_or(first))).collect())
}

/// The number of a level, where it is one or a factor such as `x0.8`.
pub(crate) fn number_of(level: &Level) -> Option<f64> {
    match level {
        Level::Number(number) => Some(*number),
        Level::Word(word) => word.strip_prefix('x')?.parse().ok(),
    }
}

/// Every combination of levels, the last axis fastest; the settings of each are in the
/// order in which they must be applied.
pub(crate) fn combinations(axes: &[Axis]) -> Vec<Vec<Setting>> {
    let mut all = vec![Vec::new()];
    for axis in axes {
        all = all
            .iter()
            .flat_map(|so_far: &Vec<Setting>| {
                axis.levels.iter().map(|level| {
                    let mut settings = so_far.clone();
                    settings.push(Setting { knob: axis.knob, level: level.clone() });
                    settings
                })
            })
            .collect();
    }
    all.iter_mut().for_each(|settings| settings.sort_by_key(|setting| setting.knob));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(text: &str) -> Vec<f64> {
        let axis = Axis::parse(Knob::Dilation, text).unwrap();
        let number = |level: &Level| match level {
            Level::Number(number) => *number,
            Level::Word(word) => panic!("{word}"),
        };
        axis.levels.iter().map(number).collect()
    }

    #[test]
    fn ranges_include_both_ends_and_lists_may_contain_ranges() {
        assert_eq!(numbers("1.4..2.6:0.4"), [1.4, 1.8, 2.2, 2.6]);
        assert_eq!(numbers("1.4..2.5:0.4"), [1.4, 1.8, 2.2]);
        assert_eq!(numbers("2, 1..0:-0.5"), [2.0, 1.0, 0.5, 0.0]);
    }

    #[test]
    fn a_level_that_is_given_twice_counts_once() {
        assert_eq!(numbers("1.4,1.8,1.40,1.4..1.8:0.2"), [1.4, 1.8, 1.6]);
        let axis = Axis::parse(Knob::Spacing, "x1,x1.0,x2,x1,1").unwrap();
        let [one, two] = ["x1", "x2"].map(|word| Level::Word(word.into()));
        assert_eq!(axis.levels, [one, two, Level::Number(1.0)]);
    }

    #[test]
    fn typing_errors_are_reported() {
        for text in ["", "1.4..2", "1..2:0", "1..2:inf", "2..1:0.5", "nan", "1,,2", "a..b:1"] {
            let error = Axis::parse(Knob::Dilation, text).unwrap_err();
            assert!(matches!(error, AxisError::Range { .. }), "{text}: {error}");
        }
        let error = Axis::parse(Knob::Dilation, "0..1:1e-9").unwrap_err();
        assert!(matches!(error, AxisError::TooMany { .. }), "{error}");
        let text = vec!["0..900:1"; 2000].join(",");
        let error = Axis::parse(Knob::Dilation, &text).unwrap_err();
        assert!(matches!(error, AxisError::TooMany { count: 1802.0, .. }), "{error}");
        let error = Axis::named("dilatoin", "1").unwrap_err();
        assert!(error.to_string().contains("dilation"), "{error}");
    }

    #[test]
    fn too_many_runs_are_refused_before_they_are_listed() {
        let long = |knob| Axis::parse(knob, "0..1:0.002,2..3:0.004").unwrap();
        let axes = [Knob::Dilation, Knob::CellsPerSpacing, Knob::Load, Knob::Jitter].map(long);
        for (axes, clouds) in [(&axes[..], 1), (&[], 4_000_000_000_000), (&[], 0)] {
            let error = refuse_too_many_runs(axes, clouds).unwrap_err().to_string();
            assert!(error.contains("runs; it must be 1 to 100000"), "{error}");
        }
        assert_eq!(refuse_too_many_runs(&axes[..1], 3), Ok(()));
    }

    #[test]
    fn combinations_are_ordered_and_the_spacing_is_set_first() {
        let axes = [
            Axis::parse(Knob::Dilation, "1.6,2").unwrap(),
            Axis::parse(Knob::Spacing, "x1,x0.5").unwrap(),
        ];
        let all = combinations(&axes);
        assert_eq!(all.len(), 4);
        assert_eq!(
            all[1],
            [Setting::word(Knob::Spacing, "x0.5"), Setting::number(Knob::Dilation, 1.6)]
        );
    }
}
