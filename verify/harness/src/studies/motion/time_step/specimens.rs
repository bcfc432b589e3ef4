//! Bodies whose critical step is measured.
#![allow(non_snake_case)]

use crate::studies::workbench::Workbench;
use mtled::algebra::tensor::Vector3;
use mtled::geometry::{Selector, Shape};
use mtled::material::{
    Guccione, HolzapfelGasserOgden, Isochoric, Law, ShapeEnergy, VolumetricTerm,
};
use mtled::problem::{
    Amplitude, BackgroundGrid, Basis, Cloud, Dimension, Fibres, Field, MassRule, Problem,
    Refinement, RelaxationMass,
};
use mtled_run::specimens::simple::{
    PLANE, SIZE, block_shape, bonded_face, free_body, recipe, relaxation, sphere_shape, tissue,
};

/// A problem whose largest stable step is measured.
#[derive(Debug, Clone)]
pub(crate) struct Specimen {
    pub id: String,
    /// In tables and messages.
    pub label: String,
    pub problem: Problem,
    /// Whether the motion of the problem is to be solved first.
    pub deformed: bool,
}

/// A free block of so many nodes along each edge, ν = 0.49.
fn block(dimension: Dimension, nodes: f64, jitter: f64) -> anyhow::Result<Problem> {
    let recipe = recipe(SIZE / (nodes - 1.0), jitter, 5);
    Ok(free_body(dimension, block_shape(), tissue(0.49)?, recipe))
}

fn specimen(
    id: &str,
    label: &str,
    mut problem: Problem,
    change: impl FnOnce(&mut Problem),
) -> Specimen {
    change(&mut problem);
    // The time step of motion, with the masses of the body.
    if let Some(relaxation) = problem.motion.relaxation_mut() {
        relaxation.mass = RelaxationMass::Lumped;
    }
    Specimen { id: id.into(), label: label.into(), problem, deformed: false }
}

/// Each differs from the jittered block in one or two respects.
pub(crate) fn specimens(bench: &Workbench) -> anyhow::Result<Vec<Specimen>> {
    let cube = |jitter| block(Dimension::Three, bench.pick(6.0, 9.0), jitter);
    let square = |jitter| block(PLANE, bench.pick(9.0, 17.0), jitter);
    let spacing = SIZE / (bench.pick(6.0, 9.0) - 1.0);
    let mut list = vec![
        specimen("square-regular", "square, regular", square(0.0)?, |_| ()),
        specimen("square-jittered", "square, jittered", square(0.3)?, |_| ()),
        specimen("square-wide", "square, jittered, dilation 2.5", square(0.3)?, |p| {
            p.recipe.dilation = 2.5
        }),
        specimen("cube-regular", "cube, regular", cube(0.0)?, |_| ()),
        specimen("cube-jittered", "cube, jittered", cube(0.3)?, |_| ()),
        specimen("cube-narrow", "cube, dilation 1.6", cube(0.3)?, |p| p.recipe.dilation = 1.6),
        specimen("cube-wide", "cube, dilation 2.5", cube(0.3)?, |p| p.recipe.dilation = 2.5),
        specimen("cube-coarse-cells", "cube, 1 cell per spacing", cube(0.3)?, |p| {
            p.recipe.grid = BackgroundGrid::with_cell(spacing)
        }),
        specimen("cube-fine-cells", "cube, 2 cells per spacing", cube(0.3)?, |p| {
            p.recipe.grid = BackgroundGrid::with_cell(0.5 * spacing)
        }),
        specimen("cube-row-sum", "cube, row-sum masses, dilation 2.0", cube(0.3)?, |p| {
            p.recipe.mass = MassRule::RowSum;
            p.recipe.dilation = 2.0;
        }),
        specimen("cube-quadratic", "cube, quadratic basis, dilation 2.5", cube(0.3)?, |p| {
            p.recipe.basis = Basis::Quadratic;
            p.recipe.dilation = 2.5;
        }),
        specimen("cube-bonded", "cube, two faces bonded", cube(0.3)?, bond),
    ];
    for (id, label, law) in [
        ("cube-muscle", "cube of muscle, fibres turning", muscle()?),
        ("cube-artery", "cube of artery, fibres turning", artery()?),
    ] {
        list.push(specimen(id, label, cube(0.3)?, |p| with_fibres(p, law)));
    }
    let mut soft = cube(0.3)?;
    soft.regions[0].material = tissue(0.3)?;
    list.push(specimen("cube-compressible", "cube, ν = 0.3", soft, |_| ()));
    list.push(specimen("cube-graded", "cube, spacing halved in a corner", cube(0.0)?, grade));
    let ball = Problem { body: sphere_shape(), ..cube(0.3)? };
    list.push(specimen("sphere", "sphere, jittered", ball, |_| ()));
    add_deformed(&mut list, &cube(0.3)?);
    for seed in 0..bench.pick(0, 4) {
        let id = format!("cube-seed-{seed}");
        let label = format!("cube, jitter 0.45, seed {seed}");
        list.push(specimen(&id, &label, cube(0.3)?, |p| {
            p.recipe.cloud = Cloud::Jittered { spacing, jitter: 0.45, seed };
        }));
    }
    list.iter_mut().for_each(|specimen| bench.reseed(&mut specimen.problem));
    Ok(list)
}

