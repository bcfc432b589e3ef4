//! The affine patch test and what an affine field obeys exactly.
#![allow(non_snake_case)]

use super::Workbench;
use super::plain::{axis, curve, larger, number, text};
use super::problems::{
    PLANE, Random, SIZE, block_shape, free_body, grid, recipe, relaxation, sphere_shape, tissue,
};
use crate::run::{Prepared, march, prepare};
use crate::study::{Bound, Cell, Check, Figure, Kind, Plot, Study, Table};
use mtled::geometry::Shape;
use mtled::internal_force::{Workspace, internal_force};
use mtled::nodes::node_cloud;
use mtled::observe::Unobserved;
use mtled::problem::{Amplitude, Dimension, Enforcement, EssentialCondition, Prescribed, Problem};
use mtled::selection::{Extent, Selector};
use mtled::tensor::{Matrix3, Vector3, rotation};

/// A body with a cloud.
#[derive(Debug, Clone)]
struct Body {
    name: &'static str,
    dimension: Dimension,
    shape: Shape,
    /// \[m\]
    spacing: f64,
}

/// Errors of one static solution, over the size of the affine field \[–\].
#[derive(Debug, Clone, Copy, Default)]
struct Errors {
    displacement: f64,
    gradient: f64,
}

/// Largest errors over the regular cloud and ten jittered ones (seeds 0 to 9),
/// measured with the plain scheme: displacement and gradient.
const MEASURED: [(&str, [f64; 2]); 12] = [
    ("cube-nu30-collocation", [0.0277, 0.130]),
    ("cube-nu30-direct", [0.0295, 0.139]),
    ("cube-nu49-collocation", [0.0241, 0.101]),
    ("cube-nu49-direct", [0.0248, 0.107]),
    ("sphere-nu30-collocation", [0.0430, 0.174]),
    ("sphere-nu30-direct", [0.0745, 0.279]),
    ("sphere-nu49-collocation", [0.0285, 0.109]),
    ("sphere-nu49-direct", [0.0393, 0.150]),
    ("square-nu30-collocation", [0.0321, 0.171]),
    ("square-nu30-direct", [0.0321, 0.174]),
    ("square-nu49-collocation", [0.106, 0.577]),
    ("square-nu49-direct", [0.108, 0.577]),
];

/// Room above the largest measured error.
const BAND: f64 = 1.1;
const JITTER: f64 = 0.3;

pub fn patch(bench: &Workbench, study: &mut Study) -> anyhow::Result<()> {
    let mut rows = Vec::new();
    for body in bodies() {
        for poisson_ratio in [0.3, 0.49] {
            exact_checks(study, &body, poisson_ratio)?;
            for enforcement in [Enforcement::Collocation, Enforcement::Direct] {
                let name = case_name(&body, poisson_ratio, enforcement);
                let regular = solve(&body, poisson_ratio, enforcement, 0.0, 0, 1.26)?;
                let mut jittered = Errors::default();
                for seed in 0..bench.pick(2, 10) {
                    jittered =
                        jittered.or(&solve(&body, poisson_ratio, enforcement, JITTER, seed, 1.26)?);
                }
                rows.push(row(&body, poisson_ratio, enforcement, &regular, &jittered));
                regression_checks(study, &name, &regular.or(&jittered))?;
            }
        }
    }
    study.tables.push(Table {
        title: "Errors of the plain scheme over the size of the affine field".into(),
        columns: vec![
            text("body"),
            number("Poisson's ratio", "1"),
            text("enforcement"),
            number("displacement, regular", "1"),
            number("displacement, jittered", "1"),
            number("gradient, regular", "1"),
            number("gradient, jittered", "1"),
        ],
        rows,
    });
    study.figures.push(Figure::Plot(quadrature_figure()?));
    study.notes.push(
        "The plain scheme does not pass the patch test: shape functions of interior nodes do not \
         vanish on the boundary and the quadrature does not integrate their gradients exactly, so \
         Σ_q w_q Grad φ_a differs from ∮ φ_a N dA and interior nodes feel a force in a homogeneous \
         field. The errors of the static solutions are therefore kept as regression figures, not \
         as a claim of exactness."
            .into(),
    );
    study.notes.push(format!(
        "All boundary nodes carry the affine displacement u = H (X − X_c), |H| = {:.3}; cube and \
         sphere 0.1 m wide with 7 nodes across, square with 11; 1.26 cells per spacing with volume \
         fractions, so that the grid fits no face; jitter 0.3.",
        affine(Dimension::Three).norm()
    ));
    Ok(())
}

