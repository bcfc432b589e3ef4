//! What springs exert, and the volumes of cavities and regions.

use super::vectors::{array, triple};
use crate::run::record::{Recording, Sample};
use mtled_case::scene::Case;
use mtled_checks::escape::printable;
use serde_json::{Map, Value, json};

pub(crate) fn springs_json(case: &Case, record: &Recording) -> Vec<Value> {
    let Some(last) = record.samples.last() else { return Vec::new() };
    let rows = case.problem.loads.springs.iter().zip(&last.spring_forces);
    rows.map(|(spring, force)| json!({ "spring": spring.name, "force_n": array(force) })).collect()
}

pub(crate) fn cavities_json(case: &Case, record: &Recording) -> Vec<Value> {
    let (Some(first), Some(last)) = (record.samples.first(), record.samples.last()) else {
        return Vec::new();
    };
    let rows = case.problem.loads.cavities.iter().zip(first.cavities.iter().zip(&last.cavities));
    rows.map(|(cavity, (first, last))| {
        json!({
            "cavity": cavity.name,
            "volume_at_start_m3": first.volume,
            "volume_m3": last.volume,
            "pressure_pa": last.pressure,
        })
    })
    .collect()
}

pub(crate) fn region_volumes_json(case: &Case, record: &Recording) -> Value {
    let Some(last) = record.samples.last().filter(|_| case.outputs.volumes) else {
        return json!({});
    };
    let rows = case.problem.regions.iter().zip(&last.region_volumes);
    rows.map(|(region, volume)| (region.name.clone(), json!(volume))).collect::<Map<_, _>>().into()
}

/// A line for each spring and each cavity.
pub(crate) fn loads_text(case: &Case, last: &Sample) -> Vec<String> {
    let mut lines = Vec::new();
    lines.extend(case.problem.loads.springs.iter().zip(&last.spring_forces).map(
        |(spring, force)| {
            format!("  force of springs \"{}\": ({}) N", printable(&spring.name), triple(force))
        },
    ));
    lines.extend(case.problem.loads.cavities.iter().zip(&last.cavities).map(|(cavity, now)| {
        let name = printable(&cavity.name);
        let pressure = match &cavity.fluid {
            Some(_) => format!(", pressure {:.4e} Pa", now.pressure),
            None => String::new(),
        };
        format!("  volume of cavity \"{name}\": {:.5e} m³{pressure}", now.volume)
    }));
    lines
}
