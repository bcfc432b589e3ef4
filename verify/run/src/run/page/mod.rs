//! A page for each run: verdict, pictures, histories, answers, cost. It works offline and has no
//! parts outside of itself.
#![allow(non_snake_case)]

mod plots;
mod tables;

use super::record::Recording;
use crate::picture::{Body, Choice, Shown, bar_svg, panel_svg, panels};
use anyhow::Result;
use minijinja::{Environment, Value, context};
use mtled::problem::Dimension;
use mtled_case::scene::Case;
use mtled_checks::escape::printable_lines;
use mtled_checks::report::{four_digits, html, svg};
use serde_json::Value as Json;
use tables::{answers, audit, contacts, costs, materials, reactions, vector};

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");

/// The page of a run with this `result.json`, and with the body at its end if there is one.
pub(crate) fn run_page(
    case: &Case,
    record: &Recording,
    body: Option<&Body>,
    result: &Json,
) -> Result<String> {
    let mut pages = Environment::new();
    pages.add_template("page.html", TEMPLATE)?;
    let pictures = body.map(pictures).transpose()?;
    let plots = plots::histories(case, record);
    let page = context! {
        style => Value::from_safe_string(format!("{}{}{STYLE}", html::STYLE, svg::STYLE)),
        name => case.name.as_str(),
        title => case.title.as_str(),
        overrides => case.overrides().iter().map(ToString::to_string).collect::<Vec<_>>(),
        what => what(case, result),
        verdict => verdict(result),
        largest => body.map(largest).unwrap_or_default(),
        pictures,
        plots => plots.iter().map(|plot| Value::from_safe_string(svg::to_svg(plot))).collect::<Vec<_>>(),
        plot_titles => plots.iter().map(|plot| plot.title().to_string()).collect::<Vec<_>>(),
        answers => answers(case, result),
        bars => !result["error_bars"]["probes"].is_null(),
        no_bars => result["error_bars"]["unknown"].as_str(),
        reactions => reactions(result),
        contacts => contacts(result),
        materials => materials(case),
        costs => costs(result),
        audit => audit(result),
        warnings => texts(&result["warnings"]),
        version => result["version"].as_str(),
        plane => matches!(case.problem.dimension, Dimension::PlaneStrain { .. }),
    };
    Ok(printable_lines(&pages.get_template("page.html")?.render(page)?))
}

fn texts(array: &Json) -> Vec<String> {
    let texts = array.as_array().into_iter().flatten();
    texts.filter_map(|text| text.as_str().map(String::from)).collect()
}

/// What was solved, in a line.
fn what(case: &Case, result: &Json) -> String {
    let space = match case.problem.dimension {
        Dimension::Three => "a body in space",
        Dimension::PlaneStrain { .. } => "a cross-section in plane strain",
    };
    let motion = &result["motion"];
    let method = match motion["method"].as_str() {
        Some("dynamic") => "its motion in time, step by step".to_string(),
        _ if !motion["newton"].is_null() => "at rest, by Newton's method".to_string(),
        _ if !motion["relaxation"].is_null() => "at rest, by dynamic relaxation".to_string(),
        _ => "at rest".to_string(),
    };
    let d = &result["discretisation"];
    format!("{space}, {method}; {} nodes, {} quadrature points", d["nodes"], d["quadrature_points"])
}

/// How the run ended, in words that promise no more.
fn verdict(result: &Json) -> Value {
    let motion = &result["motion"];
    let warned = result["warnings"].as_array().is_some_and(|warnings| !warnings.is_empty());
    let outcome = motion["outcome"].as_str().unwrap_or_default();
    let (mut class, mut text) = match outcome {
        "completed" => ("pass", "The motion reached its end"),
        "converged" if motion["newton"]["up_to_round_off"] == true => {
            ("pass", "Converged up to round-off")
        }
        "converged" => ("pass", "Converged to its tolerance"),
        "stopped" => ("fail", "Stopped by the user before its end"),
        "not_converged" => ("fail", "Did not converge"),
        "diverged" => ("fail", "Diverged"),
        _ => ("fail", "Failed"),
    };
    if class == "pass" && result["audit"]["doubtful"] == true {
        (class, text) = ("doubt", "Doubtful: what was done is not what was asked");
    } else if class == "pass" && !motion["instability"].is_null() {
        let passed = motion["instability"]["passed"] == true;
        let unstable = "Came to an end, but the body is unstable";
        (class, text) =
            ("doubt", if passed { "Came to an end, and has buckled" } else { unstable });
    } else if class == "pass" && warned {
        class = "doubt";
    }
    let mut details = Vec::new();
    details.extend(motion["error"].as_str().map(String::from));
    let number = |value: &Json| value.as_f64().map(four_digits);
    if let Some(residual) = number(&motion["newton"]["relative_residual"]) {
        details.push(format!("residual {residual} of the largest nodal force"));
    }
    if let Some(error) = number(&motion["relaxation"]["estimated_error_m"]) {
        details.push(format!("estimated error of the relaxation {error} m"));
    }
    details.extend(number(&motion["smallest_jacobian"]).map(|J| {
        match number(&motion["smallest_patch_jacobian"]) {
            Some(patches) => format!("smallest J {J} at points, {patches} of patches"),
            None => format!("smallest J {J}"),
        }
    }));
    if warned && class != "fail" {
        details.push("see the warnings".to_string());
    }
    let mark = match class {
        "pass" => "✓",
        "doubt" => "!",
        _ => "✗",
    };
    context! { class, mark, text, detail => details.join("; ") }
}

/// The body before, after and cut open.
fn pictures(body: &Body) -> Result<Value> {
    let Some(field) = body.field("displacement") else { return Ok(Value::UNDEFINED) };
    let mut shown = vec![Shown::Before, Shown::After];
    if body.mesh.corners == 4 {
        shown.push(Shown::Cut);
    }
    let choice = Choice { direction: None, shown };
    let (drawn, scale) = panels(body, field, &choice)?;
    let panel = |panel: &crate::picture::Panel| {
        let picture = Value::from_safe_string(panel_svg(panel));
        context! { title => panel.title.as_str(), svg => picture }
    };
    let bar = Value::from_safe_string(bar_svg(&scale));
    Ok(context! { panels => drawn.iter().map(panel).collect::<Vec<_>>(), bar })
}

/// The largest displacement of a vertex, and where.
fn largest(body: &Body) -> Value {
    let displacement = body.displacement();
    let moved = displacement.iter().zip(&body.mesh.vertices);
    let most = moved.max_by(|a, b| a.0.norm().total_cmp(&b.0.norm()));
    most.map_or(Value::UNDEFINED, |(u, place)| {
        context! { size => four_digits(u.norm()), place => vector(&(*place).into()) }
    })
}

#[cfg(test)]
mod tests;
