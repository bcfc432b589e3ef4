//! The clouds on which the critical step is measured.

use crate::specimens::simple::{
    PLANE, SIZE, block_shape, bonded_face, free_body, grid, recipe, relaxation, sphere_shape,
    tissue,
};
use crate::studies::workbench::Workbench;
use mtled::algebra::tensor::Vector3;
use mtled::geometry::selection::Selector;
use mtled::problem::{
    Amplitude, Basis, Cloud, Dimension, MassRule, Motion, Problem, Refinement, RelaxationMass,
};

/// A problem whose stable step is to be found.
#[derive(Debug, Clone)]
pub struct Specimen {
    pub id: String,
    /// What is special about it.
    pub words: String,
    pub problem: Problem,
    /// Whether the motion of the problem is to be solved first.
    pub deformed: bool,
}

/// A free block of 6 nodes along each edge, jitter 0.3, ν = 0.49.
fn block(dimension: Dimension, nodes: f64, jitter: f64) -> anyhow::Result<Problem> {
    let recipe = recipe(SIZE / (nodes - 1.0), jitter, 5);
    Ok(free_body(dimension, block_shape(), tissue(0.49)?, recipe))
}

fn specimen(
    id: &str,
    words: &str,
    mut problem: Problem,
    change: impl FnOnce(&mut Problem),
) -> Specimen {
    change(&mut problem);
    // The step of real motion, with real masses.
    if let Motion::Static(relaxation) = &mut problem.motion {
        relaxation.mass = RelaxationMass::Lumped;
    }
    Specimen { id: id.into(), words: words.into(), problem, deformed: false }
}

/// Each differs from the jittered block in one or two respects.
pub fn specimens(bench: &Workbench) -> anyhow::Result<Vec<Specimen>> {
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
            p.recipe.grid = grid(spacing)
        }),
        specimen("cube-fine-cells", "cube, 2 cells per spacing", cube(0.3)?, |p| {
            p.recipe.grid = grid(0.5 * spacing)
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
    let mut soft = cube(0.3)?;
    soft.regions[0].material = tissue(0.3)?;
    list.push(specimen("cube-compressible", "cube, ν = 0.3", soft, |_| ()));
    list.push(specimen("cube-graded", "cube, spacing halved in a corner", cube(0.0)?, grade));
    let ball = Problem { body: sphere_shape(), ..cube(0.3)? };
    list.push(specimen("sphere", "sphere, jittered", ball, |_| ()));
    let mut pressed =
        specimen("cube-compressed", "cube, compressed by 30 %", cube(0.3)?, |p| stretch(p, -0.3));
    pressed.deformed = true;
    list.push(pressed);
    let mut drawn =
        specimen("cube-stretched", "cube, stretched by 40 %", cube(0.3)?, |p| stretch(p, 0.4));
    drawn.deformed = true;
    list.push(drawn);
    if bench.pick(false, true) {
        for seed in 0..4 {
            let id = format!("cube-seed-{seed}");
            let words = format!("cube, jitter 0.45, seed {seed}");
            list.push(specimen(&id, &words, cube(0.3)?, |p| {
                p.recipe.cloud = Cloud::Jittered { spacing, jitter: 0.45, seed };
            }));
        }
    }
    list.iter_mut().for_each(|specimen| bench.reseed(&mut specimen.problem));
    Ok(list)
}

fn bond(problem: &mut Problem) {
    problem.conditions = [0.0, SIZE]
        .map(|at| bonded_face(problem.dimension.components() - 1, at, 0.0, Amplitude::Constant))
        .into();
}

/// Bonded faces, one moved away from the other by a share of the height.
fn stretch(problem: &mut Problem, share: f64) {
    let smooth = Amplitude::Smooth { duration: 1.0 };
    problem.conditions = vec![
        bonded_face(2, 0.0, 0.0, Amplitude::Constant),
        bonded_face(2, SIZE, share * SIZE, smooth),
    ];
    problem.motion = relaxation(1000, 1e-7);
}

/// Half the spacing within a fifth of the edge from the corner at the origin.
fn grade(problem: &mut Problem) {
    let Cloud::Regular { spacing } = problem.recipe.cloud else { return };
    let corner =
        mtled::geometry::Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(0.2 * SIZE) };
    let part = Selector::Inside { shape: corner, tolerance: 0.0 };
    let refinement = Refinement { part, size: 0.5 * spacing };
    problem.recipe.grid.refinements = vec![refinement.clone()];
    problem.recipe.cloud =
        Cloud::Graded { spacing, refinements: vec![refinement], growth: 0.5, seed: 0 };
}