fn bodies() -> [Body; 3] {
    let body = |name, dimension, shape, nodes: f64| Body {
        name,
        dimension,
        shape,
        spacing: SIZE / (nodes - 1.0),
    };
    [
        body("cube", Dimension::Three, block_shape(), 7.0),
        body("sphere", Dimension::Three, sphere_shape(), 7.0),
        body("square", PLANE, block_shape(), 11.0),
    ]
}

/// Stretch, contraction and shear of about 10 %, not symmetric.
fn affine(dimension: Dimension) -> Matrix3 {
    let mut H = Matrix3::new(0.08, 0.03, 0.01, 0.02, -0.05, 0.03, -0.01, 0.02, -0.02);
    if dimension.components() == 2 {
        H.fill_row(2, 0.0);
        H.fill_column(2, 0.0);
    }
    H
}

fn centre() -> Vector3 {
    Vector3::repeat(0.5 * SIZE)
}

fn case_name(body: &Body, poisson_ratio: f64, enforcement: Enforcement) -> String {
    format!("{}-nu{:.0}-{}", body.name, 100.0 * poisson_ratio, enforcement_name(enforcement))
}

fn enforcement_name(enforcement: Enforcement) -> &'static str {
    match enforcement {
        Enforcement::Collocation => "collocation",
        Enforcement::Direct => "direct",
    }
}

fn problem(
    body: &Body,
    poisson_ratio: f64,
    enforcement: Enforcement,
    jitter: f64,
    seed: u64,
    cells_per_spacing: f64,
) -> anyhow::Result<Problem> {
    let mut recipe = recipe(body.spacing, jitter, seed);
    recipe.grid = grid(body.spacing / cells_per_spacing);
    recipe.enforcement = enforcement;
    let material = tissue(poisson_ratio)?;
    let mut problem = free_body(body.dimension, body.shape.clone(), material, recipe);
    problem.motion = relaxation(200, 1e-11);
    Ok(problem)
}

/// A condition for each boundary node: its own value of the affine field.
fn prescribe_affine(problem: &mut Problem) -> anyhow::Result<()> {
    let cloud = node_cloud(&problem.body, &problem.recipe.cloud, &problem.dimension)?;
    let H = affine(problem.dimension);
    let boundary = cloud.positions.iter().zip(&cloud.on_boundary).filter(|(_, on)| **on);
    problem.conditions = boundary
        .map(|(X, _)| {
            let u = H * (X - centre());
            EssentialCondition {
                name: format!("node at {:.4}, {:.4}, {:.4} m", X.x, X.y, X.z),
                extent: Extent::Surface,
                part: Selector::Inside {
                    shape: Shape::Sphere { centre: *X, radius: 1e-6 * SIZE },
                    tolerance: 0.0,
                },
                prescribed: Prescribed::Displacement([Some(u.x), Some(u.y), Some(u.z)]),
                amplitude: Amplitude::Smooth { duration: 1.0 },
                release: None,
            }
        })
        .collect();
    Ok(())
}

fn solve(
    body: &Body,
    poisson_ratio: f64,
    enforcement: Enforcement,
    jitter: f64,
    seed: u64,
    cells_per_spacing: f64,
) -> anyhow::Result<Errors> {
    let mut problem = problem(body, poisson_ratio, enforcement, jitter, seed, cells_per_spacing)?;
    prescribe_affine(&mut problem)?;
    let prepared = prepare(&problem)?;
    let solved = march(&problem, prepared, &mut Unobserved)?;
    Ok(errors(&solved.prepared, &solved.state.displacement, &affine(body.dimension)))
}

