//! The configuration without loads of a body whose shape under loads is known, such as that of an
//! image.
//!
//! With ξ the places of the known shape, X(ξ) = ξ + w(ξ) those without loads and u the displacements
//! under loads, w is found by the fixed point w ← w − ω (w + u) (Sellier 2011; method book, eq. 31.1),
//! with ω by Aitken's rule. Nodes, supports and patches are those of the known shape all along; gradients,
//! weights and areas are those without loads.
#![allow(non_snake_case)]

use crate::algebra::packed::{dot, largest};
use crate::discretisation::{Discretisation, Rows};
use crate::error::Error;
use crate::model::Model;
use crate::model::rigid_motions::free_rigid_motions;
use crate::model::zero_energy::refuse_zero_energy_modes;
use crate::motion::observe::{Continue, Observer, View};
use crate::motion::simulate::simulate;
use crate::motion::state::State;
use crate::motion::summary::Summary;
use crate::problem::{Field, Motion, Prescribed, Problem};

/// How it is looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unloading {
    /// Distance to the known shape over the largest displacement at which it is found \[–\].
    pub tolerance: f64,
    /// Solutions under loads, at most.
    pub most: usize,
}

impl Default for Unloading {
    fn default() -> Unloading {
        Unloading { tolerance: 1e-4, most: 30 }
    }
}

/// A body without loads.
#[derive(Debug)]
pub struct Unloaded {
    /// From the known shape to that without loads, at the nodes' parameters w
    /// \[component of node\] \[m\].
    pub offsets: Vec<f64>,
    /// The known shape.
    pub image: Discretisation,
    /// The body without loads.
    pub model: Model,
    /// It under loads.
    pub state: State,
    /// How it was solved the last time.
    pub summary: Summary,
    /// What each solution has left.
    pub distances: Vec<Distance>,
    /// Whether the last one is small enough.
    pub found: bool,
    /// Whether the observer ended the search.
    pub stopped: bool,
}

/// How far a body under loads is from the known shape, at nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distance {
    /// \[m\]
    pub largest: f64,
    /// Root of the mean square \[m\].
    pub mean: f64,
    /// Largest displacement \[m\].
    pub displacement: f64,
}

/// Bounds of ω \[–\].
const FACTORS: (f64, f64) = (0.2, 1.5);
/// Part of the loads that is tried first, and the smallest step of it \[–\].
const FIRST: f64 = 0.25;
const SMALLEST: f64 = 5e-3;
/// Tolerance at a part of the loads \[–\].
const PASSING: f64 = 0.02;
/// Distance over the size of the body that is none \[–\].
const ROUND_OFF: f64 = 1e-12;
/// Solutions at a part of the loads, at most.
const MOST_ON_THE_WAY: usize = 6;

/// Finds the body that has the shape of `problem` under its loads, which grow in as few parts as it
/// takes. `observer` is asked in every solution and between them whether to go on.
///
/// # Errors
/// [`Error::NotUnloaded`] for what has no such body or is not told apart from the known shape; those
/// of the discretisation and of the solutions.
pub fn unload(
    problem: &Problem,
    settings: Unloading,
    observer: &mut dyn Observer,
) -> Result<Unloaded, Error> {
    refuse_others(problem)?;
    let image = Discretisation::new(problem)?;
    let model = Model::new(problem, &image)?;
    refuse_zero_energy_modes(problem, &image, &model)?;
    if free_rigid_motions(&model, problem.motion.end(), &vec![0.0; model.size()]) > 0 {
        return Err(Error::NotUnloaded { what: "bodies that can move freely" });
    }
    let size = problem.dimension.components() * image.cloud.positions.len();
    let rows = image.rows_at(&image.cloud.positions)?;
    let mut search = Search { problem, image, rows, settings, observer, distances: Vec::new() };
    let mut reached = (0.0, vec![0.0; size]);
    let mut before = reached.clone();
    let mut step = FIRST;
    loop {
        let fraction = if reached.0 + 1.5 * step > 1.0 { 1.0 } else { reached.0 + step };
        // Straight on from the last two.
        let ahead = (fraction - reached.0) / (reached.0 - before.0).max(f64::MIN_POSITIVE);
        let ahead = if reached.0 > 0.0 { ahead } else { 0.0 };
        let change = reached.1.iter().zip(&before.1).map(|(w, before)| w + ahead * (w - before));
        let last = match search.at(fraction, change.collect()) {
            Ok(last) if last.stopped || fraction == 1.0 => return Ok(search.end(last)),
            Ok(found) if found.found => {
                before = std::mem::replace(&mut reached, (fraction, found.offsets));
                step *= 2.0;
                continue;
            }
            Ok(_) => "the solutions do not come nearer to the known shape".to_string(),
            Err(error) if is_of_the_way(&error) => error.to_string(),
            Err(error) => return Err(error),
        };
        step *= 0.5;
        if step < SMALLEST {
            return Err(Error::NoneUnloaded { reached: reached.0, last });
        }
    }
}

/// Whether smaller loads may do better.
fn is_of_the_way(error: &Error) -> bool {
    matches!(error, Error::NoEquilibrium { .. } | Error::FoldedBody { .. })
}

/// What came of a fraction of the loads.
struct Tried {
    offsets: Vec<f64>,
    model: Model,
    state: State,
    summary: Summary,
    found: bool,
    stopped: bool,
}

/// What the search has at hand at every part of the loads.
struct Search<'a> {
    problem: &'a Problem,
    /// The known shape.
    image: Discretisation,
    /// φ at its nodes.
    rows: Rows,
    settings: Unloading,
    observer: &'a mut dyn Observer,
    distances: Vec<Distance>,
}

