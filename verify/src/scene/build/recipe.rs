//! The discretisation table of a case file → the solver's recipe.

use crate::files;
use crate::scene::build::Builder;
use crate::scene::format::recipe::{
    BasisFormat, CloudFormat, DiscretisationFormat, EnforcementFormat, GradientStorageFormat,
    GradientsFormat, GridFormat, InsideFormat, MassFormat, VolumetricProjectionFormat,
    WeightFunctionFormat,
};
use mtled::geometry::Shape;
use mtled::problem::{
    BackgroundGrid, Basis, Cloud, Dimension, Enforcement, GradientStorage, Gradients, InsideRule,
    MassRule, Recipe, Refinement, VolumetricProjection, WeightFunction,
};

/// What a case file need not say.
pub mod defaults {
    use mtled::problem::{
        Basis, Enforcement, InsideRule, MassRule, VolumetricProjection, WeightFunction,
    };

    /// Influence radius over nodal spacing \[–\], by basis: a quadratic one needs
    /// more nodes in its supports.
    pub fn dilation(basis: Basis) -> f64 {
        match basis {
            Basis::Linear => 1.8,
            Basis::Quadratic => 2.6,
            Basis::ModifiedQuadratic { .. } => 2.0,
        }
    }
    pub const BASIS: Basis = Basis::Linear;
    /// Of the modified quadratic basis \[–\] (Joldes et al. 2015).
    pub const REGULARISATION: f64 = 1e-7;
    pub const WEIGHT_FUNCTION: WeightFunction = WeightFunction::QuarticSpline;
    /// Row sums of quadratic functions are negative at some corners.
    pub fn mass(basis: Basis) -> MassRule {
        match basis {
            Basis::Linear => MassRule::RowSum,
            Basis::Quadratic | Basis::ModifiedQuadratic { .. } => MassRule::EvenSplit,
        }
    }
    pub const ENFORCEMENT: Enforcement = Enforcement::Collocation;
    /// Of consistent gradients, over the defect of plain ones \[–\].
    pub const GRADIENT_TOLERANCE: f64 = 1e-3;
    pub const VOLUMETRIC_PROJECTION: VolumetricProjection = VolumetricProjection::Patches;
    pub const INSIDE: InsideRule = InsideRule::VolumeFraction;
    /// Two cells per node in three dimensions: 1.26³ = 2.
    pub const CELLS_PER_SPACING: f64 = 1.26;
    pub const GAUSS_POINTS: usize = 1;
    /// Growth of the spacing per length \[–\].
    pub const GROWTH: f64 = 0.25;
    pub const SEED: u64 = 1;
    /// Of selectors, over the nodal spacing \[–\].
    pub const TOLERANCE: f64 = 1e-3;
    /// Of selectors where the nodes come from a file \[m\].
    pub const TOLERANCE_OF_GIVEN_NODES: f64 = 1e-6;
}

/// Tolerance \[m\] of selectors that state none.
pub fn tolerance(format: &DiscretisationFormat) -> f64 {
    match format.spacing {
        Some(spacing) if spacing > 0.0 => defaults::TOLERANCE * spacing,
        _ => defaults::TOLERANCE_OF_GIVEN_NODES,
    }
}