/// Relative L2 errors over the quadrature points.
fn errors(prepared: &Prepared, u: &[f64], H: &Matrix3) -> Errors {
    let discretisation = &prepared.discretisation;
    let (rows, quadrature) = (&discretisation.supports, &discretisation.quadrature);
    let components = prepared.model.components;
    let (mut error, mut size, mut slope_error, mut slope_size) = (0.0, 0.0, 0.0, 0.0);
    for (i, (X, weight)) in quadrature.positions.iter().zip(&quadrature.weights).enumerate() {
        let exact = H * (X - centre());
        error += weight * (rows.interpolate(i, u, components) - exact).norm_squared();
        size += weight * exact.norm_squared();
        let F = rows.deformation_gradient(i, u, components);
        slope_error += weight * (F - Matrix3::identity() - H).norm_squared();
        slope_size += weight * H.norm_squared();
    }
    Errors { displacement: f64::sqrt(error / size), gradient: f64::sqrt(slope_error / slope_size) }
}

impl Errors {
    fn or(&self, other: &Errors) -> Errors {
        Errors {
            displacement: larger(self.displacement, other.displacement),
            gradient: larger(self.gradient, other.gradient),
        }
    }
}

fn row(
    body: &Body,
    poisson_ratio: f64,
    enforcement: Enforcement,
    regular: &Errors,
    jittered: &Errors,
) -> Vec<Cell> {
    vec![
        Cell::Text(body.name.into()),
        Cell::Number(poisson_ratio),
        Cell::Text(enforcement_name(enforcement).into()),
        Cell::Number(regular.displacement),
        Cell::Number(jittered.displacement),
        Cell::Number(regular.gradient),
        Cell::Number(jittered.gradient),
    ]
}

fn regression_checks(study: &mut Study, name: &str, errors: &Errors) -> anyhow::Result<()> {
    let measured = MEASURED.iter().find(|(case, _)| *case == name).map(|(_, figures)| *figures);
    let measured = measured.ok_or_else(|| anyhow::anyhow!("no measured figures for {name}"))?;
    let rows = [
        ("displacement", errors.displacement, measured[0]),
        ("gradient", errors.gradient, measured[1]),
    ];
    for (quantity, value, figure) in rows {
        let id = format!("patch/{name}/{quantity}");
        let words = format!("relative L2 error of the {quantity} in a static affine patch");
        let source = format!(
            "plain scheme: {figure:.4} is the largest of a regular cloud and ten jittered ones \
             (seeds 0 to 9), times {BAND}"
        );
        let bound = Bound::AtMost(BAND * figure);
        study.checks.push(Check::new(&id, &words, Kind::Regression, value, bound, "1", &source));
    }
    Ok(())
}

/// What holds on any cloud, jittered too.
fn exact_checks(study: &mut Study, body: &Body, poisson_ratio: f64) -> anyhow::Result<()> {
    let problem = problem(body, poisson_ratio, Enforcement::Direct, JITTER, 0, 1.26)?;
    let prepared = prepare(&problem)?;
    let H = affine(body.dimension);
    let stretched = field(&prepared, |X| H * (X - centre()));
    let scale = forces(&prepared, &stretched).iter().map(|f| f.norm()).fold(0.0, larger);
    let turn = rotation(&Vector3::z(), 1.0) - Matrix3::identity();
    let turned = field(&prepared, |X| turn * (X - centre()) + Vector3::new(0.3, -0.2, 0.0));
    let rigid = forces(&prepared, &turned).iter().map(|f| f.norm()).fold(0.0, larger);
    let (force, moment) = resultants(&prepared, body.spacing);
    let reproduction = "Linear reproduction: Σ φ_a,_j X_a,i = δ_ij";
    let balance = "Σ_a Grad φ_a = 0, and Σ_a x_a × P Grad φ_a = axial part of P Fᵀ = 0; round-off";
    let rows = [
        (
            "affine_gradient",
            "largest |F − (I + H)| of an affine field",
            uniformity(&prepared, &stretched, &H),
            1e-12,
            reproduction,
        ),
        (
            "rigid_force",
            "largest force in a turn by 1 rad and a shift of 3.6 sizes, over that of the affine field",
            rigid / scale,
            1e-10,
            "A rigid motion makes no stress; round-off of F times (λ + 2μ)/μ",
        ),
        ("force", "sum of the internal forces over the sum of their sizes", force, 1e-12, balance),
        ("moment", "sum of the moments over the sum of their sizes", moment, 1e-12, balance),
    ];
    let case = format!("{}-nu{:.0}", body.name, 100.0 * poisson_ratio);
    for (quantity, words, value, bound, source) in rows {
        let id = format!("patch/{case}/{quantity}");
        let bound = Bound::AtMost(bound);
        study.checks.push(Check::new(&id, words, Kind::Exact, value, bound, "1", source));
    }
    Ok(())
}

