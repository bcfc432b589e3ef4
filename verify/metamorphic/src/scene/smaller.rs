//! Smaller scenes: with one thing less, or one thing plainer.

use super::{Basis, Cloud, Form, Gradients, Hold, Law, Part, Piece, Place, Rubs, Scene, Wall, Way};

impl Scene {
    /// Scenes that are a little plainer than this one, the largest cuts first.
    pub fn smaller(&self) -> Vec<Scene> {
        let mut all = Vec::new();
        let mut add = |change: &dyn Fn(&mut Scene)| {
            let mut scene = self.clone();
            change(&mut scene);
            if scene != *self {
                all.push(scene);
            }
        };
        for n in 0..self.pushes.len() {
            add(&|scene| {
                scene.pushes.remove(n);
            });
        }
        for n in 0..self.holds.len() {
            add(&|scene| {
                scene.holds.remove(n);
            });
        }
        add(&|scene| scene.obstacle = None);
        add(&|scene| scene.inclusion = None);
        add(&of_halves);
        add(&|scene| scene.bed = None);
        add(&|scene| scene.filling = None);
        add(&|scene| scene.memory = None);
        add(&|scene| scene.tension = None);
        add(&without_hole);
        add(&|scene| scene.way = Way::Newton);
        add(&|scene| (scene.law, scene.memory) = (Law::LogJ, None));
        add(&|scene| scene.law = if scene.memory.is_some() { Law::Isochoric } else { scene.law });
        add(&|scene| scene.cloud = Cloud::Lattice);
        add(&|scene| scene.basis = Basis::Linear);
        add(&|scene| scene.gradients = Gradients::Plain);
        if self.gradients == Gradients::SecondOrder {
            add(&|scene| scene.gradients = Gradients::Consistent);
        }
        add(&|scene| scene.direct = false);
        add(&|scene| scene.even_mass = scene.basis == Basis::Quadratic);
        add(&|scene| scene.projected = false);
        add(&|scene| scene.poisson_ratio = 0.25);
        add(&|scene| (scene.size, scene.young_modulus, scene.density) = (1.0, 1.0, 1.0));
        add(&|scene| scene.size = 1.0);
        add(&|scene| scene.edges = [1.0; 3]);
        add(&|scene| scene.spacings = (scene.spacings / 2).max(2));
        add(&|scene| scene.spacings = (scene.spacings - 1).max(2));
        add(&|scene| scene.thickness = scene.thickness.map(|_| 1.0));
        add(&|scene| scene.seed = 1);
        for n in 0..self.holds.len() {
            for hold in plainer(&self.holds[n]) {
                add(&|scene| scene.holds[n] = hold);
            }
        }
        for wall in self.obstacle.iter().flat_map(plainer_wall) {
            add(&|scene| scene.obstacle = Some(wall));
        }
        add(&on_a_lower_end);
        all
    }
}

/// With a half of the other material, if there is one.
fn of_halves(scene: &mut Scene) {
    if let Some(inclusion) = &mut scene.inclusion {
        inclusion.piece = Piece::Half;
    }
}

/// With springs below, if there are any.
fn on_a_lower_end(scene: &mut Scene) {
    if let Some(bed) = &mut scene.bed {
        bed.part = Part::End { axis: 1, upper: false, depth: 0.15 };
    }
}

/// The box, with nothing on or in a hole.
fn without_hole(scene: &mut Scene) {
    scene.form = Form::Box;
    scene.filling = None;
    if let Some(bed) = &mut scene.bed
        && bed.part == Part::Hole
    {
        bed.part = Part::Whole;
    }
}

/// Plainer obstacles.
fn plainer_wall(wall: &Wall) -> [Wall; 3] {
    [
        Wall { drift: None, ..*wall },
        Wall { rubs: Rubs::Free, ..*wall },
        Wall { drift: wall.drift.map(|drift| super::Drift { turn: 0.0, ..drift }), ..*wall },
    ]
}

/// Plainer conditions.
fn plainer(hold: &Hold) -> Vec<Hold> {
    let mut all = vec![
        Hold { release: None, ..*hold },
        Hold { inner: false, ..*hold },
        Hold { to: Place::Still, ..*hold },
    ];
    if let Part::End { axis, upper, .. } | Part::Spot { axis, upper, .. } = hold.part {
        all.push(Hold { part: Part::End { axis, upper, depth: 1e-4 }, ..*hold });
    }
    all
}
