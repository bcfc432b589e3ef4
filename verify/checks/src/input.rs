//! Files that are read as text.

use std::io;
use std::path::Path;

/// The text of a file. It may come from a pipe that a shell has opened, as `<(command)` and
/// `/dev/stdin` are; a named pipe is refused, for nobody need ever write into it.
pub fn read_text(path: &Path) -> io::Result<String> {
    refuse_named_pipe(path)?;
    std::fs::read_to_string(path)
}

/// Refuses a named pipe, whose opening waits for a writer.
#[cfg(unix)]
pub fn refuse_named_pipe(path: &Path) -> io::Result<()> {
    use std::os::unix::fs::FileTypeExt;
    let is_pipe = std::fs::metadata(path)?.file_type().is_fifo();
    if is_pipe && !path.starts_with("/dev") && !path.starts_with("/proc") {
        let reason = "it is a named pipe, whose reader waits for a writer: give a file";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
    }
    Ok(())
}

/// Refuses a named pipe, which there are none of.
#[cfg(not(unix))]
pub(crate) fn refuse_named_pipe(_: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_named_pipe_is_refused_without_waiting_for_a_writer() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        assert!(read_text(&pipe).unwrap_err().to_string().contains("is a named pipe"));
        let file = folder.path().join("file");
        std::fs::write(&file, "text").unwrap();
        assert_eq!(read_text(&file).unwrap(), "text");
    }
}
