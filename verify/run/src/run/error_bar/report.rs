//! Error bars in `result.json` and in the summary.

use super::bars::{ErrorBar, Estimated};
use super::coarser::CoarserCloud;
use super::no_error_bar::NoErrorBar;
use mtled_case::reference::Family;
use mtled_case::scene::{Case, ProbeKind};
use mtled_checks::escape::printable;
use mtled_checks::report::four_digits;
use serde_json::{Map, Value, json};

/// `error_bars` of `result.json`: the estimated error of every answer in its unit, or in
/// words why there is none.
pub(crate) fn error_bars_json(bars: &Estimated) -> Value {
    let bars = match bars {
        Ok(bars) => bars,
        Err(reason) => return json!({ "unknown": reason.to_string() }),
    };
    let of = |families: &[Family]| -> Vec<Value> {
        let chosen = bars.bars.iter().filter(|bar| families.contains(&bar.quantity.family));
        chosen.map(bar_json).collect()
    };
    json!({
        "probes": of(&[Family::Displacement]),
        "forces": of(&[Family::Force]),
        "moments": of(&[Family::Moment]),
        "energies": of(&[Family::StrainEnergy, Family::KineticEnergy]),
        "coarser_clouds": bars.clouds.iter().map(cloud_json).collect::<Vec<_>>(),
    })
}

fn bar_json(bar: &ErrorBar) -> Value {
    let name = bar.quantity.name.split_once('/').map_or(bar.quantity.name.as_str(), |(_, n)| n);
    let (label, key) = match bar.quantity.family {
        Family::Displacement | Family::Centre => ("probe", "displacement_m"),
        Family::Force => ("condition", "force_n"),
        Family::Moment => ("condition", "moment_n_m"),
        Family::StrainEnergy | Family::KineticEnergy => ("energy", "energy_j"),
    };
    let mut entry = Map::from_iter([(label.to_string(), json!(name))]);
    match &bar.size {
        Ok(size) => entry.insert(key.to_string(), json!(size)),
        Err(reason) => entry.insert("unknown".to_string(), json!(reason.to_string())),
    };
    Value::Object(entry)
}

fn cloud_json(cloud: &CoarserCloud) -> Value {
    json!({
        "spacing_ratio": cloud.ratio,
        "nodes": cloud.nodes,
        "work_counters": cloud.work,
    })
}

/// ` ± 2.0e-4` behind an answer; nothing where there is no bar.
pub(crate) fn plus_minus(bars: Option<&Estimated>, name: &str) -> String {
    match bars {
        Some(Ok(bars)) => match bars.of(name) {
            Some(Ok(size)) => format!(" ± {size:.1e}"),
            _ => String::new(),
        },
        _ => String::new(),
    }
}

/// For the first lines of a summary: that no answer at all has an error bar, and why.
pub(crate) fn no_bars_text(bars: &Estimated) -> Option<String> {
    let reason = match bars {
        Err(reason) => reason.to_string(),
        Ok(bars) if bars.bars.iter().all(|bar| bar.size.is_err()) => {
            bars.bars.iter().find_map(|bar| bar.size.as_ref().err())?.to_string()
        }
        Ok(_) => return None,
    };
    Some(format!("  NO ANSWER HAS AN ERROR BAR, its error is not known: {}", printable(&reason)))
}

/// What the summary says beside the answers that it lists: lattices, moments, energies, and
/// what has no error bar.
pub(crate) fn error_bars_text(case: &Case, bars: &Estimated) -> Vec<String> {
    let bars = match bars {
        Ok(bars) => bars,
        // Said at the start.
        Err(_) => return Vec::new(),
    };
    let ratios: Vec<String> = bars.clouds.iter().map(|cloud| four_digits(cloud.ratio)).collect();
    let mut lines = vec![format!(
        "  ± is the estimated error of the discretisation, from clouds {} times as coarse",
        ratios.join(", ")
    )];
    let lattice = |bar: &&ErrorBar| {
        let named = |name: &str| bar.quantity.name.strip_prefix("displacement/") == Some(name);
        let mut probes = case.probes.iter().filter(|probe| named(&probe.name));
        probes.any(|probe| matches!(probe.kind, ProbeKind::Lattice { .. }))
    };
    let unlisted = |bar: &&ErrorBar| match bar.quantity.family {
        Family::Force => false,
        Family::Displacement => lattice(bar),
        _ => true,
    };
    for bar in bars.bars.iter().filter(unlisted) {
        let Ok(size) = bar.size else { continue };
        let (name, unit) = (printable(&bar.quantity.name), bar.quantity.family.unit());
        lines.push(format!("  error of {name}: ± {size:.1e} {unit}"));
    }
    let mut reasons: Vec<(&NoErrorBar, Vec<String>)> = Vec::new();
    for bar in &bars.bars {
        let Err(reason) = &bar.size else { continue };
        let name = printable(&bar.quantity.name);
        match reasons.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, names)) => names.push(name),
            None => reasons.push((reason, vec![name])),
        }
    }
    lines.extend(reasons.iter().map(|(reason, names)| {
        format!("  no error bar of {}: {}", names.join(", "), printable(&reason.to_string()))
    }));
    lines
}
