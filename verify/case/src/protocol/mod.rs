//! The solver protocol: a program reads a job, one JSON file, and writes an answer, another.
//! `reference/adapters/README.md` describes it for those who write such a program.

mod answer;
mod job;
mod material;
mod read;
mod schema;
mod version;

pub use answer::{Answer, Refusal, RefusalReason, Refused, Reply, SolverName};
pub use job::{Job, Probe, Resolution};
pub use read::{
    AnswerFault, Answered, SoundReply, parse_job, read_reply, reply_value, sound_reply,
};
pub use schema::{answer_schema, job_schema};
pub use version::PROTOCOL;
