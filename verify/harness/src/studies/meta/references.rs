//! The finite-element references themselves: do the two codes agree?

use crate::studies::workbench::Workbench;
use anyhow::{Result, bail};
use mtled_case::bundled::CASES;
use mtled_case::reference::richardson::{SAFETY, estimate};
use mtled_case::reference::{Agreement, ReferenceFile, agreements};
use mtled_checks::measure::grid_convergence_index;
use mtled_checks::study::{Bound, Cell, Check, Kind, Study, Table, number, text};

pub(crate) fn references(bench: &Workbench, study: &mut Study) -> Result<()> {
    self_test(study);
    let (mut values, mut meshes, mut unusable) = (Vec::new(), Vec::new(), Vec::new());
    for (name, _) in CASES {
        let case = bench.case(name)?;
        let file = match bench.reference(&case) {
            Ok(file) => file,
            Err(reason) => {
                unusable.push(reason.to_string());
                continue;
            }
        };
        let agreements = agreements(&case, &file);
        check_agreement(study, name, &agreements);
        values.extend(agreements.iter().map(|agreement| value_row(name, agreement)));
        meshes.extend(mesh_rows(name, &file));
    }
    study.tables.push(values_table(values));
    study.tables.push(meshes_table(meshes));
    study.notes.push(
        "Values are lengths of vectors and root mean squares over points and instants; the \
         error bars are grid convergence indices from three meshes. An order *in the norm* \
         bounds the error with a safety factor of three but allows no extrapolation. One in brackets \
         was observed and rejected: the bar is then three times a change between \
         meshes over the refinement less one. The codes use different meshes or elements; a \
         comparison uses the code with the shorter bar, and a bar at least as long as the \
         difference of the codes. CPU seconds and memory were measured where the \
         references were made."
            .into(),
    );
    if !unusable.is_empty() {
        bail!("{}", unusable.join("; "));
    }
    Ok(())
}

/// NASA NPARC, Examining Spatial Grid Convergence: three values, ratio 2.
fn self_test(study: &mut Study) {
    let f = [0.97050, 0.96854, 0.96178];
    let estimate = estimate([&f[..1], &f[1..2], &f[2..]], [1.0, 2.0, 4.0], 2.0, 1.0);
    let order = estimate.observed().unwrap_or(f64::NAN);
    let coarse = grid_convergence_index(f[1], f[2], 2.0, order, 100.0 * SAFETY);
    for (id, quantity, value, published, digit) in [
        ("order", "observed order of the NPARC example", order, 1.78617, 1e-5),
        ("value", "extrapolated value of the NPARC example", estimate.values[0], 0.971300, 1e-6),
        ("gci_coarse", "GCI of the coarser pair, per cent", coarse, 0.356249, 1e-6),
    ] {
        study.checks.push(Check::new(
            &format!("references/self_test/{id}"),
            quantity,
            Kind::Exact,
            value,
            Bound::Between(published - 0.5 * digit, published + 0.5 * digit),
            "1",
            "NASA NPARC, Examining Spatial Grid Convergence: all printed digits",
        ));
    }
}

fn check_agreement(study: &mut Study, name: &str, agreements: &[Agreement]) {
    let worst = agreements.iter().max_by(|a, b| a.ratio().total_cmp(&b.ratio()));
    let Some(worst) = worst else { return };
    study.checks.push(Check::new(
        &format!("references/{name}/codes_agree"),
        &format!(
            "{name}: difference of the codes over the sum of their error bars, worst in {}",
            worst.quantity.name
        ),
        Kind::Reference,
        worst.ratio(),
        Bound::AtMost(1.0),
        "1",
        "both error bars are valid",
    ));
}

fn value_row(case: &str, agreement: &Agreement) -> Vec<Cell> {
    let mut row = vec![
        Cell::Text(case.into()),
        Cell::Text(agreement.quantity.name.clone()),
        Cell::Text(agreement.quantity.family.unit().into()),
    ];
    for (index, estimate) in agreement.estimates.iter().enumerate() {
        row.push(Cell::Number(agreement.magnitude(index)));
        row.push(Cell::Number(agreement.bars[index]));
        row.push(Cell::Text(estimate.basis.to_string()));
    }
    row.push(Cell::Number(agreement.difference));
    row.push(Cell::Number(agreement.ratio()));
    row.push(Cell::Text(if agreement.agrees() { "yes" } else { "no" }.into()));
    row
}

fn values_table(rows: Vec<Vec<Cell>>) -> Table {
    Table {
        title: "Two finite-element codes".into(),
        columns: vec![
            text("case"),
            text("quantity"),
            text("unit"),
            number("FEniCSx", ""),
            number("±", ""),
            text("order"),
            number("scikit-fem", ""),
            number("±", ""),
            text("order"),
            number("difference", ""),
            number("difference over bars", "1"),
            text("agree"),
        ],
        rows,
    }
}

fn mesh_rows(case: &str, file: &ReferenceFile) -> Vec<Vec<Cell>> {
    let mut rows = Vec::new();
    for solution in &file.solutions {
        for mesh in &solution.meshes {
            rows.push(vec![
                Cell::Text(case.into()),
                Cell::Text(format!("{} {}", solution.code, solution.version)),
                Cell::Text(format!("{}, {}", solution.element, solution.mesh_family)),
                Cell::Number(mesh.size_m),
                Cell::Number(mesh.unknowns as f64),
                Cell::Number(mesh.cpu_s),
                Cell::Number(mesh.peak_memory_bytes as f64 / 1e6),
                Cell::Text(solution.date.clone()),
            ]);
        }
    }
    rows
}

fn meshes_table(rows: Vec<Vec<Cell>>) -> Table {
    Table {
        title: "Meshes of the references and their cost".into(),
        columns: vec![
            text("case"),
            text("code"),
            text("elements"),
            number("size", "m"),
            number("unknowns", ""),
            number("CPU", "s"),
            number("memory", "MB"),
            text("date"),
        ],
        rows,
    }
}
