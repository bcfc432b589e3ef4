//! Whether the straight way between two places of a body stays inside of it (method book,
//! section 6).
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::shape::Shape;

/// A way may leave the body by so much and come back through the same face \[length\].
const GRAZING: f64 = 0.02;
/// A way that leaves the body by more than this part of what of it lies outside has crossed a gap. In
/// a hollow whose normals turn by less than [`TURNED`] says, a chord is 0.15 of its length away from the
/// wall, and the way along the wall 6 % longer; between tips that touch it is 0.2 or more.
const DEEP: f64 = 0.17;
/// Outside by more than this is no round-off \[length\].
const THIN: f64 = 1e-6;
/// Shortest step along a way beside the boundary \[length\].
const STEP: f64 = 0.1;
/// Where the normals outside of the places at which a way leaves and comes back have a smaller
/// product, it has crossed a gap.
const TURNED: f64 = 0.4;
/// Outward normals with a smaller product face each other across the outside.
const FACING: f64 = -0.3;
/// Where between two places the outside beside one of them is looked at \[half of the way across\].
const BEFORE: f64 = 0.1;
/// Depth of the way below the boundary that is looked along where both of its ends are on the
/// boundary; half of it is a shortest step, so that steps end at gaps only \[length\].
const BELOW: f64 = 0.2;
/// Faces that may meet at a place on the boundary.
const FACES: usize = 3;
/// Steps along a way outside \[length\].
const FINE: f64 = 0.01;
/// Farther outside than this is straight between two faces \[half of the way across\].
const STRAIGHT: f64 = 0.8;
/// Looks for the outside between two places on its two sides.
const LOOKS: usize = 3;
/// Looks along the boundary \[way to the next place\].
const ALONG: [f64; 3] = [0.5, 0.25, 0.75];
/// Looks beside a place on the boundary \[way to the next place\].
const BESIDE: [f64; 3] = [0.1, 0.01, 0.001];
/// The same for the narrowest gaps \[way to the next place\].
const NEXT_TO: f64 = 1e-5;
/// Halvings towards the places where a way leaves and comes back: those that find the walls of a hollow, and
/// those that find the two faces of a narrow gap.
const HALVINGS: [usize; 2] = [8, 24];
/// Parts of what of a way lies outside, between which it is looked how far outside.
const PARTS: usize = 8;
/// Places as deep or as low but for less are equal \[length\].
const TIE: f64 = 1e-6;

/// Between two places on the two sides of a gap the distance rises above a line by more than
/// this part of the sum of their depths, unless a face beside the way is nearer.
const BENT: f64 = 0.1;

/// A place with its signed distance \[m\].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub X: Vector3,
    /// Negative inside.
    pub distance: f64,
}

impl Place {
    /// Whether ways start here and not at another place: from the deeper one, or from the lower
    /// one in x, y or z where both are as deep, so that there and back are one way.
    fn comes_before(&self, other: &Place, tie: f64) -> bool {
        let (one, two) = (self, other);
        let [x, y, z] = [0, 1, 2].map(|axis| (one.X[axis], two.X[axis]));
        let decides = |(a, b): &(f64, f64)| (a - b).abs() > tie;
        let first = [(one.distance, two.distance), x, y, z].into_iter().find(decides);
        first.is_some_and(|(a, b)| a < b)
    }
}

impl Shape {
    /// With its distance.
    pub(crate) fn place(&self, X: &Vector3) -> Place {
        Place { X: *X, distance: self.signed_distance(X) }
    }

    /// Whether every straight way between two points of the solid stays in it, as far as
    /// its kind tells.
    pub(crate) fn is_convex(&self) -> bool {
        match self {
            Shape::Box { .. }
            | Shape::Cylinder { .. }
            | Shape::Sphere { .. }
            | Shape::Ellipsoid { .. }
            | Shape::HalfSpace { .. } => true,
            Shape::Polygon { points, .. } => points.is_convex(),
            Shape::Union(members) => members.len() == 1 && members[0].is_convex(),
            Shape::Intersection(members) => members.iter().all(Shape::is_convex),
            Shape::Surface(surface) => surface.is_convex(),
            Shape::Difference(..) | Shape::Labels(_) | Shape::Function(_) => false,
        }
    }

