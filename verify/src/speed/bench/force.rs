//! The internal force against the plain loop and the bandwidth of memory.

use super::limits::Triad;
use super::plain::PlainLoop;
use super::pose::{Place, Subject, cube, pointwise};
use super::turns::{Clock, Piece, Turns, in_turns};
use crate::specimens::simple::Random;
use anyhow::ensure;
use mtled::discretisation::Discretisation;
use mtled::problem::{Cloud, GradientStorage, Problem};
use rayon::ThreadPool;
use serde::Serialize;

/// One evaluation of the internal force on one thread.
#[derive(Debug, Clone, Serialize)]
pub struct ForceRow {
    pub place: &'static str,
    /// Whether J is projected on patches.
    pub projected: bool,
    pub points: usize,
    pub nodes: usize,
    /// Mean number of nodes per support.
    pub neighbours: f64,
    pub bytes: usize,
    pub nanoseconds_per_neighbour: f64,
    pub plain_nanoseconds_per_neighbour: f64,
    /// Time of the plain loop over that of the solver, of the same rounds.
    pub plain_over_solver: f64,
    pub bytes_per_second: f64,
    /// Of the triad of the same rounds, where memory is what limits.
    pub share_of_triad: Option<f64>,
}

/// Operations per point and neighbour: nine multiply-adds for F and nine for
/// the force. What the law takes per point is not counted.
const OPERATIONS: f64 = 36.0;

impl ForceRow {
    /// Share of a rate of multiply-adds \[flop/s\] that is used.
    pub fn share_of(&self, multiply_adds: f64) -> f64 {
        1e9 * OPERATIONS / self.nanoseconds_per_neighbour / multiply_adds
    }
}

/// Two ways of one evaluation against each other.
#[derive(Debug, Clone, Serialize)]
pub struct RatioRow {
    pub what: &'static str,
    pub points: usize,
    pub neighbours: f64,
    /// Seconds of one evaluation of the first and of the second.
    pub seconds: [f64; 2],
    /// The first over the second, of the same rounds.
    pub ratio: f64,
}

/// What is the same for all measurements.
pub struct Settings {
    pub rounds: usize,
    pub quick: bool,
    pub one: ThreadPool,
    pub all: ThreadPool,
}

/// Measures one size and support, the triad beside it where it leaves the caches.
pub fn force_row(
    settings: &Settings,
    place: Place,
    wanted: f64,
    projected: bool,
    triad: &mut Triad,
) -> anyhow::Result<ForceRow> {
    let mut problem = cube(place.cells(wanted, settings.quick), wanted);
    if !projected {
        problem = pointwise(problem);
    }
    let discretisation = Discretisation::new(&problem)?;
    let mut subject = Subject::new(&problem, &discretisation)?;
    let mut plain = PlainLoop::new(&problem, &discretisation);
    let (u, mut f) = (subject.u.clone(), subject.f.clone());
    let turns = settings.one.install(|| {
        let mut pass = || triad.pass();
        let mut pieces: Vec<Piece> = Vec::new();
        let mut evaluate = || subject.evaluate();
        let mut yardstick = || plain.internal_force(&u, &mut f);
        pieces.push(&mut evaluate);
        pieces.push(&mut yardstick);
        if place == Place::Memory {
            pieces.push(&mut pass);
        }
        in_turns(Clock::Processor, settings.rounds, &mut pieces)
    });
    same_force(&subject.f, &f, 1e-9)?;
    let (bytes, entries) = (subject.model.bytes_per_step(), discretisation.supports.nodes.len());
    let per_second = bytes as f64 / turns.median(0);
    let share = |turns: &Turns| turns.ratio(2, 0) * bytes as f64 / triad.bytes() as f64;
    Ok(ForceRow {
        place: place.name(),
        projected,
        points: discretisation.supports.len(),
        nodes: subject.model.positions.len(),
        neighbours: discretisation.mean_support(),
        bytes,
        nanoseconds_per_neighbour: 1e9 * turns.median(0) / entries as f64,
        plain_nanoseconds_per_neighbour: 1e9 * turns.median(1) / entries as f64,
        plain_over_solver: turns.ratio(1, 0),
        bytes_per_second: per_second,
        share_of_triad: (place == Place::Memory).then(|| share(&turns)),
    })
}