fn add_deformed(list: &mut Vec<Specimen>, cube: &Problem) {
    for (id, label, fraction) in [
        ("cube-compressed", "cube, compressed by 30 %", -0.3),
        ("cube-stretched", "cube, stretched by 40 %", 0.4),
    ] {
        let deformed = specimen(id, label, cube.clone(), |p| stretch(p, fraction));
        list.push(Specimen { deformed: true, ..deformed });
    }
}

/// Guccione's law with the constants of Land et al. 2015, problem 1, fifty times as stiff against a
/// change of volume.
fn muscle() -> anyhow::Result<Law> {
    let shape = Guccione::new(&[2000.0, 8.0, 2.0, 4.0])?;
    Ok(Law::Guccione(Isochoric::new(shape, 1e5, VolumetricTerm::Quadratic)?))
}

/// Two families of fibres at ± 0.6 from the direction that is given.
fn artery() -> anyhow::Result<Law> {
    let shape = HolzapfelGasserOgden::new(&[3000.0, 2000.0, 0.8, 0.1, 0.6])?;
    Ok(Law::HolzapfelGasserOgden(Isochoric::new(shape, 1.5e5, VolumetricTerm::Quadratic)?))
}

/// Fibres that turn by a right angle from face to face.
fn with_fibres(problem: &mut Problem, law: Law) {
    let angle = |X: &Vector3| 0.5 * std::f64::consts::PI * X.z / SIZE;
    let fibre = Field::of(move |X: &Vector3| Vector3::new(angle(X).cos(), angle(X).sin(), 0.2));
    problem.regions[0].material.law = law;
    problem.regions[0].fibres = Some(Fibres { fibre, sheet: Some(Vector3::z().into()) });
}

fn bond(problem: &mut Problem) {
    problem.conditions = [0.0, SIZE]
        .map(|at| bonded_face(problem.dimension.components() - 1, at, 0.0, Amplitude::Constant))
        .into();
}

/// Bonded faces, one moved away from the other by a fraction of the height.
fn stretch(problem: &mut Problem, fraction: f64) {
    let smooth = Amplitude::Smooth { duration: 1.0 };
    problem.conditions = vec![
        bonded_face(2, 0.0, 0.0, Amplitude::Constant),
        bonded_face(2, SIZE, fraction * SIZE, smooth),
    ];
    problem.motion = relaxation(1000, 1e-7);
}

/// Half the spacing within a fifth of the edge from the corner at the origin.
fn grade(problem: &mut Problem) {
    let Cloud::Regular { spacing } = problem.recipe.cloud else { return };
    let corner = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(0.2 * SIZE) };
    let part = Selector::Inside { shape: corner, tolerance: 0.0 };
    let refinement = Refinement { part, size: 0.5 * spacing };
    problem.recipe.grid.refinements = vec![refinement.clone()];
    problem.recipe.cloud =
        Cloud::Graded { spacing, refinements: vec![refinement], growth: 0.5, seed: 0 };
}
