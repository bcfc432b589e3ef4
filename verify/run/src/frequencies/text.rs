//! Natural frequencies as text and as JSON.

use super::measure::Found;
use comfy_table::{CellAlignment, presets};
use mtled::frequencies::{CONVERGED, MassKind, NaturalMode};
use mtled_checks::escape::printable;
use serde_json::{Value, json};

/// A table of them, and what they are.
pub fn to_text(found: &Found) -> String {
    let Found { case, simulation, modes, .. } = found;
    let components = simulation.model.size();
    let mut text = printable(&format!("{}: {}", case.name, case.title));
    text += &format!(
        "\n  natural frequencies of small vibrations about the undeformed body, undamped, with {} masses\n  {} nodes; \
         {} of {components} components are held; {}\n\n{}\n\n",
        name(found.masses),
        simulation.model.positions.len(),
        found.simulation.model.constraints.count(0.0),
        rigid_motions(modes.rigid_motions),
        table(&modes.modes)
    );
    for note in &found.left_out {
        text += &format!("  {note}\n");
    }
    text += &format!(
        "  residual: some frequency of the nodes and shape functions is within half of it, relatively; up to \
         {CONVERGED:.0e} it is found.\n  The error of the nodal spacing is not in it.\n"
    );
    text += &format!(
        "  {} products with the stiffness, {:.2} s of CPU time\n",
        modes.products, found.cpu_s
    );
    text
}

fn name(masses: MassKind) -> &'static str {
    match masses {
        MassKind::Consistent => "consistent",
        MassKind::Lumped => "lumped",
    }
}

fn rigid_motions(count: usize) -> String {
    match count {
        0 => "no rigid motion is free".into(),
        1 => "1 rigid motion is free, of frequency 0".into(),
        several => format!("{several} rigid motions are free, of frequency 0"),
    }
}

fn table(modes: &[NaturalMode]) -> comfy_table::Table {
    let mut table = comfy_table::Table::new();
    table.load_style(presets::NOTHING);
    table.set_header(["mode", "frequency [Hz]", "period [s]", "residual", ""]);
    for (number, mode) in (1..).zip(modes) {
        let NaturalMode { frequency, residual, converged, .. } = mode;
        table.add_row([
            number.to_string(),
            digits(*frequency),
            digits(1.0 / frequency),
            format!("{residual:.0e}"),
            if *converged { String::new() } else { "not found to its tolerance".into() },
        ]);
    }
    for column in table.column_iter_mut().take(4) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

/// Six significant digits.
fn digits(value: f64) -> String {
    let before = value.abs().log10().floor();
    if (-4.0..6.0).contains(&before) {
        format!("{value:.*}", (5.0 - before) as usize)
    } else {
        format!("{value:.5e}")
    }
}

/// All of it but the motions.
pub fn to_json(found: &Found) -> Value {
    let mode = |(number, mode): (usize, &NaturalMode)| {
        json!({
            "mode": number,
            "frequency_hz": mode.frequency,
            "residual": mode.residual,
            "converged": mode.converged,
        })
    };
    json!({
        "case": found.case.name,
        "problem_hash": found.case.problem_hash,
        "about": "undeformed body",
        "masses": name(found.masses),
        "nodes": found.simulation.model.positions.len(),
        "components": found.simulation.model.size(),
        "held_components": found.simulation.model.constraints.count(0.0),
        "rigid_motions": found.modes.rigid_motions,
        "modes": (1..).zip(&found.modes.modes).map(mode).collect::<Vec<_>>(),
        "converged": found.modes.converged(),
        "left_out": found.left_out,
        "doubts": found.doubts,
        "products": found.modes.products,
        "timings": { "frequencies_cpu_s": found.cpu_s },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequencies_of_any_size_have_six_digits() {
        for (value, text) in [
            (4.88271234, "4.88271"),
            (123456.7, "123457"),
            (0.001234567, "0.00123457"),
            (1.5e9, "1.50000e9"),
            (2.5e-7, "2.50000e-7"),
        ] {
            assert_eq!(digits(value), text);
        }
    }
}
