//! Places that a cloud may be too coarse for: edges, gaps, layers.
#![allow(non_snake_case)]

use super::sampling::level;
use super::{Kind, Row, Run};
use crate::algebra::tensor::Vector3;
use crate::discretisation::neighbours::Neighbours;
use crate::error::Error;
use crate::problem::MaterialBorders;

/// A node lies on an edge that is nearer than this \[spacing\]: the corners of the largest cells
/// at edges are 0.11 from their middle.
const ON_EDGE: f64 = 0.15;
/// An edge has nodes where one on it is nearer than this \[spacing\]: half a spacing, and a
/// quarter for spacings that do not divide it.
const ALONG: f64 = 0.75;
/// Part of the edges that may be without nodes \[–\]: more, and the body is another one.
const WITHOUT: f64 = 0.5;
/// Cells that are cut at an edge, larger than this \[spacing\], do not say where it is.
const SHARP: f64 = 0.13;
/// Places that are looked at.
const SAMPLES: usize = 2000;
/// Sum of the sizes of shape functions across a gap from which it is glued \[–\].
const SEEN: f64 = 0.05;
/// Part of the boundary that may be glued \[–\]: the tips of notches are.
const GLUED: f64 = 0.01;
/// Half of the narrowest gap that is seen \[spacing\]: what is narrower may be round-off of a drawing.
const NARROWEST: f64 = 5e-6;
/// The sides of a gap face each other: cosine of their normals \[–\].
const OPPOSITE: f64 = -0.7;
/// Spacings across a layer below which its stiffness is off by more than a tenth \[–\]: with
/// layers of a tenth of the stiffness in series, 3 spacings give 1.12 times the force, 2 give
/// 1.27 times, and 1 gives 1.57 times.
const ACROSS: f64 = 2.5;
/// The same where borders between materials are sharp: thinner layers may escape what looks for them.
const ACROSS_SHARP: f64 = 0.24;
/// The same of nearly incompressible layers, which lock without nodes inside.
const ACROSS_FULL: f64 = 0.95;
/// Poisson's ratio from which that is so \[–\].
const NEARLY_INCOMPRESSIBLE: f64 = 0.45;
/// Ratio of moduli from which that matters \[–\]: at 0.3 it is 4 % with 2 spacings.
const CONTRAST: f64 = 4.0;

