//! The manufactured solutions as problems for the solver.
#![allow(non_snake_case)]

use crate::exact::manufactured::Manufactured;
use anyhow::Result;
use mtled::algebra::tensor::{Matrix3, Vector3, rotation};
use mtled::discretisation::quadrature::quadrature;
use mtled::geometry::{Selector, Shape, Surface};
use mtled::material::Material;
use mtled::problem::{
    Amplitude, BodyForce, Enforcement, Field, Gradients, InsideRule, MassRule, Prescribed, Problem,
    Traction, VolumetricProjection, defaults,
};
use mtled_case::scene::{one_error, parse_case};
use std::path::Path;
use std::sync::Arc;

/// Orientation of the cube in the background grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Orientation {
    /// Its faces run along the grid.
    Along,
    /// It is turned by 1.1 rad about (1, 2, 3) and given as a surface of triangles: nodes lie on a
    /// lattice inside and along its faces, and the faces cut cells at any angle.
    Turned,
}

/// How a solution is discretised.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RecipeKind {
    /// The defaults of the case format.
    Default,
    /// The default with 2 cells per spacing, eight points per node.
    Finer,
    /// The default with gradients consistent for constant stresses only.
    Consistent,
    /// That of Horton 2007: plain gradients, cells kept whole where their centre is inside,
    /// nodal parameters prescribed, J at every point, masses split evenly; with at least
    /// this many points.
    Plain { points: usize },
}

/// Young's modulus \[Pa\].
pub(crate) const YOUNG_MODULUS: f64 = 3000.0;
/// Density \[kg/m³\].
pub(crate) const DENSITY: f64 = 1000.0;

/// A solution after X → R X.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Oriented {
    solution: Manufactured,
    orientation: Orientation,
    /// Rotation R.
    pub turn: Matrix3,
}

impl Oriented {
    /// A solution in one of the two orientations.
    pub(crate) fn new(solution: Manufactured, orientation: Orientation) -> Oriented {
        let turn = match orientation {
            Orientation::Along => Matrix3::identity(),
            Orientation::Turned => rotation(&Vector3::new(1.0, 2.0, 3.0).normalize(), 1.1),
        };
        Oriented { solution, orientation, turn }
    }

    /// R u(Rᵀ X) \[m\].
    pub(crate) fn displacement(&self, X: &Vector3) -> Vector3 {
        self.turn * self.solution.displacement(&self.turn.tr_mul(X))
    }

    /// R F(Rᵀ X) Rᵀ.
    pub(crate) fn deformation_gradient(&self, X: &Vector3) -> Matrix3 {
        let F = self.solution.deformation_gradient(&self.turn.tr_mul(X));
        self.turn * F * self.turn.transpose()
    }

    /// R b(Rᵀ X) \[N/kg\]: the laws know no direction.
    pub(crate) fn body_force(&self, X: &Vector3) -> Vector3 {
        self.turn * self.solution.body_force(&self.turn.tr_mul(X))
    }
}

/// Case file with the defaults of the format for everything that is left out.
fn case_text(nodes_per_edge: usize, seed: u64) -> String {
    format!(
        r#"
title = "Manufactured solution"
description = "A cube whose boundary follows a given field, under the body force that belongs to it."
source = "reference/manufactured/derive.py"

[geometry]
shape = {{ box = {{ min = [0.0, 0.0, 0.0], max = [1.0, 1.0, 1.0] }} }}

[material.solid]
law = "neo_hookean_log_j"
density = {DENSITY:?}
young_modulus = {YOUNG_MODULUS:?}
poisson_ratio = 0.3

[discretisation]
cloud = "jittered"
spacing = {:?}
jitter = 0.3
seed = {seed}

[[prescribe]]
name = "boundary"
of = "surface"
where = "all"
displacement = {{ x = 0.0, y = 0.0, z = 0.0 }}
amplitude = {{ smooth = {{ duration = 1.0 }} }}

[time]
method = "static"
load_steps = {}
tolerance = 3e-5

[[probe]]
name = "middle"
point = [0.5, 0.5, 0.5]
"#,
        1.0 / (nodes_per_edge - 1) as f64,
        // A wave needs more steps to cross a finer cloud.
        if nodes_per_edge > 9 { 800 } else { 200 },
    )
}

