//! Vectors at the nodes of a block, which sixteen bits point to.

use fearless_simd::{Simd, f64x2, f64x4, prelude::*};

/// Quadrature points whose supports are read side by side.
pub const QUAD: usize = 4;

/// Where the vector of a node begins among [`LocalVectors`].
pub type Place = u16;

/// Numbers from one node to the next: the components, and one of padding in space.
pub const fn stride(components: usize) -> usize {
    match components {
        2 => 2,
        _ => 4,
    }
}

/// Most nodes that a block can have.
pub const fn most_nodes(components: usize) -> usize {
    (Place::MAX as usize + 1) / stride(components)
}

/// All places and the vector at the last one.
const ROOM: usize = Place::MAX as usize + 1 + 4;

/// Bytes of a line of the caches, where the first vector begins: none is in two lines.
const LINE: usize = 64;

/// Vectors at the nodes of a block. Their room is that of all places, so that no place needs
/// a check; what no node uses is never touched.
#[derive(Debug)]
pub struct LocalVectors {
    numbers: Vec<f64>,
    first: usize,
}

impl LocalVectors {
    /// All are 0.
    pub fn zeros() -> LocalVectors {
        let spare = LINE / size_of::<f64>();
        let numbers = vec![0.0; ROOM + spare];
        let first = numbers.as_ptr().align_offset(LINE).min(spare);
        LocalVectors { numbers, first }
    }

    fn room(&self) -> &[f64; ROOM] {
        let Some(room) = self.numbers[self.first..].first_chunk() else { unreachable!() };
        room
    }

    fn room_mut(&mut self) -> &mut [f64; ROOM] {
        let Some(room) = self.numbers[self.first..].first_chunk_mut() else { unreachable!() };
        room
    }

    /// Takes over the values at some nodes of all.
    pub fn gather<const D: usize>(&mut self, nodes: &[u32], all: &[f64]) {
        let all = all.as_chunks::<D>().0;
        for (&node, vector) in nodes.iter().zip(self.room_mut().chunks_exact_mut(stride(D))) {
            vector[..D].copy_from_slice(&all[node as usize]);
        }
    }

    /// Makes the vectors of the first nodes 0.
    pub fn clear<const D: usize>(&mut self, nodes: usize) {
        self.room_mut()[..nodes * stride(D)].fill(0.0);
    }

    /// The vectors, in the order of the nodes and beyond them.
    pub fn iter<const D: usize>(&self) -> impl Iterator<Item = &[f64; D]> {
        self.room().chunks_exact(stride(D)).filter_map(|vector| vector.first_chunk())
    }

    /// The vector of a local node.
    pub fn at<const D: usize>(&self, node: usize) -> [f64; D] {
        std::array::from_fn(|i| self.numbers[self.first + node * stride(D) + i])
    }

    /// To read at places.
    #[inline(always)]
    pub fn reader(&self) -> Reader<'_> {
        Reader(self.room())
    }

    /// To add at places.
    #[inline(always)]
    pub fn adder(&mut self) -> Adder<'_> {
        Adder(self.room_mut())
    }
}

/// Reads vectors at places.
#[derive(Clone, Copy)]
pub struct Reader<'a>(&'a [f64; ROOM]);

impl Reader<'_> {
    /// Components `first` and `first + 1` at a place.
    #[inline(always)]
    pub fn two<S: Simd>(&self, simd: S, place: Place, first: usize) -> f64x2<S> {
        let place = place as usize + first;
        let numbers = self.0[place..place + 2].first_chunk::<2>();
        numbers.copied().unwrap_or_default().simd_into(simd)
    }
}

/// Adds to vectors at places.
pub struct Adder<'a>(&'a mut [f64; ROOM]);

impl Adder<'_> {
    /// In space.
    #[inline(always)]
    pub fn add_four<S: Simd>(&mut self, simd: S, place: Place, term: f64x4<S>) {
        let place = place as usize;
        if let Some(numbers) = self.0[place..place + 4].first_chunk_mut::<4>() {
            let sum: f64x4<S> = (*numbers).simd_into(simd);
            *numbers = (sum + term).into();
        }
    }

    /// In a plane.
    #[inline(always)]
    pub fn add_two<S: Simd>(&mut self, simd: S, place: Place, term: f64x2<S>) {
        let place = place as usize;
        if let Some(numbers) = self.0[place..place + 2].first_chunk_mut::<2>() {
            let sum: f64x2<S> = (*numbers).simd_into(simd);
            *numbers = (sum + term).into();
        }
    }
}
