//! The two output streams: data on standard output, messages on standard error. Nothing
//! else in the program writes to them.

use mtled_checks::escape::{printable_json, printable_lines, without_commands};
use std::io::{self, ErrorKind, Write};

/// Writes a message to standard error, no line of which is a command of a workflow. Where nobody
/// can read it, the program goes on: what it computes is worth more than its messages.
pub(crate) fn to_standard_error(message: &str) {
    command_to_standard_error(&without_commands(message));
}

/// Writes a command of a workflow to standard error.
pub(crate) fn command_to_standard_error(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Writes to standard output as it is. It is no error if the reader ends early, as `head`
/// does.
pub(crate) fn print_data(data: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    or_reader_has_ended(out.write_all(data.as_bytes()).and_then(|()| out.flush()))
}

/// Writes text for people, which may contain texts from files: none is a command of a workflow.
pub(crate) fn print_text(text: &str) -> io::Result<()> {
    print_data(&without_commands(&printable_lines(text)))
}

/// As [`print_text`], for text with colours, in which texts from files have been escaped.
pub(crate) fn print_coloured(text: &str) -> io::Result<()> {
    print_data(&without_commands(text))
}

/// Writes a JSON document.
pub(crate) fn print_json(document: &str) -> io::Result<()> {
    print_data(&printable_json(document))
}

/// The result of writing to standard output, where a reader may end early.
pub(crate) fn or_reader_has_ended(result: io::Result<()>) -> io::Result<()> {
    match result {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        Err(error) => {
            Err(io::Error::new(error.kind(), format!("cannot write to standard output: {error}")))
        }
        Ok(()) => Ok(()),
    }
}
