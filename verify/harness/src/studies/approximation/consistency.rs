//! The approximation: partition of unity, reproduction, derivatives.
#![allow(non_snake_case)]

use crate::studies::workbench::{Workbench, exact};
use mtled::algebra::random::Random;
use mtled::algebra::tensor::Vector3;
use mtled::discretisation::mls::{Approximation, Support};
use mtled::discretisation::nodes::{NodeCloud, node_cloud};
use mtled::problem::{Basis, Dimension, WeightFunction};
use mtled_checks::measure::larger;
use mtled_checks::study::{Cell, Column, Figure, Plot, Study, Table, axis, curve, number, text};
use mtled_run::specimens::simple::{PLANE, SIZE, block_shape, recipe};
use nalgebra::DMatrix;

/// Nodal spacing \[m\]: six nodes along each edge.
const SPACING: f64 = SIZE / 5.0;
const JITTERS: [f64; 4] = [0.0, 0.15, 0.3, 0.45];
/// Distances from the origin \[m\].
const DISTANCES: [f64; 3] = [0.0, 1.0, 10.0];
/// Step of the central differences over the spacing: the truncation error,
/// about C·step²/6 with C ~ 10², and the round-off, about 10²·1e-16/step,
/// are both far below the bound of 1e-6.
const DIFFERENCE_STEP: f64 = 1e-5;
/// The same for the modified basis, whose φ may change its slope within 10⁻⁴ of the spacing:
/// differences over this step and twice this step are extrapolated.
const MODIFIED_STEP: f64 = 2e-5;

/// Modified moving least squares with the default regularisation.
const MODIFIED: Basis = Basis::ModifiedQuadratic { regularisation: 1e-7 };

/// Influence radius over spacing \[–\].
fn dilation(basis: Basis) -> f64 {
    match basis {
        Basis::Linear => 1.8,
        Basis::Quadratic => 2.7,
        Basis::ModifiedQuadratic { .. } => 2.0,
    }
}

/// Largest errors so far \[–\].
#[derive(Debug, Clone, Copy, Default)]
struct Errors {
    partition: f64,
    /// Over spacing, or spacing² for squares.
    value: f64,
    gradient: f64,
    /// Times spacing.
    derivative: f64,
    condition: f64,
    /// Relative change of the condition by moving the cloud.
    shift: f64,
    compared: usize,
}

/// Measures the errors of every basis and weight function on every cloud.
pub(crate) fn consistency(bench: &Workbench, study: &mut Study) -> anyhow::Result<()> {
    let mut rows = Vec::new();
    for (dimension, space) in [(PLANE, "2d"), (Dimension::Three, "3d")] {
        for (basis, order) in
            [(Basis::Linear, "linear"), (Basis::Quadratic, "quadratic"), (MODIFIED, "modified")]
        {
            let mut worst = Errors::default();
            for weight_function in WeightFunction::ALL {
                let errors = measure(bench, dimension, basis, weight_function)?;
                rows.push(row(&space.replace('d', "-D"), order, weight_function, &errors));
                worst = worst.or(&errors);
            }
            anyhow::ensure!(worst.compared > 1000, "Grad φ was compared with too few differences");
            add_checks(study, &format!("{space}-{order}"), basis, &worst);
        }
    }
    study.tables.push(Table {
        title: "Largest errors over all clouds and points".into(),
        columns: columns(),
        rows,
    });
    study.figures.push(Figure::Plot(condition_figure(bench)?));
    study.figures.push(Figure::Plot(regularisation_figure(bench)?));
    study.notes.push(format!(
        "Clouds of 6 nodes along each edge, spacing {SPACING} m, jitter 0, 0.15, 0.3 and 0.45 of the \
         spacing, at 0, 1 and 10 m from the origin; dilation 1.8 (linear), 2.7 (quadratic) and 2 \
         (modified quadratic, regularised by 1e-7). \
         Differences are left out where the support changes within the step: the exponential \
         weight function has a kink at its edge."
    ));
    Ok(())
}