/// A yardstick that does other work would measure nothing.
fn same_force(f: &[f64], yardstick: &[f64], tolerance: f64) -> anyhow::Result<()> {
    let largest = yardstick.iter().fold(0.0f64, |a, x| a.max(x.abs()));
    let off = f.iter().zip(yardstick).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    ensure!(
        largest.is_finite() && largest > 0.0 && off <= tolerance * largest,
        "the force and the one that it is compared with differ by {off:.1e} of {largest:.1e} N"
    );
    Ok(())
}

/// One thread against all.
pub fn threads_row(settings: &Settings, place: Place, wanted: f64) -> anyhow::Result<RatioRow> {
    let problem = cube(place.cells(wanted, settings.quick), wanted);
    let discretisation = Discretisation::new(&problem)?;
    let mut first = Subject::new(&problem, &discretisation)?;
    let mut second = Subject::new(&problem, &discretisation)?;
    let turns = in_turns(
        Clock::Wall,
        settings.rounds,
        &mut [&mut || settings.one.install(|| first.evaluate()), &mut || {
            settings.all.install(|| second.evaluate())
        }],
    );
    ensure!(first.f == second.f, "the internal force depends on the number of threads");
    Ok(ratio_row("one thread over all", &discretisation, &turns))
}

/// Gradients held in double precision against single.
pub fn storage_row(settings: &Settings, place: Place, wanted: f64) -> anyhow::Result<RatioRow> {
    let problem = cube(place.cells(wanted, settings.quick), wanted);
    let mut halved = problem.clone();
    halved.recipe.gradient_storage = GradientStorage::Single;
    let discretisation = Discretisation::new(&problem)?;
    let mut first = Subject::new(&problem, &discretisation)?;
    let mut second = Subject::new(&halved, &discretisation)?;
    let turns = settings.one.install(|| {
        let pieces: &mut [Piece] = &mut [&mut || first.evaluate(), &mut || second.evaluate()];
        in_turns(Clock::Processor, settings.rounds, pieces)
    });
    same_force(&second.f, &first.f, 1e-5)?;
    Ok(ratio_row("gradients in double over single precision", &discretisation, &turns))
}

/// Nodes given in random order against the same nodes sorted.
pub fn order_row(settings: &Settings, place: Place, wanted: f64) -> anyhow::Result<RatioRow> {
    let sorted = given(place.cells(wanted, settings.quick), wanted)?;
    let mut shuffled = sorted.clone();
    if let Cloud::Given { nodes } = &mut shuffled.recipe.cloud {
        let mut random = Random(7);
        for i in (1..nodes.len()).rev() {
            let other = (0.5 * (random.symmetric() + 1.0) * (i + 1) as f64) as usize;
            nodes.swap(i, other.min(i));
        }
    }
    let discretisation = Discretisation::new(&shuffled)?;
    let mut first = Subject::new(&shuffled, &discretisation)?;
    let mut second = Subject::new(&sorted, &Discretisation::new(&sorted)?)?;
    let turns = settings.one.install(|| {
        let pieces: &mut [Piece] = &mut [&mut || first.evaluate(), &mut || second.evaluate()];
        in_turns(Clock::Processor, settings.rounds, pieces)
    });
    Ok(ratio_row("shuffled nodes over sorted ones", &discretisation, &turns))
}

/// The cube with its nodes given one by one.
fn given(cells: usize, wanted: f64) -> anyhow::Result<Problem> {
    let mut problem = cube(cells, wanted);
    let (body, recipe) = (&problem.body, &mut problem.recipe);
    let nodes = mtled::discretisation::nodes::node_cloud(body, &recipe.cloud, &problem.dimension)?
        .positions;
    recipe.cloud = Cloud::Given { nodes };
    Ok(problem)
}

fn ratio_row(what: &'static str, discretisation: &Discretisation, turns: &Turns) -> RatioRow {
    RatioRow {
        what,
        points: discretisation.supports.len(),
        neighbours: discretisation.mean_support(),
        seconds: [turns.median(0), turns.median(1)],
        ratio: turns.ratio(0, 1),
    }
}
