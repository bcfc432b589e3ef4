//! The default recipe against the plain scheme of Horton 2007, on the same clouds.

use crate::manufactured::{Orientation, RecipeKind};
use crate::studies::manufactured::scenario::{CLOUDS, Errors, Level, SCENARIOS, Scenario, errors};
use crate::studies::workbench::Workbench;
use anyhow::{Context, Result};
use mtled_checks::study::{Bound, Cell, Study, Table, number, text};
use rayon::prelude::*;

/// One problem with both recipes, on all clouds of one size.
pub(crate) struct Pair {
    scenario: Scenario,
    nodes_per_edge: usize,
    default: Vec<Errors>,
    plain: Vec<Errors>,
}

/// The scenarios: log-J at ν = 0.3 and 0.49.
const COMPARED: [usize; 2] = [0, 2];
/// Nodes per edge of the coarsest clouds that are compared.
const FROM: usize = 9;

/// Target of the error of the plain scheme over that of the default recipe.
const TARGET: f64 = 8.0;

/// A quantity whose errors are compared.
struct Ratio {
    id: &'static str,
    label: &'static str,
    of: fn(&Errors) -> f64,
}

const RATIOS: [Ratio; 3] = [
    Ratio { id: "displacement", label: "displacement", of: |e| e.displacement },
    Ratio { id: "gradient", label: "gradient", of: |e| e.gradient },
    Ratio {
        id: "pressure_deviation",
        label: "pressure less its mean",
        of: |e| e.pressure_deviation,
    },
];

/// Solves with the plain scheme on the finer clouds of both scenarios, and with both recipes on clouds
/// of the turned cube.
pub(crate) fn pairs(bench: &Workbench, all: &[(Scenario, Vec<Level>)]) -> Result<Vec<Pair>> {
    let mut pairs = Vec::new();
    for scenario in COMPARED.map(|index| SCENARIOS[index]) {
        let series = all.iter().find(|(other, _)| other.name == scenario.name);
        let (_, levels) = series.context("a scenario is missing")?;
        for level in levels.iter().filter(|level| level.nodes_per_edge >= FROM) {
            pairs.push(pair(bench, scenario, level.nodes_per_edge, level.errors.clone())?);
            let turned = Scenario { orientation: Orientation::Turned, ..scenario };
            let default = on_clouds(|cloud| errors(bench, &turned, level.nodes_per_edge, cloud))
                .with_context(|| format!("{}, turned", scenario.name))?;
            pairs.push(pair(bench, turned, level.nodes_per_edge, default)?);
        }
    }
    Ok(pairs)
}

fn pair(
    bench: &Workbench,
    scenario: Scenario,
    nodes_per_edge: usize,
    default: Vec<Errors>,
) -> Result<Pair> {
    let plain = on_clouds(|cloud| {
        let points = default[cloud as usize].points;
        let plain = Scenario { recipe: RecipeKind::Plain { points }, ..scenario };
        errors(bench, &plain, nodes_per_edge, cloud)
            .with_context(|| format!("{}, plain scheme, cloud {cloud}", scenario.name))
    })?;
    Ok(Pair { scenario, nodes_per_edge, default, plain })
}

fn on_clouds(solve: impl Fn(u64) -> Result<Errors> + Sync + Send) -> Result<Vec<Errors>> {
    (0..CLOUDS).into_par_iter().map(solve).collect()
}

impl Pair {
    /// Mean errors of the plain scheme and the default recipe.
    fn means(&self, of: fn(&Errors) -> f64) -> [f64; 2] {
        [&self.plain, &self.default]
            .map(|errors| errors.iter().map(of).sum::<f64>() / errors.len() as f64)
    }

    fn orientation(&self) -> &'static str {
        match self.scenario.orientation {
            Orientation::Along => "cube along the grid",
            Orientation::Turned => "cube turned in the grid",
        }
    }

    fn add_checks(&self, bench: &Workbench, study: &mut Study) {
        let Scenario { name, label, poisson_ratio, .. } = self.scenario;
        let id = match self.scenario.orientation {
            Orientation::Along => "plain_over_default",
            Orientation::Turned => "turned_plain_over_default",
        };
        for ratio in &RATIOS {
            let [plain, default] = self.means(ratio.of);
            study.checks.push(bench.target(
                &format!("manufactured/{name}/{id}/{}", ratio.id),
                &format!(
                    "{label}, ν = {poisson_ratio}, {}, {} nodes per edge, at least as many points: {} \
                     error of the plain scheme over that of the default recipe",
                    self.orientation(),
                    self.nodes_per_edge,
                    ratio.label
                ),
                plain / default,
                Bound::AtLeast(TARGET),
                "our target",
            ));
        }
    }
}

/// Checks how many times smaller the errors of the default recipe are on the finest clouds.
pub(crate) fn check_pairs(bench: &Workbench, study: &mut Study, pairs: &[Pair]) -> Result<()> {
    let finest = pairs.iter().map(|pair| pair.nodes_per_edge).max().context("no pairs")?;
    let finest = pairs.iter().filter(|pair| pair.nodes_per_edge == finest);
    finest.for_each(|pair| pair.add_checks(bench, study));
    Ok(())
}

/// Mean errors over the clouds.
pub(crate) fn plain_table(pairs: &[Pair]) -> Table {
    let mut rows = Vec::new();
    for pair in pairs {
        let [plain_points, points] = pair.means(|e| e.points as f64);
        for ratio in &RATIOS {
            let [plain, default] = pair.means(ratio.of);
            rows.push(vec![
                Cell::Text(pair.orientation().into()),
                Cell::Number(pair.nodes_per_edge as f64),
                Cell::Number(pair.scenario.poisson_ratio),
                Cell::Text(ratio.label.into()),
                Cell::Number(plain_points),
                Cell::Number(points),
                Cell::Number(plain),
                Cell::Number(default),
                Cell::Number(plain / default),
            ]);
        }
    }
    Table {
        title: "Plain scheme of Horton 2007 against the default recipe, mean errors".into(),
        columns: vec![
            text("orientation"),
            number("nodes per edge", ""),
            number("Poisson's ratio", "1"),
            text("quantity"),
            number("points, plain", ""),
            number("points, default", ""),
            number("plain", "1"),
            number("default", "1"),
            number("ratio", "1"),
        ],
        rows,
    }
}
