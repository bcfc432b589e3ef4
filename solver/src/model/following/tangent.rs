//! The tangent of loads that depend on displacements.

use super::cavity::{FluidTangent, OwnFluid};
use super::loads::FollowingLoads;
use super::part::Following;
use crate::algebra::block_matrix::BlockMatrix;

/// Products after which what pressures turn is kept as a matrix, which costs as much as some of them.
const WORTH: usize = 8;

/// ∂f/∂u of the loads at some displacements.
pub struct FollowingTangent<'a> {
    loads: &'a FollowingLoads,
    t: f64,
    u: &'a [f64],
    components: usize,
    fluids: Vec<Option<FluidTangent>>,
    /// The symmetric part of what pressures turn, once it is worth that, and products until then.
    turning: Option<BlockMatrix>,
    products: usize,
}

impl<'a> FollowingTangent<'a> {
    /// At time `t` \[s\] and displacements `u` \[m\], of fluids with pressures of their own or with those
    /// of their volumes.
    pub fn new(
        loads: &'a FollowingLoads,
        (t, own): (f64, Option<&[OwnFluid]>),
        u: &'a [f64],
        components: usize,
    ) -> FollowingTangent<'a> {
        let cavities = loads.cavities.iter().enumerate();
        let fluids = cavities
            .map(|(index, cavity)| cavity.tangent((t, own.map(|own| own[index])), u, components));
        let fluids = fluids.collect();
        FollowingTangent { loads, t, u, components, fluids, turning: None, products: 0 }
    }

    /// Adds a part of ∂f/∂u v \[N\].
    pub fn add_times(&mut self, v: &[f64], part: Following, product: &mut [f64]) {
        self.add_turning_times(v, part, product);
        self.loads.springs.iter().for_each(|load| load.add_force(v, self.components, product));
        for fluid in self.fluids.iter().flatten() {
            fluid.add_compression_times(v, part, product);
        }
    }

    fn add_turning_times(&mut self, v: &[f64], part: Following, product: &mut [f64]) {
        let (uv, d) = ((self.u, v), self.components);
        self.products += 1;
        if part == Following::Symmetric && self.products > WORTH {
            return self.turning().add_times(v, product);
        }
        for load in &self.loads.pressures {
            load.add_stiffness_times(self.t, uv, part, d, product);
        }
        for (cavity, fluid) in self.loads.cavities.iter().zip(&self.fluids) {
            if let Some(fluid) = fluid {
                cavity.add_turning_times(fluid.own.pressure, uv, part, d, product);
            }
        }
    }

    /// The symmetric part of the stiffness of pressures \[N/m\], without the compression of fluids.
    pub(crate) fn turning(&mut self) -> &BlockMatrix {
        let FollowingTangent { loads, t, u, components, fluids, turning, .. } = self;
        let d = *components;
        turning.get_or_insert_with(|| {
            let mut matrix = BlockMatrix::new(u.len() / d, d);
            loads.pressures.iter().for_each(|load| load.add_stiffness(*t, u, d, &mut matrix));
            for (cavity, fluid) in loads.cavities.iter().zip(fluids) {
                if let Some(fluid) = fluid {
                    cavity.add_turning(fluid.own.pressure, u, d, &mut matrix);
                }
            }
            matrix
        })
    }

    /// Adds the part of it that never pushes: of springs, and of fluids without the turning of their
    /// walls. The critical time step counts it.
    pub fn add_stiff_part_times(&self, v: &[f64], product: &mut [f64]) {
        self.loads.springs.iter().for_each(|load| load.add_force(v, self.components, product));
        for fluid in self.fluids.iter().flatten() {
            fluid.add_compression_times(v, Following::Symmetric, product);
        }
    }
}
