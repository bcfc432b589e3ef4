//! Why nothing can be warped.

use mtled::algebra::tensor::Vector3;
use mtled::geometry::GeometryError;
use std::path::PathBuf;

/// Why an image or landmarks cannot be warped by a field.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // The messages say it.
pub enum WarpError {
    #[error(
        "{}: none of the nodes of the body lies in this image: it covers {} mm and the nodes {} mm (RAS); it is an \
         image of another space, or its unit of length is another", path.display(), range(.image), range(.body)
    )]
    OtherSpace { path: PathBuf, image: (Vector3, Vector3), body: (Vector3, Vector3) },
    #[error("{}: is named twice, and one file would replace the other", path.display())]
    NamedTwice { path: PathBuf },
    #[error("the body of the case has no such cross-section: {0}")]
    Body(#[from] GeometryError),
    #[error("a body in plane strain has no surfaces to write: leave out --surfaces")]
    NoSurfaces,
    #[error("no shape functions can be built at node {node}, at ({}) mm", numbers(position))]
    UncoveredNode { node: usize, position: Vector3 },
}

fn range((lower, upper): &(Vector3, Vector3)) -> String {
    format!("({}) to ({})", numbers(lower), numbers(upper))
}

fn numbers(position: &Vector3) -> String {
    let [x, y, z] = [0, 1, 2].map(|axis| format!("{:.1}", 1e3 * position[axis]));
    format!("{x}, {y}, {z}")
}
