//! The observer that samples probes, reactions, energies and frames.

use super::{MassCentre, Prepared, centres_of_mass, interrupted};
use crate::scene::{Case, ProbeKind};
use mtled::algebra::tensor::Vector3;
use mtled::discretisation::Rows;
use mtled::error::Error;
use mtled::model::essential::Reaction;
use mtled::motion::energy::Energies;
use mtled::motion::observe::{Continue, Observer, View};

/// Everything that was recorded, complete up to the last sample.
#[derive(Debug, Clone, Default)]
pub struct Record {
    /// Per probe: its reference positions \[m\].
    pub references: Vec<Vec<Vector3>>,
    pub samples: Vec<Sample>,
    pub frames: Vec<Frame>,
}

/// What was seen at one instant.
#[derive(Debug, Clone)]
pub struct Sample {
    pub step: usize,
    /// \[s\]
    pub time: f64,
    /// Displacement per probe and position \[m\].
    pub displacements: Vec<Vec<Vector3>>,
    /// Per condition of the problem.
    pub reactions: Vec<Reaction>,
    pub energies: Energies,
    /// \[–\]
    pub smallest_jacobian: f64,
    /// Nodes that touch an obstacle.
    pub touching: usize,
}

/// Nodal parameters at one instant \[m\].
#[derive(Debug, Clone)]
pub struct Frame {
    pub step: usize,
    /// \[s\]
    pub time: f64,
    pub displacement: Vec<f64>,
}

enum Watched {
    Points(Rows),
    Centre(MassCentre),
}

/// Samples a run at equal shares of its progress and at its end.
pub struct Recorder<'a> {
    probes: Vec<Watched>,
    components: usize,
    moment_about: Vector3,
    samples_wanted: usize,
    frames_wanted: usize,
    record: Record,
    progress: Option<&'a dyn Fn(f64, usize)>,
}

impl<'a> Recorder<'a> {
    /// Prepares the probes of a case; `frames` frames are kept.
    pub fn new(case: &Case, prepared: &Prepared, frames: usize) -> Result<Recorder<'a>, Error> {
        let discretisation = &prepared.discretisation;
        let centres = centres_of_mass(&case.problem, discretisation);
        let mut probes = Vec::new();
        let mut references = Vec::new();
        for probe in &case.probes {
            match &probe.kind {
                ProbeKind::CentreOfMass { region } => {
                    let named = case.problem.regions.iter().position(|r| &r.name == region);
                    let centre = centres[named.unwrap_or_default()].clone();
                    references.push(vec![centre.reference]);
                    probes.push(Watched::Centre(centre));
                }
                kind => {
                    let positions = kind.positions();
                    probes.push(Watched::Points(discretisation.rows_at(&positions)?));
                    references.push(positions);
                }
            }
        }
        Ok(Recorder {
            probes,
            components: prepared.model.components,
            moment_about: case.outputs.moment_about,
            samples_wanted: case.outputs.history.max(1),
            frames_wanted: frames,
            record: Record { references, ..Record::default() },
            progress: None,
        })
    }

    /// Calls `report(progress, step)` as the run goes on.
    pub fn with_progress(mut self, report: &'a dyn Fn(f64, usize)) -> Recorder<'a> {
        self.progress = Some(report);
        self
    }

    /// Hands over what was recorded.
    pub fn finish(self) -> Record {
        self.record
    }

    fn sample(&self, view: &View, energies: Energies) -> Sample {
        let u = &view.state.displacement;
        let displacements = self.probes.iter().map(|probe| match probe {
            Watched::Points(rows) => {
                (0..rows.len()).map(|i| rows.interpolate(i, u, self.components)).collect()
            }
            Watched::Centre(centre) => vec![centre.displacement(u, self.components)],
        });
        Sample {
            step: view.state.step,
            time: view.state.time,
            displacements: displacements.collect(),
            reactions: view.reactions(&self.moment_about),
            energies,
            smallest_jacobian: view.smallest_jacobian,
            touching: view.state.contact.touching.len(),
        }
    }
}

impl Observer for Recorder<'_> {
    fn observe(&mut self, view: &mut View) -> Continue {
        let stop = interrupted();
        let last = stop || view.progress >= 1.0;
        let due = |done: usize, wanted: usize| {
            wanted > 0 && (last || view.progress * wanted as f64 >= done as f64)
        };
        let frame = due(self.record.frames.len(), self.frames_wanted);
        let sample = due(self.record.samples.len(), self.samples_wanted);
        // A state that has just lost its energy is seen by the next step; it
        // must not stand among the results.
        let energies = (frame || sample).then(|| view.energies());
        if let Some(energies) = energies.filter(|energies| energies.strain.is_finite()) {
            if frame {
                self.record.frames.push(Frame {
                    step: view.state.step,
                    time: view.state.time,
                    displacement: view.state.displacement.clone(),
                });
            }
            if sample {
                let sample = self.sample(view, energies);
                self.record.samples.push(sample);
            }
        }
        if let Some(report) = self.progress {
            report(view.progress, view.state.step);
        }
        if stop { Continue::Stop } else { Continue::Yes }
    }

    fn tracks_work(&self) -> bool {
        true
    }
}
