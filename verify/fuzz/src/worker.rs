//! A child that reads input after input with the library.

use crate::child::Answer;
use crate::finding::{Finding, Kind};
use crate::judge::death;
use crate::process::{Limits, Watch, command, tail};
use crate::target::Target;
use anyhow::{Context, Result};
use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

/// A child with a line of input and of output per file.
#[derive(Debug)]
pub(crate) struct Worker {
    child: Child,
    answers: Receiver<String>,
    stderr: PathBuf,
}

impl Worker {
    /// Starts a worker whose standard error goes to a file.
    pub(crate) fn start(target: Target, stderr: &Path, limits: &Limits) -> Result<Worker> {
        let mut child = command(target.name(), limits)?
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(File::create(stderr)?)
            .spawn()?;
        let out = child.stdout.take().context("a worker without standard output")?;
        let (sender, answers) = channel();
        std::thread::spawn(move || {
            BufReader::new(out).lines().map_while(Result::ok).try_for_each(|line| sender.send(line))
        });
        Ok(Worker { child, answers, stderr: stderr.to_path_buf() })
    }

    /// Its answer on a file, or why it is dead now.
    pub(crate) fn ask(&mut self, file: &Path, limits: &Limits) -> Result<Result<Answer, Finding>> {
        let watch = Watch::new(self.child.id());
        let pipe = self.child.stdin.as_mut().context("a worker without standard input")?;
        // A worker that has died is found below.
        let _ = writeln!(pipe, "{}", file.display());
        loop {
            match self.answers.recv_timeout(Duration::from_millis(100)) {
                Ok(line) => return Ok(Ok(serde_json::from_str(&line)?)),
                Err(RecvTimeoutError::Disconnected) => {
                    let status = self.child.wait()?;
                    return Ok(Err(death(&tail(&self.stderr), status.signal())));
                }
                Err(RecvTimeoutError::Timeout) if watch.is_over(limits) => {
                    let detail = format!("no answer after {:.0} s of CPU time", limits.cpu_s);
                    return Ok(Err(Finding::new(Kind::Hang, detail)));
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // It may be dead already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
