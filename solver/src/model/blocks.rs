//! Quadrature points in blocks that the internal force runs over.

use crate::discretisation::Discretisation;
use crate::discretisation::patches::orthonormal_basis;
use crate::discretisation::rows::Rows;
use crate::material::Law;
use crate::model::projection::{Projection, Weighted};
use crate::problem::{GradientStorage, Problem, VolumetricProjection};
use std::ops::Range;

/// Grad φ as it is held, `components` per support entry \[1/m\].
#[derive(Debug, Clone)]
pub enum Stored {
    Double(Vec<f64>),
    Single(Vec<f32>),
}

/// Runs `$body` with `$held` bound to the numbers of `$stored`.
macro_rules! with_stored {
    ($stored:expr, $held:ident => $body:expr) => {
        match $stored {
            $crate::model::blocks::Stored::Double($held) => $body,
            $crate::model::blocks::Stored::Single($held) => $body,
        }
    };
}
pub(crate) use with_stored;

/// A number as it is held in memory.
pub trait Held: Copy + Into<f64> {
    /// Four gradients in double precision, in `room` if they are not held so: a
    /// copy of what is would have to be made before forces are written.
    fn wide<'a, const D: usize>(
        four: &'a [[Self; D]; 4],
        room: &'a mut [[f64; D]; 4],
    ) -> &'a [[f64; D]; 4];
}

impl Held for f64 {
    #[inline(always)]
    fn wide<'a, const D: usize>(
        four: &'a [[f64; D]; 4],
        _room: &'a mut [[f64; D]; 4],
    ) -> &'a [[f64; D]; 4] {
        four
    }
}

impl Held for f32 {
    #[inline(always)]
    fn wide<'a, const D: usize>(
        four: &'a [[f32; D]; 4],
        room: &'a mut [[f64; D]; 4],
    ) -> &'a [[f64; D]; 4] {
        // Not `map`: its closure would be a call where it is not inlined.
        for (wide, held) in room.iter_mut().zip(four) {
            for j in 0..D {
                wide[j] = held[j] as f64;
            }
        }
        room
    }
}

/// Consecutive quadrature points of one material, with their own numbering of
/// the nodes they touch. Blocks depend on the problem alone, never on the
/// number of threads.
#[derive(Debug, Clone)]
pub struct Block {
    pub law: Law,
    pub points: Range<usize>,
    /// Global node of each local one.
    pub nodes: Vec<u32>,
    /// Support of local point p is `starts[p]..starts[p + 1]`, filled up to whole
    /// fours with its last node and gradients of 0.
    pub starts: Vec<u32>,
    /// Local node indices \[support entry\].
    pub supports: Vec<u32>,
    pub grad_phi: Stored,
    /// \[point\] \[m³\]
    pub quadrature_weights: Vec<f64>,
    /// Points that are worked on together are `chunks[c]..chunks[c + 1]`: a
    /// patch, or a few where nothing is projected.
    pub chunks: Vec<u32>,
    /// Only where the material is nearly incompressible.
    pub projection: Option<Projection>,
}

impl Block {
    /// Local nodes and gradients of a local point, D components each, from what
    /// `grad_phi` holds.
    #[inline(always)]
    pub fn support<'a, G, const D: usize>(
        &'a self,
        grad_phi: &'a [G],
        point: usize,
    ) -> (&'a [u32], &'a [[G; D]]) {
        let entries = self.starts[point] as usize..self.starts[point + 1] as usize;
        (&self.supports[entries.clone()], &grad_phi.as_chunks::<D>().0[entries])
    }

    /// The entries that stand `ahead` entries after the support of a point.
    #[inline(always)]
    pub fn coming<'a, G, const D: usize>(
        &'a self,
        grad_phi: &'a [G],
        point: usize,
        ahead: usize,
    ) -> (&'a [u32], &'a [[G; D]]) {
        let first = (self.starts[point] as usize + ahead).min(self.supports.len());
        (&self.supports[first..], &grad_phi.as_chunks::<D>().0[first..])
    }

    /// Bytes that one evaluation of the internal force streams.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.supports[..])
            + with_stored!(&self.grad_phi, held => size_of_val(&held[..]))
    }

    pub fn chunks(&self) -> impl Iterator<Item = Chunk> {
        let mut eights = 0..0;
        self.chunks.windows(2).map(move |ends| {
            let points = ends[0] as usize..ends[1] as usize;
            eights = eights.end..eights.end + points.len().div_ceil(8);
            Chunk { points, eights: eights.clone() }
        })
    }
}

/// Points that are worked on together.
#[derive(Debug, Clone)]
pub struct Chunk {
    /// Local points.
    pub points: Range<usize>,
    /// Where they are where eight points make an entry.
    pub eights: Range<usize>,
}

/// Points worked on together where nothing is projected: their gradients stay
/// in the first cache.
const CHUNK: usize = 16;

/// A block holds at least and at most this many points.
const BLOCK_POINTS: (usize, usize) = (1024, 8192);

/// Blocks end where a patch does.
pub fn blocks(problem: &Problem, discretisation: &Discretisation) -> Vec<Block> {
    let regions = &discretisation.quadrature.regions;
    let most = (regions.len() / 16).clamp(BLOCK_POINTS.0, BLOCK_POINTS.1);
    let patches = &discretisation.patches;
    let mut blocks = Vec::new();
    let mut first = 0;
    while first + 1 < patches.len() {
        let start = patches[first];
        let last = (first + 1..patches.len())
            .take_while(|&p| regions[patches[p] - 1] == regions[start])
            .take_while(|&p| p == first + 1 || patches[p] - start <= most)
            .last()
            .unwrap_or(first + 1);
        blocks.push(block(problem, first..last, discretisation));
        first = last;
    }
    blocks
}

