//! The benchmark of hearts by Land et al.

use super::published::Published;

/// Height of the beam of the first problem \[m\].
pub(crate) const BEAM_HEIGHT: f64 = 1e-3;

/// z of the middle of the upper edge of its free end, (10, 0.5, 1) mm, where the pressure has bent
/// it \[m\]: the fine solutions of eleven groups lie between 4.14 and 4.20 mm. It is a position: the
/// deflection is 1 mm less.
pub(crate) const TIP_OF_BEAM: Published = Published {
    value: 4.17e-3,
    uncertainty: 0.03e-3,
    unit: "m",
    source: "Land et al., Proc. R. Soc. A 471:20150641 (2015), problem 1; read off its figure",
};
