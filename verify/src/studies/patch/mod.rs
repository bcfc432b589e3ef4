//! The affine patch test and what an affine field obeys exactly.
#![allow(non_snake_case)]

mod exact;

use crate::run::{Prepared, march, prepare};
use crate::specimens::simple::{
    PLANE, SIZE, block_shape, free_body, grid, recipe, relaxation, sphere_shape, tissue,
};
use crate::studies::patch::exact::{exact_checks, vector};
use crate::studies::workbench::Workbench;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::geometry::Shape;
use mtled::geometry::selection::{Extent, Selector};
use mtled::motion::observe::Unobserved;
use mtled::problem::{
    Amplitude, Dimension, Enforcement, EssentialCondition, Field, Gradients, Prescribed, Problem,
    Traction,
};
use mtled_checks::study::shorthand::{axis, curve, larger, number, text};
use mtled_checks::study::{Bound, Cell, Check, Figure, Kind, Plot, Study, Table};

/// A body with a cloud.
#[derive(Debug, Clone)]
pub(super) struct Body {
    pub name: &'static str,
    pub dimension: Dimension,
    pub shape: Shape,
    /// \[m\]
    pub spacing: f64,
    pub centre: Vector3,
    /// The affine field is u = H (X − centre).
    pub H: Matrix3,
}

/// Errors of one static solution, over the largest displacement or the size of
/// the gradient \[–\].
#[derive(Debug, Clone, Copy, Default)]
struct Errors {
    /// Largest of all nodal parameters and of the field at all points.
    displacement: f64,
    gradient: f64,
}

/// How a patch is solved.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scheme {
    enforcement: Enforcement,
    gradients: Gradients,
    cells_per_spacing: f64,
    seed: u64,
}

/// As by default, with gradients consistent to round-off.
pub(super) const EXACT: Scheme = Scheme {
    enforcement: Enforcement::Collocation,
    gradients: Gradients::Consistent { tolerance: 1e-13 },
    cells_per_spacing: 1.26,
    seed: 0,
};

const JITTER: f64 = 0.3;
/// The bounds: prescribed all around, and free under traction \[–\].
const BOUND: f64 = 1e-10;
const BOUND_FREE: f64 = 1e-9;

pub fn patch(bench: &Workbench, study: &mut Study) -> anyhow::Result<()> {
    for body in &bodies(bench)? {
        for poisson_ratio in [0.3, 0.49] {
            let case = format!("{}-nu{:.0}", body.name, 100.0 * poisson_ratio);
            exact_checks(bench, study, body, &case, poisson_ratio)?;
            let mut worst = Errors::default();
            for seed in 0..bench.pick(1, 10) {
                let scheme = Scheme { seed, ..EXACT };
                let errors = solve(bench, body, poisson_ratio, &scheme)?;
                worst = worst.or(&errors);
            }
            static_checks(study, &case, &worst);
        }
    }
    let cube = &bodies(bench)?[0];
    // Dead loads that push would turn the body around, and hydrostatic ones
    // above about 2μ let it neck: a stretch between the two for each ν.
    for (poisson_ratio, stretch) in [(0.3, 0.015), (0.49, 0.0)] {
        let stretch = Matrix3::from_diagonal_element(stretch);
        let free = Body { H: 0.5 * (cube.H + cube.H.transpose()) + stretch, ..cube.clone() };
        study.checks.push(Check::new(
            &format!("patch/free-cube-nu{:.0}/stretch", 100.0 * poisson_ratio),
            "largest error of the stretch of a free body under tractions all around",
            Kind::Exact,
            stretch_error(bench, poisson_ratio, &free)?,
            Bound::AtMost(BOUND_FREE),
            "1",
            "Consistent gradients: a uniform stress balances its tractions; round-off",
        ));
    }
    study.tables.push(comparison(bench, cube)?);
    study.figures.push(Figure::Plot(quadrature_figure(bench, cube)?));
    study.notes.push(
        "Plain gradients do not pass: shape functions of interior nodes do not vanish on the \
         boundary and the quadrature does not integrate their gradients exactly, so \
         Σ_q w_q Grad φ_a differs from ∮ φ_a N dA and interior nodes feel a force in a homogeneous \
         field. Consistent gradients mend that. Nodal parameters prescribed directly do not pass \
         either: the boundary integral also pushes interior nodes near the boundary, and only \
         forces on the displacement field, as collocation makes them, can balance that."
            .into(),
    );
    study.notes.push(format!(
        "All boundary nodes carry the affine displacement u = H (X − X_c), |H| = {:.3}; jitter \
         {JITTER}; 1.26 cells per spacing with volume fractions, so that the grid fits no face; \
         dynamic relaxation to 1e-12. At ν = 0.49 the projection of J is at work.",
        affine(Dimension::Three).norm()
    ));
    Ok(())
}

