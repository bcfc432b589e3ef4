//! What the benches measure and how, and the files that they write for `bench-table`.

pub mod limits;
pub mod notes;

pub mod bodies;
pub mod measure;
pub mod plain_loop;
pub mod stepper;
