//! Search of near points where distances vary over the cloud.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use rustc_hash::FxHashMap;

/// Points sorted into cubes of several sizes, each twice the last, so that a
/// search of any radius visits few cubes.
pub(crate) struct PointHash {
    smallest: f64,
    levels: Vec<FxHashMap<[i64; 3], Vec<u32>>>,
    points: Vec<Vector3>,
}

impl PointHash {
    /// For search radii from `smallest` to `largest` \[m\].
    pub fn new(smallest: f64, largest: f64) -> Self {
        let levels = (largest / smallest).log2().ceil().clamp(0.0, 12.0) as usize + 1;
        PointHash { smallest, levels: vec![FxHashMap::default(); levels], points: Vec::new() }
    }

    fn key(&self, X: &Vector3, level: usize) -> [i64; 3] {
        let edge = self.smallest * (1_u64 << level) as f64;
        [0, 1, 2].map(|axis| (X[axis] / edge).floor() as i64)
    }

    pub fn insert(&mut self, X: Vector3) {
        for level in 0..self.levels.len() {
            let key = self.key(&X, level);
            self.levels[level].entry(key).or_default().push(self.points.len() as u32);
        }
        self.points.push(X);
    }

    /// Calls `visit(index, distance)` for every point closer than `radius`
    /// \[m\] until it returns false.
    pub fn visit(&self, X: &Vector3, radius: f64, mut visit: impl FnMut(usize, f64) -> bool) {
        let level = (radius / self.smallest).log2().ceil().max(0.0) as usize;
        let level = level.min(self.levels.len() - 1);
        let lower = self.key(&(X - Vector3::repeat(radius)), level);
        let upper = self.key(&(X + Vector3::repeat(radius)), level);
        for i in lower[0]..=upper[0] {
            for j in lower[1]..=upper[1] {
                for k in lower[2]..=upper[2] {
                    for &index in self.levels[level].get(&[i, j, k]).into_iter().flatten() {
                        let distance = (self.points[index as usize] - X).norm();
                        if distance < radius && !visit(index as usize, distance) {
                            return;
                        }
                    }
                }
            }
        }
    }

    /// Whether a point lies closer than `radius` \[m\].
    pub fn any_within(&self, X: &Vector3, radius: f64) -> bool {
        let mut found = false;
        self.visit(X, radius, |_, _| {
            found = true;
            false
        });
        found
    }

    /// Distances to the `count` nearest points other than `own`, nearest
    /// first, and their indices; fewer if there are fewer.
    pub fn nearest(&self, X: &Vector3, own: usize, count: usize) -> Vec<(f64, usize)> {
        let others = self.points.len() - usize::from(own < self.points.len());
        let available = count.min(others);
        let mut radius = self.smallest;
        loop {
            let mut found = Vec::new();
            self.visit(X, radius, |index, distance| {
                if index != own {
                    found.push((distance, index));
                }
                true
            });
            if found.len() >= available || !radius.is_finite() {
                found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                found.truncate(count);
                return found;
            }
            radius *= 2.0;
        }
    }
}
