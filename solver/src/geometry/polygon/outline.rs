//! Simple polygons of many corners.

use crate::geometry::polygon::polygon_area;
use std::ops::Deref;

/// Corners of a simple polygon \[m\], with boxes around runs of its edges, so that the
/// nearest of many is found without a look at all.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    corners: Vec<[f64; 2]>,
    bounds: Rectangle,
    /// Around √n edges each.
    runs: Vec<Run>,
}

/// Lower and upper corner \[m\].
type Rectangle = ([f64; 2], [f64; 2]);

/// Edges next to each other.
#[derive(Debug, Clone, PartialEq)]
struct Run {
    /// Edge n runs from corner n to the next one.
    edges: std::ops::Range<usize>,
    /// A little larger than the edges, so that rounding cannot lead past them.
    around: Rectangle,
}

/// Boxes are larger than their edges by this fraction of the polygon \[–\].
const MARGIN: f64 = 1e-9;
/// Sine of the angle between edges that are all but parallel \[–\].
const BLUNT: f64 = 0.1;

impl From<Vec<[f64; 2]>> for Outline {
    fn from(corners: Vec<[f64; 2]>) -> Outline {
        let n = corners.len();
        let around = |points: &mut dyn Iterator<Item = [f64; 2]>| {
            let nowhere = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
            points.fold(nowhere, |(lower, upper), p| {
                ([0, 1].map(|k| lower[k].min(p[k])), [0, 1].map(|k| upper[k].max(p[k])))
            })
        };
        let bounds = around(&mut corners.iter().copied());
        let margin = MARGIN * (bounds.1[0] - bounds.0[0]).max(bounds.1[1] - bounds.0[1]);
        let length = (n as f64).sqrt().ceil().max(8.0) as usize;
        let run = |first: usize| {
            let edges = first..(first + length).min(n);
            let (lower, upper) = around(&mut (first..=edges.end).map(|c| corners[c % n]));
            Run { edges, around: (lower.map(|c| c - margin), upper.map(|c| c + margin)) }
        };
        let runs = (0..n).step_by(length).map(run).collect();
        Outline { corners, bounds, runs }
    }
}

impl Deref for Outline {
    type Target = [[f64; 2]];

    fn deref(&self) -> &[[f64; 2]] {
        &self.corners
    }
}

impl Outline {
    /// Lower and upper corner of the box around it \[m\].
    pub(crate) fn bounds(&self) -> Rectangle {
        self.bounds
    }

