//! Cases whose answers are known: bundled ones, manufactured fields, made-up bodies.
#![allow(non_snake_case)]

use crate::exact::manufactured::{Family, FieldKind, Manufactured};
use crate::manufactured::{DENSITY, Orientation, Oriented, YOUNG_MODULUS, impose};
use crate::studies::workbench::Workbench;
use anyhow::{Result, bail};
use mtled::algebra::tensor::Vector3;
use mtled::material::ElasticConstants;
use mtled::problem::{Cloud, Motion, Newton};
use mtled_case::bundled::small_cases;
use mtled_case::reference::agreement::rms_of_points;
use mtled_case::reference::quantities;
use mtled_case::scene::{Case, one_error, parse_case};
use mtled_run::accuracy::ReferenceSolution;
use mtled_run::run::{Recording, numbers, solve_case};
use std::collections::BTreeMap;
use std::path::Path;

/// Where a subject is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Set {
    /// Bundled cases with finite-element references, on which the factors were set.
    Bundled,
    /// Made-up bodies, known from finer clouds, on which the factors were set too.
    KnownBodies,
    /// Fields with a closed form in three bodies.
    Manufactured,
    /// Other made-up bodies.
    NewBodies,
}

/// A known value at the end of a run.
pub(crate) struct Known {
    pub values: Vec<f64>,
    /// Its own error, root mean square over positions.
    pub error: f64,
}

/// Known values by the names of their quantities.
pub(crate) type KnownValues = BTreeMap<String, Known>;

/// A case and what is known of it.
pub(crate) struct Subject {
    pub set: Set,
    pub name: String,
    pub case: Case,
    pub known: KnownValues,
}

