//! References as tables and as JSON.

use super::stored::{Referenced, StoredReference};
use comfy_table::{ContentArrangement, LineStyle, Table, presets};
use mtled_case::reference::{Agreement, Basis};
use mtled_checks::escape::printable;
use mtled_checks::report::four_digits;
use serde_json::{Value, json};

fn table(header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> Table {
    let mut table = Table::new();
    table.load_style(presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()));
    table.set_content_arrangement(ContentArrangement::Dynamic);
    table.set_header(header);
    table.add_rows(rows);
    table
}

/// A row per case.
pub(crate) fn check_table(stored: &[StoredReference]) -> Table {
    let header = [
        "case",
        "quantities",
        "largest difference / error bars",
        "in",
        "without an order",
        "CPU s",
        "memory MB",
        "verdict",
    ];
    table(&header, stored.iter().map(check_row))
}

fn check_row(stored: &StoredReference) -> Vec<String> {
    let Ok(reference) = &stored.reference else {
        let mut row = vec![stored.case.clone()];
        row.extend(std::iter::repeat_n(String::new(), 6));
        row.push("refused".into());
        return row;
    };
    let agreements = &reference.agreements;
    let worst = agreements.iter().max_by(|a, b| a.ratio().total_cmp(&b.ratio()));
    let estimates = || agreements.iter().flat_map(|a| &a.estimates);
    let lacking = estimates().filter(|e| matches!(e.basis, Basis::NoOrder(_))).count();
    let meshes = || reference.file.solutions.iter().flat_map(|solution| &solution.meshes);
    let memory = meshes().map(|mesh| mesh.peak_memory_bytes).max().unwrap_or(0);
    vec![
        stored.case.clone(),
        agreements.len().to_string(),
        worst.map_or(String::new(), |a| four_digits(a.ratio())),
        worst.map_or(String::new(), |a| a.quantity.name.clone()),
        format!("{lacking} of {}", estimates().count()),
        four_digits(meshes().map(|mesh| mesh.cpu_s).sum()),
        format!("{:.0}", memory as f64 / 1e6),
        if stored.mistake().is_none() { "agree" } else { "DIFFER" }.into(),
    ]
}

/// Everything about one case.
pub(crate) fn show_text(reference: &Referenced) -> String {
    let title = format!("{}: {}", reference.case.name, reference.case.title);
    let mut text = printable(&title) + "\n";
    for solution in &reference.file.solutions {
        let packages: Vec<String> =
            solution.packages.iter().map(|(name, version)| format!("{name} {version}")).collect();
        text += &format!(
            "  {} {}, {}: {}; {}; {}; {}{}; {}\n",
            solution.code,
            solution.version,
            solution.date,
            solution.formulation,
            solution.element,
            solution.mesh_family,
            solution.solver,
            solution.time_scheme.as_ref().map_or(String::new(), |scheme| format!("; {scheme}")),
            packages.join(", ")
        );
    }
    let codes: Vec<&str> = reference.file.solutions.iter().map(|s| s.code.as_str()).collect();
    let header = ["quantity", "unit", codes[0], "order", codes[1], "order", "difference", "ratio"];
    text += "\nLengths of vectors, root mean squares over points and instants, ± error bars\n";
    text += &format!("{}\n\n", table(&header, reference.agreements.iter().map(quantity_row)));
    text += &format!("{}\n", meshes_table(reference));
    text
}

fn quantity_row(agreement: &Agreement) -> Vec<String> {
    let mut row = vec![agreement.quantity.name.clone(), agreement.quantity.family.unit().into()];
    for (index, estimate) in agreement.estimates.iter().enumerate() {
        let bar = four_digits(agreement.bars[index]);
        row.push(format!("{} ± {bar}", four_digits(agreement.magnitude(index))));
        row.push(estimate.basis.to_string());
    }
    row.push(four_digits(agreement.difference));
    row.push(format!("{:.3}", agreement.ratio()));
    row
}

fn meshes_table(reference: &Referenced) -> Table {
    let header = ["code", "size m", "elements", "unknowns", "step s", "CPU s", "memory MB"];
    let rows = reference.file.solutions.iter().flat_map(|solution| {
        solution.meshes.iter().map(|mesh| {
            vec![
                solution.code.clone(),
                four_digits(mesh.size_m),
                mesh.elements.to_string(),
                mesh.unknowns.to_string(),
                mesh.time_step_s.map_or("static".into(), four_digits),
                four_digits(mesh.cpu_s),
                format!("{:.0}", mesh.peak_memory_bytes as f64 / 1e6),
            ]
        })
    });
    table(&header, rows)
}

/// All cases as JSON.
pub(crate) fn to_json(stored: &[StoredReference]) -> Value {
    let case = |stored: &StoredReference| {
        let quantities: Vec<Value> = stored.reference.iter().flat_map(quantities_json).collect();
        json!({
            "case": stored.case,
            "sound": stored.mistake().is_none(),
            "complaint": stored.mistake(),
            "quantities": quantities,
        })
    };
    json!({ "schema_version": 1, "cases": stored.iter().map(case).collect::<Vec<_>>() })
}

fn quantities_json(reference: &Referenced) -> Vec<Value> {
    let one = |agreement: &Agreement| {
        let codes = reference.file.solutions.iter().enumerate().map(|(index, solution)| {
            let estimate = &agreement.estimates[index];
            json!({
                "code": solution.code,
                "rms_value": agreement.magnitude(index),
                "rms_error": agreement.bars[index],
                "observed_order": estimate.observed(),
                "order_reached": matches!(estimate.basis, Basis::Order(_)),
            })
        });
        let agreed = agreement.reference();
        json!({
            "quantity": agreement.quantity.name,
            "unit": agreement.quantity.family.unit(),
            "codes": codes.collect::<Vec<_>>(),
            "rms_difference": agreement.difference,
            "difference_over_error_bars": agreement.ratio(),
            "agree": agreement.agrees(),
            "reference": { "values": agreed.values, "errors": agreed.errors, "rms_error": agreed.error },
        })
    };
    reference.agreements.iter().map(one).collect()
}
