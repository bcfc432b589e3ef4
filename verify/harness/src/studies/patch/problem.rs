//! Bodies of the patch test and how they are discretised.
#![allow(non_snake_case)]

use crate::studies::workbench::Workbench;
use mtled::algebra::tensor::Vector3;
use mtled::geometry::Shape;
use mtled::problem::{BackgroundGrid, Dimension, Enforcement, Gradients, Problem};
use mtled_run::accuracy::patch::{AffineField, affine_gradient};
use mtled_run::specimens::simple::{
    PLANE, SIZE, block_shape, free_body, recipe, relaxation, sphere_shape, tissue,
};

/// A body, its node spacing and its affine field.
#[derive(Debug, Clone)]
pub(crate) struct Body {
    pub name: &'static str,
    pub dimension: Dimension,
    pub shape: Shape,
    /// \[m\]
    pub spacing: f64,
    pub field: AffineField,
}

/// How the patch is discretised.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PatchRecipe {
    pub enforcement: Enforcement,
    pub gradients: Gradients,
    pub cells_per_spacing: f64,
    pub seed: u64,
}

/// The defaults, with gradients consistent to round-off.
pub(crate) const EXACT: PatchRecipe = PatchRecipe {
    enforcement: Enforcement::Collocation,
    gradients: Gradients::Consistent { tolerance: 1e-13 },
    cells_per_spacing: 1.26,
    seed: 0,
};

/// Jitter of all clouds \[spacing\].
pub(crate) const JITTER: f64 = 0.3;

/// Simple bodies in space and in a plane, and two of the bundled cases.
pub(crate) fn bodies(bench: &Workbench) -> anyhow::Result<Vec<Body>> {
    let centre = Vector3::repeat(0.5 * SIZE);
    let body = |name, dimension: Dimension, shape, spacing| {
        let field = AffineField { H: affine_gradient(dimension.components()), centre };
        Body { name, dimension, shape, spacing, field }
    };
    let cylinder = Shape::Cylinder {
        base: Vector3::new(0.5 * SIZE, 0.5 * SIZE, 0.0),
        axis: Vector3::z(),
        radius: 0.4 * SIZE,
        height: SIZE,
    };
    let mut bodies = vec![
        body("cube", Dimension::Three, block_shape(), SIZE / 6.0),
        body("cylinder", Dimension::Three, cylinder, SIZE / 6.0),
        body("sphere", Dimension::Three, sphere_shape(), SIZE / 6.0),
        body("square", PLANE, block_shape(), SIZE / 10.0),
    ];
    for (name, case, spacing) in
        [("cook", "cook_membrane", 0.004), ("brain-outline", "brain_slice", 0.008)]
    {
        let problem = bench.case(case)?.problem;
        let section = problem.body.section(&problem.dimension)?;
        let around = section.bounding_box().unwrap_or((centre, centre));
        let centre =
            Vector3::from_fn(|k, _| if k < 2 { 0.5 * (around.0[k] + around.1[k]) } else { 0.0 });
        let mut body = body(name, problem.dimension, problem.body, spacing);
        body.field.centre = centre;
        bodies.push(body);
    }
    Ok(bodies)
}

/// The free body, without loads.
pub(crate) fn problem(
    bench: &Workbench,
    body: &Body,
    poisson_ratio: f64,
    choice: &PatchRecipe,
) -> anyhow::Result<Problem> {
    let mut recipe = recipe(body.spacing, JITTER, bench.seed(choice.seed));
    recipe.grid = BackgroundGrid::with_cell(body.spacing / choice.cells_per_spacing);
    recipe.enforcement = choice.enforcement;
    recipe.gradients = choice.gradients;
    let material = tissue(poisson_ratio)?;
    let mut problem = free_body(body.dimension, body.shape.clone(), material, recipe);
    problem.motion = relaxation(200, 1e-12);
    Ok(problem)
}
