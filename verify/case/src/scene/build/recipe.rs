//! The discretisation table of a case file → the solver's recipe.

use crate::scene::build::builder::Builder;
use crate::scene::build::geometry::comes_from_a_file;
use crate::scene::format::{
    BasisFormat, CloudFormat, DiscretisationFormat, GradientsFormat, GridFormat,
};
use mtled::algebra::tensor::{Vector3, bounding_box};
use mtled::discretisation::nodes::{refuse_far_nodes, refuse_fine_spacing};
use mtled::geometry::GeometryError;
use mtled::problem::{
    BackgroundGrid, Basis, Cloud, Dimension, Gradients, Mistake, Recipe, Refinement, defaults,
};
use mtled_io::files;

/// Tolerance of selectors that state none where the nodes come from a file \[m\]; else it is
/// [`defaults::SELECTION_TOLERANCE`].
const TOLERANCE_OF_GIVEN_NODES: f64 = 1e-6;

/// Nodes lie in a plane whose thickness is at most this fraction of its extent \[–\].
const FLAT: f64 = 1e-6;

/// Tolerance \[m\] of selectors that state none.
pub(crate) fn tolerance(format: &DiscretisationFormat) -> f64 {
    match format.spacing {
        Some(spacing) if spacing > 0.0 => defaults::SELECTION_TOLERANCE * spacing,
        _ => TOLERANCE_OF_GIVEN_NODES,
    }
}

