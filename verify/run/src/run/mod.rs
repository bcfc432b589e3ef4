//! One case from its problem to its result.

mod audit;
mod contact;
mod error_bar;
mod finished;
mod interrupt;
mod load;
mod memory;
mod numbers;
mod output;
mod page;
mod probes;
mod record;
mod result;
mod saved_state;
mod solved;
mod stored_field;
mod work;

pub use audit::audit_doubts;
pub use error_bar::{ErrorBar, Estimated, NoErrorBar, error_bars};
pub use finished::{Failed, Finished, solve_recorded};
pub use interrupt::{interrupt, interrupted};
pub use load::{ensure_fits, load, located};
pub use memory::{estimated_memory, refuse_beyond_memory};
pub use numbers::numbers;
pub(crate) use output::write_modes;
pub use output::{PAGE_FILE, field_at_nodes, history, last_body_frame, vtu, write_unloaded};
pub use probes::{MassCentre, centres_of_mass};
pub use record::{Recorder, Recording, Sample};
pub use saved_state::SavedState;
pub use solved::{Solved, integrate, solve_case, warnings};
pub use stored_field::StoredField;
pub use work::Work;
