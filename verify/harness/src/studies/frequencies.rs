//! Natural frequencies of bodies of which they are known.

use crate::exact::beam::Beam;
use crate::studies::comparison::published::numbers::{case, problems};
use crate::studies::workbench::{Workbench, exact, relative_error};
use anyhow::{Context, Result, ensure};
use mtled::Simulation;
use mtled::algebra::tensor::Vector3;
use mtled::frequencies::{MassKind, NaturalModes, body_at_rest};
use mtled::geometry::{Extent, Selector, Shape};
use mtled::problem::{Amplitude, Dimension, EssentialCondition, Prescribed, Problem, Recipe};
use mtled_checks::measure::larger;
use mtled_checks::study::{Bound, Cell, Check, Kind, Study, Table, number, text};
use mtled_run::specimens::simple::{PLANE, SIZE, block_shape, bonded_face, free_body, tissue};
use mtled_run::specimens::spacing::respaced;
use std::path::Path;

/// Wave speed √(E/density) of a rod of the tissue \[m/s\].
fn rod_speed() -> f64 {
    3f64.sqrt()
}

/// Cases of Demarest's free cube among the published problems with their Poisson's ratios in words. Their
/// numbers are the frequencies \[Hz\] of groups of modes that are equal by the symmetry of the cube: Ritz's
/// method up to degree 18 of `mtled_reference.free_cube`, of which the last digit is certain.
const CUBES: [(&str, &str); 2] = [("nu_030", "0.3"), ("nu_049", "0.49")];
/// Spacings on an edge.
const SPACINGS: [usize; 3] = [4, 6, 8];
/// Bound on the relative error at 8 spacings \[–\], and on the order between 4 and 8.
const CUBE_BOUND: f64 = 5e-3;
const ORDER: f64 = 2.0;
/// Bounds of the relative errors of a bar, whose waves are exact, and of a beam, whose theory has an error
/// of a few thousandths \[–\].
const BAR_BOUND: f64 = 1e-3;
const BEAM_BOUND: f64 = 1e-2;
/// Largest residual of a mode \[–\].
const RESIDUAL: f64 = 1e-6;
const RITZ: &str = "Demarest 1971: Ritz's method in Legendre polynomials, to the last digit";

/// Computed and known values.
#[derive(Default)]
struct Results {
    rows: Vec<Vec<Cell>>,
    /// Largest residual of all modes \[–\].
    residual: f64,
}

impl Results {
    fn row(&mut self, what: &str, (computed, known): (f64, f64)) {
        self.rows.push(vec![
            Cell::Text(what.into()),
            Cell::Number(computed),
            Cell::Number(known),
            Cell::Number(relative_error(computed, known)),
        ]);
    }

    /// The lowest frequencies of a problem \[Hz\], with so many rigid motions.
    fn find(&mut self, problem: &Problem, count: usize, rigid: usize) -> Result<Vec<f64>> {
        let found = search(problem, count, MassKind::Consistent)?;
        ensure!(found.rigid_motions == rigid, "{} rigid motions are free", found.rigid_motions);
        let residuals = found.modes.iter().map(|mode| mode.residual);
        self.residual = residuals.fold(self.residual, larger);
        Ok(found.modes.iter().map(|mode| mode.frequency).collect())
    }
}

fn search(problem: &Problem, count: usize, kind: MassKind) -> Result<NaturalModes> {
    let rest = body_at_rest(problem);
    let Simulation { discretisation, model, .. } = Simulation::with_any_recipe(&rest)?;
    Ok(NaturalModes::find(&rest, &discretisation, &model, (count, kind), &mut |_| true)?)
}

pub(crate) fn frequencies(_: &Workbench, study: &mut Study) -> Result<()> {
    let mut results = Results::default();
    for cube in CUBES {
        free_cube(cube, study, &mut results)?;
    }
    bar(study, &mut results)?;
    beam(study, &mut results)?;
    free_square(study, &mut results)?;
    study.checks.push(exact(
        "frequencies/residual",
        "largest residual √(rᵀ K⁻¹ r)/ω of all modes",
        results.residual,
        RESIDUAL,
        "some frequency of the discretised body is within half of it (method book, eq. 30.4)",
    ));
    study.notes.push(
        "Masses are consistent. Lumped ones have errors of 12 % at 4 spacings on the edge of the cube, and of \
         3.5 % at 8, which fall with the square of the spacing. The search is blind to the symmetry of the cube: \
         what is equal by it comes out equal."
            .into(),
    );
    study.tables.push(Table {
        title: "Natural frequencies".into(),
        columns: vec![
            text("body and mode"),
            number("computed", "Hz"),
            number("known", "Hz"),
            number("relative error", "1"),
        ],
        rows: results.rows,
    });
    Ok(())
}

