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
pub use colours::region_colour;
pub use panel::{Choice, Panel, Shown, panels};
pub use svg::{bar_svg, panel_svg, picture_svg};

#[cfg(test)]
mod tests;
