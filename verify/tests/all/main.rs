//! What the program does, in one test program: it is linked once.

mod common;

mod house {
    mod architecture;
    mod faults;
    mod imports;
    mod method_book;
    mod rules;
    mod tokens;
    mod writing;
}
mod cases {
    mod bad_cases;
    mod cases_are_valid;
    mod label_maps;
    mod organs;
    mod overrides;
    mod surfaces;
    mod templates;
}
mod references {
    mod commands;
    mod stored;
}
mod runs {
    mod error_bars;
    #[cfg(unix)]
    mod folder;
    mod frequencies;
    mod inconclusive;
    #[cfg(unix)]
    mod interrupted;
    mod memory;
    mod outcomes;
    mod own_suite;
    mod planned_runs;
    mod restart;
    mod run_store;
    mod sensitivity;
}
mod commands {
    mod command_line;
    mod gate;
    mod gate_command;
    mod view_command;
}
mod images {
    mod command;
    mod fields;
    mod image;
}
#[cfg(target_os = "linux")]
mod contests {
    mod contest;
    mod fake;
    mod stored;
}