/// A cube that nothing holds, at three spacings.
fn free_cube(
    (name, poisson_ratio): (&str, &str),
    study: &mut Study,
    results: &mut Results,
) -> Result<()> {
    let all = problems()?;
    let published = all.iter().find(|(published, _)| published.name == "free_cube");
    let (published, cube) = published.context("the free cube is not among the published ones")?;
    let case = case(published, name, Path::new("."))?;
    let numbers = || cube.numbers.iter().filter(|number| number.case == name);
    let modes = cube.modes(name);
    let mut errors = Vec::new();
    for spacings in SPACINGS {
        let found = results.find(&respaced(&case, 1.0 / spacings as f64)?.problem, modes, 6)?;
        let mut largest = 0.0;
        for (number, known) in (1..).zip(numbers()) {
            let (first, last) = known.modes().context("the number is no frequency")?;
            let own = &found[first - 1..last];
            let mean = own.iter().sum::<f64>() / own.len() as f64;
            let worst = own.iter().map(|f| relative_error(*f, known.value)).fold(0.0, larger);
            largest = larger(largest, worst);
            if spacings == SPACINGS[SPACINGS.len() - 1] {
                let count = own.len();
                let what =
                    format!("free cube, ν = {poisson_ratio}, {count} modes of group {number}");
                results.row(&what, (mean, known.value));
            }
        }
        errors.push(largest);
    }
    let id = |what: &str| format!("frequencies/cube_{poisson_ratio}/{what}");
    let label = |what: &str| format!("free cube, ν = {poisson_ratio}: {what}");
    study.checks.push(exact(
        &id("error"),
        &label(&format!(
            "largest relative error of the {modes} lowest frequencies at 8 spacings on an edge"
        )),
        errors[SPACINGS.len() - 1],
        CUBE_BOUND,
        RITZ,
    ));
    let ratio = SPACINGS[SPACINGS.len() - 1] as f64 / SPACINGS[0] as f64;
    let order = (errors[0] / errors[SPACINGS.len() - 1]).ln() / ratio.ln();
    study.checks.push(Check::new(
        &id("order"),
        &label("order of that error from 4 to 8 spacings"),
        Kind::Exact,
        order,
        Bound::AtLeast(ORDER),
        "1",
        "eigenvalues converge at twice the order of strains (Strang and Fix 1973, chapter 6)",
    ));
    Ok(())
}

/// A bar of ν = 0 that moves along itself alone: waves of one dimension.
fn bar(study: &mut Study, results: &mut Results) -> Result<()> {
    let length = 5.0 * SIZE;
    let mut problem = block(length, 0.0, SIZE / 4.0)?;
    problem.conditions = vec![bonded_face(0, 0.0, 0.0, Amplitude::Constant), guide()];
    let found = results.find(&problem, 3, 0)?;
    let mut largest = 0.0;
    for (number, f) in (0..).zip(found) {
        let known = f64::from(2 * number + 1) * rod_speed() / (4.0 * length);
        let what = format!("bar held at one end, longitudinal wave {}", number + 1);
        results.row(&what, (f, known));
        largest = larger(largest, relative_error(f, known));
    }
    study.checks.push(exact(
        "frequencies/bar/error",
        "guided bar: largest relative error of the first three longitudinal waves",
        largest,
        BAR_BOUND,
        "f = (2 k − 1) c/(4 L), c = √(E/density) for ν = 0",
    ));
    Ok(())
}

/// A slender beam with a square section, clamped at one end: pairs of bending modes.
fn beam(study: &mut Study, results: &mut Results) -> Result<()> {
    let length = 20.0 * SIZE;
    let mut problem = block(length, 0.0, SIZE / 3.0)?;
    problem.conditions = vec![bonded_face(0, 0.0, 0.0, Amplitude::Constant)];
    let found = results.find(&problem, 2, 0)?;
    let (area, second_moment) = (SIZE * SIZE, SIZE.powi(4) / 12.0);
    let material = (3000.0, 1000.0);
    let (young_modulus, density) = material;
    let known = Beam { length, area, second_moment, young_modulus, density }.cantilever_frequency();
    let largest = found.iter().map(|f| relative_error(*f, known)).fold(0.0, larger);
    let first = *found.first().context("the beam has no mode")?;
    results.row("clamped beam, first bending mode, both ways", (first, known));
    study.checks.push(exact(
        "frequencies/beam/error",
        "clamped beam, length 20 times its width: relative error of its first frequency, both ways",
        largest,
        BEAM_BOUND,
        "Euler and Bernoulli, f = 1.8751²/(2π) √(EI/(ρA L⁴))",
    ));
    Ok(())
}

/// A free square in plane strain: its Lamé modes, which need no boundary layer.
fn free_square(study: &mut Study, results: &mut Results) -> Result<()> {
    let problem = free_body(PLANE, block_shape(), tissue(0.3)?, Recipe::with_spacing(SIZE / 12.0));
    let found = results.find(&problem, 8, 3)?;
    let shear_modulus = 3000.0 / 2.6;
    let known = f64::sqrt(shear_modulus / 1000.0) / (SIZE * f64::sqrt(2.0));
    let off = |f: &f64| relative_error(*f, known);
    let nearest = found.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    let nearest = *nearest.context("the square has no mode")?;
    results.row("free square in plane strain, Lamé's mode", (nearest, known));
    study.checks.push(exact(
        "frequencies/square/error",
        "free square in plane strain: relative error of Lamé's mode",
        off(&nearest),
        CUBE_BOUND,
        "Lamé 1852: f = √(μ/density)/(√2 a), a shear without stress on the edges",
    ));
    Ok(())
}

/// A block of so long a side along x, and of SIZE along the others.
fn block(length: f64, poisson_ratio: f64, spacing: f64) -> Result<Problem> {
    let shape = Shape::Box { min: Vector3::zeros(), max: Vector3::new(length, SIZE, SIZE) };
    let recipe = Recipe::with_spacing(spacing);
    Ok(free_body(Dimension::Three, shape, tissue(poisson_ratio)?, recipe))
}

/// Nothing moves but along x.
fn guide() -> EssentialCondition {
    EssentialCondition {
        name: "guide".into(),
        extent: Extent::Volume,
        part: Selector::All,
        prescribed: Prescribed::Displacement([None, Some(0.0), Some(0.0)]),
        amplitude: Amplitude::Constant,
        release: None,
    }
}