fn measure(
    bench: &Workbench,
    dimension: Dimension,
    basis: Basis,
    weight_function: WeightFunction,
) -> anyhow::Result<Errors> {
    let components = dimension.components();
    let mut errors = Errors::default();
    for (index, jitter) in JITTERS.into_iter().enumerate() {
        for seed in (0..bench.pick(3, 10)).map(|seed| bench.seed(seed)) {
            let cloud = cloud(dimension, jitter, seed)?;
            let mut random = Random(1000 * seed + index as u64);
            let points: Vec<Vector3> =
                (0..bench.pick(25, 100)).map(|_| point_inside(&mut random, components)).collect();
            let mut at_origin = Vec::new();
            for distance in DISTANCES {
                let shift = shift(distance, components);
                let approximation = approximation(&cloud, shift, dimension, basis, weight_function);
                for (i, X) in points.iter().enumerate() {
                    let support = evaluate(&approximation, &(X + shift))?;
                    errors.sample(&approximation, &(X + shift), &support, components);
                    if distance == 0.0 {
                        at_origin.push(support.condition);
                    }
                    let change = (support.condition / at_origin[i] - 1.0).abs();
                    errors.shift = larger(errors.shift, change);
                }
            }
        }
    }
    Ok(errors)
}

impl Errors {
    fn or(&self, other: &Errors) -> Errors {
        Errors {
            partition: larger(self.partition, other.partition),
            value: larger(self.value, other.value),
            gradient: larger(self.gradient, other.gradient),
            derivative: larger(self.derivative, other.derivative),
            condition: larger(self.condition, other.condition),
            shift: larger(self.shift, other.shift),
            compared: self.compared + other.compared,
        }
    }

    fn sample(&mut self, approximation: &Approximation, X: &Vector3, support: &Support, d: usize) {
        self.condition = larger(self.condition, support.condition);
        let sum: f64 = support.phi.iter().sum();
        self.partition = larger(self.partition, (sum - 1.0).abs());
        let slope: Vector3 = support.grad_phi.iter().sum();
        self.partition = larger(self.partition, SPACING * slope.norm());
        let offset = |node: u32| (approximation.nodes[node as usize] - X) / SPACING;
        for i in 0..d {
            let mut unit = Vector3::zeros();
            unit[i] = 1.0;
            self.reproduce(support, |node| offset(node)[i], unit);
            if approximation.basis == Basis::Quadratic {
                for j in i..d {
                    let square = |node| offset(node)[i] * offset(node)[j];
                    self.reproduce(support, square, Vector3::zeros());
                }
            }
            self.differentiate(approximation, X, support, i);
        }
    }

    /// A monomial about X in units of the spacing has the value 0 there.
    fn reproduce(&mut self, support: &Support, monomial: impl Fn(u32) -> f64, slope: Vector3) {
        let (mut value, mut gradient) = (0.0, Vector3::zeros());
        for ((&node, phi), grad_phi) in
            support.nodes.iter().zip(&support.phi).zip(&support.grad_phi)
        {
            value += phi * monomial(node);
            gradient += grad_phi * (SPACING * monomial(node));
        }
        self.value = larger(self.value, value.abs());
        self.gradient = larger(self.gradient, (gradient - slope).norm());
    }

    fn differentiate(&mut self, a: &Approximation, X: &Vector3, support: &Support, axis: usize) {
        let modified = matches!(a.basis, Basis::ModifiedQuadratic { .. });
        let over = |step| differences(a, X, support, axis, step);
        let differences = if modified {
            over(MODIFIED_STEP).zip(over(2.0 * MODIFIED_STEP)).map(|(fine, coarse)| {
                let extrapolated = |(f, c): (&f64, &f64)| (4.0 * f - c) / 3.0;
                fine.iter().zip(&coarse).map(extrapolated).collect()
            })
        } else {
            over(DIFFERENCE_STEP)
        };
        let Some(differences) = differences else { return };
        self.compared += 1;
        // φ of the modified basis may be as steep as 10³/h.
        let steepest = support.grad_phi.iter().map(|slope| SPACING * slope.norm());
        let size = if modified { steepest.fold(1.0, larger) } else { 1.0 };
        for (gradient, difference) in support.grad_phi.iter().zip(differences) {
            let error = SPACING * (difference - gradient[axis]).abs();
            self.derivative = larger(self.derivative, error / size);
        }
    }
}