/// A subject before its known values are computed.
pub(crate) enum Plan {
    /// A bundled case on a cloud of its own, all lengths of its recipe multiplied.
    Bundled { name: &'static str, cloud: u64, factor: f64 },
    /// A field in a body on nodes this far apart \[m\].
    Manufactured { body: usize, field: usize, cloud: u64, spacing: f64 },
    /// A made-up body.
    Body { set: Set, name: &'static str, text: &'static str, cloud: u64 },
}

/// Bodies that the factors were set on, beside the bundled cases.
const KNOWN_BODIES: [(&str, &str); 21] = [
    ("egg", include_str!("bodies/later/egg.toml")),
    ("dome", include_str!("bodies/later/dome.toml")),
    ("layers", include_str!("bodies/later/layers.toml")),
    ("dumbbell", include_str!("bodies/later/dumbbell.toml")),
    ("lobe", include_str!("bodies/later/lobe.toml")),
    ("pad", include_str!("bodies/later/pad.toml")),
    ("pellet", include_str!("bodies/known/pellet.toml")),
    ("jelly", include_str!("bodies/known/jelly.toml")),
    ("holed", include_str!("bodies/known/holed.toml")),
    ("cantilever", include_str!("bodies/known/cantilever.toml")),
    ("tube", include_str!("bodies/known/tube.toml")),
    ("stiff_core", include_str!("bodies/known/stiff_core.toml")),
    ("wedge", include_str!("bodies/known/wedge.toml")),
    ("sheared", include_str!("bodies/known/sheared.toml")),
    ("lshape", include_str!("bodies/known/lshape.toml")),
    ("quarter", include_str!("bodies/known/quarter.toml")),
    ("notched", include_str!("bodies/known/notched.toml")),
    ("swing", include_str!("bodies/known/swing.toml")),
    ("shaken", include_str!("bodies/known/shaken.toml")),
    ("bracket", include_str!("bodies/later/bracket.toml")),
    ("flap", include_str!("bodies/later/flap.toml")),
];
/// Bodies that were made up when the factors had been set: three with contact, three in motion, four
/// in a plane; with fibres, springs, and three layers.
const NEW_BODIES: [(&str, &str); 15] = [
    ("thumb", include_str!("bodies/new/thumb.toml")),
    ("saddle", include_str!("bodies/new/saddle.toml")),
    ("fin", include_str!("bodies/new/fin.toml")),
    ("tumbler", include_str!("bodies/new/tumbler.toml")),
    ("bladder", include_str!("bodies/new/bladder.toml")),
    ("arch", include_str!("bodies/new/arch.toml")),
    ("cushion", include_str!("bodies/new/cushion.toml")),
    ("knee", include_str!("bodies/new/knee.toml")),
    ("peg", include_str!("bodies/new/peg.toml")),
    ("bed", include_str!("bodies/new/bed.toml")),
    ("calf", include_str!("bodies/new/calf.toml")),
    ("tyre", include_str!("bodies/new/tyre.toml")),
    ("gallows", include_str!("bodies/new/gallows.toml")),
    ("sandwich", include_str!("bodies/new/sandwich.toml")),
    ("hook", include_str!("bodies/new/hook.toml")),
];
/// The first of the new ones, and of the known ones, of which the quick suite solves those from
/// here on: finer clouds in a plane are solved in a moment.
const FIRST_PLANE_BODY: [usize; 2] = [14, 15];

const SHAPES: [(&str, &str); 3] = [
    ("cube", "{ box = { min = [0.0, 0.0, 0.0], max = [1.0, 1.0, 1.0] } }"),
    ("ball", "{ sphere = { centre = [0.5, 0.5, 0.5], radius = 0.5 } }"),
    (
        "rod",
        "{ cylinder = { base = [0.5, 0.5, 0.0], axis = [0.0, 0.0, 1.0], radius = 0.3, height = 1.0 } }",
    ),
];
const FIELDS: [(&str, FieldKind, Family, f64); 4] = [
    ("log-J, ν = 0.3", FieldKind::General, Family::LogJ, 0.3),
    ("isochoric, ν = 0.49", FieldKind::NearlyIsochoric, Family::Isochoric, 0.49),
    ("isochoric, ν = 0.3", FieldKind::General, Family::Isochoric, 0.3),
    ("Mooney–Rivlin, ν = 0.499", FieldKind::NearlyIsochoric, Family::MooneyRivlin, 0.499),
];
/// Positions of the probes in each of the bodies \[m\].
const PROBES: [[f64; 3]; 5] =
    [[0.5, 0.5, 0.5], [0.4, 0.55, 0.3], [0.62, 0.38, 0.7], [0.35, 0.6, 0.5], [0.5, 0.7, 0.62]];

/// Jitter of the lattices of other clouds \[spacing\].
const JITTER: f64 = 0.1;

/// What is solved in either suite, the most expensive first.
pub(crate) fn plans(bench: &Workbench) -> Vec<Plan> {
    let mut plans = Vec::new();
    let clouds = bench.pick(1, 3);
    for cloud in 0..clouds {
        for &factor in bench.pick(&[1.0][..], &[1.0, 1.2]) {
            plans.extend(small_cases().map(|name| Plan::Bundled { name, cloud, factor }));
        }
        let [new, known] = bench.pick(FIRST_PLANE_BODY, [0, 0]);
        let bodies = (&KNOWN_BODIES[known..], &NEW_BODIES[new..]);
        for (set, bodies) in [(Set::KnownBodies, bodies.0), (Set::NewBodies, bodies.1)] {
            plans.extend(bodies.iter().map(|&(name, text)| Plan::Body { set, name, text, cloud }));
        }
        let fields = bench.pick(2, FIELDS.len());
        for &spacing in bench.pick(&[0.125][..], &[0.1, 0.125]) {
            let each = |body| (0..fields).map(move |field| (body, field));
            plans.extend((0..SHAPES.len()).flat_map(each).map(|(body, field)| {
                Plan::Manufactured { body, field, cloud: bench.seed(cloud), spacing }
            }));
        }
    }
    plans
}

impl Plan {
    /// The case with its known values; None where a bundled case has no reference.
    pub(crate) fn subject(&self, bench: &Workbench) -> Result<Option<Subject>> {
        match *self {
            Plan::Bundled { name, cloud, factor } => bundled(bench, name, cloud, factor),
            Plan::Manufactured { body, field, cloud, spacing } => {
                manufactured(body, field, cloud, spacing).map(Some)
            }
            Plan::Body { set, name, text, cloud } => {
                made_up(bench, (name, text), set, cloud).map(Some)
            }
        }
    }
}

fn bundled(bench: &Workbench, name: &str, cloud: u64, factor: f64) -> Result<Option<Subject>> {
    let mut case = bench.case(name)?;
    let Some(reference) = ReferenceSolution::bundled(&case) else { return Ok(None) };
    let known = reference.quantities.iter().map(|values| {
        let last = reference.times.len() - 1;
        let components = values.quantity.family.components();
        let error = rms_of_points(values.bars(last), components);
        let known = Known { values: values.instant(last).to_vec(), error };
        (values.quantity.name.clone(), known)
    });
    let known = known.collect();
    case.problem.recipe.scale_lengths(factor);
    vary(&mut case, cloud);
    let label = format!("{name}, cloud {cloud}, spacing × {factor}");
    Ok(Some(Subject { set: Set::Bundled, name: label, case, known }))
}

/// Another cloud of the same spacing; 0 changes nothing.
fn vary(case: &mut Case, cloud: u64) {
    if cloud == 0 {
        return;
    }
    let other = match case.problem.recipe.cloud.clone() {
        Cloud::Regular { spacing } => Cloud::Jittered { spacing, jitter: JITTER, seed: cloud },
        Cloud::Jittered { spacing, jitter, seed } => {
            Cloud::Jittered { spacing, jitter, seed: seed + cloud }
        }
        Cloud::Graded { spacing, refinements, growth, seed } => {
            Cloud::Graded { spacing, refinements, growth, seed: seed + cloud }
        }
        given => given,
    };
    case.problem.recipe.cloud = other;
}

fn manufactured(body: usize, field: usize, cloud: u64, spacing: f64) -> Result<Subject> {
    let (shape, (label, field, family, poisson_ratio)) = (SHAPES[body], FIELDS[field]);
    let probe = |(i, X): (usize, &[f64; 3])| format!("[[probe]]\nname = \"{i}\"\npoint = {X:?}\n");
    let probes: String = PROBES.iter().enumerate().map(probe).collect();
    let text = format!(
        r#"
title = "Manufactured solution"

[geometry]
shape = {}

[material.solid]
law = "neo_hookean_log_j"
density = {DENSITY:?}
young_modulus = {YOUNG_MODULUS:?}
poisson_ratio = 0.3

[discretisation]
cloud = "jittered"
spacing = {spacing:?}
jitter = 0.3
seed = {}

[[prescribe]]
name = "boundary"
of = "surface"
where = "all"
displacement = {{ x = 0.0, y = 0.0, z = 0.0 }}
amplitude = {{ smooth = {{ duration = 1.0 }} }}

[time]
method = "static"

{probes}"#,
        shape.1,
        cloud + 1
    );
    let mut case = parse_case(&text, "manufactured", Path::new(".")).map_err(one_error)?;
    let constants = ElasticConstants::from_young_poisson(YOUNG_MODULUS, poisson_ratio)?;
    let solution = Manufactured { field, family, constants, density: DENSITY };
    let oriented = Oriented::new(solution, Orientation::Along);
    impose(&mut case.problem, oriented)?;
    let mut known = KnownValues::new();
    let exact = |values: Vec<f64>| Known { values, error: 0.0 };
    for (i, X) in PROBES.iter().enumerate() {
        let u = oriented.displacement(&Vector3::from(*X));
        known.insert(format!("displacement/{i}"), exact(vec![u.x, u.y, u.z]));
    }
    if shape.0 == "cube" {
        // Reactions balance the body force.
        let force = -over_cube(&|X| oriented.body_force(X) * DENSITY);
        let law = case.problem.regions[0].material.law;
        let energy =
            over_cube(&|X| Vector3::x() * law.strain_energy(&oriented.deformation_gradient(X)));
        known.insert("force/boundary".into(), exact(vec![force.x, force.y, force.z]));
        known.insert("strain_energy".into(), exact(vec![energy.x]));
    }
    let name = format!("{} of {label}, cloud {cloud}, spacing {spacing} m", shape.0);
    Ok(Subject { set: Set::Manufactured, name, case, known })
}

/// ∫ f dX over the unit cube by Simpson's rule.
fn over_cube(f: &dyn Fn(&Vector3) -> Vector3) -> Vector3 {
    const PARTS: usize = 16;
    let weight = |i: usize| match i {
        0 | PARTS => 1.0,
        i if i % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let step = 1.0 / PARTS as f64;
    let mut sum = Vector3::zeros();
    for n in 0..(PARTS + 1).pow(3) {
        let index = [n % (PARTS + 1), n / (PARTS + 1) % (PARTS + 1), n / (PARTS + 1).pow(2)];
        let X = Vector3::from_fn(|k, _| step * index[k] as f64);
        sum += f(&X) * index.iter().map(|&i| weight(i)).product::<f64>();
    }
    sum * (step / 3.0).powi(3)
}

/// Spacings of the clouds that a made-up body is known from, over its own \[–\].
const FINER: [f64; 2] = [0.5, std::f64::consts::FRAC_1_SQRT_2];
/// Order of the extrapolation from them \[–\].
const ORDER: f64 = 1.6;

/// Known from two finer clouds by Richardson's extrapolation, half of which is taken for its
/// error.
fn made_up(bench: &Workbench, (name, text): (&str, &str), set: Set, cloud: u64) -> Result<Subject> {
    let mut case = parse_case(text, name, Path::new(".")).map_err(one_error)?;
    bench.reseed(&mut case.problem);
    let finer = |factor: f64| -> Result<Recording> {
        let mut finer = case.clone();
        finer.problem.recipe.scale_lengths(factor);
        if let Some(relaxation) = finer.problem.motion.relaxation() {
            let load_end = relaxation.load_end;
            finer.problem.motion =
                Motion::Newton(Newton { load_end, tolerance: 1e-6, ..Newton::default() });
        }
        Ok(solve_case(&finer)?.1)
    };
    let [finest, second] = [finer(FINER[0])?, finer(FINER[1])?];
    let factor = 1.0 / ((FINER[1] / FINER[0]).powf(ORDER) - 1.0);
    let mut known = KnownValues::new();
    for quantity in quantities(&case) {
        let last = |record: &Recording| {
            let sample = record.samples.last()?;
            numbers(&case, record, &quantity, sample)
        };
        let (Some(fine), Some(coarse)) = (last(&finest), last(&second)) else {
            bail!("{name}: nothing was recorded of {}", quantity.name);
        };
        let changes: Vec<f64> = fine.iter().zip(&coarse).map(|(a, b)| factor * (a - b)).collect();
        let values = fine.iter().zip(&changes).map(|(f, change)| f + change).collect();
        let error = 0.5 * rms_of_points(&changes, quantity.family.components());
        known.insert(quantity.name, Known { values, error });
    }
    vary(&mut case, cloud);
    Ok(Subject { set, name: format!("{name}, cloud {cloud}"), case, known })
}
