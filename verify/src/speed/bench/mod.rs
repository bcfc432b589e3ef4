//! How fast the solver is on this machine, beside the limits of the machine and a plain
//! loop measured in the same minute.

mod alternation;
pub mod bodies;
mod figures;
mod force;
pub mod limits;
mod markdown;
mod measure;
pub mod plain_loop;
mod set_up;
mod steps;
mod whole_cases;

pub use figures::Figures;
pub use markdown::to_markdown;
pub use measure::measure;
pub use steps::Stepper;
pub use whole_cases::bundled_case;
