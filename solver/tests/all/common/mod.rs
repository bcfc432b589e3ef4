//! Small problems for the tests: a cube and a square in plane strain.
#![allow(dead_code)] // `allocation.rs`, a program of its own, uses only a part of this.
#![allow(non_snake_case)]

pub use mtled::algebra::tensor::vector_at;
use mtled::algebra::tensor::{Vector3, rotation};
use mtled::discretisation::Discretisation;
use mtled::force::{Workspace, internal_force};
use mtled::geometry::{Extent, Selector, Shape};
use mtled::material::*;
use mtled::model::Model;
use mtled::model::essential::Reaction;
use mtled::motion::energy::Energies;
use mtled::motion::observe::{Continue, Observer, View};
use mtled::problem::*;
use nalgebra::DMatrix;

pub mod pipe;
pub mod statics;

/// Edge of the cube and of the square \[m\].
pub const EDGE: f64 = 0.1;
/// Thickness of the square \[m\].
pub const THICKNESS: f64 = 0.02;

pub fn constants() -> ElasticConstants {
    ElasticConstants::from_young_poisson(3000.0, 0.3).unwrap()
}

/// Every law but the linear one, which is not objective.
pub fn objective_laws() -> Vec<Law> {
    vec![
        Law::MooneyRivlin(MooneyRivlin::new(1052.0, 100.0, 0.49).unwrap()),
        Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants())),
        Law::NeoHookeanIsochoric(NeoHookeanIsochoric::new(constants(), VolumetricTerm::Quadratic)),
        ogden(),
        Law::StVenantKirchhoff(StVenantKirchhoff::new(constants())),
        Law::Demiray(isochoric(&[1000.0, 2.0])),
        Law::Guccione(isochoric(&[2000.0, 8.0, 2.0, 4.0])),
        Law::HolzapfelOgden(isochoric(&[900.0, 2.0, 1800.0, 3.0, 500.0, 2.0, 200.0, 4.0])),
    ]
}

/// A law of the isochoric tensor, twenty times as stiff against a change of volume.
pub fn isochoric<W: ShapeEnergy>(constants: &[f64]) -> Isochoric<W> {
    let shape = W::new(constants).unwrap();
    Isochoric::new(shape, 20.0 * shape.shear_modulus(), VolumetricTerm::SimoTaylor).unwrap()
}

/// Fibres that turn from place to place, for laws that need some.
pub fn turning_fibres(law: &Law) -> Option<Fibres> {
    let fibre = |X: &Vector3| Vector3::new((30.0 * X.y).cos(), (30.0 * X.y).sin(), 4.0 * X.x);
    let sheet = Some(Vector3::new(0.3, -0.2, 1.0).into());
    law.has_fibres().then(|| Fibres { fibre: Field::of(fibre), sheet })
}

/// Brain tissue of Miller, Chinzei 2002, of ν = 0.49.
pub fn ogden() -> Law {
    let terms = OgdenTerms::new(&[OgdenTerm { mu: 842.0, alpha: -4.7 }]).unwrap();
    let constants = ElasticConstants::from_shear_poisson(842.0, 0.49).unwrap();
    Law::Ogden(Ogden::new(terms, constants.bulk_modulus, VolumetricTerm::Quadratic).unwrap())
}

pub fn material(law: Law) -> Material {
    Material { density: 1000.0, law }
}

pub fn neo_hookean(young_modulus: f64, poisson_ratio: f64) -> Law {
    let constants = ElasticConstants::from_young_poisson(young_modulus, poisson_ratio).unwrap();
    Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants))
}

