//! Many runs of a case: stored, compared over ranges of the recipe, searched for the
//! best recipe.

pub mod label;
pub mod store;

pub mod sweep;

pub mod records;

pub mod budget;
pub mod tune;
