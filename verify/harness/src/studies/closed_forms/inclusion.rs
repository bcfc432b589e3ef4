//! A ball of another material in a cube whose faces follow the closed form.
#![allow(non_snake_case)]

use crate::exact::inclusion::Inclusion;
use crate::studies::workbench::Workbench;
use anyhow::Result;
use mtled::Simulation;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::geometry::{Selector, Shape};
use mtled::material::{ElasticConstants, Law, LinearElastic, Material};
use mtled::motion::observe::Unobserved;
use mtled::problem::{
    Amplitude, Cloud, Dimension, EssentialCondition, Field, MaterialBorders, Motion, Newton,
    Prescribed, Problem, Recipe, Region,
};
use mtled_checks::study::{Cell, Study, Table, number, text};
use mtled_run::run::integrate;
use mtled_run::specimens::simple::free_body;

/// Edge of the cube \[m\]; the radius of the ball is a quarter of it.
const EDGE: f64 = 0.1;
/// E around the ball \[Pa\], and ν of both.
const ELASTICITY: (f64, f64) = (3000.0, 0.3);
/// Names in keys, and Young's modulus of the ball over that around it.
const BALLS: [(&str, f64); 4] =
    [("soft_300", 1.0 / 300.0), ("soft_10", 0.1), ("stiff_10", 10.0), ("stiff_300", 300.0)];
/// Words of the case format.
const BORDERS: [(&str, MaterialBorders); 2] =
    [("straddled", MaterialBorders::Straddled), ("sharp", MaterialBorders::Sharp)];
/// Of the nodes \[spacing\].
const JITTER: f64 = 0.3;
/// Places along an edge at which displacements are compared.
const PLACES: usize = 24;

/// Errors of the displacement at two spacings, and a check of each on the coarser cloud.
pub(crate) fn inclusions(bench: &Workbench, study: &mut Study) -> Result<()> {
    let (coarse, fine) = (8, bench.pick(12, 16));
    let mut rows = Vec::new();
    for (name, stiffness_ratio) in BALLS {
        for (word, borders) in BORDERS {
            let ball = inclusion(stiffness_ratio);
            let at_coarse = errors(bench, ball, borders, coarse)?;
            let at_fine = errors(bench, ball, borders, fine)?;
            for (part, error) in [("inside", at_coarse.inside), ("outside", at_coarse.outside)] {
                study.checks.push(bench.regression(
                    &format!("closed_forms/inclusion/{name}/{word}/{part}"),
                    &format!(
                        "ball of {stiffness_ratio:.3} times the stiffness, {word} border: {part}"
                    ),
                    error,
                    "1",
                    "closed form of Eshelby 1957 and Goodier 1933; two spacings per radius",
                ));
            }
            rows.push(vec![
                Cell::Number(stiffness_ratio),
                Cell::Text(word.into()),
                Cell::Number(at_coarse.inside),
                Cell::Number(at_coarse.outside),
                Cell::Number(at_fine.inside),
                Cell::Number(at_fine.outside),
            ]);
        }
    }
    study.tables.push(table(rows, coarse, fine));
    study.notes.push(
        "The error inside a ball is over the displacement from its centre, its own or, if larger, \
         that of the same part of an even cube; the error outside over the displacement there."
            .into(),
    );
    Ok(())
}

fn table(rows: Vec<Vec<Cell>>, coarse: usize, fine: usize) -> Table {
    Table {
        title: "A ball of another material in a cube: rms error of the displacement".into(),
        columns: vec![
            number("stiffness of the ball over that around it", "1"),
            text("border"),
            number(&format!("inside, {coarse} spacings per edge"), "1"),
            number("outside", "1"),
            number(&format!("inside, {fine} spacings"), "1"),
            number("outside", "1"),
        ],
        rows,
    }
}

fn inclusion(stiffness_ratio: f64) -> Inclusion {
    let strain = Matrix3::new(1.0, 0.3, 0.0, 0.3, -0.2, 0.1, 0.0, 0.1, 0.4) * 0.01;
    Inclusion { radius: 0.25 * EDGE, stiffness_ratio, poisson_ratio: ELASTICITY.1, strain }
}

fn centre() -> Vector3 {
    Vector3::repeat(0.5 * EDGE)
}

/// The cube with `spacings` of them along an edge.
fn problem(
    bench: &Workbench,
    ball: Inclusion,
    material_borders: MaterialBorders,
    spacings: usize,
) -> Result<Problem> {
    let spacing = EDGE / spacings as f64;
    let cloud = Cloud::Jittered { spacing, jitter: JITTER, seed: bench.seed(1) };
    let recipe = Recipe { cloud, material_borders, ..Recipe::with_spacing(spacing) };
    let body = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(EDGE) };
    let mut problem = free_body(Dimension::Three, body, material(1.0)?, recipe);
    let shape = Shape::Sphere { centre: centre(), radius: ball.radius };
    let part = Selector::Inside { shape, tolerance: 0.0 };
    let own = Region::new("ball", part, material(ball.stiffness_ratio)?);
    problem.regions.insert(0, own);
    let ramp = Amplitude::Linear { duration: 1.0 };
    let exact = Field::of(move |X| ball.displacement(&(X - centre())));
    problem.conditions = vec![EssentialCondition {
        prescribed: Prescribed::Field(exact),
        ..EssentialCondition::on_surface("faces", Selector::All, Vector3::zeros(), ramp)
    }];
    problem.motion = Motion::Newton(Newton { load_end: 1.0, tolerance: 1e-6, ..Newton::default() });
    Ok(problem)
}

fn material(stiffness: f64) -> Result<Material> {
    let (young, poisson) = ELASTICITY;
    let constants = ElasticConstants::from_young_poisson(stiffness * young, poisson)?;
    Ok(Material { density: 1000.0, law: Law::LinearElastic(LinearElastic::new(constants)) })
}

/// Of the displacement, rms over places of a lattice \[–\].
struct Errors {
    inside: f64,
    outside: f64,
}

fn errors(
    bench: &Workbench,
    ball: Inclusion,
    borders: MaterialBorders,
    spacings: usize,
) -> Result<Errors> {
    let problem = problem(bench, ball, borders, spacings)?;
    let solved = integrate(Simulation::with_any_recipe(&problem)?, &mut Unobserved)?;
    let at = |i: usize| (i as f64 + 0.5) * EDGE / PLACES as f64;
    let place =
        |i: usize| Vector3::new(at(i % PLACES), at(i / PLACES % PLACES), at(i / (PLACES * PLACES)));
    let places: Vec<Vector3> = (0..PLACES.pow(3)).map(place).collect();
    let rows = solved.simulation.discretisation.rows_at(&places)?;
    let (mut inside, mut outside) = (Sums::default(), Sums::default());
    for (i, X) in places.iter().enumerate() {
        let offset = X - centre();
        let exact = ball.displacement(&offset);
        let error = rows.interpolate(i, &solved.simulation.state.displacement, 3) - exact;
        let sums = if offset.norm() <= ball.radius { &mut inside } else { &mut outside };
        sums.error += error.norm_squared();
        sums.exact += exact.norm_squared();
        sums.even += (ball.strain * offset).norm_squared();
    }
    Ok(Errors {
        inside: (inside.error / inside.exact.max(inside.even)).sqrt(),
        outside: (outside.error / outside.exact).sqrt(),
    })
}

/// Sums of squared lengths \[m²\].
#[derive(Default)]
struct Sums {
    error: f64,
    exact: f64,
    /// Of the displacements of a cube of one material.
    even: f64,
}