fn body(dimension: Dimension, cells: usize) -> Problem {
    let spacing = EDGE / cells as f64;
    Problem {
        dimension,
        body: Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(EDGE) },
        regions: vec![Region::new("tissue", Selector::All, material(neo_hookean(3000.0, 0.3)))],
        recipe: Recipe {
            cloud: Cloud::Regular { spacing },
            dilation: 1.8,
            basis: Basis::Linear,
            weight_function: WeightFunction::QuarticSpline,
            grid: BackgroundGrid {
                cell: spacing / 1.5,
                cells_per_spacing: None,
                boundary_cell: None,
                refinements: vec![],
                gauss_points: 1,
                inside: InsideRule::VolumeFraction,
            },
            mass: MassRule::RowSum,
            enforcement: Enforcement::Direct,
            gradients: Gradients::Plain,
            gradient_storage: GradientStorage::Double,
            volumetric_projection: VolumetricProjection::None,
            material_borders: MaterialBorders::Straddled,
        },
        conditions: vec![],
        loads: Loads::default(),
        obstacles: vec![],
        motion: Motion::Dynamic { end: 0.1, step: StepControl::default(), damping: 0.0 },
    }
}

/// A cube with one corner at the origin and `cells` nodal spacings per edge.
pub fn cube(cells: usize) -> Problem {
    body(Dimension::Three, cells)
}

/// A square in plane strain with one corner at the origin.
pub fn square(cells: usize) -> Problem {
    body(Dimension::PlaneStrain { thickness: THICKNESS, z: 0.03 }, cells)
}

pub fn with_law(mut problem: Problem, law: Law) -> Problem {
    problem.regions[0].fibres = turning_fibres(&law);
    problem.regions[0].material = material(law);
    problem
}

/// The half x < EDGE/2 made of another law.
pub fn with_stiff_half(mut problem: Problem, law: Law) -> Problem {
    let (fibres, material) = (turning_fibres(&law), material(law));
    let half = Region { fibres, ..Region::new("half", half_space(), material) };
    problem.regions.insert(0, half);
    problem
}

fn half_space() -> Selector {
    let shape =
        Shape::HalfSpace { point: Vector3::new(0.5 * EDGE, 0.0, 0.0), normal: Vector3::x() };
    Selector::Inside { shape, tolerance: 0.0 }
}

pub fn jittered(mut problem: Problem, jitter: f64, seed: u64) -> Problem {
    if let Cloud::Regular { spacing } = problem.recipe.cloud {
        problem.recipe.cloud = Cloud::Jittered { spacing, jitter, seed };
    }
    problem
}

pub fn quadratic(mut problem: Problem) -> Problem {
    problem.recipe.basis = Basis::Quadratic;
    problem.recipe.dilation = 2.6;
    // Row sums of quadratic functions are negative at the corners.
    problem.recipe.mass = MassRule::EvenSplit;
    problem
}

pub fn collocated(mut problem: Problem) -> Problem {
    problem.recipe.enforcement = Enforcement::Collocation;
    problem
}

/// The face of the body where coordinate `axis` is `at` \[m\].
pub fn face(axis: usize, at: f64) -> Selector {
    let mut point = Vector3::zeros();
    point[axis] = at;
    let mut normal = Vector3::zeros();
    normal[axis] = 1.0;
    Selector::Plane { point, normal, tolerance: 1e-9 }
}

pub fn condition(name: &str, part: Selector, values: [Option<f64>; 3]) -> EssentialCondition {
    EssentialCondition {
        name: name.into(),
        extent: Extent::Surface,
        part,
        prescribed: Prescribed::Displacement(values),
        amplitude: Amplitude::Constant,
        release: None,
    }
}

pub fn gravity(problem: &mut Problem, acceleration: Vector3) {
    let amplitude = Amplitude::Constant;
    problem.loads.body_forces.push(BodyForce {
        part: Selector::All,
        acceleration: acceleration.into(),
        amplitude,
    });
}

/// The square in plane strain, turned by `angle` \[rad\] about its corner at the origin.
pub fn tilted_square(cells: usize, angle: f64) -> Problem {
    let tilt = rotation(&Vector3::z(), angle);
    let corner = |x: f64, y: f64| {
        let at = tilt * Vector3::new(x, y, 0.0);
        [at.x, at.y]
    };
    let points = [corner(0.0, 0.0), corner(EDGE, 0.0), corner(EDGE, EDGE), corner(0.0, EDGE)];
    let body = Shape::Polygon { points: points.to_vec().into(), z: (0.0, EDGE) };
    Problem { body, ..square(cells) }
}

