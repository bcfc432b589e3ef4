//! What is published of a problem: `reference/published/PROBLEM/numbers.toml`.

use anyhow::{Context, Result, anyhow};
use mtled_case::scene::{Case, parse_case};
use mtled_checks::report::write_atomically;
use mtled_reference::{CASES, FIBRES, PUBLISHED, PUBLISHED_FILES, Published};
use serde::Deserialize;
use std::path::Path;

/// A problem with its numbers.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Problem {
    /// Its name for readers.
    pub title: String,
    /// What it is about, where it comes from and what is known of its numbers.
    pub remark: String,
    /// Its cases.
    #[serde(rename = "case")]
    pub cases: Vec<CaseOf>,
    /// Its numbers; a problem may have none.
    #[serde(default, rename = "number")]
    pub numbers: Vec<Number>,
}

impl Problem {
    /// How many natural frequencies of a case its numbers need; none where it is solved.
    pub(crate) fn modes(&self, case: &str) -> usize {
        let own = self.numbers.iter().filter(|number| number.case == case);
        own.filter_map(Number::modes).map(|(_, last)| last).max().unwrap_or(0)
    }
}

/// A case of a problem.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CaseOf {
    /// Of its file, of a bundled case or of a body with fibres.
    pub name: String,
    /// Spacings that the full suite solves \[m\]; that of the file, which is judged, is among them.
    pub spacings: Vec<f64>,
    /// Whether only the full suite solves it.
    #[serde(default)]
    pub only_full: bool,
}

/// Who a number comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum By {
    /// People who have nothing to do with this program.
    Others,
    /// A formula or an integral.
    ClosedForm,
    /// A series that is summed for this repository until its last digit stays.
    SeriesHere,
    /// Finite elements, computed for this repository.
    FiniteElementsHere,
}

impl By {
    pub(crate) fn words(self) -> &'static str {
        match self {
            By::Others => "others",
            By::ClosedForm => "closed form",
            By::SeriesHere => "series, for this page",
            By::FiniteElementsHere => "finite elements, for this page",
        }
    }
}

/// When an answer is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum When {
    Start,
    End,
    Maximum,
    Minimum,
    /// The time at which it is largest \[s\].
    TimeOfMaximum,
    /// The time at which it is smallest \[s\].
    TimeOfMinimum,
    /// Half of the sum of the largest and the smallest.
    Mean,
    /// Half of their difference.
    Amplitude,
    /// The largest change from the first sample.
    Drift,
    /// From the first sample that is not zero to the last \[s\].
    Duration,
}

fn end() -> When {
    When::End
}

fn always() -> [f64; 2] {
    [0.0, f64::INFINITY]
}

/// One number.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Number {
    /// Case that it belongs to.
    pub case: String,
    /// In words, for readers and for the id of its check.
    pub name: String,
    /// What is measured, such as `displacement/tip/z`, or `frequency/3-5` for the mean natural frequency
    /// of the third to the fifth mode of the case.
    pub answer: String,
    /// When.
    #[serde(default = "end")]
    pub when: When,
    /// Samples that count \[s\].
    #[serde(default = "always")]
    pub between: [f64; 2],
    /// \[`unit`\]
    pub value: f64,
    /// SI unit.
    pub unit: String,
    /// Half-width of the interval in which the value is known to lie \[`unit`\].
    pub spread: f64,
    /// What differences are divided by \[`unit`\]; the value if left out.
    pub scale: Option<f64>,
    /// Difference over the scale, beside the spread, that still agrees \[–\].
    pub tolerance: f64,
    /// Who computed it.
    pub by: By,
    /// Paper, table, file.
    pub source: String,
    /// Licence of a file that the value was copied from.
    #[serde(default)]
    pub licence: String,
    /// Why it is known to be missed at the spacing of the case; met if left out.
    #[serde(default)]
    pub missed: String,
}

impl Number {
    /// What differences are divided by \[`unit`\].
    pub(crate) fn scale(&self) -> f64 {
        self.scale.unwrap_or(self.value).abs()
    }

    /// Its first and its last mode, counted from 1 and without rigid motions, where it is a natural
    /// frequency.
    pub(crate) fn modes(&self) -> Option<(usize, usize)> {
        let (first, last) = self.answer.strip_prefix("frequency/")?.split_once('-')?;
        Some((first.parse().ok()?, last.parse().ok()?))
    }

    /// |ours − published| over the scale \[–\].
    pub fn difference(&self, ours: f64) -> f64 {
        (ours - self.value).abs() / self.scale()
    }

    /// Spread and tolerance over the scale \[–\].
    pub(crate) fn bound(&self) -> f64 {
        self.tolerance + self.spread / self.scale()
    }

    /// Id of its check.
    pub(crate) fn id(&self, problem: &str) -> String {
        let case = if self.case == "case" { String::new() } else { format!("/{}", self.case) };
        let name = self.name.replace([' ', ',', '.', '’'], "_");
        format!("published/{problem}{case}/{name}")
    }
}

/// The problems with their names.
pub(crate) fn problems() -> Result<Vec<(&'static Published, Problem)>> {
    let read = |published: &'static Published| {
        let problem = toml_edit::de::from_str(published.numbers);
        Ok((published, problem.with_context(|| format!("numbers of {}", published.name))?))
    };
    PUBLISHED.iter().map(read).collect()
}

/// Writes what cases name into `folder`.
pub(crate) fn unpack(folder: &Path) -> Result<()> {
    for (name, text) in PUBLISHED_FILES {
        write_atomically(&folder.join(name), text.as_bytes())?;
    }
    Ok(())
}

/// A case of a problem; what it names lies in `folder`.
pub(crate) fn case(published: &Published, name: &str, folder: &Path) -> Result<Case> {
    let own = published.cases.iter().find(|(own, _)| *own == name).map(|(_, text)| *text);
    let bundled = || CASES.iter().find(|(other, _)| *other == name).map(|(_, text)| *text);
    let with_fibres = || FIBRES.iter().find(|body| body.name == name).map(|body| body.case);
    let text = own
        .or_else(bundled)
        .or_else(with_fibres)
        .with_context(|| format!("{} has no case {name}", published.name))?;
    parse_case(text, name, folder).map_err(|found| anyhow!("{name}: {found:?}"))
}
