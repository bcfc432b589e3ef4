//! How large clouds, grids and boundaries may become, judged before they are made.

use crate::geometry::error::GeometryError;

/// Something that a set-up makes many of, and the most that it makes.
pub(crate) struct SizeLimit {
    what: &'static str,
    pub most: f64,
    /// What needs fewer of them.
    remedy: &'static str,
}

pub(crate) const NODES: SizeLimit =
    SizeLimit { what: "nodes", most: 2e7, remedy: "use a larger spacing" };
pub(crate) const BOUNDARY_NODES: SizeLimit =
    SizeLimit { what: "boundary nodes", most: 2e7, remedy: "use a larger spacing" };
pub(crate) const PANELS: SizeLimit = SizeLimit {
    what: "boundary panels",
    most: 1e7,
    remedy: "use a larger spacing, or move nodes that are much closer than others apart",
};
pub(crate) const DISTANCE_SAMPLES: SizeLimit =
    SizeLimit { what: "distance samples", most: 2e8, remedy: "use a larger spacing" };
pub(crate) const CELLS: SizeLimit =
    SizeLimit { what: "background cells", most: 2e8, remedy: "use larger cells" };
pub(crate) const POINTS: SizeLimit = SizeLimit {
    what: "quadrature points",
    most: 2e8,
    remedy: "use larger cells, coarser refinements or fewer Gauss points",
};

impl SizeLimit {
    /// Refuses a count beyond the limit, and one that is NaN.
    pub fn check(&self, count: f64) -> Result<(), GeometryError> {
        let SizeLimit { what, most: limit, remedy } = *self;
        if count <= limit {
            Ok(())
        } else {
            Err(GeometryError::TooMany { what, count, limit, remedy })
        }
    }
}