/// The problem that has the solution.
pub(crate) fn manufactured_problem(
    oriented: Oriented,
    nodes_per_edge: usize,
    seed: u64,
    kind: RecipeKind,
) -> Result<Problem> {
    let text = case_text(nodes_per_edge, seed);
    let case = parse_case(&text, "manufactured", Path::new(".")).map_err(one_error)?;
    let mut problem = case.problem;
    if oriented.orientation == Orientation::Turned {
        problem.body = turned_cube(&oriented.turn)?;
    }
    match kind {
        RecipeKind::Default => {}
        RecipeKind::Finer => problem.recipe.grid.cell = 0.5 / (nodes_per_edge - 1) as f64,
        RecipeKind::Consistent => {
            let tolerance = defaults::GRADIENT_TOLERANCE;
            problem.recipe.gradients = Gradients::Consistent { tolerance };
        }
        RecipeKind::Plain { points } => make_plain(&mut problem, points)?,
    }
    impose(&mut problem, oriented)?;
    Ok(problem)
}

/// Gives a body of one region with one condition the material, boundary values and
/// body force of a solution.
pub(crate) fn impose(problem: &mut Problem, oriented: Oriented) -> Result<()> {
    let solution = oriented.solution;
    let law = solution.family.law(solution.constants)?;
    problem.regions[0].material = Material { density: solution.density, law };
    problem.conditions[0].prescribed =
        Prescribed::Field(Field::of(move |X| oriented.displacement(X)));
    problem.loads.body_forces = vec![BodyForce {
        part: Selector::All,
        acceleration: Field::of(move |X| oriented.body_force(X)),
        amplitude: Amplitude::Smooth { duration: 1.0 },
    }];
    Ok(())
}

/// Leaves three faces of the cube along the grid to the tractions P N of the solution.
pub(crate) fn free_three_faces(problem: &mut Problem, oriented: Oriented) {
    let law = problem.regions[0].material.law;
    let face = |axis: usize, at: f64| {
        let normal = Vector3::ith(axis, 1.0);
        Selector::Plane { point: at * normal, normal, tolerance: 1e-9 }
    };
    problem.conditions[0].part = Selector::Union((0..3).map(|axis| face(axis, 0.0)).collect());
    problem.loads.tractions.extend((0..3).map(|axis| Traction {
        name: format!("face {axis}"),
        part: face(axis, 1.0),
        traction: Field::of(move |X| {
            law.first_piola_kirchhoff(&oriented.deformation_gradient(X)).column(axis).into()
        }),
        amplitude: Amplitude::Smooth { duration: 1.0 },
    }));
}

/// The unit cube after X → R X, as a closed surface of twelve triangles.
fn turned_cube(turn: &Matrix3) -> Result<Shape> {
    let corner = |n: usize| Vector3::new((n & 1) as f64, (n >> 1 & 1) as f64, (n >> 2) as f64);
    let vertices: Vec<Vector3> = (0..8).map(|n| turn * corner(n)).collect();
    let faces =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let halves = faces.iter().flat_map(|&[a, b, c, d]: &[u32; 4]| [[a, b, c], [a, c, d]]);
    Ok(Shape::Surface(Arc::new(Surface::new(vertices, halves.collect())?)))
}

/// The plain scheme with the largest cells, by steps of half a percent, that give at least
/// `points` points. Along the grid they fit the cube, which favours the scheme.
fn make_plain(problem: &mut Problem, points: usize) -> Result<()> {
    let recipe = &mut problem.recipe;
    recipe.grid.inside = InsideRule::Centre;
    recipe.gradients = Gradients::Plain;
    recipe.enforcement = Enforcement::Direct;
    recipe.volumetric_projection = VolumetricProjection::None;
    recipe.mass = MassRule::EvenSplit;
    let grid = &mut recipe.grid;
    match problem.body {
        Shape::Box { .. } => {
            let cells_per_edge = (1..).find(|n: &usize| n.pow(3) >= points).unwrap_or(1);
            grid.cell = 1.0 / cells_per_edge as f64;
        }
        _ => {
            grid.cell = 1.02 / (points as f64).cbrt();
            let count = |grid: &_| {
                quadrature(&problem.body, &problem.regions, grid, &problem.dimension)
                    .map(|quadrature| quadrature.positions.len())
            };
            while count(grid)? < points {
                grid.cell *= 0.995;
            }
        }
    }
    Ok(())
}
