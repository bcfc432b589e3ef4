//! Loads: their forces and moments from the shapes against those at the nodes.
#![allow(non_snake_case)]

use super::sampling::{Divided, part_of_surface, sample};
use super::{Kind, Row, Run};
use crate::algebra::packed::largest;
use crate::algebra::tensor::{Vector3, vector_at};
use crate::error::Error;
use crate::geometry::{Field, Selector};
use crate::model::following::CavityLoad;
use crate::problem::{Amplitude, BodyForce, Cavity};

/// Difference of a force over the sum of the sizes of its parts \[–\]: displacements inherit it,
/// and error bars of usual clouds are 2 % and more.
const FORCE: f64 = 0.02;
/// Distance by which a load may miss its place, over the spacing \[–\] and over the size of the
/// part that it acts on \[–\]: nearer than any support resolves.
const ARM: (f64, f64) = (0.1, 0.02);

/// Forces at places.
#[derive(Default)]
struct Resultant {
    forces: Vec<(Vector3, Vector3)>,
    /// How wrong the force may be \[N\].
    doubt: f64,
}

impl Resultant {
    fn force(&self) -> Vector3 {
        self.forces.iter().map(|(_, force)| force).sum()
    }

    /// Sum of the sizes of the forces \[N\].
    fn size(&self) -> f64 {
        self.forces.iter().map(|(_, force)| force.norm()).sum()
    }

    fn moment(&self, about: &Vector3) -> Vector3 {
        self.forces.iter().map(|(X, force)| (X - about).cross(force)).sum()
    }

    /// Centre of the sizes of the forces \[m\], and their largest distance from it \[m\].
    fn place(&self) -> (Vector3, f64) {
        let first: Vector3 = self.forces.iter().map(|(X, force)| X * force.norm()).sum();
        let centre = first / self.size().max(f64::MIN_POSITIVE);
        let distance = self.forces.iter().map(|(X, _)| (X - centre).norm());
        (centre, distance.fold(0.0, f64::max))
    }
}

