//! From a scene to its problem, anywhere in space.

mod conditions;
mod frame;
mod material;
mod shape;

pub(crate) use conditions::solid;
pub(crate) use frame::Frame;
pub(crate) use material::relaxed_materials;
pub(crate) use shape::{as_surface, as_voxels, closed_form_volume, part, wedge_in_another_order};

use crate::scene::{Basis, Cloud, Gradients, Scene, Way};
use anyhow::Result;
use mtled::Vector3;
use mtled::geometry::Selector;
use mtled::problem::{
    self, Dimension, GradientStorage, Loads, MassRule, Motion, Newton, Problem, Recipe, Refinement,
    Region, VolumetricProjection, defaults,
};

/// Residual of a static solution over its largest nodal force \[–\]: ten thousand times
/// round-off, so that two ways to the same solution differ by no more than their
/// condition times this.
pub(crate) const RESIDUAL: f64 = 1e-12;
/// Of consistent gradients \[–\], for the same reason.
const GRADIENT_TOLERANCE: f64 = 1e-11;
/// Parts of the time in which materials with memory are followed.
const PARTS: usize = 4;
/// Movement of jittered nodes \[spacing\].
const JITTER: f64 = 0.2;

/// The problem of a scene at home.
pub(crate) fn problem(scene: &Scene) -> Result<Problem> {
    problem_in(scene, &Frame::home(scene))
}

/// The problem of a scene in a frame.
pub(crate) fn problem_in(scene: &Scene, frame: &Frame) -> Result<Problem> {
    let plane = scene.thickness.map(|thickness| Dimension::PlaneStrain {
        thickness: thickness * scene.size,
        z: frame.point(&frame.middle()).z,
    });
    let mut problem = Problem {
        dimension: plane.unwrap_or(Dimension::Three),
        body: shape::body(scene, frame)?,
        regions: regions(scene, frame)?,
        recipe: recipe(scene, frame),
        conditions: conditions::conditions(scene, frame),
        loads: Loads::default(),
        obstacles: conditions::obstacles(scene, frame),
        motion: motion(scene),
    };
    conditions::load(scene, frame, &mut problem.loads);
    conditions::load_more(scene, frame, &mut problem.loads);
    Ok(problem)
}

/// Newton's method to a time \[s\]; few parts of it are enough for what compares with itself.
pub(crate) fn newton(load_end: f64, tolerance: f64) -> Motion {
    Motion::Newton(Newton { load_end, tolerance, parts: PARTS })
}

fn motion(scene: &Scene) -> Motion {
    match scene.way {
        Way::Newton => newton(1.0, RESIDUAL),
        Way::Motion { damping, .. } => {
            Motion::dynamic(conditions::duration(scene), damping / scene.wave_time())
        }
    }
}

fn regions(scene: &Scene, frame: &Frame) -> Result<Vec<Region>> {
    let mut regions = Vec::new();
    if let Some(inclusion) = scene.inclusion {
        let part = shape::piece(frame, &inclusion);
        regions.push(material::region(scene, frame, "piece", part, inclusion.stiffness)?);
    }
    regions.push(material::region(scene, frame, "rest", Selector::All, 1.0)?);
    Ok(regions)
}

fn recipe(scene: &Scene, frame: &Frame) -> Recipe {
    let spacing = scene.size / f64::from(scene.spacings);
    let basis = match scene.basis {
        Basis::Linear => problem::Basis::Linear,
        Basis::Quadratic => {
            problem::Basis::ModifiedQuadratic { regularisation: defaults::REGULARISATION }
        }
    };
    let tolerance = GRADIENT_TOLERANCE;
    let seed = u64::from(scene.seed);
    let mut recipe = Recipe {
        basis,
        dilation: defaults::dilation(basis),
        gradients: match scene.gradients {
            Gradients::Plain => problem::Gradients::Plain,
            Gradients::Consistent => problem::Gradients::Consistent { tolerance },
            Gradients::SecondOrder => problem::Gradients::SecondOrder { tolerance },
        },
        mass: if scene.even_mass { MassRule::EvenSplit } else { MassRule::RowSum },
        gradient_storage: GradientStorage::Double,
        ..Recipe::with_spacing(spacing)
    };
    if scene.direct {
        recipe.enforcement = problem::Enforcement::Direct;
    }
    if !scene.projected {
        recipe.volumetric_projection = VolumetricProjection::None;
    }
    match scene.cloud {
        Cloud::Lattice => {}
        Cloud::Jittered => {
            recipe.cloud = problem::Cloud::Jittered { spacing, jitter: JITTER, seed };
        }
        Cloud::Graded => {
            let refinements = vec![Refinement {
                part: shape::ball(frame, &Vector3::zeros(), 0.3),
                size: 0.7 * spacing,
            }];
            let growth = defaults::GROWTH;
            recipe.cloud = problem::Cloud::Graded { spacing, refinements, growth, seed };
            recipe.grid = problem::BackgroundGrid::following(defaults::CELLS_PER_SPACING);
        }
    }
    recipe
}

#[cfg(test)]
mod tests {
    use super::*;
    use fastrand::Rng;

    #[test]
    fn every_scene_makes_a_problem() {
        let mut rng = Rng::with_seed(3);
        for _ in 0..300 {
            let scene = Scene::draw(&mut rng);
            assert!(problem(&scene).is_ok(), "{scene:?}: {:?}", problem(&scene).err());
        }
    }
}
