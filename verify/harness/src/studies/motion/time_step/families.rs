//! Eight families of small random bodies on which the time step is tested.

use mtled::algebra::random::Random;
use mtled::algebra::tensor::Vector3;
use mtled::geometry::{Selector, Shape};
use mtled::material::{ElasticConstants, Law, NeoHookeanLogJ};
use mtled::problem::{
    Amplitude, BackgroundGrid, Basis, Cloud, Dimension, Gradients, MassRule, Problem, Refinement,
    Region, RelaxationMass,
};
use mtled_run::specimens::simple::{
    PLANE, SIZE, block_shape, bonded_face, free_body, recipe, sphere_shape, tissue,
};

/// A family of bodies: what its members have in common, and how one is made from random numbers.
pub(crate) struct Family {
    pub id: &'static str,
    /// In tables and messages.
    pub label: &'static str,
    change: fn(&mut Problem, &mut Random, f64),
    dimension: Dimension,
    /// Nodes along an edge.
    nodes: f64,
}

const SPACE: Dimension = Dimension::Three;

pub(crate) const FAMILIES: [Family; 8] = [
    Family {
        id: "square",
        label: "squares in plane strain",
        change: |_, _, _| (),
        dimension: PLANE,
        nodes: 9.0,
    },
    Family { id: "cube", label: "cubes", change: |_, _, _| (), dimension: SPACE, nodes: 6.0 },
    Family {
        id: "sphere",
        label: "spheres",
        change: |problem, _, _| problem.body = sphere_shape(),
        dimension: SPACE,
        nodes: 7.0,
    },
    Family {
        id: "slab",
        label: "slabs two to three spacings thick",
        change: |problem, random, spacing| {
            let height = spacing * (2.5 + 0.5 * random.symmetric());
            let max = Vector3::new(SIZE, SIZE, height);
            problem.body = Shape::Box { min: Vector3::zeros(), max };
        },
        dimension: SPACE,
        nodes: 8.0,
    },
    Family { id: "graded", label: "graded cubes", change: grade, dimension: SPACE, nodes: 5.0 },
    Family {
        id: "layered",
        label: "cubes of two materials, stiffness 1 to 600",
        change: layer,
        dimension: SPACE,
        nodes: 6.0,
    },
    Family {
        id: "quadratic",
        label: "squares with the quadratic basis",
        change: |problem, random, _| {
            problem.recipe.basis = Basis::Quadratic;
            problem.recipe.dilation = 2.8 + 0.4 * random.symmetric();
        },
        dimension: PLANE,
        nodes: 9.0,
    },
    Family {
        id: "bonded",
        label: "cubes with two bonded faces and row-sum masses",
        change: |problem, random, _| {
            problem.recipe.mass = MassRule::RowSum;
            problem.recipe.dilation = 1.9 + 0.2 * random.symmetric();
            problem.conditions =
                [0.0, SIZE].map(|at| bonded_face(2, at, 0.0, Amplitude::Constant)).into();
        },
        dimension: SPACE,
        nodes: 6.0,
    },
];

impl Family {
    /// Member `seed` of the family: jitter 0 to 0.45, dilation 1.6 to 2.4, 1.1
    /// to 2 cells per spacing and ν from 0 to 0.499 at random.
    pub(crate) fn member(&self, seed: u64) -> anyhow::Result<Problem> {
        let mut random = Random(seed.wrapping_mul(0x9e37_79b9).wrapping_add(self.id.len() as u64));
        let mut between =
            |low: f64, high: f64| low + 0.5 * (high - low) * (1.0 + random.symmetric());
        let spacing = SIZE / (self.nodes - 1.0);
        let poisson_ratio = [0.0, 0.3, 0.45, 0.49, 0.499][between(0.0, 5.0) as usize];
        let mut recipe = recipe(spacing, between(0.0, 0.45), seed);
        recipe.dilation = between(1.6, 2.4);
        recipe.grid = BackgroundGrid::with_cell(spacing / between(1.1, 2.0));
        recipe.gradients = Gradients::Consistent { tolerance: 1e-3 };
        let mut problem = free_body(self.dimension, block_shape(), tissue(poisson_ratio)?, recipe);
        (self.change)(&mut problem, &mut random, spacing);
        // The time step of motion, with the masses of the body.
        if let Some(relaxation) = problem.motion.relaxation_mut() {
            relaxation.mass = RelaxationMass::Lumped;
        }
        Ok(problem)
    }
}

/// Two to four times finer within a random ball.
fn grade(problem: &mut Problem, random: &mut Random, spacing: f64) {
    let centre = Vector3::repeat(0.5 * SIZE) + 0.4 * SIZE * random.vector(3);
    let part =
        Selector::Inside { shape: Shape::Sphere { centre, radius: 0.25 * SIZE }, tolerance: 0.0 };
    let size = spacing / (3.0 + random.symmetric());
    let refinements = vec![Refinement { part, size }];
    problem.recipe.grid.refinements =
        vec![Refinement { size: size / 1.26, ..refinements[0].clone() }];
    problem.recipe.cloud = Cloud::Graded { spacing, refinements, growth: 0.5, seed: 0 };
}

/// One half up to 600 times stiffer.
fn layer(problem: &mut Problem, random: &mut Random, _spacing: f64) {
    let mut stiff = problem.regions[0].clone();
    let constants = ElasticConstants::from_young_poisson(
        3000.0 * 600f64.powf(0.5 * (1.0 + random.symmetric())),
        0.45,
    );
    if let Ok(constants) = constants {
        stiff.material.law = Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants));
    }
    let half = Shape::Box { min: Vector3::zeros(), max: Vector3::new(0.47 * SIZE, SIZE, SIZE) };
    let part = Selector::Inside { shape: half, tolerance: 0.0 };
    problem.regions.insert(0, Region { name: "stiff".into(), part, ..stiff });
}
