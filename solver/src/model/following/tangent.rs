//! The tangent of loads that depend on displacements.

use super::cavity::{FluidTangent, OwnFluid};
use super::loads::FollowingLoads;
use super::part::Following;

/// ∂f/∂u of the loads at some displacements.
pub struct FollowingTangent<'a> {
    loads: &'a FollowingLoads,
    t: f64,
    u: &'a [f64],
    components: usize,
    fluids: Vec<Option<FluidTangent>>,
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
        FollowingTangent { loads, t, u, components, fluids: fluids.collect() }
    }

    /// Adds a part of ∂f/∂u v \[N\].
    pub fn add_times(&self, v: &[f64], part: Following, product: &mut [f64]) {
        let (uv, d) = ((self.u, v), self.components);
        for load in &self.loads.pressures {
            load.add_stiffness_times(self.t, uv, part, d, product);
        }
        self.loads.springs.iter().for_each(|load| load.add_force(v, d, product));
        for (cavity, fluid) in self.loads.cavities.iter().zip(&self.fluids) {
            if let Some(fluid) = fluid {
                cavity.add_turning_times(fluid.own.pressure, uv, part, d, product);
                fluid.add_compression_times(v, part, product);
            }
        }
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