    /// Whether it turns the same way at every corner, once around.
    pub(crate) fn is_convex(&self) -> bool {
        let turn = |n: usize| {
            let ((a, b), (_, c)) = (self.edge(n), self.edge((n + 1) % self.corners.len()));
            (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
        };
        let turns = || (0..self.corners.len()).map(turn);
        turns().all(|turn| turn >= 0.0) || turns().all(|turn| turn <= 0.0)
    }

    /// With each edge moved outwards by a small distance \[m\] of its middle, its outward normal and
    /// half of its way.
    pub(crate) fn with_edges_moved(
        &self,
        distance: impl Fn([f64; 2], [f64; 2], [f64; 2]) -> f64,
    ) -> Outline {
        let sense = polygon_area(&self.corners).signum();
        let moves = (0..self.corners.len()).map(|n| {
            let (a, b) = self.edge(n);
            let half = [0.5 * (b[0] - a[0]), 0.5 * (b[1] - a[1])];
            let length = half[0].hypot(half[1]);
            let normal = [sense * half[1] / length, -sense * half[0] / length];
            (normal, distance([a[0] + half[0], a[1] + half[1]], normal, half))
        });
        let moves: Vec<_> = moves.collect();
        let corner = |n: usize| {
            let (u, a) = moves[(n + moves.len() - 1) % moves.len()];
            let (v, b) = moves[n];
            let [x, y] = self.corners[n];
            // On both moved edges, and beside them where they are all but parallel.
            let sine = u[0] * v[1] - u[1] * v[0];
            if sine.abs() < BLUNT {
                let by = |k: usize| if a > b { a * u[k] } else { b * v[k] };
                return [x + by(0), y + by(1)];
            }
            [x + (a * v[1] - b * u[1]) / sine, y + (b * u[0] - a * v[0]) / sine]
        };
        (0..moves.len()).map(corner).collect::<Vec<_>>().into()
    }

    fn edge(&self, n: usize) -> ([f64; 2], [f64; 2]) {
        (self.corners[n], self.corners[(n + 1) % self.corners.len()])
    }

    /// Signed distance \[m\], negative inside, whichever way it runs.
    pub fn signed_distance(&self, x: f64, y: f64) -> f64 {
        let (mut squared, mut inside) = (f64::INFINITY, false);
        let nearest = self.runs.iter().map(|run| squared_distance_of_box(&run.around, x, y));
        let nearest = nearest.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        let first = nearest.map_or(0, |(run, _)| run);
        for run in self.runs[first..].iter().chain(&self.runs[..first]) {
            if squared_distance_of_box(&run.around, x, y) <= squared {
                for n in run.edges.clone() {
                    squared = squared.min(self.squared_distance_of_edge(n, x, y));
                }
            }
            if run.around.0[1] <= y && y <= run.around.1[1] {
                for n in run.edges.clone() {
                    let (a, b) = self.edge(n);
                    let crosses = (a[1] > y) != (b[1] > y);
                    inside ^= crosses && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                }
            }
        }
        if inside { -squared.sqrt() } else { squared.sqrt() }
    }

    fn squared_distance_of_edge(&self, n: usize, x: f64, y: f64) -> f64 {
        let (a, b) = self.edge(n);
        let (ex, ey) = (b[0] - a[0], b[1] - a[1]);
        let (wx, wy) = (x - a[0], y - a[1]);
        let t = ((wx * ex + wy * ey) / (ex * ex + ey * ey)).clamp(0.0, 1.0);
        (wx - t * ex).powi(2) + (wy - t * ey).powi(2)
    }

    /// The first edges that cross or touch without being neighbours, or of which one has
    /// no length.
    pub(crate) fn crossing(&self) -> Option<(usize, usize)> {
        let n = self.corners.len();
        for first in 0..n {
            let (a, b) = self.edge(first);
            if a == b {
                return Some((first, (first + 1) % n));
            }
            let may_meet = |run: &&Run| {
                run.edges.end > first + 1
                    && (0..2).all(|k| {
                        a[k].min(b[k]) <= run.around.1[k] && run.around.0[k] <= a[k].max(b[k])
                    })
            };
            for second in self.runs.iter().filter(may_meet).flat_map(|run| run.edges.clone()) {
                let (c, d) = self.edge(second);
                let neighbours = second == first + 1 || (second + 1) % n == first;
                if second > first && !neighbours && segments_meet(a, b, c, d) {
                    return Some((first, second));
                }
            }
        }
        None
    }
}

fn squared_distance_of_box((lower, upper): &Rectangle, x: f64, y: f64) -> f64 {
    let beyond = |k: usize, at: f64| (lower[k] - at).max(at - upper[k]).max(0.0);
    beyond(0, x).powi(2) + beyond(1, y).powi(2)
}

fn segments_meet(a: [f64; 2], b: [f64; 2], c: [f64; 2], d: [f64; 2]) -> bool {
    let side = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
        (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
    };
    let within = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
        (0..2).all(|k| p[k].min(q[k]) <= r[k] && r[k] <= p[k].max(q[k]))
    };
    let (s1, s2, s3, s4) = (side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b));
    (s1 * s2 < 0.0 && s3 * s4 < 0.0)
        || (s1 == 0.0 && within(a, b, c))
        || (s2 == 0.0 && within(a, b, d))
        || (s3 == 0.0 && within(c, d, a))
        || (s4 == 0.0 && within(c, d, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A star whose edges are not on any grid.
    fn star(corners: usize) -> Vec<[f64; 2]> {
        let at = |n: usize| {
            let angle = n as f64 * std::f64::consts::TAU / corners as f64;
            let radius = 1.0 + 0.3 * (7.0 * angle).sin() + 0.02 * (n % 3) as f64;
            [3.0 + radius * angle.cos(), radius * angle.sin() - 1.0]
        };
        (0..corners).map(at).collect()
    }

    /// All edges in one run.
    fn unsorted(corners: Vec<[f64; 2]>) -> Outline {
        let everywhere = ([f64::NEG_INFINITY; 2], [f64::INFINITY; 2]);
        let runs = vec![Run { edges: 0..corners.len(), around: everywhere }];
        Outline { runs, ..Outline::from(corners) }
    }

    #[test]
    fn runs_of_edges_give_the_distance_of_all_edges_bit_for_bit() {
        for corners in [3, 17, 500] {
            let (fast, slow) = (Outline::from(star(corners)), unsorted(star(corners)));
            assert!(corners < 17 || fast.runs.len() > 1);
            for n in 0..4000 {
                let (x, y) = (1.5 + 0.05 * (n % 63) as f64, 0.047 * (n / 63) as f64 - 2.5);
                let expected = slow.signed_distance(x, y);
                assert_eq!(fast.signed_distance(x, y).to_bits(), expected.to_bits(), "{x} {y}");
            }
        }
    }

    #[test]
    fn runs_of_edges_find_the_crossing_that_all_edges_show_first() {
        assert_eq!(Outline::from(star(500)).crossing(), None);
        for (moved, to) in [(40, 333), (450, 12), (0, 250), (7, 6)] {
            let mut corners = star(500);
            corners[moved] = corners[to];
            let expected = unsorted(corners.clone()).crossing();
            assert!(expected.is_some());
            assert_eq!(Outline::from(corners).crossing(), expected);
        }
    }
}
