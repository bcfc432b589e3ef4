//! Changes to the text of a case file: it stays as it was written, comments and
//! all, but for the keys that change.

mod load;
mod overrides;
mod paths;
mod settings;
mod values;

pub(crate) use overrides::Overridden;
pub use overrides::{NotAnOverride, Override};
pub use paths::{with_absolute_paths, with_paths_from};
pub use settings::edited;
pub use values::EditError;
