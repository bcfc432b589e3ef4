//! Relations between the answers to a scene and to another that says the same.

mod balance;
mod cavities;
mod geometry;
mod linear;
mod obstacles;
mod order;
mod paths;
mod rigid;
mod sameness;
mod space;
mod springs;
mod subject;
mod viscosity;

pub(crate) use subject::Subject;
pub use subject::{Compared, Relation};

/// All relations.
pub fn all() -> impl Iterator<Item = &'static Relation> {
    [
        sameness::RELATIONS,
        order::RELATIONS,
        space::RELATIONS,
        geometry::RELATIONS,
        paths::RELATIONS,
        linear::RELATIONS,
        rigid::RELATIONS,
        balance::RELATIONS,
        springs::RELATIONS,
        cavities::RELATIONS,
        viscosity::RELATIONS,
        obstacles::RELATIONS,
    ]
    .into_iter()
    .flatten()
}
