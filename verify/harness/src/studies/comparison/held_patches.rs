//! Parts of the boundary that are held up to a curve within a face: what clouds and spacings
//! change.
#![allow(non_snake_case)]

use crate::studies::workbench::Workbench;
use anyhow::Result;
use mtled::Simulation;
use mtled::algebra::tensor::Vector3;
use mtled::force::strain_energy;
use mtled::geometry::{Selector, Shape};
use mtled::motion::observe::Unobserved;
use mtled::problem::{Amplitude, Cloud, Dimension, EssentialCondition, Problem, Recipe};
use mtled_checks::study::{Cell, Study, Table, number, text};
use mtled_run::run::integrate;
use mtled_run::specimens::simple::{bonded_face, free_body, relaxation, tissue};
use rayon::prelude::*;

const NOTES: &str = "Bodies of E = 3 kPa on a bonded bottom; the patch moves by 0.8 mm towards it and \
     by 0.4 mm sideways, 2 % of the height. Compared are strain energies, half the work of the \
     reactions. Without nodes along the edge of a patch the same clouds gave energies 10 to 25 % too \
     low at these spacings, with a scatter of 1 to 9 %, and the next finer cloud was as likely worse \
     as better.";

/// A body and the part of its boundary that is moved.
struct Patch {
    id: &'static str,
    label: &'static str,
    body: Shape,
    part: Selector,
}

/// Half the edge of the block, height of all bodies \[m\].
const HALF: f64 = 0.06;
const HEIGHT: f64 = 0.04;
/// Displacement of the patches \[m\].
const MOVED: Vector3 = Vector3::new(4e-4, 0.0, -8e-4);

fn inside(shape: Shape) -> Selector {
    Selector::Inside { shape, tolerance: 0.0 }
}

fn box_of(min: [f64; 3], max: [f64; 3]) -> Shape {
    Shape::Box { min: Vector3::from(min), max: Vector3::from(max) }
}

/// None of them is a bundled case.
fn patches() -> Vec<Patch> {
    let block = box_of([-HALF, -HALF, 0.0], [HALF, HALF, HEIGHT]);
    let cylinder = Shape::Cylinder {
        base: Vector3::zeros(),
        axis: Vector3::z(),
        radius: HEIGHT,
        height: 2.0 * HEIGHT,
    };
    let centre = Vector3::z() * HEIGHT;
    let above = Selector::Plane { point: centre, normal: Vector3::z(), tolerance: 1e-9 };
    let ellipse = Shape::Ellipsoid { centre, radii: Vector3::new(0.035, 0.02, 0.02) };
    vec![
        Patch {
            id: "ellipse",
            label: "an ellipse on the top of a block",
            body: block.clone(),
            part: Selector::Intersection(vec![above, inside(ellipse)]),
        },
        Patch {
            id: "strip",
            label: "a strip over an edge of a block",
            body: block,
            part: inside(box_of([0.035, -0.013, 0.02], [0.07, 0.017, 0.05])),
        },
        Patch {
            id: "side",
            label: "half of the side of a cylinder, in the middle half of its height",
            body: cylinder,
            part: inside(box_of([0.0, -0.1, 0.02], [0.1, 0.1, 0.06])),
        },
    ]
}

fn problem(patch: &Patch, spacing: f64, poisson_ratio: f64, seed: u64) -> Result<Problem> {
    let recipe = Recipe {
        cloud: Cloud::Jittered { spacing, jitter: 0.2, seed },
        ..Recipe::with_spacing(spacing)
    };
    let mut problem =
        free_body(Dimension::Three, patch.body.clone(), tissue(poisson_ratio)?, recipe);
    let smooth = Amplitude::Smooth { duration: 1.0 };
    problem.conditions = vec![
        bonded_face(2, 0.0, 0.0, smooth.clone()),
        EssentialCondition::on_surface("patch", patch.part.clone(), MOVED, smooth),
    ];
    problem.motion = relaxation(100, 1e-4);
    Ok(problem)
}

/// Strain energy \[J\].
fn energy(patch: &Patch, spacing: f64, poisson_ratio: f64, seed: u64) -> Result<f64> {
    let problem = problem(patch, spacing, poisson_ratio, seed)?;
    let solved = integrate(Simulation::with_any_recipe(&problem)?, &mut Unobserved)?;
    let model = &solved.simulation.model;
    Ok(strain_energy(&model.points, &solved.simulation.state.displacement))
}

/// Energies of several clouds against one another and against that of a finer cloud.
pub(crate) fn held_patches(bench: &Workbench, study: &mut Study) -> Result<()> {
    let clouds: u64 = bench.pick(3, 10);
    let ratios = bench.pick(vec![0.45], vec![0.3, 0.45, 0.49]);
    let (spacing, finer) = (0.008, bench.pick(0.0055, 0.004));
    let patches = patches();
    let jobs: Vec<(&Patch, f64)> =
        patches.iter().flat_map(|patch| ratios.iter().map(move |&nu| (patch, nu))).collect();
    let mut rows = Vec::new();
    for (patch, nu) in jobs {
        let fine = energy(patch, finer, nu, bench.seed(1))?;
        let coarse: Vec<f64> = (0..clouds)
            .into_par_iter()
            .map(|seed| energy(patch, spacing, nu, bench.seed(seed)))
            .collect::<Result<_>>()?;
        let count = coarse.len() as f64;
        let mean = coarse.iter().sum::<f64>() / count;
        let squares: f64 = coarse.iter().map(|energy| (energy - mean).powi(2)).sum();
        let (scatter, change) = ((squares / count).sqrt() / mean, (mean / fine - 1.0).abs());
        let id = format!("{}-nu{}", patch.id, (1000.0 * nu).round());
        for (what, label, value) in [
            ("scatter", "rms difference between clouds", scatter),
            ("change", "difference of the mean from a finer cloud", change),
        ] {
            study.checks.push(bench.regression(
                &format!("held_patches/{id}/{what}"),
                &format!("{}, ν = {nu}: {label}, over the strain energy", patch.label),
                value,
                "1",
                "no node of a cloud without the nodes along the edge knows where the patch ends",
            ));
        }
        let mut row = vec![Cell::Text(patch.label.into())];
        row.extend([nu, spacing, finer, mean, fine, scatter, change].map(Cell::Number));
        rows.push(row);
    }
    study.tables.push(Table {
        title: "Patches that end within a face".into(),
        columns: vec![
            text("patch"),
            number("ν", "1"),
            number("spacing", "m"),
            number("finer spacing", "m"),
            number("mean energy", "J"),
            number("energy of the finer cloud", "J"),
            number("scatter", "1"),
            number("change", "1"),
        ],
        rows,
    });
    study.notes.push(NOTES.into());
    Ok(())
}
