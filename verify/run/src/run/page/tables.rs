//! Tables of the page of a run, from its `result.json`.

use crate::picture::region_colour;
use minijinja::{Value, context};
use mtled_case::scene::Case;
use mtled_checks::report::four_digits;
use serde_json::Value as Json;

/// More probes than this are only in `result.json`.
const MOST_ROWS: usize = 40;

/// `(1.000, 2.000, 3.000)`.
pub(crate) fn vector(v: &[f64; 3]) -> String {
    format!("({})", v.map(four_digits).join(", "))
}

fn components(json: &Json) -> [f64; 3] {
    std::array::from_fn(|k| json[k].as_f64().unwrap_or(f64::NAN))
}

fn size(json: &Json) -> f64 {
    components(json).iter().map(|c| c * c).sum::<f64>().sqrt()
}

fn rows(json: &Json) -> impl Iterator<Item = &Json> {
    json.as_array().into_iter().flatten()
}

/// The error bar of an answer: its size, or why there is none.
fn bar(result: &Json, family: &str, label: &str, name: &str, key: &str) -> String {
    let mut bars = rows(&result["error_bars"][family]);
    let own = bars.find(|bar| bar[label].as_str() == Some(name));
    match own {
        Some(bar) => match (bar[key].as_f64(), bar["unknown"].as_str()) {
            (Some(size), _) => format!("± {size:.1e}"),
            (_, Some(reason)) => reason.to_string(),
            _ => String::new(),
        },
        None => String::new(),
    }
}

/// Probes with their displacements and error bars.
pub(crate) fn answers(case: &Case, result: &Json) -> Value {
    let probe = |probe: &Json| {
        let name = probe["name"].as_str().unwrap_or_default();
        let positions = rows(&probe["reference_m"]).count();
        let one = positions == 1;
        let displacements: Vec<f64> = rows(&probe["displacement_m"]).map(size).collect();
        let mean = displacements.iter().map(|u| u * u).sum::<f64>() / positions.max(1) as f64;
        let place = match (probe["kind"].as_str(), one) {
            (Some("centre_of_mass"), _) => {
                format!("centre of mass, {}", vector(&components(&probe["reference_m"][0])))
            }
            (_, true) => vector(&components(&probe["reference_m"][0])),
            _ => format!("{positions} points"),
        };
        context! {
            name,
            place,
            displacement => if one { vector(&components(&probe["displacement_m"][0])) } else { "root mean square:".into() },
            size => four_digits(mean.sqrt()),
            bar => bar(result, "probes", "probe", name, "displacement_m"),
        }
    };
    let all = case.probes.len();
    let shown: Vec<Value> = rows(&result["probes"]).take(MOST_ROWS).map(probe).collect();
    context! { more => all.saturating_sub(shown.len()), rows => shown }
}

/// Forces and moments of conditions.
pub(crate) fn reactions(result: &Json) -> Vec<Value> {
    let reaction = |reaction: &Json| {
        let name = reaction["condition"].as_str().unwrap_or_default();
        context! {
            name,
            force => vector(&components(&reaction["force_n"])),
            bar => bar(result, "forces", "condition", name, "force_n"),
            moment => vector(&components(&reaction["moment_n_m"])),
        }
    };
    rows(&result["reactions"]).map(reaction).collect()
}

/// What was asked, what was done; what differs by more than it may comes first.
pub(crate) fn audit(result: &Json) -> Vec<Value> {
    let figure = |json: &Json| {
        if json.is_array() {
            vector(&components(json))
        } else {
            json.as_f64().map_or("–".into(), four_digits)
        }
    };
    let row = |row: &Json| {
        context! {
            label => row["label"].as_str(),
            of => row["of"].as_str(),
            unit => row["unit"].as_str(),
            asked => figure(&row["asked"]),
            done => figure(&row["done"]),
            difference => figure(&row["difference"]),
            limit => figure(&row["limit"]),
            advice => row["advice"].as_str(),
        }
    };
    let all = || rows(&result["audit"]["rows"]);
    let (doubtful, good) = (all().filter(|row| row["doubtful"] == true), all());
    doubtful.chain(good.filter(|row| row["doubtful"] != true)).map(row).collect()
}

/// What obstacles do.
pub(crate) fn contacts(result: &Json) -> Vec<Value> {
    let number = |json: &Json| json.as_f64().map_or("–".into(), four_digits);
    let contact = |contact: &Json| {
        context! {
            name => contact["obstacle"].as_str(),
            nodes => contact["nodes"].to_string(),
            force => vector(&components(&contact["force_n"])),
            area => number(&contact["area_m2"]),
            pressure => number(&contact["largest_pressure_pa"]),
            depth => number(&contact["deepest_penetration_m"]),
        }
    };
    rows(&result["contacts"]).map(contact).collect()
}

/// Regions and their materials.
pub(crate) fn materials(case: &Case) -> Vec<Value> {
    let regions = &case.problem.regions;
    let numbered = regions.iter().enumerate();
    numbered
        .map(|(number, region)| {
            let constants = region.material.law.constants();
            context! {
                name => region.name.as_str(),
                colour => region_colour(number, regions.len()),
                // Of a law with fibres a bound of all directions.
                shear => if region.material.law.has_fibres() {
                    format!("≤ {}", four_digits(constants.shear_modulus))
                } else {
                    four_digits(constants.shear_modulus)
                },
                bulk => four_digits(constants.bulk_modulus),
                density => four_digits(region.material.density),
            }
        })
        .collect()
}

/// Time, memory and work.
pub(crate) fn costs(result: &Json) -> Vec<Value> {
    let (timings, work) = (&result["timings"], &result["work_counters"]);
    let seconds = |json: &Json| json.as_f64().map(|s| format!("{s:.2} s"));
    let megabytes = |json: &Json| json.as_f64().map(|bytes| format!("{:.0} MB", bytes / 1e6));
    let count = |json: &Json| json.as_f64().map(four_digits);
    let discretisation = &result["discretisation"];
    let rows = [
        ("Set-up", seconds(&timings["setup_wall_s"])),
        ("Solution", seconds(&timings["solve_wall_s"])),
        ("Solution, processor time", seconds(&timings["solve_cpu_s"])),
        ("Error bars, processor time", seconds(&timings["error_bars_cpu_s"])),
        ("Memory at the peak", megabytes(&timings["peak_memory_bytes"])),
        ("Nodes", count(&discretisation["nodes"])),
        ("Quadrature points", count(&discretisation["quadrature_points"])),
        ("Nodes per support", count(&discretisation["mean_support"])),
        ("Evaluations of the internal force", count(&work["force_evaluations"])),
        ("Steps or corrections", count(&result["motion"]["steps"])),
    ];
    let known = rows.into_iter().filter_map(|(name, value)| Some((name, value?)));
    known.map(|(name, value)| context! { name, value }).collect()
}
