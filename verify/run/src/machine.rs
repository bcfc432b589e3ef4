//! Provenance, memory and processor of this process.

use mtled_checks::study::Provenance;
use std::time::{SystemTime, UNIX_EPOCH};

/// Version, commit, compiler and processor of this run.
pub fn provenance() -> Provenance {
    Provenance {
        version: env!("CARGO_PKG_VERSION").to_string(),
        commit: env!("MTLED_COMMIT").to_string(),
        compiler: env!("MTLED_COMPILER").to_string(),
        processor: processor(),
        processor_features: features(),
        threads: rayon::current_num_threads(),
        date: date(),
    }
}

/// Does work on so many threads of its own. A thread of another pool that waited for them would take
/// up other work meanwhile, upon the same stack, and so on until that overflows.
pub fn on_threads<T: Send>(
    threads: usize,
    work: impl FnOnce() -> T + Send,
) -> Result<T, rayon::ThreadPoolBuildError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let done = std::thread::scope(|scope| scope.spawn(|| pool.install(work)).join());
    Ok(done.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
}

/// CPU seconds of this process so far, all threads.
pub fn cpu_seconds() -> f64 {
    cpu_time::ProcessTime::now().as_duration().as_secs_f64()
}

/// Largest resident memory of this process so far \[bytes\], where it is known.
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kibibytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kibibytes)
}

/// Memory available to a run \[bytes\]: that of the system, or what is left of the limit
/// of this process's control group if that is less. None where it is not known.
pub(crate) fn available_memory() -> Option<u64> {
    let mut system = sysinfo::System::new();
    system.refresh_memory();
    let free = Some(system.available_memory()).filter(|bytes| *bytes > 0)?;
    let group = system.cgroup_limits().map(|limits| limits.total_memory.saturating_sub(limits.rss));
    Some(group.map_or(free, |group| group.min(free)))
}

fn processor_field(key: &str) -> Option<String> {
    let info = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = info.lines().find(|line| line.starts_with(key))?;
    Some(line.split(':').nth(1)?.trim().to_string())
}

/// The processor's own name, or that of its kind.
fn processor() -> String {
    processor_field("model name").or_else(brand).unwrap_or_else(|| std::env::consts::ARCH.into())
}

/// What systems other than Linux call the processor.
fn brand() -> Option<String> {
    let mut system = sysinfo::System::new();
    system.refresh_cpu_list(sysinfo::CpuRefreshKind::nothing());
    Some(system.cpus().first()?.brand().trim().to_string()).filter(|brand| !brand.is_empty())
}

/// Vector extensions that matter to the solver.
fn features() -> String {
    #[cfg(target_arch = "x86_64")]
    let has = [
        ("sse2", is_x86_feature_detected!("sse2")),
        ("avx2", is_x86_feature_detected!("avx2")),
        ("fma", is_x86_feature_detected!("fma")),
        ("avx512f", is_x86_feature_detected!("avx512f")),
    ];
    #[cfg(target_arch = "aarch64")]
    let has = [("neon", std::arch::is_aarch64_feature_detected!("neon"))];
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    let has: [(&str, bool); 0] = [];
    has.into_iter().filter(|(_, has)| *has).map(|(name, _)| name).collect::<Vec<_>>().join(" ")
}

/// Today as YYYY-MM-DD, UTC.
fn date() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    civil_date((seconds / 86_400) as i64)
}

/// Days since 1970-01-01 to a Gregorian date, by counting years and months.
fn civil_date(mut days: i64) -> String {
    let leap = |year: i64| (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
    let mut year = 1970;
    while days >= 365 + leap(year) as i64 {
        days -= 365 + leap(year) as i64;
        year += 1;
    }
    let february = 28 + leap(year) as i64;
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    format!("{year:04}-{month:02}-{:02}", days + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_that_waits_for_threads_of_its_own_takes_up_nothing_else() {
        use rayon::prelude::*;
        use std::cell::Cell;
        thread_local!(static DEPTH: Cell<usize> = const { Cell::new(0) });
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let deepest = |_: usize| {
            DEPTH.set(DEPTH.get() + 1);
            let slow = || std::thread::sleep(std::time::Duration::from_millis(1));
            on_threads(1, slow).unwrap();
            DEPTH.replace(DEPTH.get() - 1)
        };
        let depth = pool.install(|| (0..50).into_par_iter().with_max_len(1).map(deepest).max());
        assert_eq!(depth, Some(1));
    }

    #[test]
    fn days_become_dates() {
        assert_eq!(civil_date(0), "1970-01-01");
        assert_eq!(civil_date(59), "1970-03-01");
        assert_eq!(civil_date(11_016), "2000-02-29");
        assert_eq!(civil_date(19_722), "2023-12-31");
    }
}
