//! The system of a correction, and its solution.

use super::guide::Guide;
use crate::algebra::tensor::Matrix3;
use crate::model::Model;
use crate::motion::tangent::Tangent;

/// Approximate solution of (K + shift D) Δu = r.
#[derive(Default)]
pub(crate) struct Correction {
    pub change: Vec<f64>,
    /// Change of the pressures of patches less what J gives at once \[Pa·m^(3/2)\]; none where they
    /// are not unknowns.
    pub pressures: Vec<f64>,
    /// Change of the pressures of fluids \[cavity\] \[Pa\]; none where there are none.
    pub fluids: Vec<f64>,
    /// Whether a direction of negative curvature was met.
    pub indefinite: bool,
    /// Products with K.
    pub products: usize,
    /// What factors have cost beside them, in products.
    pub of_factors: usize,
    /// Whether the observer ended the run.
    pub stopped: bool,
}

/// The system of a correction.
pub(crate) struct System<'a> {
    pub tangent: Tangent<'a>,
    /// Free unbalanced forces r \[N\].
    pub residual: Vec<f64>,
    /// Displacement \[m\] to start from, which closes what is to be closed.
    pub change: Vec<f64>,
    /// Norm of the residual over that at the start at which the solution ends \[–\].
    pub forcing: f64,
    /// Stiffness of nodes that slide on obstacles \[N/m\].
    pub sliding: Vec<(u32, Matrix3)>,
    /// Part of the diagonal D that is added to K, against large steps \[–\].
    pub shift: f64,
    /// A spring that leads the body.
    pub guide: Option<&'a Guide>,
    /// The rows of pressures that are unknowns.
    pub saddle: Option<Saddle>,
}

/// The rows s G Δu − S q = b of the pressures of patches (method book, eq. 21.15), four a patch.
#[derive(Clone)]
pub(crate) struct Saddle {
    /// b \[m^(3/2)\].
    pub residual: Vec<f64>,
    /// Of each patch.
    pub patches: Vec<SaddlePatch>,
}

impl Saddle {
    /// The same where the pressures balance already.
    pub fn still(&self) -> Saddle {
        Saddle { residual: vec![0.0; self.residual.len()], patches: self.patches.clone() }
    }
}

/// The numbers of a patch.
#[derive(Clone, Copy)]
pub(crate) struct SaddlePatch {
    /// s \[–\]; 0 where J gives all of the pressure at once.
    pub fraction: f64,
    /// S \[1/Pa\].
    pub compliance: f64,
    /// About S + s² G K⁻¹ Gᵀ \[1/Pa\], which the preconditioner inverts.
    pub schur: f64,
}

impl System<'_> {
    /// (K + shift D) v \[N\].
    pub fn stiffness_times(&mut self, model: &Model, diagonal: &[f64], v: &[f64]) -> Vec<f64> {
        let product = self.tangent.stiffness_times(v);
        self.with_rest(model, diagonal, v, product)
    }

    /// Kᵀ v \[N\], without what is added to K.
    pub fn transposed_times(mut self, model: &Model, v: &[f64]) -> Vec<f64> {
        let mut product = self.tangent.transposed_times(v);
        add_sliding(model, &self.sliding, v, &mut product);
        product
    }

    /// Both rows of the system with pressures: (K + shift D) v + s Gᵀ q and s G v − S q, one
    /// after the other.
    pub fn saddle_times(
        &mut self,
        model: &Model,
        diagonal: &[f64],
        patches: &[SaddlePatch],
        vector: &[f64],
    ) -> Vec<f64> {
        let (v, q) = vector.split_at(model.size());
        let (product, volumes) = self.tangent.saddle_times(v, q);
        let mut product = self.with_rest(model, diagonal, v, product);
        let rows = patches.iter().zip(q.as_chunks::<4>().0.iter().zip(volumes.as_chunks::<4>().0));
        product.extend(rows.flat_map(|(patch, (q, volumes))| {
            let row = |b: usize| patch.fraction * volumes[b] - patch.compliance * q[b];
            [row(0), row(1), row(2), row(3)]
        }));
        product
    }

    /// Adds what is no tangent of the body.
    fn with_rest(
        &self,
        model: &Model,
        diagonal: &[f64],
        v: &[f64],
        mut product: Vec<f64>,
    ) -> Vec<f64> {
        let d = model.components;
        if self.shift > 0.0 {
            for ((product, v), k) in product.chunks_mut(d).zip(v.chunks(d)).zip(diagonal) {
                product.iter_mut().zip(v).for_each(|(p, v)| *p += self.shift * k * v);
            }
        }
        add_sliding(model, &self.sliding, v, &mut product);
        if let Some(guide) = self.guide {
            guide.add_stiffness_times(v, &mut product);
        }
        product
    }
}

/// The forces against sliding of displacements v.
fn add_sliding(model: &Model, sliding: &[(u32, Matrix3)], v: &[f64], product: &mut [f64]) {
    let (Some(rows), d) = (&model.nodal_rows, model.components) else { return };
    for (node, stiffness) in sliding {
        let force = stiffness * rows.interpolate(*node as usize, v, d);
        for entry in rows.row(*node as usize) {
            let first = d * rows.nodes[entry] as usize;
            (0..d).for_each(|k| product[first + k] += rows.phi[entry] * force[k]);
        }
    }
}
