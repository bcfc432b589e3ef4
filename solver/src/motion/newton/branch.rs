//! From an equilibrium that a body would leave to another one under the same load.
#![allow(non_snake_case)]

use super::increment::{Load, Unsolved};
use super::linear::Guide;
use super::solver::{Equilibrium, Solver};
use crate::algebra::packed::{dot, largest};
use crate::motion::observe::Observer;
use crate::motion::stability::{Here, Stability};
use crate::motion::state::State;
use crate::motion::step::Buffers;
use crate::motion::tangent::Tangent;

/// Stiffness of the spring over that of the motion at rest, and over the size of its
/// curvature \[–\].
const FIRM: f64 = 2.0;
/// First step of the amplitude over the size of the body, and the bounds of all \[–\].
const STEP: f64 = 0.02;
const STEPS: (f64, f64) = (1e-3, 0.2);
/// Factors of the step after a solution and after a failure \[–\].
const LONGER: f64 = 1.5;
const SHORTER: f64 = 0.4;
/// Amplitude over the size of the body beyond which nothing is looked for \[–\].
const FARTHEST: f64 = 1.0;
/// Most solutions with the spring.
const MOST_SOLUTIONS: usize = 24;
/// Their tolerance \[–\].
const TOLERANCE: f64 = 1e-3;
/// Part of the last amplitude that an equilibrium without the spring keeps; less has fallen back
/// to the first one \[–\].
const KEPT: f64 = 0.3;
/// Part of the force of the spring below which a change is none \[–\].
const ROUND_OFF: f64 = 1e-2;
/// Equilibria in turn that a body leaves for another one at the same load.
const MOST_LEFT: usize = 3;

/// How far beyond the last part of the load with an equilibrium another one is looked for \[–\].
pub(super) const AHEAD: f64 = 0.05;

/// Which of several equilibria the body is led to.
#[derive(Default)]
pub(super) struct Branch {
    pub stability: Stability,
    /// Whether it stays on one that is not stable.
    stays: bool,
    /// How often one was found beyond the last of a branch.
    found_beyond: usize,
}

impl Branch {
    /// A stable equilibrium in place of one that is not; that one as an error where no way leads
    /// away from it. What obstacles alone hold is judged at the end, and is not led.
    pub fn stable(
        &mut self,
        solver: &mut Solver,
        mut equilibrium: Equilibrium,
        load: Load,
        buffers: &mut Buffers,
        observer: &mut dyn Observer,
    ) -> Result<Equilibrium, Box<Equilibrium>> {
        let led = !self.stays && !solver.floating;
        if !led && load.fraction < 1.0 {
            return Ok(equilibrium);
        }
        let model = solver.model;
        for _ in 0..=MOST_LEFT {
            let (contact, _) = solver.without_contact(equilibrium.exact());
            let mut touching: Vec<u32> = contact.iter().map(|force| force.node).collect();
            touching.dedup();
            let unbalanced = equilibrium.exact().free(model);
            let here = Here {
                step: solver.counts.iterations,
                time: solver.path.time(load.fraction),
                displacement: &equilibrium.u,
                touching: &touching,
                unbalanced: Some(&unbalanced),
            };
            let found = self.stability.search(model, here, &mut buffers.workspace);
            let Some(motion) = found else { return Ok(equilibrium) };
            let motion = of_unit_size(motion);
            let next = if led {
                solver.lead(&equilibrium.u, &motion, load, buffers, observer)
            } else {
                None
            };
            match next {
                Some(next) => equilibrium = next.equilibrium,
                None => break,
            }
        }
        if led { Err(Box::new(equilibrium)) } else { Ok(equilibrium) }
    }

    /// An equilibrium under more load than that of a state beyond which Newton's method finds
    /// none, along the softest motion of the state.
    pub fn beyond(
        &mut self,
        solver: &mut Solver,
        state: &State,
        load: Load,
        buffers: &mut Buffers,
        observer: &mut dyn Observer,
    ) -> Option<Equilibrium> {
        if self.stays || solver.floating || self.found_beyond == MOST_LEFT {
            return None;
        }
        let (model, u) = (solver.model, &state.displacement);
        let mode = self.stability.softest(model, Here::of(state), &mut buffers.workspace)?;
        let mut motion = of_unit_size(mode.motion);
        let imbalance = solver.imbalance(u, load.fraction, buffers);
        if dot(&motion, &imbalance.free(model)) < 0.0 {
            motion.iter_mut().for_each(|v| *v = -*v);
        }
        let Led { equilibrium, unstable } = solver.lead(u, &motion, load, buffers, observer)?;
        if unstable {
            self.stability.left(model, solver.counts.iterations, &motion);
        }
        self.found_beyond += 1;
        let stable = self.stable(solver, equilibrium, load, buffers, observer);
        Some(stable.unwrap_or_else(|unstable| self.stay_on(*unstable)))
    }

