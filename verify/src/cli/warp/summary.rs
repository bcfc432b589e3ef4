//! What `mtled warp` has done, as text and as JSON.

use crate::cli::common::Common;
use anyhow::Result;
use comfy_table::{Table, presets};
use mtled_checks::escape::printable;
use mtled_checks::report::four_digits;
use mtled_run::warp::{Deformed, DisplacementField, MovedLandmark, TOLERANCE};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Figures of a warp.
pub(crate) struct Summary {
    largest_displacement: f64,
    decay: f64,
    pub deformed: Option<Counts>,
    pub landmarks: Vec<MovedLandmark>,
    pub files: Vec<PathBuf>,
}

/// Counts of a deformed image.
pub(crate) struct Counts {
    voxels: usize,
    unconverged: usize,
    largest_residual: f64,
    most_iterations: usize,
    from_outside: usize,
}

impl From<Deformed> for Counts {
    fn from(deformed: Deformed) -> Counts {
        Counts {
            voxels: deformed.sources.len(),
            unconverged: deformed.unconverged,
            largest_residual: deformed.largest_residual,
            most_iterations: deformed.most_iterations,
            from_outside: deformed.from_outside,
        }
    }
}

impl Summary {
    /// Of a field by which nothing is warped yet.
    pub(crate) fn of(field: &DisplacementField) -> Summary {
        Summary {
            largest_displacement: field.largest_displacement,
            decay: field.decay,
            deformed: None,
            landmarks: Vec::new(),
            files: Vec::new(),
        }
    }

    /// Warns where the warp cannot be trusted.
    pub(crate) fn warn(&self, common: &Common) {
        if let Some(counts) = self.deformed.as_ref().filter(|counts| counts.unconverged > 0) {
            common.warn(format!(
                "for {} of {} voxels no place was found that moved there to within {} mm (up to {} mm remain): \
                 the body has folded there, two sides of a gap have parted or met there, or it has left the place and --decay is too short",
                counts.unconverged,
                counts.voxels,
                four_digits(1e3 * TOLERANCE),
                four_digits(1e3 * counts.largest_residual)
            ));
        }
        let outside = self.landmarks.iter().filter(|landmark| landmark.outside_mm > 0.0).count();
        if outside > 0 {
            let all = self.landmarks.len();
            common.warn(format!("{outside} of {all} landmarks lie outside of the body"));
        }
    }

    pub(crate) fn json(&self) -> Result<String> {
        let image = self.deformed.as_ref().map(|counts| {
            json!({
                "voxels": counts.voxels,
                "unconverged": counts.unconverged,
                "tolerance_mm": 1e3 * TOLERANCE,
                "largest_residual_mm": 1e3 * counts.largest_residual,
                "most_iterations": counts.most_iterations,
                "from_outside_the_image": counts.from_outside,
            })
        });
        let files: Vec<Value> =
            self.files.iter().map(|path| json!(path.display().to_string())).collect();
        let document = json!({
            "largest_displacement_mm": 1e3 * self.largest_displacement,
            "decay_mm": 1e3 * self.decay,
            "image": image,
            "landmarks": self.landmarks,
            "files": files,
        });
        Ok(serde_json::to_string_pretty(&document)? + "\n")
    }

    pub(crate) fn text(&self) -> String {
        let mut text = format!(
            "largest displacement of a node {} mm, zero from {} mm outside of the body\n",
            four_digits(1e3 * self.largest_displacement),
            four_digits(1e3 * self.decay)
        );
        if let Some(counts) = &self.deformed {
            text += &format!(
                "{} voxels, {} without a source, at most {} iterations, {} from outside of the image\n",
                counts.voxels, counts.unconverged, counts.most_iterations, counts.from_outside
            );
        }
        if !self.landmarks.is_empty() {
            text += &format!("{}\n", self.table());
            text += &self.mean_errors();
        }
        for path in &self.files {
            text += &format!("  {}\n", path.display());
        }
        text
    }

    fn table(&self) -> Table {
        let mut table = Table::new();
        table.load_style(presets::NOTHING);
        table.set_header([
            "landmark",
            "x, y, z, mm",
            "moved to, mm",
            "error before, mm",
            "after, mm",
        ]);
        let place = |[x, y, z]: [f64; 3]| format!("{x:.2}, {y:.2}, {z:.2}");
        let error = |error: Option<f64>| error.map_or("–".into(), |error| format!("{error:.3}"));
        for landmark in &self.landmarks {
            table.add_row([
                printable(&landmark.name),
                place(landmark.position_mm),
                place(landmark.moved_mm),
                error(landmark.error_before_mm),
                error(landmark.error_after_mm),
            ]);
        }
        table
    }

    /// Mean target registration errors, empty where no landmark was found again.
    fn mean_errors(&self) -> String {
        let found: Vec<&MovedLandmark> =
            self.landmarks.iter().filter(|l| l.found_mm.is_some()).collect();
        if found.is_empty() {
            return String::new();
        }
        let mean = |error: fn(&MovedLandmark) -> Option<f64>| {
            found.iter().filter_map(|landmark| error(landmark)).sum::<f64>() / found.len() as f64
        };
        format!(
            "mean target registration error of {} landmarks: {:.3} mm before, {:.3} mm after\n",
            found.len(),
            mean(|landmark| landmark.error_before_mm),
            mean(|landmark| landmark.error_after_mm)
        )
    }
}
