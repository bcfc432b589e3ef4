//! Which shells bound the solid: where the winding number is at least 1.

use crate::algebra::tensor::Vector3;
use crate::geometry::error::GeometryError;
use crate::geometry::surface::note::SurfaceNote;
use crate::geometry::surface::shells::{Lies, Shell};
use std::collections::BTreeSet;

/// Where two shells cross.
struct Crossing {
    first: usize,
    second: usize,
    at: Vector3,
}

/// Shells and how they lie to each other.
struct Nest {
    shells: Vec<Shell>,
    /// 1 if a shell faces outwards, −1 if it faces inwards.
    signs: Vec<i32>,
    /// Numbers of the shells around each.
    around: Vec<BTreeSet<usize>>,
    crossings: Vec<Crossing>,
    notes: Vec<SurfaceNote>,
}

/// Triangles of solids that together are the solid; within each no shells cross.
pub(super) type Solids = Vec<Vec<[u32; 3]>>;

/// Shells that face inwards and are in no other are turned, with what is in them; shells within
/// the solid are left out; shells that cross go to different solids.
pub(super) fn united(
    vertices: &[Vector3],
    parts: Vec<Vec<[u32; 3]>>,
    size: f64,
) -> Result<(Solids, Vec<SurfaceNote>), GeometryError> {
    let mut nest = Nest::new(vertices, &parts, size);
    nest.turn();
    let kept = nest.kept()?;
    let member = nest.members(&kept)?;
    let count = member.iter().flatten().max().map_or(0, |most| most + 1);
    let mut solids = vec![Vec::new(); count];
    for ((shell, own), sign) in nest.shells.iter().zip(&member).zip(&nest.signs) {
        let turned = (*sign > 0) != (shell.volume > 0.0);
        let facing = |t: &[u32; 3]| if turned { [t[0], t[2], t[1]] } else { *t };
        if let Some(own) = own {
            solids[*own].extend(parts[shell.number].iter().map(facing));
        }
    }
    solids.iter_mut().for_each(|solid| solid.sort_unstable());
    Ok((solids, nest.notes))
}

impl Nest {
    fn new(vertices: &[Vector3], parts: &[Vec<[u32; 3]>], size: f64) -> Nest {
        let shells = parts.iter().enumerate().map(|(n, part)| Shell::new(n, vertices, part));
        let (flat, shells): (Vec<Shell>, Vec<Shell>) = shells.partition(|s| s.is_flat(size));
        let notes =
            flat.first().map(|first| SurfaceNote::Flat { shells: flat.len(), at: first.at() });
        let signs = shells.iter().map(|shell| if shell.volume > 0.0 { 1 } else { -1 }).collect();
        let around = vec![BTreeSet::new(); shells.len()];
        let mut nest =
            Nest { shells, signs, around, crossings: Vec::new(), notes: Vec::from_iter(notes) };
        for second in 1..nest.shells.len() {
            for first in 0..second {
                nest.relate(first, second, size);
            }
        }
        nest
    }

    fn relate(&mut self, first: usize, second: usize, size: f64) {
        let (one, other) = (&self.shells[first], &self.shells[second]);
        if !one.is_near(other) {
            return;
        }
        match (one.lies_in(other, size), other.lies_in(one, size)) {
            (Lies::Across(at), _) | (_, Lies::Across(at)) => {
                self.crossings.push(Crossing { first, second, at });
            }
            (Lies::Inside, _) => drop(self.around[first].insert(second)),
            (_, Lies::Inside) => drop(self.around[second].insert(first)),
            _ => {}
        }
    }

    /// Winding number just outside of a shell.
    fn outside(&self, shell: usize) -> i32 {
        self.around[shell].iter().map(|&other| self.signs[other]).sum()
    }

