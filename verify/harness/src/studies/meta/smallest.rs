//! The smallest case file that reproduces a failure: a cube between rollers, whose solution is
//! known to round-off on any cloud.
#![allow(non_snake_case)]

use crate::exact::homogeneous::uniaxial;
use crate::studies::workbench::relative_error;
use mtled::algebra::tensor::Vector3;
use mtled_case::bundled::CASES;
use mtled_case::scene::{Case, Knob, Setting, edited, parse_case};
use mtled_checks::study::Study;
use mtled_run::run::solve_case;
use std::path::Path;

/// Edge of the cube \[m\].
const EDGE: f64 = 0.1;
/// Stretch between the rollers \[–\].
const STRETCH: f64 = 1.1;
/// Spacings along an edge that are tried, the coarsest cloud last.
const SPACINGS: [f64; 4] = [5.0, 4.0, 3.0, 2.0];
/// Tolerance of the width \[–\]: the gradients are consistent to 1e-12, the relaxation to 1e-7.
const WIDTH: f64 = 1e-5;
/// Tolerance of the reaction \[–\]; the residual may be ten times that of the relaxation.
const REACTION: f64 = 1e-4;

/// Attaches to each failing check of a study a case that reproduces the failure: the smallest cube
/// that also fails, else the bundled case that the check is about.
pub(crate) fn attach(study: &mut Study) {
    if study.checks.iter().all(|check| check.pass || check.reproduce.is_some()) {
        return;
    }
    let cube = smallest_failing(&cube_text(), &SPACINGS.map(|n| EDGE / n), is_off);
    for check in study.checks.iter_mut().filter(|check| !check.pass) {
        let bundled = CASES.iter().find(|(name, _)| check.id.split('/').nth(1) == Some(name));
        let text = || bundled.map(|(_, text)| text.to_string());
        check.reproduce = check.reproduce.take().or_else(|| cube.clone()).or_else(text);
    }
}

/// The case at the coarsest of ever coarser `spacings` \[m\] at which it still fails;
/// None if it passes at the first. The finest costs most, so the work is at most about twice
/// that of the first.
pub(crate) fn smallest_failing(
    text: &str,
    spacings: &[f64],
    fails: impl Fn(&Case) -> bool,
) -> Option<String> {
    let failing = |&spacing: &f64| {
        let text = edited(text, &[Setting::number(Knob::Spacing, spacing)]).ok()?;
        let case = parse_case(&text, "smallest", Path::new(".")).ok()?;
        fails(&case).then_some(text)
    };
    spacings.iter().map_while(failing).last()
}

/// A jittered cube pulled between rollers: one stretch everywhere.
fn cube_text() -> String {
    let face = |name: &str, at: f64, by: f64| {
        format!(
            "[[prescribe]]\nname = \"{name}\"\nof = \"surface\"\n\
             where = {{ plane = {{ point = [{at:?}, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }} }}\n\
             displacement = {{ x = {by:?} }}\n\
             amplitude = {{ smooth = {{ duration = 1.0 }} }}\n\n"
        )
    };
    let faces = [face("left", 0.0, 0.0), face("right", EDGE, (STRETCH - 1.0) * EDGE)];
    format!("{CUBE}{}{ENDING}", faces.concat())
}

const CUBE: &str = r#"# Pulled between two rollers the cube stretches by 1.1 along x and is free to contract:
# its corners (0.1, 0, 0) and (0.1, 0.1, 0) end 0.095433 m apart, and the force is that
# of the stretch. A correct solver agrees with the closed form to five digits on this cloud and
# on any other; the one that wrote this file does not.
title = "Smallest cube that fails"
description = "A jittered cube between two rollers, pulled by 10 %."
source = "Bonet and Wood 2008, section 6.4, lateral stress zero"

[geometry]
shape = { box = { min = [0.0, 0.0, 0.0], max = [0.1, 0.1, 0.1] } }

[material.tissue]
law = "neo_hookean_log_j"
density = 1000.0
young_modulus = 3000.0
poisson_ratio = 0.49

[discretisation]
cloud = "jittered"
jitter = 0.3
seed = 1
spacing = 0.02
gradient_tolerance = 1e-12

"#;

const ENDING: &str = r#"[time]
method = "static"
load_steps = 300
tolerance = 1e-7
max_steps = 5000

[[probe]]
name = "one corner"
point = [0.1, 0.0, 0.0]

[[probe]]
name = "the next"
point = [0.1, 0.1, 0.0]
"#;

/// Whether the cube differs from its closed form or cannot be solved.
fn is_off(case: &Case) -> bool {
    let within = |[width, force]: [f64; 2]| width <= WIDTH && force <= REACTION;
    !errors(case).is_some_and(within)
}

/// Relative errors of the width at the pulled end and of the force.
fn errors(case: &Case) -> Option<[f64; 2]> {
    let (_, record) = solve_case(case).ok()?;
    let last = record.samples.last()?;
    let corner = |n: usize| last.displacements.get(n)?.first().copied();
    let width = (Vector3::y() * EDGE + corner(1)? - corner(0)?).norm();
    let pull = last.reactions.last()?.force.x;
    let exact = uniaxial::uniaxial_stress(&case.problem.regions[0].material.law, STRETCH)?;
    let force = exact.nominal_stress * EDGE * EDGE;
    Some([relative_error(width, exact.lateral_stretch * EDGE), relative_error(pull, force)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::{Context, Result, anyhow};
    use mtled_run::specimens::spacing::spacing_of;

    fn cube(spacings: f64) -> Result<Case> {
        let text = edited(&cube_text(), &[Setting::number(Knob::Spacing, EDGE / spacings)])?;
        parse_case(&text, "cube", Path::new("."))
            .map_err(|mistakes| anyhow!("{}", mistakes[0]))
            .context("the cube is not a valid case")
    }

    #[test]
    fn the_solver_agrees_with_the_closed_form_on_every_cube() {
        for spacings in SPACINGS {
            let [width, force] = errors(&cube(spacings).unwrap()).unwrap();
            assert!(width < WIDTH && force < REACTION, "{width} {force}");
        }
    }

    #[test]
    fn the_width_that_the_file_states_is_the_closed_form() {
        let case = cube(2.0).unwrap();
        let law = &case.problem.regions[0].material.law;
        let lateral = uniaxial::uniaxial_stress(law, STRETCH).unwrap().lateral_stretch;
        assert!((lateral - 0.95433).abs() < 1e-5, "{lateral}");
    }

    #[test]
    fn the_coarsest_failing_cloud_is_kept_and_the_search_ends_where_it_passes() {
        let fine = |case: &Case| spacing_of(&case.problem).unwrap() < 0.03;
        let text = smallest_failing(&cube_text(), &SPACINGS.map(|n| EDGE / n), fine).unwrap();
        assert!(text.contains("spacing = 0.025"), "{text}");
        assert!(smallest_failing(&cube_text(), &[0.05], fine).is_none());
    }
}
