//! The manufactured solutions and the errors of one cloud.
#![allow(non_snake_case)]

use crate::exact::manufactured::{Family, FieldKind, Manufactured};
use crate::manufactured::{
    DENSITY, Orientation, Oriented, RecipeKind, YOUNG_MODULUS, free_three_faces,
    manufactured_problem,
};
use crate::studies::workbench::Workbench;
use anyhow::Result;
use mtled::Simulation;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::discretisation::Discretisation;
use mtled::force::projected_mean_stress;
use mtled::material::{ElasticConstants, Law};
use mtled::motion::nodal_fields::NodalFields;
use mtled::motion::observe::Unobserved;
use mtled::problem::Problem;
use mtled_run::run::{Solved, integrate};

/// Clouds per size, which differ in the random seed of their jitter.
pub(crate) const CLOUDS: u64 = 5;
/// Displacements are compared at the centres of this many cells per edge, the same for every cloud.
const PROBES: usize = 12;

/// One solution in one material.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scenario {
    /// Part of the ids of its checks.
    pub name: &'static str,
    pub label: &'static str,
    pub field: FieldKind,
    pub family: Family,
    pub poisson_ratio: f64,
    pub recipe: RecipeKind,
    pub orientation: Orientation,
    pub boundary: Boundary,
}

/// What is known on the boundary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Boundary {
    /// Displacements.
    Prescribed,
    /// Displacements on three faces that meet, tractions on the others.
    Mixed,
}

/// Errors of one cloud, each in L2 over that of the solution \[–\].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Errors {
    pub displacement: f64,
    /// The same of the field through the solution at the nodes; NaN on the turned cube, where sweeps
    /// do not find it.
    pub interpolation: f64,
    /// Of F − I at the quadrature points.
    pub gradient: f64,
    /// Of −tr σ/3 at the quadrature points.
    pub pressure: f64,
    /// Of the pressure less its mean over the body, which the incompressible limit determines.
    pub pressure_deviation: f64,
    /// Of −tr σ/3 at the nodes, weighted by Σ w φ.
    pub nodal_pressure: f64,
    /// Σ w (det F_h − det F)/V: the gain of volume where the boundary data are known at the nodes only.
    pub volume: f64,
    pub points: usize,
}

/// All clouds of one size.
#[derive(Debug, Clone)]
pub(crate) struct Level {
    pub nodes_per_edge: usize,
    /// \[m\]
    pub spacing: f64,
    /// \[cloud\]
    pub errors: Vec<Errors>,
}

const fn scenario(
    name: &'static str,
    label: &'static str,
    field: FieldKind,
    family: Family,
    poisson_ratio: f64,
) -> Scenario {
    Scenario {
        name,
        label,
        field,
        family,
        poisson_ratio,
        recipe: RecipeKind::Default,
        orientation: Orientation::Along,
        boundary: Boundary::Prescribed,
    }
}

const fn mixed(name: &'static str, label: &'static str, scenario: Scenario) -> Scenario {
    Scenario { name, label, boundary: Boundary::Mixed, ..scenario }
}

const fn finer(name: &'static str, label: &'static str, scenario: Scenario) -> Scenario {
    Scenario { name, label, recipe: RecipeKind::Finer, ..scenario }
}

/// The general field where the material is compressible, the one of bounded pressure where it is
/// nearly incompressible; the Mooney–Rivlin law of Horton 2007 is unstable at ν = 0.3.
pub(crate) const SCENARIOS: [Scenario; 8] = {
    use Family::{Isochoric, LogJ, MooneyRivlin};
    use FieldKind::{General, NearlyIsochoric};
    [
        scenario("log_j-nu300", "log-J", General, LogJ, 0.3),
        scenario("isochoric-nu300", "isochoric", General, Isochoric, 0.3),
        scenario("log_j-nu490", "log-J", NearlyIsochoric, LogJ, 0.49),
        scenario("isochoric-nu490", "isochoric", NearlyIsochoric, Isochoric, 0.49),
        scenario("mooney_rivlin-nu490", "Mooney–Rivlin", NearlyIsochoric, MooneyRivlin, 0.49),
        scenario("log_j-nu499", "log-J", NearlyIsochoric, LogJ, 0.499),
        scenario("isochoric-nu499", "isochoric", NearlyIsochoric, Isochoric, 0.499),
        scenario("mooney_rivlin-nu499", "Mooney–Rivlin", NearlyIsochoric, MooneyRivlin, 0.499),
    ]
};