impl Builder<'_> {
    /// The recipe, or `None` and a mistake.
    pub fn recipe(&mut self, format: &DiscretisationFormat) -> Option<Recipe> {
        let basis = self.basis(format);
        let dilation = format.dilation.unwrap_or(defaults::dilation(basis));
        if dilation <= 1.0 {
            let message = format!(
                "is {dilation}; it must be larger than 1, or nodes do not reach their neighbours"
            );
            self.mistake("discretisation.dilation", message);
        }
        self.keys_of_cloud(format);
        if let Some(spacing) = format.spacing {
            self.spacing_fits(spacing);
        }
        let cloud = self.cloud(format);
        let grid = self.grid(&format.grid, format);
        Some(Recipe {
            cloud: cloud?,
            dilation,
            basis,
            weight_function: format
                .weight_function
                .map_or(defaults::WEIGHT_FUNCTION, WeightFunction::from),
            grid: grid?,
            mass: format.mass.map_or(defaults::mass(basis), MassRule::from),
            enforcement: format.enforcement.map_or(defaults::ENFORCEMENT, Enforcement::from),
            gradients: self.gradients(format),
            gradient_storage: match format.gradient_storage {
                Some(GradientStorageFormat::Single) => GradientStorage::Single,
                Some(GradientStorageFormat::Double) | None => GradientStorage::Double,
            },
            volumetric_projection: format
                .volumetric_projection
                .map_or(defaults::VOLUMETRIC_PROJECTION, VolumetricProjection::from),
        })
    }

    fn basis(&mut self, format: &DiscretisationFormat) -> Basis {
        let key = "discretisation.regularisation";
        let regularisation = format.regularisation.unwrap_or(defaults::REGULARISATION);
        if !(regularisation > 0.0 && regularisation <= 1.0) {
            self.mistake(
                key,
                format!("is {regularisation}; it must lie in 0 < regularisation ≤ 1"),
            );
        }
        let basis = match format.basis {
            None => defaults::BASIS,
            Some(BasisFormat::Linear) => Basis::Linear,
            Some(BasisFormat::Quadratic) => Basis::Quadratic,
            Some(BasisFormat::ModifiedQuadratic) => Basis::ModifiedQuadratic { regularisation },
        };
        if format.regularisation.is_some() && !matches!(basis, Basis::ModifiedQuadratic { .. }) {
            self.mistake(key, "belongs to basis = \"modified_quadratic\"");
        }
        basis
    }

    fn gradients(&mut self, format: &DiscretisationFormat) -> Gradients {
        let key = "discretisation.gradient_tolerance";
        let tolerance = format.gradient_tolerance.unwrap_or(defaults::GRADIENT_TOLERANCE);
        self.positive(key, tolerance);
        match format.gradients.unwrap_or(GradientsFormat::Consistent) {
            GradientsFormat::Consistent => Gradients::Consistent { tolerance },
            GradientsFormat::Plain => {
                if format.gradient_tolerance.is_some() {
                    self.mistake(key, "belongs to gradients = \"consistent\"");
                }
                Gradients::Plain
            }
        }
    }

    /// Refuses a spacing that the body cannot hold.
    fn spacing_fits(&mut self, spacing: f64) {
        let Some((min, max)) = self.section.as_ref().and_then(Shape::bounding_box) else {
            return;
        };
        let edges = max - min;
        let smallest = edges.iter().copied().fold(f64::INFINITY, f64::min);
        if spacing > smallest {
            let message = format!(
                "is {spacing} m; it must not be larger than the body, which is {smallest} m thick"
            );
            self.mistake("discretisation.spacing", message);
        }
    }

    /// Refuses keys that belong to another kind of cloud.
    fn keys_of_cloud(&mut self, format: &DiscretisationFormat) {
        use CloudFormat::{File, Graded, Jittered};
        let cloud = format.cloud;
        let keys = [
            ("jitter", format.jitter.is_some(), cloud == Jittered, "jittered"),
            ("seed", format.seed.is_some(), matches!(cloud, Jittered | Graded), "jittered"),
            ("file", format.file.is_some(), cloud == File, "file"),
            ("refine", format.refine.is_some(), cloud == Graded, "graded"),
            ("growth", format.growth.is_some(), cloud == Graded, "graded"),
        ];
        for (name, given, belongs, owner) in keys {
            if given && !belongs {
                let message = format!("belongs to cloud = \"{owner}\"");
                self.mistake(&format!("discretisation.{name}"), message);
            }
        }
        let key = "discretisation.spacing";
        match format.spacing {
            Some(_) if cloud == File => {
                self.mistake(key, "does not belong to cloud = \"file\", where it is estimated");
            }
            Some(spacing) => self.positive(key, spacing),
            None if cloud == File => {}
            None => self.mistake(key, "is missing; this cloud needs the distance of its nodes"),
        }
    }

    fn cloud(&mut self, format: &DiscretisationFormat) -> Option<Cloud> {
        match format.cloud {
            CloudFormat::Regular => Some(Cloud::Regular { spacing: format.spacing? }),
            CloudFormat::Jittered => {
                let key = "discretisation.jitter";
                let Some(jitter) = format.jitter else {
                    self.mistake(key, "is missing; cloud = \"jittered\" needs it");
                    return None;
                };
                if !(0.0..0.5).contains(&jitter) {
                    self.mistake(key, format!("is {jitter}; it must lie in 0 ≤ jitter < 0.5"));
                }
                let seed = format.seed.unwrap_or(defaults::SEED);
                Some(Cloud::Jittered { spacing: format.spacing?, jitter, seed })
            }
            CloudFormat::Graded => self.graded(format),
            CloudFormat::File => self.given(format),
        }
    }

    fn graded(&mut self, format: &DiscretisationFormat) -> Option<Cloud> {
        let growth = format.growth.unwrap_or(defaults::GROWTH);
        self.positive("discretisation.growth", growth);
        let mut refinements = Vec::new();
        for (n, row) in format.refine.iter().flatten().enumerate() {
            let key = format!("discretisation.refine[{n}]");
            self.positive(&format!("{key}.spacing"), row.spacing);
            let part = self.selector(&format!("{key}.where"), &row.part);
            refinements.extend(part.map(|part| Refinement { part, size: row.spacing }));
        }
        let seed = format.seed.unwrap_or(0);
        Some(Cloud::Graded { spacing: format.spacing?, refinements, growth, seed })
    }

    fn given(&mut self, format: &DiscretisationFormat) -> Option<Cloud> {
        let key = "discretisation.file";
        let Some(file) = &format.file else {
            self.mistake(key, "is missing; cloud = \"file\" needs it");
            return None;
        };
        let path = self.resolve(file);
        match files::points::read(&path) {
            Ok(mut nodes) => {
                self.hash_file(key, &path);
                if let Dimension::PlaneStrain { z, .. } = self.dimension {
                    nodes.iter_mut().for_each(|node| node.z = z);
                }
                Some(Cloud::Given { nodes })
            }
            Err(error) => {
                self.mistake(key, error);
                None
            }
        }
    }

    fn grid(
        &mut self,
        format: &GridFormat,
        recipe: &DiscretisationFormat,
    ) -> Option<BackgroundGrid> {
        let key = "discretisation.grid";
        let gauss_points = format.gauss_points.unwrap_or(defaults::GAUSS_POINTS);
        if !(1..=5).contains(&gauss_points) {
            let message = format!("is {gauss_points}; it must be 1 to 5");
            self.mistake(&format!("{key}.gauss_points"), message);
        }
        if let Some(edge) = format.boundary_cell {
            self.positive(&format!("{key}.boundary_cell"), edge);
        }
        let mut refinements = Vec::new();
        for (n, row) in format.refine.iter().enumerate() {
            let key = format!("{key}.refine[{n}]");
            self.positive(&format!("{key}.cell"), row.cell);
            let part = self.selector(&format!("{key}.where"), &row.part);
            refinements.extend(part.map(|part| Refinement { part, size: row.cell }));
        }
        Some(BackgroundGrid {
            cell: self.cell(key, format, recipe)?,
            boundary_cell: format.boundary_cell,
            refinements,
            gauss_points,
            inside: format.inside.map_or(defaults::INSIDE, InsideRule::from),
        })
    }

    /// Edge of the largest cells \[m\].
    fn cell(
        &mut self,
        key: &str,
        format: &GridFormat,
        recipe: &DiscretisationFormat,
    ) -> Option<f64> {
        match (format.cell, format.cells_per_spacing, recipe.spacing) {
            (Some(_), Some(_), _) => {
                let message = "cannot be given together with cell; remove one";
                self.mistake(&format!("{key}.cells_per_spacing"), message);
                None
            }
            (Some(cell), None, _) => {
                self.positive(&format!("{key}.cell"), cell);
                Some(cell)
            }
            (None, ratio, Some(spacing)) => {
                let ratio = ratio.unwrap_or(defaults::CELLS_PER_SPACING);
                self.positive(&format!("{key}.cells_per_spacing"), ratio);
                Some(spacing / ratio)
            }
            // The missing spacing has been noted already.
            (None, _, None) if recipe.cloud != CloudFormat::File => None,
            (None, _, None) => {
                let message = "is missing; without a nodal spacing the cells need a length";
                self.mistake(&format!("{key}.cell"), message);
                None
            }
        }
    }
}