impl Run<'_> {
    /// The part of the edges of the body that has no nodes.
    pub(super) fn edges(&self) -> Option<Row> {
        let edges = &self.sampled.edges;
        if edges.is_empty() || self.sampled.finest > SHARP * self.spacing {
            return None;
        }
        let cloud = &self.discretisation.cloud;
        let step = edges.len().div_ceil(8 * SAMPLES);
        let edges: Vec<Vector3> = edges.iter().step_by(step).copied().collect();
        let near = Neighbours::new(&edges, self.spacing);
        let is_on_edge = |&node: &usize| {
            let mut found = false;
            let reach = ON_EDGE * cloud.spacing[node];
            near.for_each_within(&cloud.positions[node], reach, |_, _| found = true);
            cloud.on_boundary[node] && found
        };
        let mut covered = vec![false; edges.len()];
        for node in (0..cloud.positions.len()).filter(is_on_edge) {
            let reach = ALONG * cloud.spacing[node];
            near.for_each_within(&cloud.positions[node], reach, |place, _| covered[place] = true);
        }
        let without = covered.iter().filter(|covered| !**covered).count();
        let part = without as f64 / edges.len() as f64;
        Some(Row::numbers(Kind::Edges, "", 0.0, part, WITHOUT))
    }

    /// The part of the boundary whose support reaches across a gap.
    pub(super) fn gaps(&self) -> Result<Option<Row>, Error> {
        let facets = &self.sampled.facets;
        let (mut all, mut places) = (0.0, Vec::new());
        let step = facets.len().div_ceil(SAMPLES).max(1);
        for facet in facets.iter().step_by(step) {
            all += facet.area();
            let gap = (!facet.edge).then(|| self.gap_before(facet.centre(), facet.normal()));
            places.extend(gap.flatten().map(|width| (facet, width)));
        }
        let at: Vec<Vector3> = places.iter().map(|(facet, _)| self.at(facet.centre())).collect();
        let rows = self.discretisation.rows_at(&at)?;
        let positions = &self.discretisation.cloud.positions;
        let mut glued = 0.0;
        for (row, (facet, width)) in places.iter().enumerate() {
            let normal = facet.normal();
            let beyond = |entry: &usize| {
                let way = positions[rows.nodes[*entry] as usize] - at[row];
                way.dot(&normal) > 0.9 * width
            };
            let seen: f64 = rows.row(row).filter(beyond).map(|entry| rows.phi[entry].abs()).sum();
            glued += if seen > SEEN { facet.area() } else { 0.0 };
        }
        let done = glued / f64::max(all, f64::MIN_POSITIVE);
        Ok((all > 0.0).then(|| Row::numbers(Kind::Gap, "", 0.0, done, GLUED)))
    }

    /// Width \[m\] of the gap in front of a place of the boundary that a support may reach across.
    fn gap_before(&self, X: Vector3, normal: Vector3) -> Option<f64> {
        let reach = self.problem.recipe.dilation * self.spacing;
        let middle = 0.5 * reach;
        // The nearest place of the boundary is X itself unless something is in front of it.
        if self.body.signed_distance(&self.at(X + middle * normal)) > 0.8 * middle {
            return None;
        }
        // Facets of curved faces are chords.
        let X = X - self.body.signed_distance(&self.at(X)) * normal;
        let least = NARROWEST * self.spacing;
        let mut way = least;
        for _ in 0..64 {
            let place = self.at(X + way * normal);
            let distance = self.body.signed_distance(&place);
            if distance < 0.1 * least && way > 2.0 * least {
                let opposite = self.body.gradient(&place).dot(&normal) < OPPOSITE;
                return opposite.then_some(way);
            }
            way += distance.max(least);
            if way > reach {
                break;
            }
        }
        None
    }

    /// Spacings across each region that is softer or harder than another.
    pub(super) fn layers(&self) -> Vec<Row> {
        let regions = &self.problem.regions;
        let modulus = |region: usize| regions[region].material.law.constants().shear_modulus;
        let differs = |region: usize| {
            (0..regions.len()).filter(|&other| self.sampled.volumes[other].size > 0.0).any(
                |other| {
                    let ratio = modulus(region) / modulus(other);
                    ratio.max(1.0 / ratio) >= CONTRAST
                },
            )
        };
        let row = |region: usize| {
            let across = 2.0 * self.largest_depth(region)? / self.spacing;
            let (asked, limit) = (self.spacings_across(region).max(across), 1e-6);
            Some(Row::numbers(Kind::Layer, &regions[region].name, asked, across, limit))
        };
        (0..regions.len()).filter(|&region| differs(region)).filter_map(row).collect()
    }

    /// Those that a layer of a region needs \[–\].
    fn spacings_across(&self, region: usize) -> f64 {
        let poisson = self.problem.regions[region].material.law.constants().poisson_ratio();
        match self.problem.recipe.material_borders {
            MaterialBorders::Straddled => ACROSS,
            MaterialBorders::Sharp if poisson < NEARLY_INCOMPRESSIBLE => ACROSS_SHARP,
            MaterialBorders::Sharp => ACROSS_FULL,
        }
    }

    /// Radius \[m\] of the largest ball in a region; `None` where no distances say that.
    fn largest_depth(&self, region: usize) -> Option<f64> {
        let regions = &self.problem.regions;
        let depth = |X: &Vector3| {
            let X = self.at(*X);
            let own = level(&regions[region].part, &X, None);
            let earlier = regions[..region].iter().map(|other| level(&other.part, &X, None));
            let (mut depth, mut metric) =
                ((-own.value).min(-self.body.signed_distance(&X)), own.metric);
            for other in earlier {
                (depth, metric) = (depth.min(other.value), metric && other.metric);
            }
            metric.then_some(depth)
        };
        let pieces = self.sampled.pieces.iter().filter(|(.., part)| *part == region);
        let mut best = (f64::NEG_INFINITY, Vector3::zeros());
        for (X, ..) in pieces {
            let depth = depth(X)?;
            best = if depth > best.0 { (depth, *X) } else { best };
        }
        let mut step = best.0.max(0.1 * self.spacing);
        while best.0.is_finite() && step > 1e-3 * self.spacing {
            let steps = (0..self.model.components)
                .flat_map(|k| [step, -step].map(|s| s * Vector3::ith(k, 1.0)));
            let tried = steps.filter_map(|way| Some((depth(&(best.1 + way))?, best.1 + way)));
            match tried.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|next| next.0 > best.0) {
                Some(next) => best = next,
                None => step *= 0.5,
            }
        }
        best.0.is_finite().then_some(best.0)
    }
}