impl Search<'_> {
    /// From some offsets \[component of node\] \[m\] at a fraction of the loads.
    fn at(&mut self, fraction: f64, mut offsets: Vec<f64>) -> Result<Tried, Error> {
        let problem = part_of(self.problem, fraction);
        let last = fraction == 1.0;
        let (tolerance, most) = if last {
            (self.settings.tolerance, self.settings.most)
        } else {
            (self.settings.tolerance.max(PASSING), MOST_ON_THE_WAY)
        };
        let mut factor = 1.0;
        let mut before: Option<Vec<f64>> = None;
        for solutions in 1.. {
            let mut model = Model::new(&problem, &self.image.moved(&offsets)?)?;
            model.move_by(&offsets);
            let mut state = State::new(&model);
            state.displacement = offsets.iter().map(|w| -w).collect();
            let mut within = Within { observer: self.observer };
            let summary = simulate(&model, &problem.motion, &mut state, &mut within)?;
            let left: Vec<f64> =
                offsets.iter().zip(&state.displacement).map(|(w, u)| w + u).collect();
            let distance = self.distance(&left, &state.displacement);
            self.distances.push(distance);
            let round_off = ROUND_OFF * model.extent;
            let found = distance.largest <= (tolerance * distance.displacement).max(round_off);
            let stopped = summary.stopped
                || (!found
                    && self.observer.iterate(fraction, self.distances.len()) == Continue::Stop);
            if found || stopped || solutions == most {
                return Ok(Tried { offsets, model, state, summary, found, stopped });
            }
            if let Some(before) = &before {
                let change: Vec<f64> = left.iter().zip(before).map(|(r, b)| r - b).collect();
                let size = dot(&change, &change).max(f64::MIN_POSITIVE);
                factor = (-factor * dot(before, &change) / size).clamp(FACTORS.0, FACTORS.1);
            }
            offsets.iter_mut().zip(&left).for_each(|(w, r)| *w -= factor * r);
            before = Some(left);
        }
        unreachable!("the last solution returns")
    }

    fn end(self, last: Tried) -> Unloaded {
        let Tried { offsets, model, state, summary, found, stopped } = last;
        let (image, distances) = (self.image, self.distances);
        Unloaded { offsets, image, model, state, summary, distances, found, stopped }
    }

    fn distance(&self, left: &[f64], displacement: &[f64]) -> Distance {
        let d = self.problem.dimension.components();
        let values = |field: &[f64]| -> Vec<f64> {
            (0..self.rows.len()).map(|node| self.rows.interpolate(node, field, d).norm()).collect()
        };
        let (away, displacement) = (values(left), largest(&values(displacement)));
        let mean = (dot(&away, &away) / away.len() as f64).sqrt();
        Distance { largest: largest(&away), mean, displacement }
    }
}

/// A problem with a fraction of its loads, by Newton's method.
fn part_of(problem: &Problem, fraction: f64) -> Problem {
    let mut part = problem.clone();
    for force in &mut part.loads.body_forces {
        if let Field::Uniform(acceleration) = &mut force.acceleration {
            *acceleration *= fraction;
        }
    }
    part.loads.pressures.iter_mut().for_each(|pressure| pressure.pressure *= fraction);
    if let Motion::Static(settings) | Motion::Relaxed(settings) = problem.motion {
        part.motion = Motion::Newton(settings.newton());
    }
    part
}

/// Passes on whether to go on, and nothing else.
struct Within<'a> {
    observer: &'a mut dyn Observer,
}

impl Observer for Within<'_> {
    fn observe(&mut self, _: &mut View) -> Continue {
        Continue::Yes
    }

    fn iterate(&mut self, progress: f64, corrections: usize) -> Continue {
        self.observer.iterate(progress, corrections)
    }
}

/// Refuses problems whose loads or materials are not those of a shape to come.
fn refuse_others(problem: &Problem) -> Result<(), Error> {
    let loads = &problem.loads;
    let is_still = |prescribed: &Prescribed| match prescribed {
        Prescribed::Displacement(values) => values.iter().flatten().all(|value| *value == 0.0),
        Prescribed::Rotation { angle, .. } => *angle == 0.0,
        Prescribed::Field(_) => false,
    };
    let is_local = |field: &Field| !matches!(field, Field::Uniform(_));
    let filled = loads.cavities.iter().any(|cavity| cavity.fluid.is_some());
    let body_forces = loads.body_forces.iter();
    let local = body_forces
        .clone()
        .any(|force| is_local(&force.acceleration) || !force.part.is_everything());
    let fibrous = problem.regions.iter().any(|region| region.fibres.is_some());
    let moving = problem.conditions.iter().any(|condition| !is_still(&condition.prescribed));
    let what = [
        (matches!(problem.motion, Motion::Dynamic { .. }), "motions in time"),
        (!problem.obstacles.is_empty(), "obstacles"),
        (!loads.tractions.is_empty(), "tractions, whose areas are those without loads"),
        (!loads.springs.is_empty(), "springs, which pull on no known shape"),
        (filled, "fluids in cavities, whose volumes without loads are not known"),
        (local, "body forces on a part or by a formula"),
        (moving, "prescribed displacements other than 0"),
        (fibrous, "fibres, whose directions are those without loads"),
        (problem.has_memory(), "viscosity"),
        (body_forces.len() + loads.pressures.len() == 0, "bodies without loads"),
    ];
    match what.into_iter().find(|(is, _)| *is) {
        Some((_, what)) => Err(Error::NotUnloaded { what }),
        None => Ok(()),
    }
}
