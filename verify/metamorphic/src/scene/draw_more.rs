//! What a scene has besides, at random.

use super::draw::{between, chance, one, vector};
use super::{Bed, Drift, Filling, Form, Memory, Part, Piece, Rubs, Scene};
use fastrand::Rng;

impl Scene {
    /// Adds springs, a fluid, memory and tension, and lets the obstacle move and rub: each to
    /// few scenes, so that most stay plain. With random numbers of its own.
    pub(super) fn draw_more(&mut self, rng: &mut Rng) {
        if self.form == Form::Box && chance(rng, 4) {
            self.draw_hole(rng);
        }
        if chance(rng, 6) {
            self.draw_bed(rng);
        }
        if self.law.is_split() && chance(rng, 3) {
            let (part, time) = (one(rng, &[0.2, 0.5, 0.9]), one(rng, &[0.05, 0.5, 5.0]));
            self.memory = Some(Memory { part, time });
        }
        if chance(rng, 10) {
            self.tension = Some(between(rng, 0.01, 0.1));
        }
        self.draw_way_of_obstacle(rng);
        if let Some(inclusion) = &mut self.inclusion {
            let thickness = one(rng, &[0.071, 0.13, 0.29]);
            let (layer, askew) = (Piece::Layer(thickness), Piece::Askew(thickness));
            let ball = Piece::Ball(one(rng, &[0.23, 0.37, 0.46]));
            inclusion.piece = one(rng, &[Piece::Half, layer, askew, ball, ball]);
        }
    }

    /// A hole with walls of more than a spacing.
    fn draw_hole(&mut self, rng: &mut Rng) {
        self.form = one(rng, &[Form::Hollow, Form::Chamber]);
        let least = if self.components() == 2 { 8 } else { 5 };
        self.spacings = self.spacings.max(least);
        self.edges = self.edges.map(|edge| edge.max(0.8));
        if !chance(rng, 4) {
            let bulk_modulus = one(rng, &[0.3, 10.0, 1e3, 1e5]);
            self.filling = Some(Filling { bulk_modulus, inflow: between(rng, -0.1, 0.3) });
        }
    }

    fn draw_bed(&mut self, rng: &mut Rng) {
        let d = self.components();
        let axis = rng.u8(..d as u8);
        let end = Part::End { axis, upper: rng.bool(), depth: between(rng, 0.15, 0.4) };
        let hole = if self.form.has_hole() { Part::Hole } else { Part::Whole };
        let part = one(rng, &[end, end, Part::Whole, hole]);
        let normal = one(rng, &[0.1, 1.0, 10.0, 1e3]);
        let tangential = one(rng, &[0.0, 0.1, 1.0, 10.0]);
        self.bed = Some(Bed { part, normal, tangential });
        // What holds a body where springs do leaves them nothing to do.
        if tangential > 0.0 && chance(rng, 3) {
            self.holds.truncate(0);
        }
    }

    fn draw_way_of_obstacle(&mut self, rng: &mut Rng) {
        let (d, motion) = (self.components(), !self.is_static());
        let Some(wall) = &mut self.obstacle else { return };
        if chance(rng, 2) {
            let mut by = vector(rng, d, 0.1);
            by[1] = wall.gap + between(rng, -0.02, 0.08);
            let turn = one(rng, &[0.0, 0.0, 0.1, -0.2]);
            wall.drift = Some(Drift { by, turn });
        }
        wall.rubs = match (rng.usize(..6), motion) {
            (0, _) => Rubs::Sticks,
            (1 | 2, true) => Rubs::Coulomb(one(rng, &[0.0, 0.1, 0.5, 3.0])),
            _ => Rubs::Free,
        };
    }
}