/// Central differences of φ along an axis over `step` spacings \[1/m\]; None where the support
/// changes within the step.
fn differences(
    a: &Approximation,
    X: &Vector3,
    support: &Support,
    axis: usize,
    step: f64,
) -> Option<Vec<f64>> {
    let (mut ahead, mut behind) = (*X, *X);
    ahead[axis] += step * SPACING;
    behind[axis] -= step * SPACING;
    // The distance of the two points after rounding.
    let distance = ahead[axis] - behind[axis];
    let (Ok(ahead), Ok(behind)) = (a.evaluate(&ahead), a.evaluate(&behind)) else { return None };
    let same_nodes =
        |other: &Support| other.nodes == support.nodes && other.enlargement == support.enlargement;
    let slopes = || ahead.phi.iter().zip(&behind.phi).map(|(p, m)| (p - m) / distance).collect();
    (same_nodes(&ahead) && same_nodes(&behind)).then(slopes)
}

fn add_checks(study: &mut Study, case: &str, basis: Basis, worst: &Errors) {
    // The modified basis reproduces linear fields.
    let limit = if basis == Basis::Quadratic { 1e-11 } else { 1e-12 };
    let derivation = "Moving least squares reproduce their basis exactly (Lancaster and \
                      Salkauskas 1981); what remains is round-off times the condition number";
    let (difference_bound, difference_source) = match basis {
        Basis::ModifiedQuadratic { .. } => (
            1e-4,
            "Grad φ is the full derivative; second-order coefficients reach 1/μ and cancel in φ to \
             1e-16/μ = 1e-9, which differences over 4e-5 of the spacing turn into 2e-5",
        ),
        _ => (
            1e-6,
            "Grad φ is the full derivative; truncation (step 1e-5 of the spacing) and round-off \
             of the differences are below 1e-7",
        ),
    };
    let rows = [
        ("partition_of_unity", "Σφ − 1 and h ΣGrad φ", worst.partition, 1e-12, derivation),
        ("value", "reproduction of the basis, value over spacing", worst.value, limit, derivation),
        ("gradient", "reproduction of the basis, gradient", worst.gradient, limit, derivation),
        (
            "derivative",
            "h Grad φ against central differences of φ",
            worst.derivative,
            difference_bound,
            difference_source,
        ),
        (
            "shift",
            "relative change of the condition number by moving the cloud by 10 m",
            worst.shift,
            1e-8,
            "The basis is local: moving the cloud changes nothing but the last bits of the \
             coordinates, 1e-13 of the spacing, times the condition number",
        ),
    ];
    for (quantity, label, value, bound, source) in rows {
        let id = format!("consistency/{case}/{quantity}");
        study.checks.push(exact(&id, label, value, bound, source));
    }
}

fn columns() -> Vec<Column> {
    vec![
        text("dimension"),
        text("basis"),
        text("weight function"),
        number("partition of unity", "1"),
        number("value", "1"),
        number("gradient", "1"),
        number("derivative", "1"),
        number("largest condition", "1"),
    ]
}

fn row(space: &str, order: &str, weight_function: WeightFunction, errors: &Errors) -> Vec<Cell> {
    let name = match weight_function {
        WeightFunction::CubicSpline => "cubic spline",
        WeightFunction::QuarticSpline => "quartic spline",
        WeightFunction::Exponential => "exponential",
    };
    let label = [space, order, name].map(|word| Cell::Text(word.to_string()));
    let numbers =
        [errors.partition, errors.value, errors.gradient, errors.derivative, errors.condition]
            .map(Cell::Number);
    label.into_iter().chain(numbers).collect()
}

/// Condition number against distance from the origin: flat in the local
/// basis, growing with monomials in the coordinates themselves.
fn condition_figure(bench: &Workbench) -> anyhow::Result<Plot> {
    let dimension = Dimension::Three;
    let cloud = cloud(dimension, 0.3, bench.seed(1))?;
    let X = Vector3::new(0.43, 0.52, 0.37) * SIZE;
    let mut series = Vec::new();
    for (basis, name) in [(Basis::Linear, "linear"), (Basis::Quadratic, "quadratic")] {
        let (mut local, mut global) = (Vec::new(), Vec::new());
        for power in -2..=2 {
            let distance = 10f64.powi(power);
            let shift = shift(distance, 3);
            let a = approximation(&cloud, shift, dimension, basis, WeightFunction::QuarticSpline);
            local.push((distance, evaluate(&a, &(X + shift))?.condition));
            if basis == Basis::Linear {
                global.push((distance, global_condition(&a, &(X + shift))));
            }
        }
        series.push(curve(&format!("{name} basis, local and scaled"), local));
        if basis == Basis::Linear {
            series.push(curve("linear basis, global monomials", global));
        }
    }
    Ok(Plot {
        title: "Condition of the moment matrix away from the origin".into(),
        caption: "One point of a jittered cloud, moved. In the local scaled basis the distance \
                  from the origin does not matter; with global monomials (for comparison only) \
                  digits would be lost."
            .into(),
        x: axis("distance from the origin", "m", true),
        y: axis("condition number", "1", true),
        series,
        slopes: Vec::new(),
    })
}

