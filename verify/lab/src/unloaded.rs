//! The configuration without loads of the body of a case, whose shape is that under its loads.

use anyhow::Result;
use mtled::Simulation;
use mtled::error::Error;
use mtled::motion::observe::{Continue, Observer, View};
use mtled::unloaded::{Distance, Unloaded, Unloading, unload};
use mtled_case::scene::Case;
use mtled_checks::escape::printable;
use mtled_checks::report::write_atomically;
use mtled_run::machine::cpu_seconds;
use mtled_run::run::{interrupted, write_unloaded};
use serde_json::{Value, json};
use std::path::Path;

/// A body without its loads.
#[derive(Debug)]
pub struct FoundUnloaded {
    case: Case,
    /// The known shape, with the model of the body without loads.
    simulation: Simulation,
    offsets: Vec<f64>,
    distances: Vec<Distance>,
    /// How small the last distance is to be, over the displacement \[–\].
    tolerance: f64,
    /// Whether it is.
    pub found: bool,
    /// Whether the user ended the search.
    pub stopped: bool,
    /// Smallest J of a point under the loads \[–\].
    smallest_jacobian: f64,
    /// Volumes of the known shape and without loads \[m³\].
    volumes: (f64, f64),
    /// \[s\]
    cpu_s: f64,
}

struct Notified<'a>(&'a dyn Fn(f64, usize));

impl Observer for Notified<'_> {
    fn observe(&mut self, _: &mut View) -> Continue {
        Continue::Yes
    }

    fn iterate(&mut self, progress: f64, count: usize) -> Continue {
        (self.0)(progress, count);
        if interrupted() { Continue::Stop } else { Continue::Yes }
    }
}

/// Finds it. `notify` takes the fraction of the loads and the number of solutions so far.
pub fn find_unloaded(
    case: &Case,
    settings: Unloading,
    notify: &dyn Fn(f64, usize),
) -> Result<FoundUnloaded, Error> {
    let cpu = cpu_seconds();
    let found = unload(&case.problem, settings, &mut Notified(notify))?;
    let Unloaded { offsets, image, model, summary, distances, found, stopped, .. } = found;
    let without = model.points.blocks.iter().flat_map(|block| &block.quadrature_weights).sum();
    let volumes = (image.volume(), without);
    Ok(FoundUnloaded {
        case: case.clone(),
        simulation: Simulation::of_parts(&case.problem, image, model),
        offsets,
        distances,
        tolerance: settings.tolerance,
        found,
        stopped,
        smallest_jacobian: summary.smallest_jacobian.jacobian,
        volumes,
        cpu_s: cpu_seconds() - cpu,
    })
}

/// What it is and how well it was found, for people.
pub fn unloaded_text(found: &FoundUnloaded) -> String {
    let FoundUnloaded { case, simulation, distances, volumes, .. } = found;
    let mut text = printable(&format!("{}: {}", case.name, case.title));
    text += &format!("\n  {} nodes; the shape of the case is that under its loads\n", {
        simulation.model.positions.len()
    });
    if let Some(Distance { largest, mean, displacement }) = distances.last() {
        text += &format!(
            "  {}: the body without loads, loaded again, is {largest:.3e} m from the known shape at most, {mean:.3e} m in \
             the root mean square; its largest displacement is {displacement:.4e} m\n",
            if found.found { "found" } else { "not found" },
        );
    }
    text += &format!(
        "  volume without loads {:.5e} m³, of the known shape {:.5e} m³; smallest J {:.4} at points\n  {} solutions under \
         loads, {:.2} s of CPU time\n",
        volumes.1,
        volumes.0,
        found.smallest_jacobian,
        distances.len(),
        found.cpu_s
    );
    text
}

/// The same for programs.
pub fn unloaded_json(found: &FoundUnloaded) -> Value {
    let row = |distance: &Distance| {
        json!({
            "largest_m": distance.largest,
            "root_mean_square_m": distance.mean,
            "largest_displacement_m": distance.displacement,
        })
    };
    json!({
        "case": found.case.name,
        "found": found.found,
        "tolerance": found.tolerance,
        "nodes": found.simulation.model.positions.len(),
        "distances": found.distances.iter().map(row).collect::<Vec<_>>(),
        "volume_m3": found.volumes.0,
        "unloaded_volume_m3": found.volumes.1,
        "smallest_jacobian": found.smallest_jacobian,
        "cpu_s": found.cpu_s,
    })
}

/// Writes `unloaded.json`, VTU files and the surface to a folder.
pub fn write_unloaded_of(found: &FoundUnloaded, folder: &Path) -> Result<()> {
    write_unloaded(&found.simulation, &found.offsets, folder)?;
    let text = format!("{}\n", unloaded_json(found));
    write_atomically(&folder.join("unloaded.json"), text.as_bytes())
}
