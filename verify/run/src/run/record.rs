//! The observer that samples probes, reactions, energies and frames.

use super::interrupt::interrupted;
use super::probes::{MassCentre, centres_of_mass};
use super::saved_state::SavedState;
use mtled::Simulation;
use mtled::algebra::tensor::Vector3;
use mtled::discretisation::Rows;
use mtled::error::Error;
use mtled::force::point_volumes;
use mtled::model::CavityState;
use mtled::model::contact::ContactForce;
use mtled::model::essential::Reaction;
use mtled::motion::energy::{Energies, Momenta};
use mtled::motion::observe::{Continue, Observer, View};
use mtled_case::scene::{Case, ProbeKind};

/// Samples and frames of a run up to its last sample.
#[derive(Debug, Clone, Default)]
pub struct Recording {
    /// Per probe: its reference positions \[m\].
    pub references: Vec<Vec<Vector3>>,
    /// In the order of time.
    pub samples: Vec<Sample>,
    /// In the order of time.
    pub frames: Vec<Frame>,
    /// States from which a motion can be continued.
    pub states: Vec<SavedState>,
    /// The motion in which the body is unstable, if it is \[component of node\] \[–\].
    pub unstable_mode: Option<Vec<f64>>,
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
    /// About the place that moments are about.
    pub momenta: Momenta,
    /// Smallest J of the quadrature points \[–\].
    pub smallest_jacobian: f64,
    /// Nodes that touch an obstacle.
    pub touching: usize,
    /// What each obstacle exerts on the body \[N\].
    pub contact_forces: Vec<Vector3>,
    /// What each spring exerts on the body \[N\].
    pub spring_forces: Vec<Vector3>,
    /// Of each cavity of the problem.
    pub cavities: Vec<CavityState>,
    /// Of each region \[m³\]; nothing where they are not asked for.
    pub region_volumes: Vec<f64>,
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
    /// What obstacles exert on nodes.
    pub contact: Vec<ContactForce>,
    /// Second Piola–Kirchhoff stress beside that of the laws \[point\]\[xx, yy, zz, xy, yz, xz\]
    /// \[Pa\]; nothing where no material has any.
    pub extra_stress: Vec<[f64; 6]>,
}

/// A probe as the recorder evaluates it.
enum Evaluator {
    Points(Rows),
    Centre(MassCentre),
}

/// Progress at which a run may end, and share of a time at which it is reached \[–\]: time
/// steps sum up to the end but for round-off.
const FULL: f64 = 1.0 - 1e-12;

/// States of a run at equal parts of its progress, the first and the last among them: at
/// most one more than `parts`, however many steps the run takes and however its progress
/// goes up and down.
#[derive(Debug)]
struct Series<T> {
    parts: usize,
    kept: Vec<T>,
    /// Those that were asked for by their time, besides the equal parts.
    asked: usize,
    /// Whether the last that is kept was taken at full progress. A run that goes on all the
    /// same, such as a relaxation whose residual is still too large, replaces it.
    full: bool,
}

impl<T> Series<T> {
    fn new(parts: usize) -> Series<T> {
        Series { parts, kept: Vec::new(), asked: 0, full: false }
    }

    /// Whether a state at this progress \[–\] is to be kept; `last` after which the run stops.
    fn is_due(&self, progress: f64, last: bool) -> bool {
        let (parts, kept) = (self.parts as f64, (self.kept.len() - self.asked) as f64);
        let next = kept < parts && progress * parts >= kept;
        self.parts > 0 && (last || progress >= FULL || next)
    }

    /// Keeps a state, `due` by its progress or asked for by its time.
    fn keep(&mut self, item: T, progress: f64, due: bool) {
        if self.full {
            self.kept.pop();
        }
        self.full = progress >= FULL;
        self.asked += !due as usize;
        self.kept.push(item);
    }
}

/// Samples a run at equal parts of its progress and at its end.
pub struct Recorder<'a> {
    probes: Vec<Evaluator>,
    components: usize,
    obstacles: usize,
    moment_about: Vector3,
    /// Of each quadrature point, where their volumes are recorded, and their number.
    regions: Option<(Vec<u16>, usize)>,
    references: Vec<Vec<Vector3>>,
    samples: Series<Sample>,
    frames: Series<Frame>,
    /// At which a frame and a sample are taken, and how many of them have been \[s\].
    times: Vec<f64>,
    reached: usize,
    /// At which states are saved \[s\].
    saves: Vec<f64>,
    states: Vec<SavedState>,
    progress: Option<&'a dyn Fn(f64, usize) -> Continue>,
}

