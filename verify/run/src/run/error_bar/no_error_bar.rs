//! Why there is no error bar.

/// Why there is no error bar.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NoErrorBar {
    /// The run itself ended early.
    #[error("the run was stopped")]
    Stopped,
    /// The user stopped the runs on coarser clouds.
    #[error("the runs on coarser clouds were stopped")]
    CoarserStopped,
    /// There is no spacing to change.
    #[error("nodes given one by one have no coarser cloud")]
    GivenNodes,
    /// Answers of a body that has lost its stability or its shape do not converge.
    #[error("the run itself is in doubt, and a coarser cloud cannot tell by how much")]
    InDoubt,
    /// Coarser clouds join the sides of gaps even more.
    #[error(
        "both sides of a gap move as one where there are too few nodes, on coarser clouds even more so"
    )]
    BridgedGap,
    /// One spacing lies along an edge, and no fewer can.
    #[error("there are too few spacings along the body for a coarser cloud")]
    NotCoarser,
    /// Too few coarser clouds could be solved; the last reason.
    #[error("coarser clouds cannot be solved: {0}")]
    Coarser(String),
    /// What touches changes from cloud to cloud.
    #[error("the body touches an obstacle, at other nodes on every cloud")]
    Contact,
    /// The clouds differ by more than is small; the difference over the size \[%\].
    #[error("coarser clouds differ by {0} % of its size, too much to tell")]
    TooFarApart(u64),
}
