//! Long work beside the interpreter: it runs in a thread of its own without the lock of the
//! interpreter, while the thread of the caller waits for signals and shows progress.

use mtled::Continue;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread::Builder;
use std::time::Duration;

/// How often signals are looked for and progress is shown.
const INTERVAL: Duration = Duration::from_millis(50);

/// Stack of the thread \[byte\], as the main thread has it.
const STACK: usize = 8 << 20;

/// What the work and the thread that waits for it share.
#[derive(Debug, Default)]
pub(crate) struct Watch {
    stopped: AtomicBool,
    /// Progress \[–\] and step.
    reached: Mutex<(f64, usize)>,
    /// What a Python function that the work calls has raised.
    raised: Mutex<Option<PyErr>>,
}

impl Watch {
    /// Notes how far the work has come, and says whether it goes on.
    pub(crate) fn report(&self, progress: f64, step: usize) -> Continue {
        if let Ok(mut reached) = self.reached.lock() {
            *reached = (progress, step);
        }
        if self.is_stopped() { Continue::Stop } else { Continue::Yes }
    }

    /// Ends the work with an exception; the first one counts.
    pub(crate) fn raise(&self, error: PyErr) {
        self.stopped.store(true, Ordering::Relaxed);
        if let Ok(mut raised) = self.raised.lock() {
            raised.get_or_insert(error);
        }
    }

    /// Whether the result of the work is not wanted any more.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    fn take_raised(&self) -> PyResult<()> {
        self.raised.lock().ok().and_then(|mut raised| raised.take()).map_or(Ok(()), Err)
    }
}

/// Shows progress where it has changed.
struct Shown<'a> {
    callback: Option<&'a Py<PyAny>>,
    last: (f64, usize),
}

impl Shown<'_> {
    fn show(&mut self, py: Python, watch: &Watch) -> PyResult<()> {
        let reached = watch.reached.lock().map_or(self.last, |reached| *reached);
        let Some(callback) = self.callback.filter(|_| reached != self.last) else { return Ok(()) };
        self.last = reached;
        callback.call1(py, reached).map(drop)
    }
}

/// Does work that tells `watch` its progress, and calls `progress(fraction, step)` meanwhile.
/// An exception there or Ctrl-C is raised at once: the work ends by itself after its step.
pub(crate) fn in_background<T: Send + 'static>(
    py: Python,
    watch: &Arc<Watch>,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, mut receiver) = sync_channel(1);
    let theirs = watch.clone();
    let run = move || {
        // Nobody waits for work that has been stopped.
        let _ = sender.send(work(&theirs));
    };
    Builder::new().name("mtled".into()).stack_size(STACK).spawn(run)?;
    let mut shown = Shown { callback: progress, last: (0.0, 0) };
    loop {
        // It can be used by one thread at a time only.
        let (back, result) = py.detach(move || {
            let result = receiver.recv_timeout(INTERVAL);
            (receiver, result)
        });
        receiver = back;
        let seen = watch
            .take_raised()
            .and_then(|()| py.check_signals())
            .and_then(|()| shown.show(py, watch));
        if let Err(error) = seen {
            watch.stopped.store(true, Ordering::Relaxed);
            return Err(error);
        }
        match result {
            Ok(result) => return Ok(result),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err(
                    "the solver has panicked, which is a fault in it; its message is on standard error",
                ));
            }
        }
    }
}
