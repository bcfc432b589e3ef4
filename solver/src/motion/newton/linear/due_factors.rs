//! When factors of the tangent are made.

use super::coarse_space::Stiffness;
use super::factors::Factors;
use super::system::System;
use crate::algebra::tensor::Vector3;
use crate::model::Model;
use crate::motion::newton::free_space::FreeSpace;

/// Held displacements that may change before what was made for them is made again, over their
/// number \[–\].
const CHANGED: f64 = 0.02;
/// The same for the shift, as a factor \[–\].
const SHIFTED: f64 = 3.0;

/// What a preconditioner was made for: held nodes, roughly with the directions, and the shift.
pub(super) struct MadeFor {
    held: Vec<(u32, [u64; 3])>,
    shift: f64,
}

impl MadeFor {
    /// What is held now.
    pub fn now(free: &FreeSpace, shift: f64) -> MadeFor {
        // Normals of a closed contact turn a little; its node says enough.
        let roughly = |along: Vector3| [0, 1, 2].map(|k| (along[k].abs() * 2.0) as u64);
        let mut held: Vec<(u32, [u64; 3])> =
            free.held().iter().map(|(node, along)| (*node, roughly(*along))).collect();
        held.sort_unstable();
        MadeFor { held, shift }
    }

    /// Whether it still serves.
    pub fn serves(&self, now: &MadeFor) -> bool {
        let known = now.held.iter().filter(|entry| self.held.binary_search(entry).is_ok()).count();
        let changed = now.held.len() + self.held.len() - 2 * known;
        let ratio = (now.shift / self.shift).max(self.shift / now.shift);
        changed as f64 <= CHANGED * now.held.len() as f64
            && (now.shift == self.shift || ratio < SHIFTED)
    }
}

/// Factors of the tangent, made each time that iterations have cost as much as they do: so neither
/// costs more than twice what the other would have.
#[derive(Default)]
pub(super) struct DueFactors {
    factors: Option<Factors>,
    /// Whether they have been looked at; they may be too large.
    seen: bool,
    /// What they were made for, where they are in use.
    made_for: Option<MadeFor>,
    /// Products since they were made, and what solutions with them cost in products.
    spent: f64,
    /// How often in succession they could not be made.
    failures: i32,
    /// What factors and solutions with them have cost, in products.
    cost: f64,
}

impl DueFactors {
    /// Whether they are in use.
    pub fn are_made(&self) -> bool {
        self.made_for.is_some()
    }

    /// Leaves them where they no longer serve.
    pub fn keep_for(&mut self, now: &MadeFor) {
        self.made_for = self.made_for.take().filter(|made| made.serves(now));
    }

    /// Leaves them where the tangent is no longer positive definite.
    pub fn leave(&mut self) {
        self.made_for = None;
    }

    /// Counts a product; whether factors were due with it and have been made, or given up.
    pub fn count(
        &mut self,
        model: &Model,
        free: &FreeSpace,
        at_rest: &Stiffness,
        system: &mut System,
    ) -> bool {
        #[cfg(test)]
        if tests::SWITCHED_OFF.get() {
            return false;
        }
        self.spent += 1.0;
        if !self.seen && self.spent > Factors::least_price(model) {
            self.seen = true;
            self.factors = Factors::new(model);
        }
        let used = self.are_made();
        let Some(factors) = &mut self.factors else { return false };
        if used {
            self.spent += factors.price_of_solution;
            self.cost += factors.price_of_solution;
        }
        if self.spent < factors.price * f64::powi(2.0, self.failures) {
            return false;
        }
        self.spent = 0.0;
        self.cost += factors.price;
        let made = factors.make(free, at_rest, system);
        self.failures = if made { 0 } else { self.failures + 1 };
        self.made_for = made.then(|| MadeFor::now(free, system.shift));
        made || used
    }

    /// What they have cost since this was asked for, in products with the tangent.
    pub fn take_cost(&mut self) -> usize {
        let whole = self.cost.floor();
        self.cost -= whole;
        whole as usize
    }

    /// Solves with a force \[N\] in place.
    pub fn solve(&mut self, force: &mut [f64]) {
        if let Some(factors) = &mut self.factors {
            factors.solve(force);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::algebra::random::Random;
    use crate::algebra::tensor::Vector3;
    use crate::geometry::{Selector, Shape};
    use crate::material::{ElasticConstants, Law, Material, NeoHookeanLogJ};
    use crate::motion::observe::Unobserved;
    use crate::problem::{
        Amplitude, BodyForce, Dimension, EssentialCondition, Motion, Newton, Problem, Recipe,
    };
    use crate::simulation::Simulation;
    use std::cell::Cell;

    thread_local! {
        /// Whether iterations go on without factors, however much they cost.
        pub(super) static SWITCHED_OFF: Cell<bool> = const { Cell::new(false) };
    }

    /// A bar of random edges, two to eight times as long as it is thick, that hangs from one end
    /// aslant, in space or in a plane.
    fn bar(random: &mut Random, number: usize) -> Problem {
        let mut between =
            |low: f64, high: f64| low + 0.5 * (high - low) * (1.0 + random.symmetric());
        let edges = Vector3::new(between(2.0, 8.0), between(1.0, 1.5), between(1.0, 1.5)) * 0.01;
        let poisson_ratio = [0.3, 0.45, 0.49, 0.499][number % 4];
        let constants = ElasticConstants::from_young_poisson(3000.0, poisson_ratio).unwrap();
        let law = Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants));
        let material = Material { density: 1000.0, law };
        let body = Shape::Box { min: Vector3::zeros(), max: edges };
        let mut problem = Problem::new(body, material, Recipe::with_spacing(between(3e-3, 5e-3)));
        if number.is_multiple_of(3) {
            problem.dimension = Dimension::PlaneStrain { thickness: 1.0, z: 0.5 * edges.z };
        }
        let beyond = Shape::HalfSpace { point: Vector3::zeros(), normal: Vector3::x() };
        let end = Selector::Inside { shape: beyond, tolerance: 1e-6 };
        let ramp = Amplitude::Smooth { duration: 1.0 };
        problem.conditions =
            vec![EssentialCondition::on_surface("end", end, Vector3::zeros(), ramp.clone())];
        let acceleration = Vector3::new(between(-1.0, 1.0), between(-0.5, 0.5), 0.0).into();
        problem.loads.body_forces =
            vec![BodyForce { part: Selector::All, acceleration, amplitude: ramp }];
        problem.motion = Motion::Newton(Newton::default());
        problem
    }

    /// The displacement \[component of node\] \[m\], and products with the tangent.
    fn solved(problem: &Problem, switched_off: bool) -> (Vec<f64>, usize) {
        let mut simulation = Simulation::new(problem).unwrap();
        SWITCHED_OFF.set(switched_off);
        let summary = simulation.run(&mut Unobserved);
        SWITCHED_OFF.set(false);
        (simulation.state.displacement, summary.unwrap().newton.unwrap().products)
    }

    #[test]
    fn factors_lead_random_bars_where_iterations_without_them_do() {
        let mut random = Random(5);
        let mut factored = 0;
        for number in 0..24 {
            let problem = bar(&mut random, number);
            let (with, products) = solved(&problem, false);
            let (without, more) = solved(&problem, true);
            factored += usize::from(products < more);
            let largest = without.iter().fold(0.0f64, |most, u| most.max(u.abs()));
            let difference =
                with.iter().zip(&without).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
            assert!(difference <= 1e-6 * largest, "bar {number}: {difference} of {largest} m");
        }
        assert!(factored >= 8, "factors were made for {factored} bars only");
    }
}