    fn turn(&mut self) {
        let mut order: Vec<usize> = (0..self.shells.len()).collect();
        order.sort_by_key(|&shell| self.around[shell].len());
        let mut turned = BTreeSet::new();
        for shell in order {
            if self.signs[shell] > 0 || turned.contains(&shell) || self.outside(shell) != 0 {
                continue;
            }
            // It may be meant to cut.
            if self.crossed(shell).any(|(other, _)| self.shells[other].volume > 0.0) {
                continue;
            }
            // All that is in an outermost shell faces the wrong way with it.
            let within: Vec<usize> = if self.around[shell].is_empty() {
                (0..self.shells.len())
                    .filter(|other| self.around[*other].contains(&shell))
                    .filter(|other| turned.insert(*other))
                    .collect()
            } else {
                Vec::new()
            };
            for &one in within.iter().chain([&shell]) {
                self.signs[one] = -self.signs[one];
            }
            let (with, count, at) = (within.len(), self.count(), self.shells[shell].at());
            let shell = self.shells[shell].number + 1;
            self.notes.push(SurfaceNote::Turned { shell, with, count, at });
        }
    }

    /// Number of shells with a volume.
    fn count(&self) -> usize {
        self.shells.len()
    }

    /// Whether the solid lies on one side of each shell alone.
    fn kept(&mut self) -> Result<Vec<bool>, GeometryError> {
        let mut kept = Vec::with_capacity(self.shells.len());
        for shell in 0..self.shells.len() {
            let outside = self.outside(shell);
            let bounds = (outside >= 1) != (outside + self.signs[shell] >= 1);
            kept.push(bounds);
            if bounds {
                continue;
            }
            if let (..=0, Some((other, at))) = (outside, self.crossed(shell).next()) {
                return Err(self.cross(shell, other, at));
            }
            let (count, at) = (self.count(), self.shells[shell].at());
            let solid = self.around[shell].iter().find(|&&other| self.signs[other] > 0);
            let inner = self.shells[shell].number + 1;
            self.notes.push(match (self.signs[shell] > 0, solid) {
                (true, Some(&outer)) => {
                    let outer = self.shells[outer].number + 1;
                    SurfaceNote::Inside { inner, outer, count, at }
                }
                _ => SurfaceNote::Filled { shell: inner, count, at },
            });
        }
        Ok(kept)
    }

    /// The solid that each shell goes to: one without any that it crosses, a cavity to that of
    /// the innermost shell around it.
    fn members(&mut self, kept: &[bool]) -> Result<Vec<Option<usize>>, GeometryError> {
        let mut member = vec![None; self.shells.len()];
        let solid = |shell: &usize| kept[*shell] && self.signs[*shell] > 0;
        for shell in (0..self.shells.len()).filter(solid) {
            let taken: BTreeSet<usize> =
                self.crossed(shell).filter_map(|(other, _)| member[other]).collect();
            member[shell] = (0..).find(|own| !taken.contains(own));
        }
        for shell in (0..self.shells.len()).filter(|&n| kept[n] && self.signs[n] < 0) {
            let around = self.around[shell].iter().filter(|other| solid(other));
            let body = around.copied().max_by_key(|&other| self.around[other].len());
            // What crosses a cavity must reach into it from outside of its body.
            let enters = |other: usize| {
                kept[other]
                    && self.signs[other] > 0
                    && body.is_some_and(|b| self.crossed(b).any(|(third, _)| third == other))
            };
            if let Some((other, at)) = self.crossed(shell).find(|(other, _)| !enters(*other)) {
                return Err(self.cross(shell, other, at));
            }
            member[shell] = body.and_then(|body| member[body]);
        }
        for Crossing { first, second, at } in &self.crossings {
            if kept[*first] && kept[*second] {
                let [first, second] = [first, second].map(|n| self.shells[*n].number + 1);
                let (count, at) = (self.count(), (*at).into());
                self.notes.push(SurfaceNote::United { first, second, count, at });
            }
        }
        Ok(member)
    }

    /// The shells that cross one, and where.
    fn crossed(&self, shell: usize) -> impl Iterator<Item = (usize, Vector3)> + '_ {
        self.crossings.iter().filter_map(move |crossing| match shell {
            n if n == crossing.first => Some((crossing.second, crossing.at)),
            n if n == crossing.second => Some((crossing.first, crossing.at)),
            _ => None,
        })
    }

    fn cross(&self, one: usize, other: usize, at: Vector3) -> GeometryError {
        let (one, other) = (self.shells[one].number + 1, self.shells[other].number + 1);
        let (first, second) = (one.min(other), one.max(other));
        GeometryError::CavityCrosses { first, second, count: self.count(), at: at.into() }
    }
}