    /// Gives up to look for another one.
    pub fn stay_on(&mut self, unstable: Equilibrium) -> Equilibrium {
        self.stays = true;
        unstable
    }
}

/// Where a body was led.
struct Led {
    equilibrium: Equilibrium,
    /// Whether it had to be held back more and more somewhere on the way.
    unstable: bool,
}

impl Solver<'_> {
    /// Leads the body from displacements `from` \[m\] along a motion, whose largest component
    /// is 1, until it has to be pushed and no longer to be held, and lets go of it there
    /// (method book, eq. 20.8).
    fn lead(
        &mut self,
        from: &[f64],
        motion: &[f64],
        load: Load,
        buffers: &mut Buffers,
        observer: &mut dyn Observer,
    ) -> Option<Led> {
        let kept = (self.contacts.clone(), self.own.clone());
        let led = self.led(from, motion, load, buffers, observer);
        self.guide = None;
        if led.is_none() {
            self.put_back(kept, from);
        }
        led
    }

    fn led(
        &mut self,
        from: &[f64],
        motion: &[f64],
        load: Load,
        buffers: &mut Buffers,
        observer: &mut dyn Observer,
    ) -> Option<Led> {
        let extent = self.model.extent;
        let passing = Load { tolerance: load.tolerance.max(TOLERANCE), ..load };
        self.guide = Some(self.spring(from, motion, load.fraction, buffers));
        let mut here = from.to_vec();
        let (mut amplitude, mut step) = (0.0, STEP * extent);
        let (mut held, mut unstable) = (f64::INFINITY, false);
        for _ in 0..MOST_SOLUTIONS {
            let next = amplitude + step;
            if next > FARTHEST * extent || step < STEPS.0 * extent {
                return None;
            }
            self.guide.as_mut()?.amplitude = next;
            match self.solve(&here, passing, buffers, observer) {
                Ok(equilibrium) => {
                    here = equilibrium.u;
                    (amplitude, step) = (next, (LONGER * step).min(STEPS.1 * extent));
                }
                Err(Unsolved::Stopped(_)) => return None,
                Err(Unsolved::Failed { .. }) => {
                    step *= SHORTER;
                    continue;
                }
            }
            // Held back, it is still on its way.
            let ahead = self.guide.as_ref()?.reached(&here) - amplitude;
            unstable |= ahead > (1.0 + ROUND_OFF) * held;
            held = ahead;
            if held > 0.0 {
                continue;
            }
            let guide = self.guide.take()?;
            let free = self.solve(&here, load, buffers, observer);
            if let Ok(equilibrium) = free
                && guide.reached(&equilibrium.u).abs() > KEPT * guide.reached(&here).abs()
            {
                return Some(Led { equilibrium, unstable });
            }
            self.guide = Some(guide);
        }
        None
    }

    fn spring(
        &mut self,
        from: &[f64],
        motion: &[f64],
        fraction: f64,
        buffers: &mut Buffers,
    ) -> Guide {
        let model = self.model;
        let mass = |i: usize| model.inertia[i / model.components];
        let heavy: Vec<f64> = motion.iter().enumerate().map(|(i, v)| mass(i) * v).collect();
        let norm = dot(&heavy, motion);
        let weights: Vec<f64> = heavy.iter().map(|v| v / norm).collect();
        let at_rest = self.curvature(&vec![0.0; from.len()], motion, fraction, buffers);
        let here = self.curvature(from, motion, fraction, buffers);
        let stiffness = FIRM * (at_rest.max(0.0) + here.abs());
        let origin = dot(&weights, from);
        Guide { weights, stiffness, origin, amplitude: 0.0 }
    }

    /// vᵀ K v \[N m\] along a motion at displacements `u` \[m\].
    fn curvature(
        &mut self,
        u: &[f64],
        motion: &[f64],
        fraction: f64,
        buffers: &mut Buffers,
    ) -> f64 {
        let t = self.path.time(fraction);
        self.counts.products += 1;
        self.counts.evaluations += 1;
        let mut tangent = Tangent::new(self.model, u, t, &mut buffers.workspace);
        dot(motion, &tangent.stiffness_times(motion))
    }
}

/// A motion whose largest component is 1.
fn of_unit_size(mut motion: Vec<f64>) -> Vec<f64> {
    let size = largest(&motion).max(f64::MIN_POSITIVE);
    motion.iter_mut().for_each(|v| *v /= size);
    motion
}
