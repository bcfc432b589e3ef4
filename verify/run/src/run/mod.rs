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
pub use error_bar::{
    CoarserCloud, ErrorBar, ErrorBars, Estimated, Indicator, NoErrorBar, error_bars,
};
pub use finished::{Failed, Finished, solve_recorded};
pub use interrupt::{interrupt, interrupted};
pub use load::{ensure_fits, load, located};
pub use memory::{MemoryShortage, estimated_memory, refuse_beyond_memory};
pub use numbers::numbers;
pub use output::{
    PAGE_FILE, field_at_nodes, history, last_body_frame, vtu, write_modes, write_unloaded,
};
pub use probes::{MassCentre, centres_of_mass};
pub use record::{Recorder, Recording, Sample};
pub use result::{result_json, summary_text};
pub use saved_state::SavedState;
pub use solved::{Solved, integrate, solve_case, warnings};
pub use stored_field::{FIELD_FILE, FieldError, SolvedCase, StoredField};
pub use work::Work;