impl<'a> Recorder<'a> {
    /// Prepares the probes of a case; at most `frames` frames are recorded after the first.
    pub fn new(case: &Case, simulation: &Simulation, frames: usize) -> Result<Recorder<'a>, Error> {
        let discretisation = &simulation.discretisation;
        let centres = centres_of_mass(&case.problem, discretisation);
        let mut probes = Vec::new();
        let mut references = Vec::new();
        for probe in &case.probes {
            match &probe.kind {
                ProbeKind::CentreOfMass { region } => {
                    let named = case.problem.regions.iter().position(|r| &r.name == region);
                    let centre = centres[named.unwrap_or_default()].clone();
                    if centre.mass == 0.0 {
                        return Err(Error::EmptyRegion { name: region.clone() });
                    }
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
        let start = simulation.state.time;
        let left = |times: &[f64]| -> Vec<f64> {
            times.iter().copied().filter(|time| start < FULL * time).collect()
        };
        Ok(Recorder {
            probes,
            components: simulation.model.components,
            obstacles: simulation.model.contact.obstacles.len(),
            moment_about: case.outputs.moment_about,
            regions: (case.outputs.volumes)
                .then(|| (discretisation.quadrature.regions.clone(), case.problem.regions.len())),
            references,
            samples: Series::new(case.outputs.history.max(1)),
            // Besides those at given times only the first state and the last.
            frames: Series::new(if case.outputs.times.is_empty() { frames } else { frames.min(1) }),
            times: left(&case.outputs.times),
            reached: 0,
            saves: left(&case.outputs.states),
            states: Vec::new(),
            progress: None,
        })
    }

    /// Calls `report(progress, step)` during the run, which it can end.
    pub(crate) fn with_progress(
        mut self,
        report: &'a dyn Fn(f64, usize) -> Continue,
    ) -> Recorder<'a> {
        self.progress = Some(report);
        self
    }

    /// The recording.
    pub fn finish(self) -> Recording {
        let Recorder { references, samples, frames, states, .. } = self;
        let (samples, frames) = (samples.kept, frames.kept);
        Recording { references, samples, frames, states, unstable_mode: None }
    }

    /// Whether the run is to end.
    fn is_stopped(&self, progress: f64, step: usize) -> bool {
        let reported = self.progress.map(|report| report(progress, step));
        interrupted() || reported == Some(Continue::Stop)
    }

    fn region_volumes(&self, view: &View) -> Vec<f64> {
        let Some((regions, count)) = &self.regions else { return Vec::new() };
        let mut volumes = vec![0.0; *count];
        let points = point_volumes(&view.model.points, &view.state.displacement);
        regions.iter().zip(points).for_each(|(region, own)| volumes[*region as usize] += own);
        volumes
    }

    fn sample(&self, view: &View, energies: Energies) -> Sample {
        let u = &view.state.displacement;
        let displacements = self.probes.iter().map(|probe| match probe {
            Evaluator::Points(rows) => {
                (0..rows.len()).map(|i| rows.interpolate(i, u, self.components)).collect()
            }
            Evaluator::Centre(centre) => vec![centre.displacement(u, self.components)],
        });
        let mut contact_forces = vec![Vector3::zeros(); self.obstacles];
        for contact in view.state.contact_forces() {
            contact_forces[contact.obstacle as usize] += contact.force;
        }
        Sample {
            step: view.state.step,
            time: view.state.time,
            displacements: displacements.collect(),
            reactions: view.reactions(&self.moment_about),
            energies,
            momenta: view.momenta(&self.moment_about),
            smallest_jacobian: view.smallest_jacobian,
            touching: view.state.contact.touching.len(),
            contact_forces,
            spring_forces: view.spring_forces(),
            cavities: view.cavities(),
            region_volumes: self.region_volumes(view),
        }
    }
}

impl Observer for Recorder<'_> {
    fn observe(&mut self, view: &mut View) -> Continue {
        let stop = self.is_stopped(view.progress, view.state.step);
        let before = self.reached;
        while self.times.get(self.reached).is_some_and(|time| view.state.time >= FULL * time) {
            self.reached += 1;
        }
        let asked = self.reached > before;
        let frame_due = self.frames.is_due(view.progress, stop);
        let sample_due = self.samples.is_due(view.progress, stop);
        let frame = frame_due || (asked && self.frames.parts > 0);
        let sample = sample_due || asked;
        // A state whose energy is no number fails in the next step and is not a result.
        let energies = (frame || sample).then(|| view.energies());
        if let Some(energies) = energies.filter(is_finite) {
            if frame {
                let frame = Frame {
                    step: view.state.step,
                    time: view.state.time,
                    displacement: view.state.displacement.clone(),
                    contact: view.state.contact_forces(),
                    extra_stress: view.state.extra.stresses(view.model),
                };
                self.frames.keep(frame, view.progress, frame_due);
            }
            if sample {
                let sample = self.sample(view, energies);
                self.samples.keep(sample, view.progress, sample_due);
            }
        }
        if stop { Continue::Stop } else { Continue::Yes }
    }

