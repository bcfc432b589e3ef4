use std::process::ExitCode;

fn main() -> ExitCode {
    mtled_verify::cli::run()
}