/// Only in the full suite.
pub(crate) const FINER: [Scenario; 4] = [
    finer("log_j-nu300-finer", "log-J, 2 cells", SCENARIOS[0]),
    finer("isochoric-nu300-finer", "isochoric, 2 cells", SCENARIOS[1]),
    finer("log_j-nu490-finer", "log-J, 2 cells", SCENARIOS[2]),
    finer("log_j-nu499-finer", "log-J, 2 cells", SCENARIOS[5]),
];

/// With tractions; the quick suite has the first and the last. With the isochoric law at ν = 0.3 free
/// faces are unstable: see the notes of the study.
pub(crate) const MIXED: [Scenario; 7] = [
    mixed("log_j-nu300-mixed", "log-J, tractions", SCENARIOS[0]),
    mixed("log_j-nu490-mixed", "log-J, tractions", SCENARIOS[2]),
    mixed("mooney_rivlin-nu490-mixed", "Mooney–Rivlin, tractions", SCENARIOS[4]),
    mixed("log_j-nu499-mixed", "log-J, tractions", SCENARIOS[5]),
    mixed("isochoric-nu499-mixed", "isochoric, tractions", SCENARIOS[6]),
    mixed("mooney_rivlin-nu499-mixed", "Mooney–Rivlin, tractions", SCENARIOS[7]),
    mixed("isochoric-nu490-mixed", "isochoric, tractions", SCENARIOS[3]),
];

/// In both suites: what second order is compared with.
pub(crate) const CONSISTENT: Scenario = Scenario {
    name: "log_j-nu300-consistent",
    label: "log-J, constant stresses",
    recipe: RecipeKind::Consistent,
    ..SCENARIOS[0]
};

/// Errors of the cloud with this number.
pub(crate) fn errors(
    bench: &Workbench,
    scenario: &Scenario,
    nodes_per_edge: usize,
    cloud: u64,
) -> Result<Errors> {
    let constants = ElasticConstants::from_young_poisson(YOUNG_MODULUS, scenario.poisson_ratio)?;
    let (field, family) = (scenario.field, scenario.family);
    let solution = Manufactured { field, family, constants, density: DENSITY };
    let oriented = Oriented::new(solution, scenario.orientation);
    let mut problem =
        manufactured_problem(oriented, nodes_per_edge, bench.seed(cloud), scenario.recipe)?;
    if scenario.boundary == Boundary::Mixed {
        free_three_faces(&mut problem, oriented);
    }
    let solved = integrate(Simulation::with_any_recipe(&problem)?, &mut Unobserved)?;
    let discretisation = &solved.simulation.discretisation;
    let displacement =
        displacement_error(&oriented, discretisation, &solved.simulation.state.displacement)?;
    let interpolation = match scenario.orientation {
        Orientation::Along => {
            let parameters = through_nodes(&oriented, discretisation)?;
            displacement_error(&oriented, discretisation, &parameters)?
        }
        Orientation::Turned => f64::NAN,
    };
    Ok(Errors { displacement, interpolation, ..errors_at_points(&oriented, &problem, &solved) })
}

/// Residuals of the values at the nodes over the values, and sweeps that take them there.
const THROUGH: f64 = 1e-9;
const MOST_SWEEPS: usize = 1000;

/// Nodal parameters \[m\] of the field that takes the solution's values at the nodes, by sweeps
/// that add to each what its node lacks.
fn through_nodes(solution: &Oriented, discretisation: &Discretisation) -> Result<Vec<f64>> {
    let positions = &discretisation.cloud.positions;
    let rows = discretisation.rows_at(positions)?;
    let values: Vec<Vector3> = positions.iter().map(|X| solution.displacement(X)).collect();
    let size = values.iter().map(|u| u.amax()).fold(0.0, f64::max);
    let mut parameters: Vec<f64> = values.iter().flat_map(|u| [u.x, u.y, u.z]).collect();
    for _ in 0..MOST_SWEEPS {
        let lack = |(node, u): (usize, &Vector3)| u - rows.interpolate(node, &parameters, 3);
        let lacks: Vec<Vector3> = values.iter().enumerate().map(lack).collect();
        if lacks.iter().all(|lack| lack.amax() < THROUGH * size) {
            return Ok(parameters);
        }
        for (parameter, lack) in parameters.iter_mut().zip(lacks.iter().flatten()) {
            *parameter += lack;
        }
    }
    anyhow::bail!("no field through the values at the nodes in {MOST_SWEEPS} sweeps")
}