    fn iterate(&mut self, progress: f64, corrections: usize) -> Continue {
        if self.is_stopped(progress, corrections) { Continue::Stop } else { Continue::Yes }
    }

    fn awaited_time(&self) -> Option<f64> {
        let save = self.saves.get(self.states.len());
        let next = [self.times.get(self.reached), save].into_iter().flatten().copied();
        next.reduce(f64::min)
    }

    fn checkpoint(&mut self, view: &View) -> bool {
        let due = |saved: usize| self.saves.get(saved).is_some_and(|t| view.state.time >= FULL * t);
        if !due(self.states.len()) {
            return false;
        }
        self.states.push(SavedState::new(view.model, view.state));
        true
    }

    fn restart(&mut self) {
        self.samples = Series::new(self.samples.parts);
        self.frames = Series::new(self.frames.parts);
    }

    fn tracks_work(&self) -> bool {
        true
    }
}

fn is_finite(e: &Energies) -> bool {
    [e.kinetic, e.strain, e.external_work, e.constraint_work, e.damping_loss, e.extra_work]
        .iter()
        .all(|energy| energy.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers of the steps that are kept of a run with this progress after each step.
    fn kept(parts: usize, progress: &[f64]) -> Vec<usize> {
        let mut series = Series::new(parts);
        for (step, &progress) in progress.iter().enumerate() {
            if series.is_due(progress, false) {
                series.keep(step, progress, true);
            }
        }
        series.kept
    }

    #[test]
    fn states_are_kept_at_equal_parts_of_the_progress() {
        let steps: Vec<f64> = (0..=100).map(|n| n as f64 / 100.0).collect();
        assert_eq!(kept(4, &steps), [0, 25, 50, 75, 100]);
        assert_eq!(kept(1, &steps), [0, 100]);
        assert_eq!(kept(0, &steps), [0; 0]);
        // Time steps that sum up to the end but for round-off.
        assert_eq!(kept(2, &[0.0, 0.3, 0.6, 1.0 - f64::EPSILON]), [0, 2, 3]);
        // All the load in one increment.
        assert_eq!(kept(20, &[0.0, 1.0]), [0, 1]);
    }

    #[test]
    fn a_state_asked_for_by_its_time_takes_the_place_of_no_other() {
        let mut series = Series::new(4);
        for step in 0..=100 {
            let progress = step as f64 / 100.0;
            let due = series.is_due(progress, false);
            if due || [10, 50, 60].contains(&step) {
                series.keep(step, progress, due);
            }
        }
        assert_eq!(series.kept, [0, 10, 25, 50, 60, 75, 100]);
    }

    #[test]
    fn a_run_that_goes_on_at_full_progress_keeps_its_first_and_its_last_state() {
        let mut progress: Vec<f64> = (0..=10).map(|n| n as f64 / 10.0).collect();
        progress.extend([1.0; 4000]);
        assert_eq!(kept(5, &progress), [0, 2, 4, 6, 8, 4010]);
    }

    #[test]
    fn progress_that_goes_up_and_down_keeps_no_more_states() {
        let mut progress = vec![0.0];
        progress.extend((0..4000).map(|n| [0.5, 1.0, 0.99, 0.2][n % 4]));
        progress.push(1.0);
        for parts in [1, 2, 20] {
            let kept = kept(parts, &progress);
            assert!(kept.len() <= parts + 1, "{parts}: {}", kept.len());
            assert_eq!((kept[0], kept.last()), (0, Some(&4001)));
            assert!(kept.is_sorted());
        }
    }
}
