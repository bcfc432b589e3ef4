//! Pictures of bodies: shaded surfaces seen from a direction, coloured by a field, as SVG with
//! pixels inside.

mod body;
mod camera;
mod colours;
mod panel;
mod pixels;
mod scale;
mod surface;
mod svg;

pub use body::{Body, Field};
pub use camera::Direction;
pub(crate) use colours::region_colour;
pub(crate) use panel::Panel;
pub use panel::{Choice, Shown, panels};
pub use svg::picture_svg;
pub(crate) use svg::{bar_svg, panel_svg};

#[cfg(test)]
mod tests;