impl Run<'_> {
    /// Two rows for each load.
    pub(super) fn loads(&self) -> Result<Vec<Row>, Error> {
        let loads = &self.problem.loads;
        let mut rows = Vec::new();
        let mut patterns = self.model.loads.iter();
        for (index, body_force) in loads.body_forces.iter().enumerate() {
            let asked = self.body_force(body_force)?;
            let name = match loads.body_forces.len() {
                1 => "the body force".to_string(),
                _ => format!("body force {index}"),
            };
            if let Some(pattern) = patterns.next() {
                rows.extend(self.compare(&name, &asked, &body_force.amplitude, &pattern.force));
            }
        }
        for traction in &loads.tractions {
            let asked =
                self.on_surface(&traction.part, |X, area| traction.traction.at(X) * area.norm());
            if let Some(pattern) = patterns.next() {
                let name = &traction.name;
                rows.extend(self.compare(name, &asked, &traction.amplitude, &pattern.force));
            }
        }
        let following = &self.model.following;
        for (pressure, load) in loads.pressures.iter().zip(&following.pressures) {
            let asked = self.on_surface(&pressure.part, |_, area| -pressure.pressure * area);
            let (size, d) = (self.model.size(), self.model.components);
            let Some((time, factor)) = self.acting(&pressure.amplitude) else { continue };
            let mut force = vec![0.0; size];
            load.add_force(time, &vec![0.0; size], d, &mut force);
            force.iter_mut().for_each(|f| *f /= factor);
            rows.extend(self.compare(&pressure.name, &asked, &pressure.amplitude, &force));
        }
        Ok(rows)
    }

    /// Two rows for each spring: its forces if all of the body were shifted as far as it has moved
    /// most.
    pub(super) fn springs(&self) -> Vec<Row> {
        let (d, size) = (self.model.components, largest(&self.state.displacement));
        let mut rows = Vec::new();
        if size == 0.0 {
            return rows;
        }
        let shift = Vector3::from_fn(|k, _| if k < d { size } else { 0.0 });
        let springs = self.problem.loads.springs.iter().zip(&self.model.following.springs);
        for (spring, load) in springs {
            let asked = self.on_surface(&spring.part, |_, area| {
                let N = area.try_normalize(0.0).unwrap_or_default();
                let along = N * N.dot(&shift);
                (spring.normal * along + spring.tangential * (shift - along)) * -area.norm()
            });
            let mut force = vec![0.0; self.model.size()];
            let shifted: Vec<f64> =
                (0..self.model.positions.len()).flat_map(|_| (0..d).map(|k| shift[k])).collect();
            load.add_force(&shifted, d, &mut force);
            rows.extend(self.compare(&spring.name, &asked, &Amplitude::Constant, &force));
        }
        rows
    }

    /// A row for each cavity: its volume at rest.
    pub(super) fn cavities(&self) -> Vec<Row> {
        let dimension = &self.problem.dimension;
        let row = |(cavity, load): (&Cavity, &CavityLoad)| {
            let facets = &self.sampled.facets;
            let found = part_of_surface(facets, &cavity.part, dimension, self.spacing);
            let about = load.about(&vec![0.0; self.model.size()], self.model.components);
            let of_piece = |(X, area): &(Vector3, Vector3)| dimension.in_plane(X - about).dot(area);
            let sum: f64 = found.pieces.iter().map(of_piece).sum();
            let asked = -sum / self.model.components as f64;
            let doubt = found.doubt / found.area.max(f64::MIN_POSITIVE);
            let limit = (FORCE + doubt) * asked.abs();
            Row::numbers(Kind::CavityVolume, &cavity.name, asked, load.volume_at_rest(), limit)
        };
        let cavities = self.problem.loads.cavities.iter();
        cavities.zip(&self.model.following.cavities).map(row).collect()
    }

    /// The last of some times at which an amplitude is not 0, and the amplitude there.
    fn acting(&self, amplitude: &Amplitude) -> Option<(f64, f64)> {
        let end = self.problem.motion.end();
        let times = (0..=8).rev().map(|n| end * n as f64 / 8.0);
        times.map(|time| (time, amplitude.at(time))).find(|(_, factor)| *factor != 0.0)
    }

    /// Forces of a density on what a selection contains of the boundary, from the centre and
    /// the vector area of each piece.
    fn on_surface(
        &self,
        part: &Selector,
        density: impl Fn(&Vector3, &Vector3) -> Vector3,
    ) -> Resultant {
        let dimension = &self.problem.dimension;
        let found = part_of_surface(&self.sampled.facets, part, dimension, self.spacing);
        let force = |(X, area): &(Vector3, Vector3)| (*X, dimension.in_plane(density(X, area)));
        let mut resultant =
            Resultant { forces: found.pieces.iter().map(force).collect(), doubt: 0.0 };
        resultant.doubt = found.doubt / found.area.max(f64::MIN_POSITIVE) * resultant.size();
        resultant
    }

    /// ∫ ρ b dV over what a selection contains of the body.
    fn body_force(&self, body_force: &BodyForce) -> Result<Resultant, Error> {
        let regions = &self.problem.regions;
        let own;
        let everywhere =
            body_force.part.is_everything() && matches!(body_force.acceleration, Field::Uniform(_));
        let sampled = if everywhere {
            self.sampled
        } else {
            // The part itself first, divided among the regions by what it has in common
            // with each.
            let common: Vec<Selector> = regions
                .iter()
                .map(|region| {
                    Selector::Intersection(vec![body_force.part.clone(), region.part.clone()])
                })
                .collect();
            let divided = Divided {
                body: self.body,
                dimension: &self.problem.dimension,
                parts: common.iter().chain([&Selector::All]).collect(),
                spacing: self.spacing,
                nodes: self.model.positions.len(),
            };
            own = sample(&divided)?;
            &own
        };
        let of_regions = sampled.pieces.iter().filter(|(.., part)| *part < regions.len());
        let force = |&(X, size, part): &(Vector3, f64, usize)| {
            let acceleration = self.problem.dimension.in_plane(body_force.acceleration.at(&X));
            (X, regions[part].material.density * size * acceleration)
        };
        let forces: Vec<(Vector3, Vector3)> = of_regions.map(force).collect();
        let masses = sampled.volumes.iter().zip(regions).map(|(volume, region)| {
            let density = region.material.density;
            (density * volume.size, density * volume.doubt)
        });
        let (mass, doubt) = masses.fold((0.0, 0.0), |(m, d), (mass, doubt)| (m + mass, d + doubt));
        let mut resultant = Resultant { forces, doubt: 0.0 };
        resultant.doubt = doubt / mass.max(f64::MIN_POSITIVE) * resultant.size();
        Ok(resultant)
    }

    /// Rows of a load at the end of the run, where its `force` at amplitude 1 is that
    /// \[component of node\] \[N\].
    fn compare(
        &self,
        name: &str,
        asked: &Resultant,
        amplitude: &Amplitude,
        force: &[f64],
    ) -> Vec<Row> {
        let Some((_, factor)) = self.acting(amplitude) else { return Vec::new() };
        let (positions, d) = (&self.model.positions, self.model.components);
        let at_nodes = |node: usize| (positions[node], vector_at(force, node, d));
        let done = Resultant { forces: (0..positions.len()).map(at_nodes).collect(), doubt: 0.0 };
        let (centre, reach) = asked.place();
        let size = factor.abs() * asked.size();
        let doubt = factor.abs() * asked.doubt;
        let limit = FORCE * size + doubt;
        let forces = [asked, &done].map(|sum| factor * sum.force());
        let moments = [asked, &done].map(|sum| factor * sum.moment(&centre));
        let arm = ARM.0 * self.spacing + ARM.1 * reach;
        let arms = arm * size + doubt * reach;
        vec![
            Row::vectors(Kind::LoadForce, name, forces[0], forces[1], limit),
            Row::vectors(Kind::LoadMoment, name, moments[0], moments[1], arms),
        ]
    }
}
