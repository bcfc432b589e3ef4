//! The program from the outside.

use std::path::Path;
use std::process::{Child, Command};
use std::time::Duration;

/// What no command of a test takes, also on a busy machine.
const LIMIT: Duration = Duration::from_secs(300);

/// The program in a folder, for tests that start it themselves.
pub fn program(folder: impl AsRef<Path>, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mtled"));
    command.current_dir(folder).args(arguments);
    command.env_remove("GITHUB_ACTIONS").env_remove("GITHUB_STEP_SUMMARY");
    command
}

/// Exit code, standard output and standard error of a command that is run to its end.
pub fn ended(command: Command) -> (i32, String, String) {
    let output = assert_cmd::Command::from_std(command).timeout(LIMIT).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let code = output.status.code().expect("the program was killed, perhaps at its time limit");
    (code, text(output.stdout), text(output.stderr))
}

/// Exit code, standard output and standard error of the program in a folder.
pub fn mtled(folder: impl AsRef<Path>, arguments: &[&str]) -> (i32, String, String) {
    ended(program(folder, arguments))
}

/// What a command that succeeds prints as JSON.
pub fn json(arguments: &[&str]) -> serde_json::Value {
    let (code, out, err) = mtled(".", &[arguments, &["--format", "json"]].concat());
    assert_eq!(code, 0, "{arguments:?}: {err}");
    serde_json::from_str(&out).unwrap()
}

/// Exit code of the program in a folder and all that it printed.
pub fn printed(folder: impl AsRef<Path>, arguments: &[&str]) -> (i32, String) {
    let (code, out, err) = mtled(folder, arguments);
    (code, out + &err)
}

/// What Ctrl-C sends to a program.
pub fn interrupt(child: &Child) {
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.unwrap().success());
}
