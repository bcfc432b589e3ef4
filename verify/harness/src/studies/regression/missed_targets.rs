//! Targets that are known to be missed. Their figures are judged by their stored bounds; every
//! other target is judged by itself, whatever the stored figures hold.

/// On some cloud the plain scheme has errors of less than the target times those of the default
/// recipe.
pub(crate) const MISSED: [&str; 10] = [
    "manufactured/log_j-nu300/plain_over_default/displacement",
    "manufactured/log_j-nu300/plain_over_default/gradient",
    "manufactured/log_j-nu300/plain_over_default/pressure_deviation",
    "manufactured/log_j-nu300/turned_plain_over_default/displacement",
    "manufactured/log_j-nu300/turned_plain_over_default/gradient",
    "manufactured/log_j-nu300/turned_plain_over_default/pressure_deviation",
    "manufactured/log_j-nu490/plain_over_default/displacement",
    "manufactured/log_j-nu490/plain_over_default/gradient",
    "manufactured/log_j-nu490/turned_plain_over_default/displacement",
    "manufactured/log_j-nu490/turned_plain_over_default/gradient",
];

/// Those that only the full suite misses, on finer clouds or in longer runs.
pub(crate) const MISSED_IN_FULL: [&str; 7] = [
    "manufactured/log_j-nu300-mixed/over_interpolation",
    "manufactured/log_j-nu499/finest_pressure",
    "manufactured/mooney_rivlin-nu490/finest_pressure",
    "manufactured/mooney_rivlin-nu490/finest_pressure_deviation",
    "manufactured/mooney_rivlin-nu499/finest_pressure",
    "manufactured/mooney_rivlin-nu499/finest_pressure_deviation",
    "time_step/runs/compressed",
];

/// Whether the target of a check is known to be missed in the quick suite, or in the full one.
pub(crate) fn is_missed(full_suite: bool, id: &str) -> bool {
    MISSED.contains(&id) || (full_suite && MISSED_IN_FULL.contains(&id))
}