/// Nodal parameters from a function of the reference position.
fn field(prepared: &Prepared, mut u: impl FnMut(&Vector3) -> Vector3) -> Vec<f64> {
    let model = &prepared.model;
    let values = model.positions.iter().flat_map(|X| {
        let value = u(X);
        (0..model.components).map(move |k| value[k])
    });
    values.collect()
}

fn forces(prepared: &Prepared, u: &[f64]) -> Vec<Vector3> {
    let model = &prepared.model;
    let mut f = vec![0.0; model.size()];
    internal_force(model, u, &mut Workspace::new(model), &mut f);
    f.chunks(model.components).map(vector).collect()
}

fn vector(components: &[f64]) -> Vector3 {
    Vector3::from_fn(|k, _| components.get(k).copied().unwrap_or(0.0))
}

fn uniformity(prepared: &Prepared, u: &[f64], H: &Matrix3) -> f64 {
    let rows = &prepared.discretisation.supports;
    let gradient = |i| rows.deformation_gradient(i, u, prepared.model.components);
    (0..rows.len()).map(|i| (gradient(i) - Matrix3::identity() - H).amax()).fold(0.0, larger)
}

/// Sums of the forces and of their moments about the centre, for random nodal
/// parameters of 5 % of the spacing, each over the sum of sizes \[–\].
fn resultants(prepared: &Prepared, spacing: f64) -> (f64, f64) {
    let mut random = Random(7);
    let u = field(prepared, |_| random.vector(prepared.model.components) * (0.05 * spacing));
    let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
    let (mut force_size, mut moment_size) = (0.0, 0.0);
    let displacements = u.chunks(prepared.model.components).map(vector);
    let places = prepared.model.positions.iter().zip(displacements);
    for ((X, u), f) in places.zip(forces(prepared, &u)) {
        let mut arm = X + u - centre();
        if prepared.model.components == 2 {
            arm.z = 0.0;
        }
        force += f;
        moment += arm.cross(&f);
        force_size += f.norm();
        moment_size += arm.norm() * f.norm();
    }
    (force.norm() / force_size, moment.norm() / moment_size)
}

/// More quadrature points do not make the error vanish.
fn quadrature_figure() -> anyhow::Result<Plot> {
    let cube = &bodies()[0];
    let mut series = Vec::new();
    for poisson_ratio in [0.3, 0.49] {
        let mut points = Vec::new();
        for cells_per_spacing in [1.0, 1.26, 1.6, 2.0] {
            let collocation = Enforcement::Collocation;
            let errors = solve(cube, poisson_ratio, collocation, JITTER, 0, cells_per_spacing)?;
            points.push((cells_per_spacing, errors.displacement));
        }
        series.push(curve(&format!("ν = {poisson_ratio}"), points));
    }
    Ok(Plot {
        title: "Patch error of the plain scheme against quadrature".into(),
        caption:
            "Jittered cube, collocation: relative L2 error of the displacement. Smaller cells \
                  lower it but do not make it vanish."
                .into(),
        x: axis("cells per nodal spacing", "1", false),
        y: axis("relative error", "1", true),
        series,
        slopes: Vec::new(),
    })
}
