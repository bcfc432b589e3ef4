//! The command line of the meshless solver `mtled` ([`cli`]).

pub mod cli;
