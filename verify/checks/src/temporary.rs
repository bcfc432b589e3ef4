//! Temporary files beside those that they become, `.<process>-….tmp`, and what is left of them
//! where a program was killed.

use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::{Builder, NamedTempFile};

/// In less a file is written by a process of another machine, which has its numbers for itself.
const YOUNG: Duration = Duration::from_secs(60);
/// No file takes longer to be written.
const OLD: Duration = Duration::from_secs(3600);

/// A file of a name that no other has, which is removed unless it is renamed.
pub(crate) fn temporary(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    let prefix = format!(".{}-", std::process::id());
    builder.prefix(&prefix).suffix(".tmp");
    // As any other new file; temporary ones are for their owner alone by default.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// The temporary files in a folder that nobody will rename any more: their process is gone, or
/// they are old. Files that come and go meanwhile are none.
pub fn abandoned(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder)?;
    let paths = entries.flatten().map(|entry| entry.path());
    let mut found: Vec<PathBuf> = paths.filter(|path| is_abandoned(path)).collect();
    found.sort();
    Ok(found)
}

/// Removes them; what cannot be removed stays.
pub fn remove_abandoned(folder: &Path) {
    for file in abandoned(folder).unwrap_or_default() {
        let _ = std::fs::remove_file(file);
    }
}

fn is_abandoned(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let Some(inner) = name.strip_prefix('.').and_then(|name| name.strip_suffix(".tmp")) else {
        return false;
    };
    let Ok(meta) = path.symlink_metadata() else { return false };
    let age = meta.modified().ok().and_then(|time| time.elapsed().ok()).unwrap_or_default();
    if !meta.is_file() || age < YOUNG {
        return false;
    }
    let process = inner.split_once('-').and_then(|(number, _)| number.parse().ok());
    age > OLD || process.is_some_and(|number: u32| is_gone(number))
}

/// Whether a process of this machine has ended, where the system can tell.
fn is_gone(process: u32) -> bool {
    let all = Path::new("/proc");
    all.join("self").exists() && !all.join(process.to_string()).exists()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::SystemTime;

    fn aged(path: &Path, age: Duration) {
        let file = std::fs::OpenOptions::new().write(true).open(path).unwrap();
        file.set_modified(SystemTime::now() - age).unwrap();
    }

    #[test]
    fn a_temporary_file_is_abandoned_when_it_is_old_or_its_process_is_gone() {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str, age: Duration| {
            let path = folder.path().join(name);
            std::fs::write(&path, "").unwrap();
            aged(&path, age);
            path
        };
        let own = temporary(folder.path()).unwrap();
        aged(own.path(), 2 * YOUNG);
        let gone = u32::MAX;
        put(&format!(".{gone}-aaaaaa.tmp"), Duration::ZERO);
        put("notes.tmp", 2 * OLD);
        put(".bbbbbb.tmp", 2 * YOUNG);
        let old = put(".cccccc.tmp", 2 * OLD);
        let orphan = put(&format!(".{gone}-dddddd.tmp"), 2 * YOUNG);
        let expected = if cfg!(target_os = "linux") { vec![old, orphan] } else { vec![old] };
        let mut expected = expected;
        expected.sort();
        assert_eq!(abandoned(folder.path()).unwrap(), expected);
        remove_abandoned(folder.path());
        assert!(abandoned(folder.path()).unwrap().is_empty());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 4);
    }
}