    /// Whether a gap lies between two places of the body: the straight way leaves it through
    /// faces that do not look the same way, however narrow the gap, or farther than along the wall
    /// of a hollow and by more than 2 % of a `length` \[m\], the local nodal spacing. Steps are no longer than the distance to the
    /// boundary, or a tenth of the length; across such a step the distance is looked at where
    /// it would be 0 if it rose and fell evenly. A way along a face passes the mouth of a narrow gap
    /// between two looks: where both places are on the boundary the way below it counts too.
    pub(crate) fn parts(&self, a: &Place, b: &Place, length: f64) -> bool {
        let (a, b) = if b.comes_before(a, TIE * length) { (b, a) } else { (a, b) };
        let way = Way::new(self, a, b, length);
        // Balls of material around both ends.
        let depths = [a, b].map(|end| (-end.distance).max(0.0));
        if depths[0] + depths[1] >= way.total {
            return false;
        }
        way.is_parted() || self.parts_below(a, b, length)
    }

    /// Whether a gap lies between two places on the boundary on the way below it.
    fn parts_below(&self, a: &Place, b: &Place, length: f64) -> bool {
        if [a, b].iter().any(|place| place.distance.abs() > THIN * length) {
            return false;
        }
        let ends = self.below(a, length).zip(self.below(b, length));
        ends.is_some_and(|(a, b)| Way::new(self, &a, &b, length).is_parted())
    }

    /// The place below one on the boundary, below all faces that meet there; none in what is
    /// thinner.
    fn below(&self, place: &Place, length: f64) -> Option<Place> {
        let depth = BELOW * length;
        let mut found = *place;
        for _ in 0..FACES {
            if found.distance > -0.5 * depth {
                let way = (depth + found.distance) * self.gradient(&found.X);
                found = self.place(&(found.X - way));
            }
        }
        (found.distance <= -0.5 * depth).then_some(found)
    }
}

impl Shape {
    /// Middle \[m\] and length \[m\] of what lies outside on the straight way between two places, as
    /// far as steps of a hundredth of a `length` \[m\] show it.
    pub(crate) fn outside_between(&self, a: &Place, b: &Place, length: f64) -> (Vector3, f64) {
        let way = b.X - a.X;
        let count = (way.norm() / (FINE * length)).ceil().max(1.0);
        let at = |step: f64| a.X + way * ((step + 0.5) / count);
        let steps = (0..count as usize).map(|step| at(step as f64));
        let outside: Vec<Vector3> = steps.filter(|X| self.signed_distance(X) > 0.0).collect();
        let part = way.norm() / count;
        match outside.len() {
            0 => (0.5 * (a.X + b.X), 0.0),
            found => (outside.iter().sum::<Vector3>() / found as f64, found as f64 * part),
        }
    }

    /// Whether two places near the boundary lie on the two sides of a gap: their middle is
    /// outside as far as they are from it, or outside and between faces that face each other.
    pub(crate) fn has_gap_between(&self, X: &Vector3, Y: &Vector3) -> bool {
        let (middle, half) = (0.5 * (X + Y), 0.5 * (Y - X).norm());
        let distance = self.signed_distance(&middle);
        let is_out = |X: &Vector3| self.signed_distance(X).max(0.0);
        // On a corner round-off chooses one of its faces; beside it the one towards the other place is the nearest.
        let away = |X: &Vector3| self.gradient(&(X + BEFORE * (middle - X)));
        distance > THIN * half
            && distance > 2.0 * is_out(X).max(is_out(Y))
            && (distance > STRAIGHT * half || away(X).dot(&away(Y)) < FACING)
    }
}

/// What of a way is outside of the body.
struct Outside {
    /// Where it was first seen to be \[m\].
    first: f64,
    /// The greatest distance that was seen \[m\].
    depth: f64,
    /// Whether it is so little that it is a gap only between faces that face each other.
    narrow: bool,
}

/// A place on a way \[m\] with its signed distance \[m\].
type Step = (f64, f64);

/// The straight way between two places.
struct Way<'a> {
    body: &'a Shape,
    ends: [Place; 2],
    along: Vector3,
    /// \[m\]
    total: f64,
    /// Outside by more, a way has left the body \[m\].
    allowed: f64,
    /// Outside by less is inside \[m\].
    thin: f64,
    /// \[m\]
    step: f64,
}

