//! Tetrahedra, and what a function that is linear in them leaves of them.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;

/// A corner \[m\] with the value of the function there.
pub(super) type Corner = (Vector3, f64);
pub(super) type Tetrahedron = [Vector3; 4];
pub(super) type Triangle = [Vector3; 3];

/// What lies on both sides of the zero level, and the level between them.
#[derive(Debug, Default)]
pub(super) struct Halves {
    /// Where the function is negative.
    pub inside: Vec<Tetrahedron>,
    pub outside: Vec<Tetrahedron>,
    /// Their corners run anticlockwise as seen from the positive side.
    pub border: Vec<Triangle>,
}

/// \[m³\]
pub(super) fn volume([a, b, c, d]: &Tetrahedron) -> f64 {
    (b - a).cross(&(c - a)).dot(&(d - a)).abs() / 6.0
}

/// Normal times area \[m²\].
pub(super) fn vector_area([a, b, c]: &Triangle) -> Vector3 {
    0.5 * (b - a).cross(&(c - a))
}

/// The last halvings are left out where corners and middle say the same.
const UNLESS_ALIKE: usize = 1;

impl Halves {
    /// With room for the parts of so many tetrahedra.
    pub fn of(tetrahedra: usize) -> Halves {
        let (inside, outside) =
            (Vec::with_capacity(3 * tetrahedra), Vec::with_capacity(3 * tetrahedra));
        Halves { inside, outside, border: Vec::with_capacity(2 * tetrahedra) }
    }

    /// Divides a tetrahedron along the zero level of the linear function with these values.
    pub fn cut(&mut self, mut corners: [Corner; 4]) {
        let negative = |corner: &Corner| corner.1 < 0.0;
        corners.sort_by_key(|corner| !negative(corner));
        match corners.split_at(corners.iter().filter(|corner| negative(corner)).count()) {
            ([], _) => self.outside.push(corners.map(|corner| corner.0)),
            (_, []) => self.inside.push(corners.map(|corner| corner.0)),
            ([a], [b, c, d]) => {
                let cap = [zero(a, b), zero(a, c), zero(a, d)];
                self.inside.push([a.0, cap[0], cap[1], cap[2]]);
                self.outside.extend(prism(cap, [b.0, c.0, d.0]));
                self.border(cap, a.0);
            }
            ([a, b, c], [d]) => {
                let cap = [zero(a, d), zero(b, d), zero(c, d)];
                self.outside.push([d.0, cap[0], cap[1], cap[2]]);
                self.inside.extend(prism(cap, [a.0, b.0, c.0]));
                self.border(cap, a.0);
            }
            ([a, b], [c, d]) => {
                let [ac, ad, bc, bd] = [zero(a, c), zero(a, d), zero(b, c), zero(b, d)];
                self.inside.extend(prism([a.0, ac, ad], [b.0, bc, bd]));
                self.outside.extend(prism([c.0, ac, bc], [d.0, ad, bd]));
                self.border([ac, ad, bd], a.0);
                self.border([ac, bd, bc], a.0);
            }
            _ => unreachable!("four corners"),
        }
    }

    /// Sorts a tetrahedron by places in it: into halves along its longest edge where they differ.
    pub fn sort(
        &mut self,
        tetrahedron: Tetrahedron,
        is_inside: &impl Fn(&Vector3) -> bool,
        halvings: usize,
    ) {
        let within = is_inside(&(tetrahedron.iter().sum::<Vector3>() / 4.0));
        let alike = || tetrahedron.iter().all(|X| is_inside(X) == within);
        if halvings == 0 || halvings <= UNLESS_ALIKE && alike() {
            let side = if within { &mut self.inside } else { &mut self.outside };
            return side.push(tetrahedron);
        }
        let length = |[i, j]: &[usize; 2]| (tetrahedron[*i] - tetrahedron[*j]).norm_squared();
        let edges = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
        let longest = edges.into_iter().max_by(|a, b| length(a).total_cmp(&length(b)));
        let [i, j] = longest.unwrap_or_default();
        let middle = 0.5 * (tetrahedron[i] + tetrahedron[j]);
        for end in [i, j] {
            let mut half = tetrahedron;
            half[end] = middle;
            self.sort(half, is_inside, halvings - 1);
        }
    }

    /// Adds a piece of the border, turned away from a place on the negative side.
    fn border(&mut self, [a, b, c]: Triangle, behind: Vector3) {
        let away = vector_area(&[a, b, c]).dot(&(a - behind)) >= 0.0;
        self.border.push(if away { [a, b, c] } else { [a, c, b] });
    }
}

/// Where the function vanishes between two corners.
fn zero(negative: &Corner, positive: &Corner) -> Vector3 {
    let part = negative.1 / (negative.1 - positive.1);
    negative.0 + (positive.0 - negative.0) * part
}

fn prism([a, b, c]: Triangle, [d, e, f]: Triangle) -> [Tetrahedron; 3] {
    [[a, b, c, d], [b, c, d, e], [c, d, e, f]]
}

/// The six tetrahedra of a box around its diagonal, by the indices of its corners, whose bits
/// are the sides along x, y and z.
pub(super) const OF_BOX: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_of_a_cut_make_up_the_tetrahedron_and_the_border_closes_them() {
        let corners = [
            Vector3::zeros(),
            Vector3::x(),
            Vector3::new(0.2, 1.1, 0.0),
            Vector3::new(0.3, 0.2, 0.9),
        ];
        for values in [[-1.0, 2.0, 3.0, 0.5], [-1.0, -0.2, 3.0, 0.5], [-1.0, -2.0, 0.3, -0.5]] {
            let mut halves = Halves::default();
            halves.cut(std::array::from_fn(|i| (corners[i], values[i])));
            let sum = |part: &[Tetrahedron]| part.iter().map(volume).sum::<f64>();
            let whole = volume(&corners);
            assert!((sum(&halves.inside) + sum(&halves.outside) - whole).abs() < 1e-15);
            // ∮ x·n dA = 3 V over the faces that do not contain the origin: a corner inside.
            let flux: f64 = halves.border.iter().map(|t| vector_area(t).dot(&t[0]) / 3.0).sum();
            let rise = |t: &Triangle| {
                vector_area(t).dot(&(corners[1] - corners[0])) * (values[1] - values[0])
            };
            assert!(flux > 0.0 && halves.border.iter().map(rise).sum::<f64>().is_finite());
        }
        let mut halves = Halves::default();
        halves.cut([0, 1, 2, 3].map(|i| (corners[i], [-1.0, 1.0, 1.0, 1.0][i])));
        // Half of every edge: an eighth of the volume.
        assert!((volume(&halves.inside[0]) - volume(&corners) / 8.0).abs() < 1e-15);
    }
}
