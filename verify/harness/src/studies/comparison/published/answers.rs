//! Answers of a run under the names that published numbers have.

use super::numbers::{Number, When};
use super::runs::Found;
use anyhow::{Context, Result, bail};
use mtled::Vector3;
use mtled_case::scene::Case;
use mtled_run::run::{Recording, Sample};

/// The answer of a run to a published number \[its unit\].
pub(crate) fn answer(case: &Case, found: &Found, number: &Number) -> Result<f64> {
    match (found, number.modes()) {
        (Found::History(record), None) => of_history(case, record, number),
        (Found::Frequencies(all), Some((first, last))) => {
            let own = first.checked_sub(1).and_then(|before| all.get(before..last));
            let own = own.filter(|own| !own.is_empty());
            let own = own.with_context(|| format!("{} is not among the modes", number.answer))?;
            Ok(own.iter().sum::<f64>() / own.len() as f64)
        }
        _ => bail!("{} is no answer of such a run", number.answer),
    }
}

/// The answer of the samples that count.
fn of_history(case: &Case, record: &Recording, number: &Number) -> Result<f64> {
    let [from, to] = number.between;
    let inside = |sample: &&Sample| (from..=to).contains(&sample.time);
    let history = record
        .samples
        .iter()
        .filter(inside)
        .map(|sample| Ok((sample.time, at(case, record, sample, &number.answer)?)))
        .collect::<Result<Vec<(f64, f64)>>>()?;
    let (first, last) = history.first().zip(history.last()).context("no sample counts")?;
    let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
    let (Some(high), Some(low)) =
        (history.iter().max_by(by_value), history.iter().min_by(by_value))
    else {
        bail!("no sample counts")
    };
    Ok(match number.when {
        When::Start => first.1,
        When::End => last.1,
        When::Maximum => high.1,
        When::Minimum => low.1,
        When::TimeOfMaximum => high.0,
        When::TimeOfMinimum => low.0,
        When::Mean => 0.5 * (high.1 + low.1),
        When::Amplitude => 0.5 * (high.1 - low.1),
        When::Drift => (high.1 - first.1).max(first.1 - low.1),
        When::Duration => {
            let mut acting = history.iter().filter(|(_, value)| *value != 0.0);
            let start = acting.next().context("it is always zero")?;
            acting.next_back().unwrap_or(start).0 - start.0
        }
    })
}

/// An answer at one instant.
fn at(case: &Case, record: &Recording, sample: &Sample, name: &str) -> Result<f64> {
    let parts: Vec<&str> = name.split('/').collect();
    match parts[..] {
        ["displacement", probe, part] => {
            component(&sample.displacements[probe_of(case, probe)?][0], part)
        }
        ["position", probe, part] => {
            let probe = probe_of(case, probe)?;
            component(&(record.references[probe][0] + sample.displacements[probe][0]), part)
        }
        ["force", condition, part] => {
            let found = case.problem.conditions.iter().position(|other| other.name == condition);
            let condition = found.with_context(|| format!("no condition {condition}"))?;
            component(&sample.reactions[condition].force, part)
        }
        ["contact", obstacle, part] => {
            let found = case.problem.obstacles.iter().position(|other| other.name == obstacle);
            let obstacle = found.with_context(|| format!("no obstacle {obstacle}"))?;
            component(&sample.contact_forces[obstacle], part)
        }
        ["momentum", part] => component(&sample.momenta.linear, part),
        ["angular_momentum", part] => component(&sample.momenta.angular, part),
        ["energy", "strain"] => Ok(sample.energies.strain),
        ["energy", "kinetic"] => Ok(sample.energies.kinetic),
        ["energy", "sum"] => Ok(sample.energies.strain + sample.energies.kinetic),
        _ => bail!("{name} is no answer"),
    }
}

fn probe_of(case: &Case, name: &str) -> Result<usize> {
    let found = case.probes.iter().position(|probe| probe.name == name);
    found.with_context(|| format!("no probe {name}"))
}

fn component(vector: &Vector3, part: &str) -> Result<f64> {
    Ok(match part {
        "x" => vector.x,
        "y" => vector.y,
        "z" => vector.z,
        "size" => vector.norm(),
        _ => bail!("{part} is no component"),
    })
}