impl From<WeightFunctionFormat> for WeightFunction {
    fn from(format: WeightFunctionFormat) -> WeightFunction {
        match format {
            WeightFunctionFormat::CubicSpline => WeightFunction::CubicSpline,
            WeightFunctionFormat::QuarticSpline => WeightFunction::QuarticSpline,
            WeightFunctionFormat::Exponential => WeightFunction::Exponential,
        }
    }
}

impl From<MassFormat> for MassRule {
    fn from(format: MassFormat) -> MassRule {
        match format {
            MassFormat::EvenSplit => MassRule::EvenSplit,
            MassFormat::RowSum => MassRule::RowSum,
        }
    }
}

impl From<EnforcementFormat> for Enforcement {
    fn from(format: EnforcementFormat) -> Enforcement {
        match format {
            EnforcementFormat::Direct => Enforcement::Direct,
            EnforcementFormat::Collocation => Enforcement::Collocation,
        }
    }
}

impl From<VolumetricProjectionFormat> for VolumetricProjection {
    fn from(format: VolumetricProjectionFormat) -> VolumetricProjection {
        match format {
            VolumetricProjectionFormat::None => VolumetricProjection::None,
            VolumetricProjectionFormat::Patches => VolumetricProjection::Patches,
        }
    }
}

impl From<InsideFormat> for InsideRule {
    fn from(format: InsideFormat) -> InsideRule {
        match format {
            InsideFormat::Centre => InsideRule::Centre,
            InsideFormat::VolumeFraction => InsideRule::VolumeFraction,
        }
    }
}