fn block(problem: &Problem, patches: Range<usize>, discretisation: &Discretisation) -> Block {
    let rows = &discretisation.supports;
    let starts = &discretisation.patches[patches.start..=patches.end];
    let points = starts[0]..starts[starts.len() - 1];
    let components = discretisation.dimension.components();
    let storage = problem.recipe.gradient_storage;
    let Packed { nodes, starts: entries, supports, grad_phi } =
        pack(rows, points.clone(), components, storage, discretisation.cloud.positions.len());
    let region = discretisation.quadrature.regions[points.start] as usize;
    let law = problem.regions[region].material.law;
    let share = match problem.recipe.volumetric_projection {
        VolumetricProjection::Patches => law.projected_share(),
        VolumetricProjection::None => 0.0,
    };
    Block {
        law,
        starts: entries,
        supports,
        grad_phi,
        quadrature_weights: discretisation.quadrature.weights[points.clone()].to_vec(),
        chunks: match share > 0.0 {
            true => starts.iter().map(|start| (start - points.start) as u32).collect(),
            false => {
                let count = points.len();
                (0..=count.div_ceil(CHUNK)).map(|c| (c * CHUNK).min(count) as u32).collect()
            }
        },
        projection: (share > 0.0).then(|| projection(share, starts, discretisation)),
        nodes,
        points,
    }
}

/// Supports of a block as [`Block`] holds them.
struct Packed {
    nodes: Vec<u32>,
    starts: Vec<u32>,
    supports: Vec<u32>,
    grad_phi: Stored,
}

/// Numbers the nodes in the order in which they appear, which is that of the
/// points in space, and fills each support up to whole fours.
fn pack(
    rows: &Rows,
    points: Range<usize>,
    components: usize,
    storage: GradientStorage,
    nodes: usize,
) -> Packed {
    const NONE: u32 = u32::MAX;
    let mut numbers = vec![NONE; nodes];
    let (mut nodes, mut starts, mut supports) = (Vec::new(), vec![0], Vec::new());
    let filled = |point: usize| rows.row(point).len().next_multiple_of(4);
    supports.reserve_exact(points.clone().map(filled).sum());
    for point in points.clone() {
        for entry in rows.row(point) {
            let number = &mut numbers[rows.nodes[entry] as usize];
            if *number == NONE {
                *number = nodes.len() as u32;
                nodes.push(rows.nodes[entry]);
            }
            supports.push(*number);
        }
        let filled = supports.len().next_multiple_of(4);
        supports.resize(filled, supports.last().copied().unwrap_or(0));
        starts.push(filled as u32);
    }
    let size = supports.len() * components;
    let grad_phi = match storage {
        GradientStorage::Double => Stored::Double(stream(rows, points, components, size, |g| g)),
        GradientStorage::Single => {
            Stored::Single(stream(rows, points, components, size, |g| g as f32))
        }
    };
    Packed { nodes, starts, supports, grad_phi }
}

/// The gradients at some points, `size` numbers in all: those of each point
/// filled up to whole fours of entries.
fn stream<G: Copy + Default>(
    rows: &Rows,
    points: Range<usize>,
    components: usize,
    size: usize,
    held: impl Fn(f64) -> G,
) -> Vec<G> {
    let mut stream = Vec::with_capacity(size);
    for point in points {
        for gradient in &rows.grad_phi[rows.row(point)] {
            stream.extend(gradient.iter().take(components).map(|g| held(*g)));
        }
        stream.resize(stream.len().next_multiple_of(4 * components), G::default());
    }
    stream
}

fn projection(share: f64, starts: &[usize], discretisation: &Discretisation) -> Projection {
    let quadrature = &discretisation.quadrature;
    let components = discretisation.dimension.components();
    let eights = |patch: &[usize]| {
        let points = patch[0]..patch[1];
        let (positions, weights) = (&quadrature.positions, &quadrature.weights);
        let basis = orthonormal_basis(positions, weights, points.clone(), components);
        Weighted::eights(&weights[points], &basis)
    };
    Projection { share, eights: starts.windows(2).flat_map(eights).collect() }
}

/// How the forces of the blocks are summed: by stretches of nodes that any
/// thread may take, each node in the order of the blocks.
#[derive(Debug, Clone)]
pub struct Sums {
    /// Nodes of a stretch.
    pub stretch: usize,
    /// What the blocks that touch a stretch give to it, in order \[stretch\].
    pub terms: Vec<Vec<Term>>,
}

/// What one block gives to a stretch.
#[derive(Debug, Clone)]
pub struct Term {
    pub block: usize,
    /// Nodes with their local numbers.
    pub nodes: Vec<(u32, u32)>,
}

impl Sums {
    pub fn new(blocks: &[Block], nodes: usize) -> Sums {
        let stretch = nodes.div_ceil(16).max(1);
        let mut terms = vec![Vec::new(); nodes.div_ceil(stretch)];
        for (index, block) in blocks.iter().enumerate() {
            let mut numbers: Vec<(u32, u32)> = block.nodes.iter().copied().zip(0..).collect();
            numbers.sort_unstable();
            let place = |node: u32| node as usize / stretch;
            for nodes in numbers.chunk_by(|a, b| place(a.0) == place(b.0)) {
                terms[place(nodes[0].0)].push(Term { block: index, nodes: nodes.to_vec() });
            }
        }
        Sums { stretch, terms }
    }
}