fn bodies(bench: &Workbench) -> anyhow::Result<Vec<Body>> {
    let centre = Vector3::repeat(0.5 * SIZE);
    let body = |name, dimension, shape, spacing| {
        let H = affine(dimension);
        Body { name, dimension, shape, spacing, centre, H }
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
        bodies.push(Body { centre, ..body(name, problem.dimension, problem.body, spacing) });
    }
    Ok(bodies)
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

pub(super) fn problem(
    bench: &Workbench,
    body: &Body,
    poisson_ratio: f64,
    scheme: &Scheme,
) -> anyhow::Result<Problem> {
    let mut recipe = recipe(body.spacing, JITTER, bench.seed(scheme.seed));
    recipe.grid = grid(body.spacing / scheme.cells_per_spacing);
    recipe.enforcement = scheme.enforcement;
    recipe.gradients = scheme.gradients;
    let material = tissue(poisson_ratio)?;
    let mut problem = free_body(body.dimension, body.shape.clone(), material, recipe);
    problem.motion = relaxation(200, 1e-12);
    Ok(problem)
}

/// All boundary nodes take the values of the affine field.
fn prescribe_affine(problem: &mut Problem, body: &Body) {
    let (H, centre) = (body.H, body.centre);
    problem.conditions = vec![EssentialCondition {
        name: "boundary".into(),
        extent: Extent::Surface,
        part: Selector::All,
        prescribed: Prescribed::Field(Field::of(move |X| H * (X - centre))),
        amplitude: Amplitude::Smooth { duration: 1.0 },
        release: None,
    }];
}

/// The faces of the cube carry the tractions P N of the affine field; nothing
/// holds it, so only its stretch is determined.
fn push_faces(problem: &mut Problem, body: &Body) {
    let law = problem.regions[0].material.law;
    let P = law.first_piola_kirchhoff(&(Matrix3::identity() + body.H));
    for axis in 0..3 {
        for (at, side) in [(0.0, -1.0), (SIZE, 1.0)] {
            let normal = Vector3::ith(axis, 1.0);
            problem.loads.tractions.push(Traction {
                name: format!("face {axis} at {at}"),
                part: Selector::Plane { point: normal * at, normal, tolerance: 1e-9 },
                traction: P * (normal * side),
                amplitude: Amplitude::Smooth { duration: 1.0 },
            });
        }
    }
}

/// Largest error of C = FᵀF at any point over the size of H: a free body may
/// turn.
fn stretch_error(bench: &Workbench, poisson_ratio: f64, body: &Body) -> anyhow::Result<f64> {
    let mut problem = problem(bench, body, poisson_ratio, &EXACT)?;
    push_faces(&mut problem, body);
    // Without a hold it swings more.
    problem.motion = relaxation(1000, 1e-12);
    let prepared = prepare(&problem)?;
    let solved = march(&problem, prepared, &mut Unobserved)?;
    let rows = &solved.prepared.discretisation.supports;
    let F = Matrix3::identity() + body.H;
    let error = |point: usize| {
        let found = rows.deformation_gradient(point, &solved.state.displacement, 3);
        (found.transpose() * found - F.transpose() * F).norm() / body.H.norm()
    };
    Ok((0..rows.len()).map(error).fold(0.0, larger))
}

fn solve(
    bench: &Workbench,
    body: &Body,
    poisson_ratio: f64,
    scheme: &Scheme,
) -> anyhow::Result<Errors> {
    let mut problem = problem(bench, body, poisson_ratio, scheme)?;
    prescribe_affine(&mut problem, body);
    let prepared = prepare(&problem)?;
    let solved = march(&problem, prepared, &mut Unobserved)?;
    Ok(errors(&solved.prepared, &solved.state.displacement, body))
}

fn errors(prepared: &Prepared, u: &[f64], body: &Body) -> Errors {
    let (H, components) = (body.H, prepared.model.components);
    let (rows, quadrature) =
        (&prepared.discretisation.supports, &prepared.discretisation.quadrature);
    let mut worst = Errors::default();
    let mut largest = 0.0;
    for (X, value) in prepared.model.positions.iter().zip(u.chunks(components)) {
        let exact = H * (X - body.centre);
        largest = larger(largest, exact.norm());
        worst.displacement =
            larger(worst.displacement, (vector(value) - in_plane(&exact, components)).norm());
    }
    for (i, X) in quadrature.positions.iter().enumerate() {
        let exact = in_plane(&(H * (X - body.centre)), components);
        let field = rows.interpolate(i, u, components);
        worst.displacement = larger(worst.displacement, (field - exact).norm());
        let F = rows.deformation_gradient(i, u, components);
        worst.gradient = larger(worst.gradient, (F - Matrix3::identity() - H).norm());
    }
    Errors { displacement: worst.displacement / largest, gradient: worst.gradient / H.norm() }
}

fn in_plane(v: &Vector3, components: usize) -> Vector3 {
    Vector3::from_fn(|k, _| if k < components { v[k] } else { 0.0 })
}

impl Errors {
    fn or(&self, other: &Errors) -> Errors {
        Errors {
            displacement: larger(self.displacement, other.displacement),
            gradient: larger(self.gradient, other.gradient),
        }
    }
}

fn static_checks(study: &mut Study, case: &str, errors: &Errors) {
    let source =
        "Consistent gradients and collocation: an affine field is in equilibrium; round-off";
    for (quantity, value, bound) in [
        ("displacement", errors.displacement, BOUND),
        // A gradient is a difference over a spacing, of a body of about ten.
        ("gradient", errors.gradient, 10.0 * BOUND),
    ] {
        study.checks.push(Check::new(
            &format!("patch/{case}/{quantity}"),
            &format!("largest error of the {quantity} in a static affine patch, all boundary nodes prescribed"),
            Kind::Exact,
            value,
            Bound::AtMost(bound),
            "1",
            source,
        ));
    }
}

/// The four schemes on the jittered cube.
fn comparison(bench: &Workbench, cube: &Body) -> anyhow::Result<Table> {
    let mut rows = Vec::new();
    for poisson_ratio in [0.3, 0.49] {
        for (gradients, name) in [(Gradients::Plain, "plain"), (EXACT.gradients, "consistent")] {
            for (enforcement, how) in
                [(Enforcement::Direct, "direct"), (Enforcement::Collocation, "collocation")]
            {
                let scheme = Scheme { gradients, enforcement, ..EXACT };
                let errors = solve(bench, cube, poisson_ratio, &scheme)?;
                rows.push(vec![
                    Cell::Number(poisson_ratio),
                    Cell::Text(name.into()),
                    Cell::Text(how.into()),
                    Cell::Number(errors.displacement),
                    Cell::Number(errors.gradient),
                ]);
            }
        }
    }
    Ok(Table {
        title: "Largest errors on the jittered cube".into(),
        columns: vec![
            number("Poisson's ratio", "1"),
            text("gradients"),
            text("enforcement"),
            number("displacement", "1"),
            number("gradient", "1"),
        ],
        rows,
    })
}

/// More quadrature points do not make the error of plain gradients vanish.
fn quadrature_figure(bench: &Workbench, cube: &Body) -> anyhow::Result<Plot> {
    let mut series = Vec::new();
    for poisson_ratio in [0.3, 0.49] {
        let mut points = Vec::new();
        for cells_per_spacing in [1.26, 1.6, 2.0] {
            let scheme = Scheme { gradients: Gradients::Plain, cells_per_spacing, ..EXACT };
            let errors = solve(bench, cube, poisson_ratio, &scheme)?;
            points.push((cells_per_spacing, errors.displacement));
        }
        series.push(curve(&format!("ν = {poisson_ratio}"), points));
    }
    Ok(Plot {
        title: "Patch error of plain gradients against quadrature".into(),
        caption: "Jittered cube, collocation: largest error of the displacement. Smaller cells \
                  lower it but do not make it vanish."
            .into(),
        x: axis("cells per nodal spacing", "1", false),
        y: axis("relative error", "1", true),
        series,
        slopes: Vec::new(),
    })
}
