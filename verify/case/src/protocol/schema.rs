//! The JSON Schemas of both files.

use super::answer::Reply;
use super::job::Job;

/// The JSON Schema of a job.
pub fn job_schema() -> String {
    schema::<Job>()
}

/// The JSON Schema of what a program writes.
pub fn answer_schema() -> String {
    schema::<Reply>()
}

fn schema<T: schemars::JsonSchema>() -> String {
    serde_json::to_string_pretty(&schemars::schema_for!(T)).unwrap_or_default()
}