impl<'a> Way<'a> {
    fn new(body: &'a Shape, a: &Place, b: &Place, length: f64) -> Way<'a> {
        let total = (b.X - a.X).norm();
        let along = (b.X - a.X) / total.max(f64::MIN_POSITIVE);
        // Centres of chords lie a little outside.
        let outside = a.distance.max(b.distance).max(0.0);
        let thin = outside + THIN * length;
        let (allowed, step) = (outside + GRAZING * length, STEP * length);
        Way { body, ends: [*a, *b], along, total, allowed, thin, step }
    }

    fn at(&self, t: f64) -> Vector3 {
        self.ends[0].X + t * self.along
    }

    fn distance(&self, t: f64) -> f64 {
        self.body.signed_distance(&self.at(t))
    }

    fn is_parted(&self) -> bool {
        let end = if self.total <= self.step {
            self.total
        } else {
            self.total + self.ends[1].distance.min(0.0)
        };
        // The last place inside, and the outside since.
        let (mut inside, mut outside) = (0.0, None);
        let (mut t, mut distance) = (0.0, self.ends[0].distance);
        while t < end {
            let next = (t + distance.abs().max(self.step)).min(end);
            let there =
                if next == self.total { self.ends[1].distance } else { self.distance(next) };
            let narrow = distance <= self.thin && there <= self.thin;
            if narrow {
                outside = self.outside_between((t, distance), (next, there), (LOOKS, false));
            }
            match (there > self.thin, &mut outside) {
                (true, Some(out)) => out.depth = out.depth.max(there),
                (true, None) => {
                    outside = Some(Outside { first: next, depth: there, narrow: false })
                }
                (false, Some(out)) if self.is_crossed(inside, out, next) => return true,
                (false, _) => (inside, outside) = (next, None),
            }
            (t, distance) = (next, there);
        }
        outside.is_some_and(|out| self.is_crossed(inside, &out, self.total))
    }

    /// The outside between two places inside, (t, distance), if it shows. Where one of these is on
    /// the boundary, a narrow gap would be beside it; elsewhere it would be where the distance
    /// vanished if it rose and fell evenly. It hardly rises where the way runs along a face that is
    /// nearer than the gap: what is found there is `narrow`.
    fn outside_between(
        &self,
        from: Step,
        to: Step,
        (looks, narrow): (usize, bool),
    ) -> Option<Outside> {
        let (before, after) = ((-from.1).max(0.0), (-to.1).max(0.0));
        let span = to.0 - from.0;
        // Balls of material that overlap.
        if looks == 0 || before + after >= span {
            return None;
        }
        let at = |part: f64| from.0 + part * span;
        let look = |t: f64, narrow: bool| {
            let depth = self.distance(t);
            (depth > self.thin).then_some(Outside { first: t, depth, narrow })
        };
        let out = |t: f64| look(t, narrow);
        let next_to = |parts: &dyn Fn(f64) -> f64| {
            let found = BESIDE.into_iter().map(parts).map(at).find_map(out);
            found.or_else(|| look(at(parts(NEXT_TO)), true))
        };
        match (before <= self.thin, after <= self.thin) {
            (true, true) => ALONG.into_iter().map(at).find_map(out),
            (true, false) => next_to(&|part| part),
            (false, true) => next_to(&|part| 1.0 - part),
            (false, false) => {
                let t = at(before / (before + after));
                let distance = self.distance(t);
                if distance > self.thin {
                    return Some(Outside { first: t, depth: distance, narrow });
                }
                let on_line = from.1 + (to.1 - from.1) * (t - from.0) / span;
                let is_even = distance - on_line <= BENT * (before + after);
                let then = (looks - 1, narrow || is_even || looks < LOOKS);
                let first = self.outside_between(from, (t, distance), then);
                first.or_else(|| self.outside_between((t, distance), to, then))
            }
        }
    }

    /// Whether a way that leaves the body after one place and is inside again at another has
    /// crossed a gap: what is outside is deep for its width, or the directions away from the body
    /// just outside of where the way leaves and comes back differ.
    fn is_crossed(&self, inside: f64, outside: &Outside, returns: f64) -> bool {
        let is_deep = |depth: f64, width: f64| depth > self.allowed.max(DEEP * width);
        if !outside.narrow && is_deep(outside.depth, returns - inside) {
            return true;
        }
        let away = |t: f64| self.body.gradient(&self.at(t));
        let [leaves, returns] =
            [inside, returns].map(|t| self.just_outside(t, outside.first, HALVINGS[1]));
        if away(leaves).dot(&away(returns)) < FACING {
            return true;
        }
        if outside.narrow {
            return false;
        }
        let [leaves, returns] =
            [inside, returns].map(|t| self.just_outside(t, outside.first, HALVINGS[0]));
        let part = (returns - leaves) / PARTS as f64;
        let depths = (1..PARTS).map(|n| self.distance(leaves + n as f64 * part));
        let depth = depths.fold(outside.depth, f64::max);
        is_deep(depth, returns - leaves) || away(leaves).dot(&away(returns)) < TURNED
    }

    /// The place outside next to where the boundary lies between one inside and one outside.
    fn just_outside(&self, mut inside: f64, mut outside: f64, halvings: usize) -> f64 {
        for _ in 0..halvings {
            let middle = 0.5 * (inside + outside);
            if self.distance(middle) > self.thin {
                outside = middle;
            } else {
                inside = middle;
            }
        }
        outside
    }
}

#[cfg(test)]
mod tests;
