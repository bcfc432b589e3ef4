//! A child process with a time limit, whose processor time and memory the system measures.

mod family;

use family::Family;
use mtled_run::machine::peak_memory;
use mtled_run::run::interrupted;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::io::{self, Read};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};
use wait4::Wait4;

/// Libraries that start threads are asked for one.
const ONE_THREAD: [&str; 6] = [
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "NUMBA_NUM_THREADS",
    "RAYON_NUM_THREADS",
];
/// The end of standard error that is kept \[byte\].
const KEPT: usize = 4000;
/// Longest wait for what was written to standard error before the end.
const LAST_WORDS: Duration = Duration::from_secs(1);
/// Longest pause between two looks at a child.
const LONGEST_PAUSE: Duration = Duration::from_millis(20);

/// What a process has taken, by the system's account: its own and that of its children that it
/// has waited for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Usage {
    /// User and system time of all threads \[s\].
    pub cpu_s: f64,
    /// On the clock \[s\].
    pub wall_s: f64,
    /// Largest resident memory of one process \[byte\].
    pub peak_memory_bytes: u64,
    /// The system counts the memory of this program to a process until it has loaded its own
    /// \[byte\]: a smaller peak is not seen.
    pub least_memory_bytes: u64,
}

/// How a process ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ended {
    /// By itself.
    Exited(ExitStatus),
    /// Killed at its time limit.
    TimedOut,
    /// Killed because the user has stopped this program.
    Stopped,
}

/// A process that has ended.
#[derive(Debug)]
pub(crate) struct ChildRun {
    /// How.
    pub ended: Ended,
    /// What it has taken.
    pub usage: Usage,
    /// The end of what it wrote to standard error.
    pub last_words: String,
}

/// Runs a command with its children in a group of their own. Nothing is left of the group, nor on
/// Linux of what has left it, when this returns. The error is that of a program that cannot be started.
pub(crate) fn run_child(words: &[String], limit: Duration) -> io::Result<ChildRun> {
    let (program, arguments) = words.split_first().ok_or(io::ErrorKind::InvalidInput)?;
    let mut command = Command::new(program);
    command.args(arguments);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    command.envs(ONE_THREAD.map(|name| (name, "1")));
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let family = Family::new();
    let least_memory_bytes = peak_memory().unwrap_or(0);
    let start = Instant::now();
    let mut child = command.spawn()?;
    let words = last_words(&mut child);
    let ended_early = wait_for_end(&mut child, start, limit);
    let wall_s = start.elapsed().as_secs_f64();
    // Before it is reaped, so that the number of the group cannot belong to others.
    kill_group(&mut child);
    #[cfg(unix)]
    family.end(rustix::process::Pid::from_child(&child));
    #[cfg(not(unix))]
    drop(family);
    let used = child.wait4()?;
    let usage = Usage {
        cpu_s: (used.rusage.utime + used.rusage.stime).as_secs_f64(),
        wall_s,
        peak_memory_bytes: used.rusage.maxrss,
        least_memory_bytes,
    };
    let ended = ended_early.unwrap_or(Ended::Exited(used.status));
    let last_words = words.recv_timeout(LAST_WORDS).unwrap_or_default();
    Ok(ChildRun { ended, usage, last_words })
}

/// Waits until a process has ended or may not go on; None where it has ended by itself.
fn wait_for_end(child: &mut Child, start: Instant, limit: Duration) -> Option<Ended> {
    let mut pause = Duration::from_micros(300);
    loop {
        if has_ended(child) {
            return None;
        }
        if interrupted() {
            return Some(Ended::Stopped);
        }
        if start.elapsed() > limit {
            return Some(Ended::TimedOut);
        }
        std::thread::sleep(pause);
        pause = (pause * 2).min(LONGEST_PAUSE);
    }
}

/// Whether a process has ended; it is not reaped.
#[cfg(unix)]
fn has_ended(child: &mut Child) -> bool {
    use rustix::process::{Pid, WaitId, WaitIdOptions, waitid};
    let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
    !matches!(waitid(WaitId::Pid(Pid::from_child(child)), options), Ok(None))
}

#[cfg(not(unix))]
fn has_ended(child: &mut Child) -> bool {
    !matches!(child.try_wait(), Ok(None))
}

/// Kills what is left of a process and of its children.
#[cfg(unix)]
fn kill_group(child: &mut Child) {
    use rustix::process::{Pid, Signal, kill_process_group};
    // It may have no members but the one that has ended.
    let _ = kill_process_group(Pid::from_child(child), Signal::KILL);
}

/// Kills a process, where there are no groups.
#[cfg(not(unix))]
fn kill_group(child: &mut Child) {
    // It may have ended.
    let _ = child.kill();
}

/// The end of what a process writes to standard error, sent when it is closed.
fn last_words(child: &mut Child) -> Receiver<String> {
    let (sender, receiver) = channel();
    let stream = child.stderr.take();
    std::thread::spawn(move || {
        let (mut kept, mut buffer) = (VecDeque::new(), [0; 4096]);
        let mut stream = stream;
        while let Some(Ok(count @ 1..)) = stream.as_mut().map(|stream| stream.read(&mut buffer)) {
            kept.extend(&buffer[..count]);
            kept.drain(..kept.len().saturating_sub(KEPT));
        }
        let bytes: Vec<u8> = kept.into();
        // Nobody waits for the words of a process that was given up.
        let _ = sender.send(String::from_utf8_lossy(&bytes).trim().to_string());
    });
    receiver
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use crate::contests::process::{Ended, run_child};
    use std::time::Duration;

    #[test]
    fn what_goes_into_a_session_of_its_own_ends_with_its_time_limit() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("pid");
        let name = file.display();
        for script in [
            format!("setsid sh -c 'echo $$ >\"{name}\"; exec sleep 60' & sleep 60"),
            // Its parent has ended, and so has the parent of that.
            format!("(setsid env -i sh -c 'echo $$ >\"{name}\"; exec sleep 60' &) & sleep 60"),
        ] {
            let words = ["sh".to_string(), "-c".into(), script.clone()];
            let run = run_child(&words, Duration::from_millis(500)).unwrap();
            assert_eq!(run.ended, Ended::TimedOut);
            let pid = std::fs::read_to_string(&file).unwrap();
            let alive = std::path::Path::new("/proc").join(pid.trim()).exists();
            assert!(!alive, "{script}");
            std::fs::remove_file(&file).unwrap();
        }
    }
}
