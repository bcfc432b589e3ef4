//! The processes that a child leaves behind, whatever group or session they have gone into.

#[cfg(target_os = "linux")]
pub(crate) use linux::Family;
#[cfg(not(target_os = "linux"))]
pub(crate) use other::Family;

#[cfg(target_os = "linux")]
mod linux {
    use rustix::process::{
        Pid, Signal, WaitOptions, getpid, kill_process, set_child_subreaper, waitpid,
    };
    use std::collections::{BTreeMap, BTreeSet};
    use std::sync::{Mutex, MutexGuard, PoisonError};
    use std::time::{Duration, Instant};

    /// Longest time in which what was killed must end: what does not is stuck in the system.
    const PATIENCE: Duration = Duration::from_secs(2);

    /// One child at a time, so that a new process is known to be of its family.
    static ONE: Mutex<()> = Mutex::new(());

    /// The processes that a child starts and those that these start. Orphans among them become
    /// children of this program, so that none is lost from sight.
    #[derive(Debug)]
    pub(crate) struct Family {
        /// Processes of this program that were there before.
        others: BTreeSet<i32>,
        _one: MutexGuard<'static, ()>,
    }

    impl Family {
        /// To be called before the child is started.
        pub(crate) fn new() -> Family {
            let one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
            // An old kernel without it leaves orphans to the first process.
            let _ = set_child_subreaper(Some(getpid()));
            Family { others: descendants(), _one: one }
        }

        /// Kills all that is left besides the child itself, and waits until it is gone.
        pub(crate) fn end(self, child: Pid) {
            let start = Instant::now();
            let child = child.as_raw_pid();
            loop {
                let left: Vec<i32> = descendants()
                    .into_iter()
                    .filter(|pid| *pid != child && !self.others.contains(pid))
                    .collect();
                if left.is_empty() || start.elapsed() > PATIENCE {
                    return;
                }
                for pid in left.into_iter().filter_map(Pid::from_raw) {
                    // It may have ended, and only children can be reaped.
                    let _ = kill_process(pid, Signal::KILL);
                    let _ = waitpid(Some(pid), WaitOptions::NOHANG);
                }
                std::thread::sleep(Duration::from_millis(1));
            }
        }
    }

    /// All processes below this one.
    fn descendants() -> BTreeSet<i32> {
        let mut children: BTreeMap<i32, Vec<i32>> = BTreeMap::new();
        for entry in std::fs::read_dir("/proc").into_iter().flatten().flatten() {
            let pid = entry.file_name().to_str().and_then(|name| name.parse().ok());
            let Some((pid, parent)) = pid.and_then(|pid| Some((pid, parent_of(pid)?))) else {
                continue;
            };
            children.entry(parent).or_default().push(pid);
        }
        let mut found = BTreeSet::new();
        let mut next = vec![getpid().as_raw_pid()];
        while let Some(parent) = next.pop() {
            for pid in children.get(&parent).into_iter().flatten() {
                if found.insert(*pid) {
                    next.push(*pid);
                }
            }
        }
        found
    }

    fn parent_of(pid: i32) -> Option<i32> {
        let text = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
        // The name in parentheses may have spaces.
        text.rsplit_once(')')?.1.split_whitespace().nth(1)?.parse().ok()
    }
}

#[cfg(not(target_os = "linux"))]
mod other {
    /// Elsewhere only the group of a child is known.
    #[derive(Debug)]
    pub(crate) struct Family;

    impl Family {
        /// Nothing is looked at.
        pub(crate) fn new() -> Family {
            Family
        }

        /// Nothing is known besides the group.
        #[cfg(unix)]
        pub(crate) fn end(self, _: rustix::process::Pid) {}
    }
}