/// Error of squares against the regularisation of the modified basis.
fn regularisation_figure(bench: &Workbench) -> anyhow::Result<Plot> {
    let dimension = Dimension::Three;
    let cloud = cloud(dimension, 0.3, bench.seed(1))?;
    let X = Vector3::new(0.43, 0.52, 0.37) * SIZE;
    let mut errors = Vec::new();
    for power in -8..=-1 {
        let regularisation = 10f64.powi(power);
        let basis = Basis::ModifiedQuadratic { regularisation };
        let weight_function = WeightFunction::QuarticSpline;
        let a = approximation(&cloud, Vector3::zeros(), dimension, basis, weight_function);
        let support = evaluate(&a, &X)?;
        let mut square = Vector3::zeros();
        for (&node, phi) in support.nodes.iter().zip(&support.phi) {
            let offset = (a.nodes[node as usize] - X) / SPACING;
            square += offset.component_mul(&offset) * *phi;
        }
        errors.push((regularisation, square.amax()));
    }
    Ok(Plot {
        title: "Quadratic fields under the modified basis".into(),
        caption: "Error of the squares of the coordinates about a point of a jittered cloud, over \
                  the spacing squared: proportional to the regularisation."
            .into(),
        x: axis("regularisation", "1", true),
        y: axis("error of a square", "1", true),
        series: vec![curve("dilation 2", errors)],
        slopes: Vec::new(),
    })
}

/// ‖A‖₁‖A⁻¹‖₁ with the monomials 1, x, y, z.
fn global_condition(a: &Approximation, X: &Vector3) -> f64 {
    let mut moment = DMatrix::<f64>::zeros(4, 4);
    for (node, radius) in a.nodes.iter().zip(&a.influence_radius) {
        let q = (node - X).norm() / radius;
        let weight = a.weight_function.value_and_derivative(q).0;
        let p = nalgebra::DVector::from_vec(vec![1.0, node.x, node.y, node.z]);
        moment.ger(weight, &p, &p, 1.0);
    }
    let norm =
        |m: &DMatrix<f64>| m.column_iter().map(|column| column.abs().sum()).fold(0.0f64, larger);
    moment.clone().try_inverse().map_or(f64::INFINITY, |inverse| norm(&moment) * norm(&inverse))
}

fn cloud(dimension: Dimension, jitter: f64, seed: u64) -> anyhow::Result<NodeCloud> {
    Ok(node_cloud(&block_shape(), &recipe(SPACING, jitter, seed).cloud, &dimension)?)
}

fn approximation(
    cloud: &NodeCloud,
    shift: Vector3,
    dimension: Dimension,
    basis: Basis,
    weight_function: WeightFunction,
) -> Approximation {
    let dilation = dilation(basis);
    let nodes: Vec<Vector3> = cloud.positions.iter().map(|X| X + shift).collect();
    let radius = cloud.spacing.iter().map(|h| dilation * h).collect();
    Approximation::new(nodes, radius, basis, weight_function, &dimension)
}

fn evaluate(approximation: &Approximation, X: &Vector3) -> anyhow::Result<Support> {
    approximation.evaluate(X).map_err(|error| anyhow::anyhow!("no approximation at {X}: {error:?}"))
}

fn point_inside(random: &mut Random, components: usize) -> Vector3 {
    let centre = Vector3::from_fn(|k, _| if k < components { 0.5 * SIZE } else { 0.0 });
    centre + random.vector(components) * (0.499 * SIZE)
}

/// A vector of length `distance` \[m\] along no axis.
fn shift(distance: f64, components: usize) -> Vector3 {
    let mut direction = Vector3::new(2.0, -3.0, 1.0);
    if components == 2 {
        direction.z = 0.0;
    }
    direction * (distance / direction.norm())
}
