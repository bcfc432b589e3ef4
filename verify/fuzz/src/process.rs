//! Child processes with limits on time and memory.

use crate::child::variable;
use anyhow::{Context, Result};
use rustix::process::{Pid, Signal, kill_process};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// What a child may take.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// CPU time of one input \[s\]; six times that on the clock.
    pub cpu_s: f64,
    /// Address space \[byte\].
    pub address_space: u64,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits { cpu_s: 10.0, address_space: 2 << 30 }
    }
}

/// The clock runs on while other programs have the processors.
const WALL_OVER_CPU: f64 = 6.0;
/// A program is asked to stop after this fraction of its CPU time.
const STOP: f64 = 0.2;

/// This program with a task for a child, on one thread.
pub(crate) fn command(task: &str, limits: &Limits) -> Result<Command> {
    let mut command = Command::new(std::env::current_exe().context("this program has no path")?);
    command
        .env_clear()
        .env("RAYON_NUM_THREADS", "1")
        .env("RUST_BACKTRACE", "0")
        .env("NO_COLOR", "1")
        .env(variable::TASK, task)
        .env(variable::ADDRESS_SPACE, limits.address_space.to_string())
        .stdin(Stdio::null());
    Ok(command)
}

/// Watches the time of a child from now on.
#[derive(Debug)]
pub(crate) struct Watch {
    pid: u32,
    start: Instant,
    cpu_at_start: f64,
}

impl Watch {
    /// Watches a child.
    pub(crate) fn new(pid: u32) -> Watch {
        Watch { pid, start: Instant::now(), cpu_at_start: cpu_seconds(pid).unwrap_or(0.0) }
    }

    /// Time on the clock so far \[s\].
    pub(crate) fn wall_s(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// CPU time so far, or that on the clock where there is no other \[s\].
    pub(crate) fn cpu_s(&self) -> f64 {
        cpu_seconds(self.pid).map_or(self.wall_s(), |cpu| cpu - self.cpu_at_start)
    }

    /// Whether the child has taken longer than it may.
    pub(crate) fn is_over(&self, limits: &Limits) -> bool {
        self.wall_s() > limits.cpu_s
            && (self.cpu_s() > limits.cpu_s || self.wall_s() > WALL_OVER_CPU * limits.cpu_s)
    }
}

/// CPU seconds of a process, where /proc has them.
fn cpu_seconds(pid: u32) -> Option<f64> {
    let text = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // The name in parentheses may have spaces.
    let mut fields = text.rsplit_once(')')?.1.split_whitespace().skip(11);
    let ticks = |field: Option<&str>| field?.parse::<f64>().ok();
    let ticks = ticks(fields.next())? + ticks(fields.next())?;
    Some(ticks / rustix::param::clock_ticks_per_second() as f64)
}

/// How a child ended.
#[derive(Debug)]
pub(crate) struct End {
    /// None where it was killed for its time.
    pub status: Option<ExitStatus>,
    /// Whether it was asked to stop before.
    pub asked: bool,
    /// Time on the clock \[s\].
    pub seconds: f64,
}

impl End {
    /// The exit code, unless a signal ended it.
    pub(crate) fn code(&self) -> Option<i32> {
        self.status.and_then(|status| status.code())
    }

    /// The signal that ended it.
    pub(crate) fn signal(&self) -> Option<i32> {
        self.status.and_then(|status| status.signal())
    }
}

/// Waits for a child, asks it to stop in time as Ctrl-C would, and kills it in the end.
pub(crate) fn wait(child: &mut Child, limits: &Limits) -> Result<End> {
    let watch = Watch::new(child.id());
    let mut pause = Duration::from_micros(300);
    let mut asked = false;
    loop {
        let seconds = watch.wall_s();
        if let Some(status) = child.try_wait()? {
            return Ok(End { status: Some(status), asked, seconds });
        }
        if watch.is_over(limits) {
            child.kill()?;
            child.wait()?;
            return Ok(End { status: None, asked, seconds });
        }
        if !asked && seconds > STOP * limits.cpu_s && watch.cpu_s() > STOP * limits.cpu_s {
            asked = true;
            // It may have ended in the meantime.
            let _ = kill_process(Pid::from_child(child), Signal::INT);
        }
        std::thread::sleep(pause);
        pause = (pause * 2).min(Duration::from_millis(20));
    }
}

/// The end of a text file, which may not be there.
pub(crate) fn tail(path: &Path) -> String {
    let bytes = std::fs::read(path).unwrap_or_default();
    String::from_utf8_lossy(&bytes[bytes.len().saturating_sub(4000)..]).into_owned()
}
