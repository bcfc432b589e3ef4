//! The observer that samples probes, reactions, energies and frames.

use super::interrupt::interrupted;
use super::prepare::Prepared;
use super::probes::{MassCentre, centres_of_mass};
use crate::scene::{Case, ProbeKind};
use mtled::algebra::tensor::Vector3;
use mtled::discretisation::Rows;
use mtled::error::Error;
use mtled::model::essential::Reaction;
use mtled::motion::energy::Energies;
use mtled::motion::observe::{Continue, Observer, View};

/// Samples and frames of a run up to its last sample.
#[derive(Debug, Clone, Default)]
pub struct Recording {
    /// Per probe: its reference positions \[m\].
    pub references: Vec<Vec<Vector3>>,
    /// In the order of time.
    pub samples: Vec<Sample>,
    /// In the order of time.
    pub frames: Vec<Frame>,
}

/// Probes, reactions and energies at one instant.
#[derive(Debug, Clone)]
pub struct Sample {
    /// Number of time steps before it.
    pub step: usize,
    /// \[s\]
    pub time: f64,
    /// Displacement per probe and position \[m\].
    pub displacements: Vec<Vec<Vector3>>,
    /// Per condition of the problem.
    pub reactions: Vec<Reaction>,
    /// Energies and works \[J\].
    pub energies: Energies,
    /// Smallest J of the quadrature points \[–\].
    pub smallest_jacobian: f64,
    /// Nodes that touch an obstacle.
    pub touching: usize,
}

/// Nodal parameters at one instant \[m\].
#[derive(Debug, Clone)]
pub struct Frame {
    /// Number of time steps before it.
    pub step: usize,
    /// \[s\]
    pub time: f64,
    /// \[node\]\[component\]
    pub displacement: Vec<f64>,
}

/// A probe as the recorder evaluates it.
enum Evaluator {
    Points(Rows),
    Centre(MassCentre),
}

/// Samples a run at equal parts of its progress and at its end.
pub struct Recorder<'a> {
    probes: Vec<Evaluator>,
    components: usize,
    moment_about: Vector3,
    samples_requested: usize,
    frames_requested: usize,
    recording: Recording,
    progress: Option<&'a dyn Fn(f64, usize)>,
}

impl<'a> Recorder<'a> {
    /// Prepares the probes of a case; `frames` frames are recorded.
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
                    probes.push(Evaluator::Centre(centre));
                }
                kind => {
                    let positions = kind.positions();
                    probes.push(Evaluator::Points(discretisation.rows_at(&positions)?));
                    references.push(positions);
                }
            }
        }
        Ok(Recorder {
            probes,
            components: prepared.model.components,
            moment_about: case.outputs.moment_about,
            samples_requested: case.outputs.history.max(1),
            frames_requested: frames,
            recording: Recording { references, ..Recording::default() },
            progress: None,
        })
    }

    /// Calls `report(progress, step)` during the run.
    pub fn with_progress(mut self, report: &'a dyn Fn(f64, usize)) -> Recorder<'a> {
        self.progress = Some(report);
        self
    }

    /// The recording.
    pub fn finish(self) -> Recording {
        self.recording
    }

    fn sample(&self, view: &View, energies: Energies) -> Sample {
        let u = &view.state.displacement;
        let displacements = self.probes.iter().map(|probe| match probe {
            Evaluator::Points(rows) => {
                (0..rows.len()).map(|i| rows.interpolate(i, u, self.components)).collect()
            }
            Evaluator::Centre(centre) => vec![centre.displacement(u, self.components)],
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
        let due = |done: usize, requested: usize| {
            requested > 0 && (last || view.progress * requested as f64 >= done as f64)
        };
        let frame = due(self.recording.frames.len(), self.frames_requested);
        let sample = due(self.recording.samples.len(), self.samples_requested);
        // A state whose energy is NaN fails in the next step and is not a result.
        let energies = (frame || sample).then(|| view.energies());
        if let Some(energies) = energies.filter(|energies| energies.strain.is_finite()) {
            if frame {
                self.recording.frames.push(Frame {
                    step: view.state.step,
                    time: view.state.time,
                    displacement: view.state.displacement.clone(),
                });
            }
            if sample {
                let sample = self.sample(view, energies);
                self.recording.samples.push(sample);
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
