//! What contact has left inside narrow obstacles, and obstacles inside the body.
#![allow(non_snake_case)]

use super::between::Outside;
use super::plan::ContactPlan;
use crate::algebra::tensor::{Vector3, bounding_box, vector_at};
use crate::discretisation::{Discretisation, Warning};
use crate::error::Error;
use crate::geometry::{PointHash, Shape, indices};

/// Depth over the mean spacing that is not worth a word \[–\].
const DEEP: f64 = 0.1;
/// Samples of an obstacle along each axis.
const SAMPLES: usize = 12;
/// Iterations X ← y − u(X) towards what has moved to y; strains of soft bodies are below one.
const ITERATIONS: usize = 12;
/// Nodes so near are around a place, over the mean spacing \[–\].
const AROUND: f64 = 1.5;
/// Length of the mean direction to them above which they lie on one side \[–\]: in front of a flat
/// face it is 0.5 and more.
const ONE_SIDED: f64 = 0.3;
/// Depth of such a place in the body over the mean spacing \[–\].
const INSIDE: f64 = 0.25;
/// Distance over the mean spacing that is none \[–\].
const FOUND: f64 = 0.05;

impl ContactPlan {
    /// Refuses a narrow obstacle inside the body at the start, where no node is in it.
    pub(crate) fn refuse_swallowed(
        &self,
        positions: &[Vector3],
        body: &Shape,
    ) -> Result<(), Error> {
        for (index, obstacle) in self.obstacles.iter().enumerate() {
            let samples = self.samples(index, 0.0, bounding_box(positions));
            let deep = |y: &Vector3| body.signed_distance(y) < -DEEP * self.mean_spacing;
            if let Some(position) = samples.into_iter().find(deep) {
                return Err(Error::ObstacleInBody { name: obstacle.name.clone(), position });
            }
        }
        Ok(())
    }

    /// Warnings of narrow obstacles that the surface enters between nodes, or that lie inside the
    /// body, at time `t` \[s\] and nodal parameters `u` \[component of node\] \[m\].
    pub fn unresolved(&self, discretisation: &Discretisation, t: f64, u: &[f64]) -> Vec<Warning> {
        let least = self.narrow.iter().flatten().copied().reduce(f64::min);
        let Some((outside, width)) = self.outside.as_ref().zip(least) else { return Vec::new() };
        // Where the surface has no panels, the set-up has refused or warned.
        let Ok(between) = outside.places(discretisation, self.mean_spacing, width) else {
            return Vec::new();
        };
        let now = between.current(u, u.len() / discretisation.cloud.positions.len());
        let mut warnings = Vec::new();
        for (index, placed) in self.all_placed(t) {
            let index = index as usize;
            if self.narrow[index].is_none() {
                continue;
            }
            let depths = now.iter().map(|x| -placed.gap(x)).enumerate();
            let (place, depth) = depths.fold((0, 0.0), |a, b| if b.1 > a.1 { b } else { a });
            let name = placed.obstacle.name.clone();
            if depth > DEEP * self.mean_spacing {
                let position = between.positions[place];
                warnings.push(Warning::SurfaceInObstacle { name, position, depth });
            } else if let Some(position) = self.swallowed(index, discretisation, t, u) {
                warnings.push(Warning::ObstacleInBody { name, position });
            }
        }
        warnings
    }

    /// Narrow obstacles with nodes close around a place of them, which then have gone in between the
    /// nodes: index, that place \[m\]. Without shape functions, for a look on the way at time `t` \[s\].
    pub(super) fn between_nodes(
        &self,
        positions: &[Vector3],
        t: f64,
        u: &[f64],
    ) -> Vec<(u32, Vector3)> {
        let Some(Outside { body, .. }) = &self.outside else { return Vec::new() };
        let d = u.len() / positions.len();
        let (now, hash) = self.moved(positions, u);
        let is_inside = |y: &Vector3| {
            let (mut nearest, mut sum, mut count) = ((f64::INFINITY, 0), Vector3::zeros(), 0.0);
            hash.visit(y, AROUND * self.mean_spacing, |node, _| {
                let way = now[node] - y;
                let distance = way.norm();
                sum += way / distance.max(f64::MIN_POSITIVE);
                count += 1.0;
                if distance < nearest.0 {
                    nearest = (distance, node);
                }
                true
            });
            let X = || y - vector_at(u, nearest.1, d);
            nearest.0 < self.mean_spacing
                && sum.norm() < ONE_SIDED * count
                && body.signed_distance(&X()) < -INSIDE * self.mean_spacing
        };
        let around = bounding_box(&now);
        let narrow = (0..self.obstacles.len()).filter(|index| self.narrow[*index].is_some());
        let found = narrow.filter_map(|index| {
            Some((index as u32, self.samples(index, t, around).into_iter().find(is_inside)?))
        });
        found.collect()
    }

    /// Where an obstacle lies inside the deformed body, in the undeformed one \[m\].
    fn swallowed(
        &self,
        index: usize,
        discretisation: &Discretisation,
        t: f64,
        u: &[f64],
    ) -> Option<Vector3> {
        let cloud = &discretisation.cloud;
        let d = u.len() / cloud.positions.len();
        let (now, hash) = self.moved(&cloud.positions, u);
        let body = &self.outside.as_ref()?.body;
        let origin = |y: &Vector3| {
            let (_, nearest) = *hash.nearest(y, usize::MAX, 1).first()?;
            let mut X = y - vector_at(u, nearest, d);
            for _ in 0..ITERATIONS {
                X = y - discretisation.rows_at(&[X]).ok()?.interpolate(0, u, d);
            }
            let x = X + discretisation.rows_at(&[X]).ok()?.interpolate(0, u, d);
            let found = (x - y).norm() < FOUND * self.mean_spacing;
            (found && body.signed_distance(&X) < -DEEP * self.mean_spacing).then_some(X)
        };
        self.samples(index, t, bounding_box(&now)).iter().find_map(origin)
    }

    /// Where nodes are now \[m\], and the same to look for those near a place.
    fn moved(&self, positions: &[Vector3], u: &[f64]) -> (Vec<Vector3>, PointHash) {
        let d = u.len() / positions.len();
        let nodes = positions.iter().enumerate();
        let now: Vec<Vector3> = nodes.map(|(node, X)| X + vector_at(u, node, d)).collect();
        let mut hash = PointHash::new(self.mean_spacing, self.mean_spacing);
        now.iter().for_each(|x| hash.insert(*x));
        (now, hash)
    }

    /// Points inside a narrow obstacle at time `t` \[s\] within a box \[m\].
    fn samples(&self, index: usize, t: f64, around: (Vector3, Vector3)) -> Vec<Vector3> {
        let (placed, obstacle) = (self.placed(index as u32, t), &self.obstacles[index]);
        if self.narrow[index].is_none() {
            return Vec::new();
        }
        let (lower, upper) = placed.own_box(around);
        let grown = Vector3::repeat(obstacle.offset);
        let (lower, upper) = match obstacle.shape.bounding_box() {
            Some((l, u)) => (lower.sup(&(l - grown)), upper.inf(&(u + grown))),
            None => (lower, upper),
        };
        let edges = upper - lower;
        if edges.min() < 0.0 {
            return Vec::new();
        }
        let point = |ijk: [usize; 3]| {
            lower + Vector3::from_fn(|k, _| (ijk[k] as f64 + 0.5) / SAMPLES as f64 * edges[k])
        };
        let own = indices([SAMPLES; 3]).map(point);
        own.map(|own| placed.now(&own)).filter(|y| placed.gap(y) < 0.0).collect()
    }
}
