//! Free vibration of a body at rest: its tangent, its masses, what holds it, and its rigid motions.
#![allow(non_snake_case)]

use super::free_space::FreeSpace;
use super::linear::{Solver, System};
use super::solver::SHIFTS;
use super::unknowns::{Pressures, are_unknowns, most};
use crate::algebra::lowest_modes::Operators;
use crate::algebra::packed::{make_orthogonal, overlap};
use crate::algebra::tensor::Vector3;
use crate::discretisation::Rows;
use crate::force::{Workspace, internal_force};
use crate::model::Model;
use crate::model::rigid_motions::free_rigid_fields;
use crate::motion::tangent::Tangent;
use rayon::prelude::*;

/// Forces that an approximate solution with K leaves, over those that it begins with \[–\]: with
/// 0.3 as many products are needed, with 0.01 a third more.
const FORCING: f64 = 0.1;
/// Square of the part of a rigid motion beside others below which it is none of its own \[–\].
const SAME: f64 = 1e-12;

/// Places that move with the displacement there, and have masses.
pub(crate) struct MassPlaces<'a> {
    /// Shape functions Φ at the places.
    pub rows: &'a Rows,
    /// m \[place\] \[kg\].
    pub masses: Vec<f64>,
}

/// K, the tangent at u = 0, and M = Φᵀ m Φ of all places with masses, on the motions that conditions leave free and that are not rigid (method book, eqs. 30.1
/// and 30.2).
pub(crate) struct Vibration<'a> {
    model: &'a Model,
    places: Vec<MassPlaces<'a>>,
    rest: Vec<f64>,
    workspace: Workspace,
    linear: Solver,
    free: FreeSpace<'a>,
    pressures: Option<Pressures>,
    /// Free rigid motions that are orthonormal in M, and M times them.
    rigid: [Vec<Vec<f64>>; 2],
    /// Called before every product, with the number of modes found.
    go_on: &'a mut dyn FnMut(usize) -> bool,
    /// Products with K.
    pub products: usize,
}

impl<'a> Vibration<'a> {
    /// Under the conditions of t = 0.
    pub fn new(
        model: &'a Model,
        places: Vec<MassPlaces<'a>>,
        go_on: &'a mut dyn FnMut(usize) -> bool,
    ) -> Vibration<'a> {
        let rest = vec![0.0; model.size()];
        let mut workspace = Workspace::new(&model.points);
        let unknown = are_unknowns(model);
        let pressures = unknown.then(|| {
            internal_force(&model.points, &rest, &mut workspace, &mut vec![0.0; rest.len()]);
            Pressures::of_j(model, &workspace)
        });
        let mut vibration = Vibration {
            places,
            linear: Solver::new(model, most(unknown)),
            free: FreeSpace::new(model, 0.0),
            rigid: Default::default(),
            model,
            rest,
            workspace,
            pressures,
            go_on,
            products: 0,
        };
        vibration.find_rigid_motions();
        vibration
    }

    /// Number of rigid motions that nothing prevents, of all pieces of the body together.
    pub fn rigid_motions(&self) -> usize {
        self.rigid[0].len()
    }

    fn find_rigid_motions(&mut self) {
        for mut motion in free_rigid_fields(self.model, 0.0) {
            let before = overlap(&motion, &self.mass(&motion));
            let [motions, masses] = &self.rigid;
            make_orthogonal(&mut motion, motions, masses);
            let mut mass = self.mass(&motion);
            let square = overlap(&motion, &mass);
            if square > SAME * before {
                let length = square.sqrt();
                motion.iter_mut().chain(&mut mass).for_each(|x| *x /= length);
                self.rigid[0].push(motion);
                self.rigid[1].push(mass);
            }
        }
    }
}

impl Operators for Vibration<'_> {
    fn size(&self) -> usize {
        self.rest.len()
    }

    fn dimension(&self) -> usize {
        let held = self.model.constraints.count(0.0);
        self.size().saturating_sub(held + self.rigid_motions())
    }

    fn project(&mut self, motion: &mut [f64]) {
        self.free.project(motion);
        let [motions, masses] = &self.rigid;
        make_orthogonal(motion, motions, masses);
    }

    fn stiffness(&mut self, motion: &[f64]) -> Vec<f64> {
        self.products += 1;
        Tangent::new(self.model, &self.rest, 0.0, &mut self.workspace).stiffness_times(motion)
    }

    fn mass(&self, motion: &[f64]) -> Vec<f64> {
        let d = self.model.components;
        let mut product = vec![0.0; motion.len()];
        for MassPlaces { rows, masses } in &self.places {
            let momentum = |place: usize| masses[place] * rows.interpolate(place, motion, d);
            let momenta: Vec<Vector3> = (0..rows.len()).into_par_iter().map(momentum).collect();
            for (place, momentum) in momenta.iter().enumerate() {
                for entry in rows.row(place) {
                    let own = &mut product[d * rows.nodes[entry] as usize..][..d];
                    own.iter_mut().zip(momentum).for_each(|(own, p)| *own += rows.phi[entry] * p);
                }
            }
        }
        product
    }

    fn solve(&mut self, residual: &[f64], found: usize) -> Option<Vec<f64>> {
        let shift = if self.rigid_motions() == 0 { 0.0 } else { SHIFTS.0 };
        let Vibration { model, rest, workspace, linear, free, pressures, go_on, .. } = self;
        let own = pressures.as_ref().map(|pressures| pressures.own.clone());
        let saddle = pressures.as_ref().map(|pressures| pressures.saddle(model).still());
        let system = System {
            tangent: Tangent::new(model, rest, 0.0, workspace).with_pressures(own),
            residual: residual.to_vec(),
            change: vec![0.0; residual.len()],
            forcing: FORCING,
            sliding: Vec::new(),
            shift,
            guide: None,
            saddle,
        };
        let solution = linear.solve(model, free, system, &mut || go_on(found));
        self.products += solution.products;
        let mut change = solution.change;
        self.project(&mut change);
        (!solution.stopped).then_some(change)
    }
}
