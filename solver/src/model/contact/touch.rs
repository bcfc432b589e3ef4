//! Nodes that have entered obstacles in a step, and the pushes that bring all of them back together
//! (method book, eqs. 16.2 and 16.6).

use super::plan::{Components, ContactPlan};
use super::values::Pushed;
use crate::algebra::tensor::Vector3;
use crate::problem::Friction;

/// Change of a value in a sweep over the deepest entry of the step below which sweeps end \[–\].
const SETTLED: f64 = 1e-9;
/// Distance from a curved surface over the mean spacing above which it is looked at again \[–\].
const OFF_SURFACE: f64 = 1e-6;
/// Most looks at it in a step.
const MOST_LOOKS: usize = 4;
/// Most sweeps after each; what is left is for the next step.
const MOST_SWEEPS: usize = 300;

/// A node that has entered an obstacle.
#[derive(Debug, Clone)]
pub(super) struct Touch {
    pub obstacle: u32,
    pub node: u32,
    /// Of the rows of the plan.
    pub row: u32,
    /// Which components the obstacle may push.
    pub free: Components,
    /// Out of the obstacle.
    pub normal: Vector3,
    /// Signed gap at the value `at` of the displacement, a plane from there on \[m\].
    pub gap: f64,
    pub at: Vector3,
    /// From there to where it would be without slip \[m\].
    pub back: Vector3,
    /// Where that is, as the obstacle sees it.
    pub anchor: Vector3,
    pub friction: Friction,
    /// Σ φ²/m along each axis \[1/kg\].
    pub mobility: Vector3,
    /// m Δu \[kg·m\].
    pub push: Vector3,
}

impl Touch {
    /// Whether the obstacle pushes.
    pub fn is_closed(&self) -> bool {
        self.push.dot(&self.normal) > 0.0
    }

    /// Takes the surface as it is where the value has come to; returns how far it was off \[m\].
    fn look_again(
        &mut self,
        plan: &ContactPlan,
        positions: &[Vector3],
        t: f64,
        pushed: &Pushed,
    ) -> f64 {
        if !self.is_closed() {
            return 0.0;
        }
        let at = plan.value(self.row, pushed.displacement);
        let (moved, x) = (at - self.at, positions[self.node as usize] + at);
        let now = plan.placed(self.obstacle, t);
        let (gap, normal) = (now.gap(&x), now.normal(&x, self.free));
        let off = (gap - (self.gap + self.normal.dot(&moved))).abs();
        if off > OFF_SURFACE * plan.mean_spacing && normal != Vector3::zeros() {
            (self.gap, self.normal, self.at) = (gap, normal, at);
            self.back -= moved;
        }
        off
    }

    /// Whether friction holds it where it was.
    pub fn holds(&self) -> bool {
        let (along, pushed) = self.parts(&self.push);
        match self.friction {
            Friction::Frictionless => false,
            Friction::NoSlip => true,
            Friction::Coulomb(coefficient) => along.norm() < coefficient * pushed * (1.0 - 1e-9),
        }
    }

    /// Begins with what of a push \[kg·m\] is right here.
    pub fn begin(&mut self, push: &Vector3) {
        let (along, pushed) = self.parts(push);
        let along = if self.friction == Friction::Frictionless { Vector3::zeros() } else { along };
        self.push = if pushed > 0.0 { pushed * self.normal + along } else { Vector3::zeros() };
    }

    /// The part of a vector along the surface, and that along the normal.
    fn parts(&self, v: &Vector3) -> (Vector3, f64) {
        let normal = v.dot(&self.normal);
        (v - self.normal * normal, normal)
    }

    /// The push that would be right if no other one changed, for a value that has moved by `moved`
    /// \[m\] since the entry.
    fn better(&self, moved: &Vector3) -> Vector3 {
        let along_normal = self.normal.component_mul(&self.normal).dot(&self.mobility);
        if along_normal <= 0.0 {
            return self.push;
        }
        let (along, pushed) = self.parts(&self.push);
        let gap = self.gap + self.normal.dot(moved);
        let pushes = (pushed - gap / along_normal).max(0.0);
        let most = match self.friction {
            Friction::Frictionless => 0.0,
            Friction::NoSlip if pushes > 0.0 => f64::INFINITY,
            Friction::NoSlip => 0.0,
            Friction::Coulomb(coefficient) => coefficient * pushes,
        };
        if most == 0.0 {
            return pushes * self.normal;
        }
        let free = Vector3::from_fn(|k, _| if self.free[k] { 1.0 } else { 0.0 });
        let (left, _) = self.parts(&(self.back - moved).component_mul(&free));
        let along = along + left / self.mobility.max();
        pushes * self.normal + along * (most / along.norm()).min(1.0)
    }
}

/// Pushes values until none is inside and friction is met, from the pushes that the touches have;
/// again with the surface where they have come to, where it is curved.
pub(super) fn settle(
    touches: &mut [Touch],
    plan: &ContactPlan,
    (positions, t): (&[Vector3], f64),
    pushed: &mut Pushed,
) {
    touches.iter().for_each(|touch| plan.push(touch.row, &touch.push, pushed));
    for _ in 0..MOST_LOOKS {
        sweep(touches, plan, pushed);
        let off = touches.iter_mut().map(|touch| touch.look_again(plan, positions, t, pushed));
        if off.fold(0.0, f64::max) <= OFF_SURFACE * plan.mean_spacing {
            break;
        }
    }
}

/// Projected Gauss–Seidel sweeps (Jean 1999).
fn sweep(touches: &mut [Touch], plan: &ContactPlan, pushed: &mut Pushed) {
    let deepest = touches.iter().map(|touch| -touch.gap).fold(0.0, f64::max);
    for _ in 0..MOST_SWEEPS {
        let mut largest = 0.0f64;
        for touch in touches.iter_mut() {
            let moved = plan.value(touch.row, pushed.displacement) - touch.at;
            let better = touch.better(&moved);
            let change = better - touch.push;
            if change != Vector3::zeros() {
                plan.push(touch.row, &change, pushed);
                touch.push = better;
                largest = largest.max(change.component_mul(&touch.mobility).amax());
            }
        }
        if largest <= SETTLED * deepest {
            break;
        }
    }
}