impl Builder<'_> {
    /// The recipe, or `None` and a mistake.
    pub(crate) fn recipe(&mut self, format: &DiscretisationFormat) -> Option<Recipe> {
        let basis = self.basis(format);
        let dilation = format.dilation.unwrap_or(defaults::dilation(basis));
        self.keys_of_cloud(format);
        if let Some(spacing) = format.spacing {
            self.spacing_fits(spacing);
        }
        let (cloud, grid) = (self.cloud(format), self.grid(&format.grid, format));
        let mut recipe = Recipe {
            cloud: cloud?,
            grid: grid?,
            basis,
            dilation,
            mass: defaults::mass(basis),
            gradients: self.gradients(format),
            ..Recipe::with_spacing(1.0)
        };
        format.choose(&mut recipe);
        let stated = |mistake: &Mistake| key_of(&mistake.field).is_some();
        let mistakes = recipe.check().into_iter().filter(stated).collect();
        self.refused(mistakes, |field| {
            format!("discretisation.{}", key_of(field).unwrap_or(field))
        });
        Some(recipe)
    }

    fn basis(&mut self, format: &DiscretisationFormat) -> Basis {
        let key = "discretisation.regularisation";
        let regularisation = format.regularisation.unwrap_or(defaults::REGULARISATION);
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
        match format.gradients {
            None => defaults::GRADIENTS.with_tolerance(tolerance),
            Some(GradientsFormat::Consistent) => Gradients::Consistent { tolerance },
            Some(GradientsFormat::SecondOrder) => Gradients::SecondOrder { tolerance },
            Some(GradientsFormat::Plain) => {
                if format.gradient_tolerance.is_some() {
                    self.mistake(key, "belongs to gradients = \"consistent\" or \"second_order\"");
                }
                Gradients::Plain
            }
        }
    }

    /// Refuses a spacing that the body cannot hold, or that gives it too many nodes.
    fn spacing_fits(&mut self, spacing: f64) {
        let Some(section) = self.section.clone() else { return };
        let Some((min, max)) = section.bounding_box() else { return };
        let edges = max - min;
        let smallest = edges.iter().copied().fold(f64::INFINITY, f64::min);
        let unit = if comes_from_a_file(&section) {
            "; is the `unit` of its file (\"m\" or \"mm\") right?"
        } else {
            ""
        };
        if spacing > smallest {
            let message = format!(
                "is {spacing} m; it must not be larger than the body, which is {smallest} m thick{unit}"
            );
            self.mistake("discretisation.spacing", message);
        } else if spacing > 0.0
            && let Err(error) = refuse_fine_spacing(&section, spacing, &self.dimension)
        {
            let largest = edges.iter().copied().filter(|edge| edge.is_finite()).fold(0.0, f64::max);
            let message =
                format!("is {spacing:?} m in a body that is {largest:?} m large: {error}{unit}");
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
                let seed = format.seed.unwrap_or(defaults::SEED);
                Some(Cloud::Jittered { spacing: format.spacing?, jitter, seed })
            }
            CloudFormat::Graded => self.graded(format),
            CloudFormat::File => self.given(format),
        }
    }

    fn graded(&mut self, format: &DiscretisationFormat) -> Option<Cloud> {
        let growth = format.growth.unwrap_or(defaults::GROWTH);
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
                self.nodes_fit(key, &nodes);
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

    /// Refuses nodes far outside the body, in one plane of a body in space, or in several
    /// planes of a cross-section.
    fn nodes_fit(&mut self, key: &str, nodes: &[Vector3]) {
        let (lower, upper) = bounding_box(nodes);
        let edges = upper - lower;
        let flat = edges.z <= FLAT * edges.x.max(edges.y);
        let far = (self.section.as_ref())
            .and_then(|body| refuse_far_nodes(body, nodes, &self.dimension).err());
        match far {
            Some(error @ GeometryError::NodeFarOutside { node, .. }) => {
                self.mistake(key, format!("point {}: {error}", node + 1));
            }
            _ if flat && !self.is_plane() => {
                let message = "m; in 3d they need x, y and z";
                self.mistake(key, format!("has all nodes at z = {} {message}", lower.z));
            }
            _ if !flat && self.is_plane() => {
                let message = "m; in plane strain they lie in one plane";
                self.mistake(
                    key,
                    format!("has nodes from z = {} m to {} {message}", lower.z, upper.z),
                );
            }
            _ => {}
        }
    }

    fn grid(
        &mut self,
        format: &GridFormat,
        recipe: &DiscretisationFormat,
    ) -> Option<BackgroundGrid> {
        let key = "discretisation.grid";
        let gauss_points = format.gauss_points.unwrap_or(defaults::GAUSS_POINTS);
        let mut refinements = Vec::new();
        for (n, row) in format.refine.iter().enumerate() {
            let key = format!("{key}.refine[{n}]");
            self.positive(&format!("{key}.cell"), row.cell);
            let part = self.selector(&format!("{key}.where"), &row.part);
            refinements.extend(part.map(|part| Refinement { part, size: row.cell }));
        }
        Some(BackgroundGrid {
            cell: self.cell(key, format, recipe)?,
            cells_per_spacing: follows(format, recipe)
                .then(|| format.cells_per_spacing.unwrap_or(defaults::CELLS_PER_SPACING)),
            boundary_cell: format.boundary_cell,
            refinements,
            gauss_points,
            inside: format.inside.map_or(defaults::INSIDE, Into::into),
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
            (None, ratio, None) if follows(format, recipe) => {
                self.positive(&format!("{key}.cells_per_spacing"), ratio.unwrap_or(1.0));
                Some(f64::INFINITY)
            }
            (None, _, None) => {
                let message = "is missing; without a nodal spacing cells that are refined by hand \
                               need a length";
                self.mistake(&format!("{key}.cell"), message);
                None
            }
        }
    }
}

/// The key of a field of the recipe; `None` for those that are computed from keys, which are
/// judged before.
fn key_of(field: &str) -> Option<&str> {
    match field {
        "dilation" => Some(field),
        "basis.regularisation" => Some("regularisation"),
        "cloud.jitter" => Some("jitter"),
        "cloud.growth" => Some("growth"),
        "gradients.tolerance" => Some("gradient_tolerance"),
        "grid.boundary_cell" | "grid.gauss_points" => Some(field),
        _ => None,
    }
}

/// Whether the grid follows a nodal spacing that varies: always, unless it is made by hand.
fn follows(format: &GridFormat, recipe: &DiscretisationFormat) -> bool {
    matches!(recipe.cloud, CloudFormat::Graded | CloudFormat::File)
        && format.cell.is_none()
        && format.refine.is_empty()
}
