//! How the supports of a block are packed: four side by side (method book, section 11).

use super::local_vectors::{Place, QUAD, stride};
use super::numbering::Numbering;
use super::stored_gradients::{GradientQuad, StoredGradients};
use crate::discretisation::rows::Rows;
use std::ops::Range;

/// The supports of a [`super::Block`].
pub struct Packed {
    pub starts: Vec<u32>,
    pub places: Vec<[Place; QUAD]>,
    pub grad_phi: StoredGradients,
}

/// Packs the supports of the points in the lanes of a block.
pub fn pack(
    supports: &Rows,
    lanes: &[Option<usize>],
    numbering: &Numbering,
    components: usize,
    single: bool,
) -> Packed {
    let (starts, entries) = slots(supports, lanes);
    let place = |node: u32| (numbering.of(node) as usize * stride(components)) as Place;
    // Lanes without a point each write to a node of their own.
    let unused = [0, 1, 2, 3].map(|lane| (lane * stride(components)) as Place);
    let mut places = Vec::with_capacity(entries.len());
    for slot in &entries {
        let of = |lane: usize| slot[lane].node().map_or(unused[lane], |e| place(supports.nodes[e]));
        places.push([of(0), of(1), of(2), of(3)]);
    }
    let grad_phi = if single {
        StoredGradients::Single(gradients(supports, &entries, components))
    } else {
        StoredGradients::Double(gradients(supports, &entries, components))
    };
    Packed { starts, places, grad_phi }
}

/// What a lane of a slot holds.
#[derive(Debug, Clone, Copy)]
enum Entry {
    /// An entry of the rows.
    Of(usize),
    /// The node of an entry once more, with a gradient of 0.
    Again(usize),
    /// Nothing: there is no point.
    Nothing,
}

impl Entry {
    /// The entry of the rows that has the node.
    fn node(self) -> Option<usize> {
        match self {
            Entry::Of(entry) | Entry::Again(entry) => Some(entry),
            Entry::Nothing => None,
        }
    }
}

/// The slots of each quad of lanes. Supports of points nearby are nearly the same, and each is
/// begun a quarter further on than that of the lane before: a slot that adds to one node
/// several times would have to wait for itself.
fn slots(supports: &Rows, lanes: &[Option<usize>]) -> (Vec<u32>, Vec<[Entry; QUAD]>) {
    let (mut starts, mut entries) = (vec![0], Vec::new());
    for quad in lanes.as_chunks::<QUAD>().0 {
        let row = |q: Option<usize>| q.map_or(0..0, |q| supports.row(q));
        let rows: [Range<usize>; QUAD] = quad.map(row);
        let longest = rows.iter().map(Range::len).max().unwrap_or(0);
        for slot in 0..longest {
            entries.push([0, 1, 2, 3].map(|lane| {
                let (first, length) = (rows[lane].start, rows[lane].len());
                let turned = |slot: usize| first + (slot + lane * length / QUAD) % length;
                match length {
                    0 => Entry::Nothing,
                    _ if slot < length => Entry::Of(turned(slot)),
                    _ => Entry::Again(turned(length - 1)),
                }
            }));
        }
        starts.push(entries.len() as u32);
    }
    (starts, entries)
}

/// Grad φ of some slots, component by component.
fn gradients<G: GradientQuad>(
    supports: &Rows,
    slots: &[[Entry; QUAD]],
    components: usize,
) -> Vec<G> {
    let mut gradients = Vec::with_capacity(slots.len() * components);
    for slot in slots {
        for component in 0..components {
            gradients.push(G::new(slot.map(|entry| match entry {
                Entry::Of(entry) => supports.grad_phi[entry][component],
                Entry::Again(_) | Entry::Nothing => 0.0,
            })));
        }
    }
    gradients
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::tensor::Vector3;

    /// Supports of 5, 3, 7, 4 and 2 among twelve nodes.
    fn supports() -> Rows {
        let lists: [&[u32]; 5] =
            [&[0, 2, 3, 5, 9], &[1, 2, 9], &[0, 1, 4, 6, 7, 8, 11], &[2, 3, 5, 10], &[4, 7]];
        let mut rows = Rows::default();
        for list in lists {
            rows.nodes.extend(list);
            rows.starts.push(rows.nodes.len());
        }
        rows.phi = vec![0.0; rows.nodes.len()];
        rows.grad_phi =
            (1..=rows.nodes.len()).map(|e| Vector3::new(e as f64, -(e as f64), 0.5)).collect();
        rows
    }

    #[test]
    fn each_lane_holds_the_support_of_its_point_once() {
        let rows = supports();
        let lanes = [2, 0, 3, 1, 4].map(Some).into_iter().chain([None; 3]).collect::<Vec<_>>();
        let mut numbering = Numbering::new(12);
        assert!(numbering.add(&rows, 0..5, 12));
        for components in [2, 3] {
            let packed = pack(&rows, &lanes, &numbering, components, false);
            assert_eq!(
                packed.starts,
                [0, 7, 9],
                "as many slots as the largest support has entries"
            );
            let StoredGradients::Double(gradients) = &packed.grad_phi else { unreachable!() };
            for (lane, point) in lanes.iter().enumerate() {
                let quad = lane / QUAD;
                let slots = packed.starts[quad] as usize..packed.starts[quad + 1] as usize;
                let entries = slots.map(|slot| {
                    let local = packed.places[slot][lane % QUAD] as usize / stride(components);
                    (numbering.nodes()[local], gradients[components * slot].at(lane % QUAD))
                });
                let mut found: Vec<(u32, f64)> = entries.filter(|entry| entry.1 != 0.0).collect();
                found.sort_by_key(|entry| entry.0);
                let row = point.map_or(0..0, |q| rows.row(q));
                let wanted: Vec<(u32, f64)> =
                    row.map(|e| (rows.nodes[e], rows.grad_phi[e].x)).collect();
                assert_eq!(found, wanted, "lane {lane}, {components} components");
            }
        }
    }

    #[test]
    fn a_numbering_that_is_full_keeps_what_it_had() {
        let rows = supports();
        let mut numbering = Numbering::new(12);
        assert!(numbering.add(&rows, 0..2, 6));
        let before = numbering.nodes().to_vec();
        assert!(!numbering.add(&rows, 2..3, 6));
        assert_eq!(numbering.nodes(), before);
        assert!(numbering.add(&rows, 1..2, 6), "what was taken back can be given again");
    }
}
