//! How fast the solver is on this machine, each figure beside a limit of the
//! machine or a yardstick of the same minute.

mod force;
pub mod limits;
mod marching;
pub mod plain;
pub mod pose;
mod set_up;
mod text;
mod turns;

pub use marching::{Marcher, carried};
pub use text::to_markdown;

use crate::bundled::unpack;
use crate::machine::{caches, load_average, provenance};
use force::{ForceRow, RatioRow, Settings, force_row, order_row, storage_row, threads_row};
use limits::{Triad, multiply_add_rate, triad_rate};
use marching::{CaseRow, MemoryRow, StepRow, case_row, contact_rows, cube_step, memory_row};
use mtled_checks::study::Provenance;
use pose::Place;
use rayon::ThreadPoolBuilder;
use serde::Serialize;
use set_up::SetUp;
use turns::Clock;

/// Everything that was measured, medians: processor time of work on one thread,
/// wall time of work on several.
#[derive(Debug, Clone, Serialize)]
pub struct Figures {
    pub schema_version: u32,
    pub provenance: Provenance,
    /// Of the last minute when the measurement began.
    pub load_average: Option<f64>,
    /// Second cache of a core and last cache \[bytes\].
    pub caches: (usize, usize),
    pub quick: bool,
    pub rounds: usize,
    pub limits: Limits,
    pub force: Vec<ForceRow>,
    pub ratios: Vec<RatioRow>,
    pub set_up: SetUp,
    pub steps: Vec<StepRow>,
    pub large: MemoryRow,
    pub cases: Vec<CaseRow>,
}

/// What the machine can do.
#[derive(Debug, Clone, Serialize)]
pub struct Limits {
    /// Triad on one thread and on all \[B/s\].
    pub triad: [f64; 2],
    /// Multiply-adds of one thread \[flop/s\], two operations each.
    pub multiply_adds: f64,
    /// Numbers in a vector of theirs.
    pub lanes: usize,
}

/// Cases that are solved whole.
const CASES: [&str; 3] = ["uniaxial_bar", "cube_compression", "cook_membrane"];

/// Measures everything, in about a minute if `quick`, and tells what it is at.
pub fn measure(quick: bool, tell: &dyn Fn(&str)) -> anyhow::Result<Figures> {
    let (provenance, load_average) = (provenance(), load_average());
    let pool = |threads| ThreadPoolBuilder::new().num_threads(threads).build();
    let rounds = if quick { 5 } else { 15 };
    let (one, all) = (pool(1)?, pool(provenance.threads)?);
    let settings = Settings { rounds, quick, one, all };
    // First, while the peak of this process is nothing else's.
    tell("a large body");
    let large = memory_row(&settings)?;
    tell("limits of the machine");
    let mut triad = Triad::new(if quick { 2 } else { 4 } * caches().1);
    let limits = measure_limits(&settings, &mut triad);
    let force = measure_force(&settings, &mut triad, tell)?;
    drop(triad);
    tell("threads and order");
    let mut ratios = vec![order_row(&settings, Place::LastCache, 30.0)?];
    ratios.push(order_row(&settings, Place::Memory, 30.0)?);
    ratios.push(storage_row(&settings, Place::Memory, 30.0)?);
    ratios.push(storage_row(&settings, Place::Memory, 70.0)?);
    if provenance.threads > 1 {
        ratios.push(threads_row(&settings, Place::LastCache, 30.0)?);
        ratios.push(threads_row(&settings, Place::Memory, 30.0)?);
    }
    tell("set-up");
    let set_up = set_up::set_up(&settings)?;
    tell("steps and cases");
    let folder = tempfile::tempdir()?;
    let cases = unpack(folder.path())?;
    let mut steps = vec![cube_step(&settings)?];
    steps.extend(contact_rows(&settings, &cases)?);
    let whole: Result<Vec<CaseRow>, _> =
        CASES.iter().map(|name| case_row(&settings, &cases, name)).collect();
    Ok(Figures {
        schema_version: 1,
        provenance,
        load_average,
        caches: caches(),
        quick,
        rounds,
        limits,
        force,
        ratios,
        set_up,
        steps,
        large,
        cases: whole?,
    })
}

fn measure_limits(settings: &Settings, triad: &mut Triad) -> Limits {
    let (multiply_adds, lanes) = multiply_add_rate();
    let rounds = settings.rounds;
    Limits {
        triad: [
            settings.one.install(|| triad_rate(triad, Clock::Processor, rounds, Triad::pass)),
            settings.all.install(|| triad_rate(triad, Clock::Wall, rounds, Triad::parallel_pass)),
        ],
        multiply_adds,
        lanes,
    }
}

fn measure_force(
    settings: &Settings,
    triad: &mut Triad,
    tell: &dyn Fn(&str),
) -> anyhow::Result<Vec<ForceRow>> {
    let mut rows = Vec::new();
    for place in [Place::SecondCache, Place::LastCache, Place::Memory] {
        for neighbours in [30.0, 70.0] {
            tell(&format!("internal force in {}, {neighbours} neighbours", place.name()));
            rows.push(force_row(settings, place, neighbours, true, triad)?);
        }
    }
    tell("internal force without projection");
    for place in [Place::SecondCache, Place::Memory] {
        rows.push(force_row(settings, place, 30.0, false, triad)?);
    }
    Ok(rows)
}