/// ‖u_h − u‖/‖u‖ by the midpoint rule on a grid of its own, u_h from nodal parameters \[m\].
fn displacement_error(
    solution: &Oriented,
    discretisation: &Discretisation,
    parameters: &[f64],
) -> Result<f64> {
    let centre = |index: usize| ((index % PROBES) as f64 + 0.5) / PROBES as f64;
    let positions: Vec<Vector3> = (0..PROBES.pow(3))
        .map(|n| Vector3::new(centre(n), centre(n / PROBES), centre(n / PROBES / PROBES)))
        .map(|X| solution.turn * X)
        .collect();
    let rows = discretisation.rows_at(&positions)?;
    let (mut error, mut size) = (0.0, 0.0);
    for (i, X) in positions.iter().enumerate() {
        let exact = solution.displacement(X);
        error += (rows.interpolate(i, parameters, 3) - exact).norm_squared();
        size += exact.norm_squared();
    }
    Ok(f64::sqrt(error / size))
}

/// ‖F_h − F‖/‖F − I‖, ‖p_h − p‖/‖p‖ and the parts of p_h − p by the quadrature of the solver; the
/// errors of displacements are left NaN.
fn errors_at_points(solution: &Oriented, problem: &Problem, solved: &Solved) -> Errors {
    let discretisation = &solved.simulation.discretisation;
    let (rows, quadrature) = (&discretisation.supports, &discretisation.quadrature);
    let law = problem.regions[0].material.law;
    let pressure = pressure_of(&law);
    let projected = projected_mean_stress(
        &solved.simulation.model.points,
        &solved.simulation.state.displacement,
    );
    let (mut error, mut size, mut pressure_error, mut pressure_size) = (0.0, 0.0, 0.0, 0.0);
    let (mut surplus, mut gain, mut volume) = (0.0, 0.0, 0.0);
    for (i, (X, weight)) in quadrature.positions.iter().zip(&quadrature.weights).enumerate() {
        let computed = rows.deformation_gradient(i, &solved.simulation.state.displacement, 3);
        let exact = solution.deformation_gradient(X);
        error += weight * (computed - exact).norm_squared();
        size += weight * (exact - Matrix3::identity()).norm_squared();
        let difference = pressure(&computed) - projected[i] - pressure(&exact);
        pressure_error += weight * difference.powi(2);
        pressure_size += weight * pressure(&exact).powi(2);
        surplus += weight * difference;
        gain += weight * (computed.determinant() - exact.determinant());
        volume += weight;
    }
    let deviation = pressure_error - surplus.powi(2) / volume;
    Errors {
        displacement: f64::NAN,
        interpolation: f64::NAN,
        gradient: f64::sqrt(error / size),
        pressure: f64::sqrt(pressure_error / pressure_size),
        pressure_deviation: f64::sqrt(deviation.max(0.0) / pressure_size),
        nodal_pressure: nodal_pressure_error(solution, problem, solved),
        volume: gain / volume,
        points: quadrature.weights.len(),
    }
}

/// −tr σ/3 \[Pa\] of a deformation gradient.
fn pressure_of(law: &Law) -> impl Fn(&Matrix3) -> f64 {
    |F| -law.cauchy(F).trace() / 3.0
}

/// ‖p_h − p‖/‖p‖ over the nodes, each with the volume Σ w φ.
fn nodal_pressure_error(solution: &Oriented, problem: &Problem, solved: &Solved) -> f64 {
    let (simulation, u) = (&solved.simulation, &solved.simulation.state.displacement);
    let discretisation = &simulation.discretisation;
    let (rows, positions) = (&discretisation.supports, &discretisation.cloud.positions);
    let mut volumes = vec![0.0; positions.len()];
    for (point, weight) in discretisation.quadrature.weights.iter().enumerate() {
        for entry in rows.row(point) {
            volumes[rows.nodes[entry] as usize] += weight * rows.phi[entry];
        }
    }
    let pressure = pressure_of(&problem.regions[0].material.law);
    let fields = NodalFields::new(problem, discretisation, &simulation.model, u, &[]);
    let (mut error, mut size) = (0.0, 0.0);
    for ((X, volume), found) in positions.iter().zip(volumes).zip(fields.at_nodes()) {
        let exact = pressure(&solution.deformation_gradient(X));
        error += volume * (found.pressure() - exact).powi(2);
        size += volume * exact.powi(2);
    }
    f64::sqrt(error / size)
}
