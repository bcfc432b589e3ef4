//! The audit of a run: what was asked beside what was done (method book, section 28).
//!
//! What was asked comes from the statement of the problem: its shapes, by their signed
//! distance, its selections, amplitudes and values. What was done comes from the nodes, the
//! quadrature points, the loads at nodes and the state at the end. The two meet here only.

#![allow(non_snake_case)]

mod balance;
mod inside;
mod loads;
mod masses;
mod places;
mod prescribed;
mod row;
mod sampling;
#[cfg(test)]
mod tests;

pub use row::{Figure, Kind, Row};

use crate::algebra::tensor::Vector3;
use crate::discretisation::Discretisation;
use crate::error::Error;
use crate::geometry::Shape;
use crate::model::Model;
use crate::motion::state::State;
use crate::problem::{Dimension, Motion, Problem};
use sampling::{Divided, Sampled, sample};

/// The table of a run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Audit {
    /// What was compared.
    pub rows: Vec<Row>,
}

impl Audit {
    /// The rows that are a reason to doubt the run.
    pub fn doubts(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| row.exceeds())
    }

    /// Whether the run is doubtful.
    pub fn is_doubtful(&self) -> bool {
        self.doubts().next().is_some()
    }
}

/// What the rows are made from.
struct Run<'a> {
    problem: &'a Problem,
    discretisation: &'a Discretisation,
    model: &'a Model,
    state: &'a State,
    /// In a plane the section.
    body: &'a Shape,
    sampled: &'a Sampled,
    /// Mean nodal spacing \[m\].
    spacing: f64,
    /// Of conditions and loads at the end \[s\].
    time: f64,
    /// Centre of the body \[m\].
    centre: Vector3,
}

/// Compares what a problem asks with what a run that came to its end has done.
pub fn audit(
    problem: &Problem,
    discretisation: &Discretisation,
    model: &Model,
    state: &State,
) -> Result<Audit, Error> {
    let cloud = &discretisation.cloud;
    let spacing = cloud.mean_spacing();
    let body = problem.body.section(&problem.dimension)?;
    let divided = Divided {
        body: &body,
        dimension: &problem.dimension,
        parts: problem.regions.iter().map(|region| &region.part).collect(),
        spacing,
        nodes: cloud.positions.len(),
    };
    let sampled = sample(&divided)?;
    let first: Vector3 = sampled.volumes.iter().map(|part| part.first).sum();
    let run = Run {
        problem,
        discretisation,
        model,
        state,
        body: &body,
        sampled: &sampled,
        spacing,
        time: match problem.motion {
            Motion::Dynamic { .. } => state.time,
            _ => problem.motion.end(),
        },
        centre: first / sampled.volume(),
    };
    let mut rows = run.prescribed()?;
    rows.extend(run.loads()?);
    rows.extend(run.springs());
    rows.extend(run.cavities());
    rows.extend(run.forces());
    rows.push(run.internal_work());
    rows.extend(run.masses());
    rows.extend(run.energy());
    rows.extend(run.edges());
    rows.extend(run.gaps()?);
    rows.extend(run.layers());
    rows.extend(run.depths()?);
    rows.extend(run.patch_volumes());
    Ok(Audit { rows })
}

impl Run<'_> {
    /// Whether the problem is one of motion.
    fn moves(&self) -> bool {
        matches!(self.problem.motion, Motion::Dynamic { .. })
    }

    /// The place at which shapes are asked: in a plane nothing depends on z.
    fn at(&self, mut X: Vector3) -> Vector3 {
        if let Dimension::PlaneStrain { z, .. } = self.problem.dimension {
            X.z = z;
        }
        X
    }

    /// Size of the body \[m\].
    fn extent(&self) -> f64 {
        self.model.extent
    }
}
