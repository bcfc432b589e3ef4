//! Between nodes and quadrature points: gradients of the displacement from the nodes of
//! supports, and forces on them, four points side by side.
#![allow(non_snake_case)]

use crate::algebra::lanes::{SimdBlock, prefetch};
use crate::force::layout::{
    Adder, Block, GradientQuad, LocalVectors, Place, QUAD, Reader, with_gradients,
};
use fearless_simd::{Simd, f64x4, prelude::*};
use std::ops::Range;

/// Places and gradients of some slots.
type Slots<'a, G, const D: usize> = (&'a [[Place; QUAD]], &'a [[G; D]]);

/// Rows of I + Σ_a u_a ⊗ Grad φ_a at the points of some SIMD blocks; `identity` is 1, or 0 for
/// the derivative. In a plane the third row and column are left alone.
#[inline(always)]
pub fn deformation_gradients<S: Simd, const D: usize>(
    simd: S,
    block: &Block,
    groups: Range<usize>,
    u: &LocalVectors,
    identity: f64,
    deformation: &mut [SimdBlock],
) {
    let u = u.reader();
    // Chooses the precision in which gradients are stored.
    with_gradients!(&block.grad_phi, grad_phi => {
        for (group, rows) in groups.zip(deformation.as_chunks_mut::<9>().0) {
            for half in 0..2 {
                let slots = block.slots::<_, D>(grad_phi, 2 * group + half);
                let sums = displacement_gradient(simd, slots, u);
                for i in 0..D {
                    for j in 0..D {
                        let entry = if i == j { sums[i][j] + identity } else { sums[i][j] };
                        rows[3 * i + j].0.as_chunks_mut::<QUAD>().0[half] = entry.into();
                    }
                }
            }
        }
    });
}

/// Σ_a u_a ⊗ Grad φ_a at the four points of a quad.
#[inline(always)]
fn displacement_gradient<S: Simd, G: GradientQuad, const D: usize>(
    simd: S,
    (places, gradients): Slots<G, D>,
    u: Reader,
) -> [[f64x4<S>; D]; D] {
    let mut sums = [[f64x4::splat(simd, 0.0); D]; D];
    for (places, gradients) in places.iter().zip(gradients) {
        let u = components::<S, D>(simd, u, places);
        for j in 0..D {
            let gradient = gradients[j].widen(simd);
            for i in 0..D {
                sums[i][j] = u[i].mul_add(gradient, sums[i][j]);
            }
        }
    }
    sums
}

/// Each component of the vectors at four places, side by side.
#[inline(always)]
fn components<S: Simd, const D: usize>(
    simd: S,
    vectors: Reader,
    places: &[Place; QUAD],
) -> [f64x4<S>; D] {
    let mut components = [f64x4::splat(simd, 0.0); D];
    for first in [0, 2] {
        if first < D {
            let [a, b, c, d] = [0, 1, 2, 3].map(
                #[inline(always)]
                |lane| vectors.two(simd, places[lane], first),
            );
            let low = (simd.zip_low_f64x2(a, b), simd.zip_low_f64x2(c, d));
            components[first] = simd.combine_f64x2(low.0, low.1);
            if first + 1 < D {
                let high = (simd.zip_high_f64x2(a, b), simd.zip_high_f64x2(c, d));
                components[first + 1] = simd.combine_f64x2(high.0, high.1);
            }
        }
    }
    components
}

/// f_a += w P Grad φ_a of the points of some SIMD blocks, lane after lane of each slot. On the way
/// the processor is told to fetch what the next chunk will read, as many slots ahead as this
/// chunk has.
#[inline(always)]
pub fn add_forces<S: Simd, const D: usize>(
    simd: S,
    block: &Block,
    groups: Range<usize>,
    stress: &[SimdBlock],
    f: &mut LocalVectors,
) {
    let mut f = f.adder();
    let ahead = block.starts[2 * groups.end] - block.starts[2 * groups.start];
    let weights = block.quadrature_weights.as_chunks::<QUAD>().0;
    // Chooses the precision in which gradients are stored.
    with_gradients!(&block.grad_phi, grad_phi => {
        for (group, rows) in groups.zip(stress.as_chunks::<9>().0) {
            for half in 0..2 {
                let quad = 2 * group + half;
                let weight: f64x4<S> = weights[quad].simd_into(simd);
                let mut weighted = [[weight; D]; D];
                for i in 0..D {
                    for j in 0..D {
                        let entry: f64x4<S> =
                            rows[3 * i + j].0.as_chunks::<QUAD>().0[half].simd_into(simd);
                        weighted[i][j] = entry * weight;
                    }
                }
                let slots = block.slots::<_, D>(grad_phi, quad);
                let next = block.slots_ahead::<_, D>(grad_phi, quad, ahead);
                add_weighted(simd, &weighted, slots, next, &mut f);
            }
        }
    });
}

/// f_a += w P Grad φ_a of the four points of a quad, from w P; `next` is what to fetch on the way.
#[inline(always)]
fn add_weighted<S: Simd, G: GradientQuad, const D: usize>(
    simd: S,
    weighted: &[[f64x4<S>; D]; D],
    (places, gradients): Slots<G, D>,
    next: Slots<G, D>,
    f: &mut Adder,
) {
    for (slot, (places, gradients)) in places.iter().zip(gradients).enumerate() {
        prefetch_slot(next, slot);
        let mut force = [f64x4::splat(simd, 0.0); D];
        for i in 0..D {
            force[i] = weighted[i][0] * gradients[0].widen(simd);
            for j in 1..D {
                force[i] = weighted[i][j].mul_add(gradients[j].widen(simd), force[i]);
            }
        }
        add_components::<S, D>(simd, &force, places, f);
    }
}

/// Prefetches both lines that a slot can touch.
#[inline(always)]
fn prefetch_slot<G, const D: usize>((places, gradients): Slots<G, D>, slot: usize) {
    if slot.is_multiple_of(8) {
        prefetch(places, slot);
    }
    prefetch(gradients, slot);
}

/// The opposite of [`components`]: adds to the vectors at four places, one after the other, so
/// that places may be the same.
#[inline(always)]
fn add_components<S: Simd, const D: usize>(
    simd: S,
    components: &[f64x4<S>; D],
    places: &[Place; QUAD],
    vectors: &mut Adder,
) {
    let (x, y) = (simd.split_f64x4(components[0]), simd.split_f64x4(components[1]));
    let pairs = [
        simd.zip_low_f64x2(x.0, y.0),
        simd.zip_high_f64x2(x.0, y.0),
        simd.zip_low_f64x2(x.1, y.1),
        simd.zip_high_f64x2(x.1, y.1),
    ];
    if D == 2 {
        for lane in 0..QUAD {
            vectors.add_two(simd, places[lane], pairs[lane]);
        }
        return;
    }
    // What comes after z goes to the padding, where any number may stand.
    let z = simd.split_f64x4(components[D - 1]);
    let rest = [z.0, simd.reverse_f64x2(z.0), z.1, simd.reverse_f64x2(z.1)];
    for lane in 0..QUAD {
        vectors.add_four(simd, places[lane], simd.combine_f64x2(pairs[lane], rest[lane]));
    }
}
