//! All measurements of `mtled bench`.

use super::alternation::Clock;
use super::bodies::MemoryLevel;
use super::figures::{BenchSettings, CaseRow, Figures, ForceRow, Limits, RatioRow, SCHEMA_VERSION};
use super::force::{force_row, order_row, storage_row, threads_row};
use super::limits::{Triad, multiply_add_rate, triad_rate};
use super::set_up::set_up;
use super::steps::{contact_rows, cube_step, memory_row};
use super::whole_cases::case_row;
use crate::bundled::unpack;
use crate::machine::{caches, load_average, provenance};
use rayon::ThreadPoolBuilder;

/// Cases that are solved from their file to their result.
const CASES: [&str; 3] = ["uniaxial_bar", "cube_compression", "cook_membrane"];

/// Measures everything, in about a minute if `quick`; `notify` is called with the name of each
/// measurement.
pub fn measure(quick: bool, notify: &dyn Fn(&str)) -> anyhow::Result<Figures> {
    let (provenance, load_average) = (provenance(), load_average());
    let pool = |threads| ThreadPoolBuilder::new().num_threads(threads).build();
    let rounds = if quick { 5 } else { 15 };
    let (one, all) = (pool(1)?, pool(provenance.threads)?);
    let settings = BenchSettings { rounds, quick, one, all };
    // First, before anything else raises the peak of the memory.
    notify("a large body");
    let large = memory_row(&settings)?;
    notify("limits of the machine");
    let mut triad = Triad::new(if quick { 2 } else { 4 } * caches().1);
    let limits = measure_limits(&settings, &mut triad);
    let force = measure_force(&settings, &mut triad, notify)?;
    drop(triad);
    notify("threads and order");
    let ratios = measure_ratios(&settings, provenance.threads)?;
    notify("set-up");
    let set_up = set_up(&settings)?;
    notify("steps and cases");
    let folder = tempfile::tempdir()?;
    let unpacked = unpack(folder.path())?;
    let mut steps = vec![cube_step(&settings)?];
    steps.extend(contact_rows(&settings, &unpacked)?);
    let cases: Result<Vec<CaseRow>, _> =
        CASES.iter().map(|name| case_row(&settings, &unpacked, name)).collect();
    Ok(Figures {
        schema_version: SCHEMA_VERSION,
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
        cases: cases?,
    })
}

fn measure_limits(settings: &BenchSettings, triad: &mut Triad) -> Limits {
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
    settings: &BenchSettings,
    triad: &mut Triad,
    notify: &dyn Fn(&str),
) -> anyhow::Result<Vec<ForceRow>> {
    let mut rows = Vec::new();
    for level in [MemoryLevel::SecondCache, MemoryLevel::LastCache, MemoryLevel::Memory] {
        for neighbours in [30.0, 70.0] {
            notify(&format!("internal force in {}, {neighbours} neighbours", level.name()));
            rows.push(force_row(settings, level, neighbours, true, triad)?);
        }
    }
    notify("internal force without projection");
    for level in [MemoryLevel::SecondCache, MemoryLevel::Memory] {
        rows.push(force_row(settings, level, 30.0, false, triad)?);
    }
    Ok(rows)
}

fn measure_ratios(settings: &BenchSettings, threads: usize) -> anyhow::Result<Vec<RatioRow>> {
    let mut ratios = vec![order_row(settings, MemoryLevel::LastCache, 30.0)?];
    ratios.push(order_row(settings, MemoryLevel::Memory, 30.0)?);
    ratios.push(storage_row(settings, MemoryLevel::Memory, 30.0)?);
    ratios.push(storage_row(settings, MemoryLevel::Memory, 70.0)?);
    if threads > 1 {
        ratios.push(threads_row(settings, MemoryLevel::LastCache, 30.0)?);
        ratios.push(threads_row(settings, MemoryLevel::Memory, 30.0)?);
    }
    Ok(ratios)
}
