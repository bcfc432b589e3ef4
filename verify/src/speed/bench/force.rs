//! The internal force beside the plain loop and the bandwidth of memory.

use super::alternation::{Alternation, Clock, Work, alternate};
use super::bodies::{DeformedModel, MemoryLevel, cube, pointwise};
use super::figures::{BenchSettings, ForceRow, RatioRow};
use super::limits::Triad;
use super::plain_loop::PlainLoop;
use anyhow::ensure;
use mtled::algebra::random::Random;
use mtled::discretisation::Discretisation;
use mtled::discretisation::nodes::node_cloud;
use mtled::problem::{Cloud, GradientStorage, Problem};

/// Measures one size and support, together with the triad where the data leave the caches.
pub fn force_row(
    settings: &BenchSettings,
    level: MemoryLevel,
    neighbours: f64,
    projected: bool,
    triad: &mut Triad,
) -> anyhow::Result<ForceRow> {
    let mut problem = cube(level.cells(neighbours, settings.quick), neighbours);
    if !projected {
        problem = pointwise(problem);
    }
    let discretisation = Discretisation::new(&problem)?;
    let mut model = DeformedModel::new(&problem, &discretisation)?;
    let mut plain = PlainLoop::new(&problem, &discretisation);
    let (u, mut f) = (model.u.clone(), model.f.clone());
    let times = settings.one.install(|| {
        let mut pass = || triad.pass();
        let mut evaluate = || model.evaluate();
        let mut evaluate_plainly = || plain.internal_force(&u, &mut f);
        let mut works: Vec<Work> = vec![&mut evaluate, &mut evaluate_plainly];
        if level == MemoryLevel::Memory {
            works.push(&mut pass);
        }
        alternate(Clock::Processor, settings.rounds, &mut works)
    });
    same_force(&model.f, &f, 1e-9)?;
    let (bytes, entries) = (model.model.bytes_per_step(), discretisation.supports.nodes.len());
    let per_second = bytes as f64 / times.median(0);
    let fraction = || times.ratio(2, 0) * bytes as f64 / triad.bytes() as f64;
    Ok(ForceRow {
        memory: level.name(),
        projected,
        points: discretisation.supports.len(),
        nodes: model.model.positions.len(),
        neighbours: discretisation.mean_support(),
        bytes,
        nanoseconds_per_neighbour: 1e9 * times.median(0) / entries as f64,
        plain_nanoseconds_per_neighbour: 1e9 * times.median(1) / entries as f64,
        plain_over_solver: times.ratio(1, 0),
        bytes_per_second: per_second,
        fraction_of_triad: (level == MemoryLevel::Memory).then(fraction),
    })
}

/// Refuses a comparison of different results.
fn same_force(f: &[f64], other: &[f64], tolerance: f64) -> anyhow::Result<()> {
    let largest = other.iter().fold(0.0f64, |a, x| a.max(x.abs()));
    let difference = f.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    ensure!(
        largest.is_finite() && largest > 0.0 && difference <= tolerance * largest,
        "two forces that are compared differ by {difference:.1e} of {largest:.1e} N"
    );
    Ok(())
}

/// One thread over all threads.
pub fn threads_row(
    settings: &BenchSettings,
    level: MemoryLevel,
    neighbours: f64,
) -> anyhow::Result<RatioRow> {
    let problem = cube(level.cells(neighbours, settings.quick), neighbours);
    let discretisation = Discretisation::new(&problem)?;
    let mut first = DeformedModel::new(&problem, &discretisation)?;
    let mut second = DeformedModel::new(&problem, &discretisation)?;
    let times = alternate(
        Clock::Wall,
        settings.rounds,
        &mut [&mut || settings.one.install(|| first.evaluate()), &mut || {
            settings.all.install(|| second.evaluate())
        }],
    );
    ensure!(first.f == second.f, "the internal force depends on the number of threads");
    Ok(ratio_row("one thread over all", &discretisation, &times))
}

/// Gradients stored in double over single precision.
pub fn storage_row(
    settings: &BenchSettings,
    level: MemoryLevel,
    neighbours: f64,
) -> anyhow::Result<RatioRow> {
    let problem = cube(level.cells(neighbours, settings.quick), neighbours);
    let mut single = problem.clone();
    single.recipe.gradient_storage = GradientStorage::Single;
    let discretisation = Discretisation::new(&problem)?;
    let mut first = DeformedModel::new(&problem, &discretisation)?;
    let mut second = DeformedModel::new(&single, &discretisation)?;
    let times = evaluations(settings, &mut first, &mut second);
    same_force(&second.f, &first.f, 1e-5)?;
    Ok(ratio_row("gradients in double over single precision", &discretisation, &times))
}

/// Nodes given in random order over the same nodes sorted.
pub fn order_row(
    settings: &BenchSettings,
    level: MemoryLevel,
    neighbours: f64,
) -> anyhow::Result<RatioRow> {
    let sorted = given(level.cells(neighbours, settings.quick), neighbours)?;
    let mut shuffled = sorted.clone();
    if let Cloud::Given { nodes } = &mut shuffled.recipe.cloud {
        let mut random = Random(7);
        for i in (1..nodes.len()).rev() {
            let other = (0.5 * (random.symmetric() + 1.0) * (i + 1) as f64) as usize;
            nodes.swap(i, other.min(i));
        }
    }
    let discretisation = Discretisation::new(&shuffled)?;
    let mut first = DeformedModel::new(&shuffled, &discretisation)?;
    let mut second = DeformedModel::new(&sorted, &Discretisation::new(&sorted)?)?;
    let times = evaluations(settings, &mut first, &mut second);
    Ok(ratio_row("shuffled nodes over sorted ones", &discretisation, &times))
}

/// The cube with given nodes.
fn given(cells: usize, neighbours: f64) -> anyhow::Result<Problem> {
    let mut problem = cube(cells, neighbours);
    let (body, recipe) = (&problem.body, &mut problem.recipe);
    let nodes = node_cloud(body, &recipe.cloud, &problem.dimension)?.positions;
    recipe.cloud = Cloud::Given { nodes };
    Ok(problem)
}

/// Alternate evaluations of two models on one thread.
fn evaluations(
    settings: &BenchSettings,
    first: &mut DeformedModel,
    second: &mut DeformedModel,
) -> Alternation {
    let works: &mut [Work] = &mut [&mut || first.evaluate(), &mut || second.evaluate()];
    settings.one.install(|| alternate(Clock::Processor, settings.rounds, works))
}

fn ratio_row(
    label: &'static str,
    discretisation: &Discretisation,
    times: &Alternation,
) -> RatioRow {
    RatioRow {
        label,
        points: discretisation.supports.len(),
        neighbours: discretisation.mean_support(),
        seconds: [times.median(0), times.median(1)],
        ratio: times.ratio(0, 1),
    }
}