pub fn obstacle(shape: Shape, side: ObstacleSide, friction: Friction) -> Obstacle {
    Obstacle { side, friction, ..Obstacle::new("obstacle", shape) }
}

/// The half-space below `height` \[m\] along `normal`.
pub fn floor(height: f64, normal: Vector3, friction: Friction) -> Obstacle {
    let shape = Shape::HalfSpace { point: normal * height, normal };
    obstacle(shape, ObstacleSide::Outside, friction)
}

pub fn build(problem: &Problem) -> (Discretisation, Model) {
    let discretisation = Discretisation::new(problem).unwrap();
    let model = Model::new(problem, &discretisation).unwrap();
    (discretisation, model)
}

pub fn dynamic(end: f64, fixed: f64, damping: f64) -> Motion {
    let step = StepControl { fixed: Some(fixed), ..StepControl::default() };
    Motion::Dynamic { end, step, damping }
}

/// The displacements u(X) of all nodes, packed.
pub fn field(model: &Model, u: impl Fn(&Vector3) -> Vector3) -> Vec<f64> {
    let components = model.components;
    model
        .positions
        .iter()
        .flat_map(|x| u(x).iter().take(components).copied().collect::<Vec<_>>())
        .collect()
}

/// Internal forces at displacements `u`.
pub fn forces(model: &Model, u: &[f64]) -> Vec<f64> {
    let mut f = vec![0.0; model.size()];
    internal_force(&model.points, u, &mut Workspace::new(&model.points), &mut f);
    f
}

/// The symmetric part of the tangent at `u`, by central differences of `step` \[m\].
pub fn dense_tangent(model: &Model, u: &[f64], step: f64) -> DMatrix<f64> {
    let mut columns = DMatrix::zeros(model.size(), model.size());
    let mut moved = u.to_vec();
    for (j, mut column) in columns.column_iter_mut().enumerate() {
        moved[j] = u[j] + step;
        let plus = forces(model, &moved);
        moved[j] = u[j] - step;
        let minus = forces(model, &moved);
        moved[j] = u[j];
        let differences =
            plus.iter().zip(&minus).map(|(plus, minus)| (plus - minus) / (2.0 * step));
        column.iter_mut().zip(differences).for_each(|(entry, difference)| *entry = difference);
    }
    0.5 * (&columns + columns.transpose())
}

/// Random displacements up to `size` \[m\] per component.
pub fn noise(model: &Model, size: f64, seed: u64) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        size * (2.0 * (state >> 11) as f64 / (1u64 << 53) as f64 - 1.0)
    };
    (0..model.size()).map(|_| next()).collect()
}

pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a: f64, x| a.max(x.abs()))
}

/// Mass-weighted mean of a packed field.
pub fn mean_by_mass(model: &Model, field: &[f64]) -> Vector3 {
    let total: f64 = model.lumped_mass.iter().sum();
    let sum: Vector3 = (0..model.positions.len())
        .map(|node| vector_at(field, node, model.components) * model.lumped_mass[node])
        .sum();
    sum / total
}

/// Records energies and reactions at every step.
#[derive(Default)]
pub struct Recorder {
    pub energies: Vec<Energies>,
    /// About the origin.
    pub reactions: Vec<Reaction>,
    pub observations: usize,
}

impl Observer for Recorder {
    fn observe(&mut self, view: &mut View) -> Continue {
        self.observations += 1;
        self.energies.push(view.energies());
        if view.state.step > 0 {
            self.reactions = view.reactions(&Vector3::zeros());
        }
        Continue::Yes
    }

    fn tracks_work(&self) -> bool {
        true
    }
}

/// Calls a function at each observation.
pub struct EachStep<F: FnMut(&mut View)>(pub F);

impl<F: FnMut(&mut View)> Observer for EachStep<F> {
    fn observe(&mut self, view: &mut View) -> Continue {
        (self.0)(view);
        Continue::Yes
    }
}
