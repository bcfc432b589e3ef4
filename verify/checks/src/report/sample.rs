//! A made-up report that uses every feature, for the tests of this folder.

use crate::study::{
    Band, BandSource, Bound, Cell, Change, Check, ColourScale, Comparison, Drawing, Figure, Kind,
    Layer, LayerStyle, Panels, Plot, Provenance, Report, Scale, Scatter, Series, SeriesStyle,
    Study, Table, Verdict, axis, curve, names_axis, number, styled, text,
};
use std::f64::consts::TAU;

/// Eleven checks of which two fail, and one study that could not run.
pub(crate) fn report() -> Report {
    let cook = Study {
        id: "cook".into(),
        title: "Cook's membrane at finite strain".into(),
        claim: "The tip rises as two published codes say.".into(),
        command: "mtled verify cook".into(),
        failure: Some("reference/cook.csv: no such file or directory".into()),
        ..Study::default()
    };
    let studies = vec![patch(), convergence(), cantilever(), brain(), cook];
    Report { studies, ..empty() }
}

/// The same compared with a baseline: one check of each verdict.
pub(crate) fn compared() -> Report {
    let change = |id: &str, verdict: Verdict, before: f64, now: f64| Change {
        id: id.into(),
        quantity: "shift, h < 1 & more".into(),
        unit: "mm".into(),
        verdict,
        before,
        now,
        band: Some(Band {
            low: 0.5 * before,
            high: 2.0 * before,
            source: BandSource::Scatter,
            scatter: Some(Scatter { scale: Scale::Logarithmic, deviation: 0.1, samples: 20 }),
        })
        .filter(|band| band.low.is_finite()),
        remark: (verdict == Verdict::Worse).then(|| "its bound was loosened".to_string()),
    };
    let changes = vec![
        change("brain/tumour/shift", Verdict::Worse, 0.0101, 0.0312),
        change("brain/none", Verdict::Missing, 0.02, f64::NAN),
        change("patch/cube/moment", Verdict::New, f64::NAN, 4.4e-15),
        change("brain/ventricle/shift", Verdict::Improved, 0.05, 0.0101),
        change("brain/step", Verdict::Same, 1.2e-5, 1.234e-5),
    ];
    let with = "the baseline of 2026-11-20 (commit d97a856)".to_string();
    let mut report = Report { comparison: Some(Comparison { with, changes }), ..report() };
    report.studies[3].checks[0].reproduce = Some("# smallest\nname = \"brain\"\n".into());
    report
}

pub(crate) fn empty() -> Report {
    Report {
        schema_version: 1,
        suite: "quick".into(),
        provenance: Provenance {
            version: "0.1.0".into(),
            commit: "d97a856".into(),
            compiler: "rustc 1.90.0".into(),
            processor: "AMD EPYC 9554".into(),
            processor_features: "avx2, fma".into(),
            threads: 2,
            date: "2026-11-21".into(),
        },
        studies: vec![],
        wall_seconds: 191.3,
        comparison: None,
    }
}

fn check(id: &str, quantity: &str, kind: Kind, value: f64, bound: Bound, unit: &str) -> Check {
    Check::new(
        id,
        quantity,
        kind,
        value,
        bound,
        unit,
        "A book on meshless methods, section 8, (8.9)",
    )
}

fn patch() -> Study {
    let exact = |id: &str, quantity: &str, value: f64, limit: f64, unit: &str| {
        check(id, quantity, Kind::Exact, value, Bound::AtMost(limit), unit)
    };
    Study {
        id: "patch".into(),
        title: "Affine patch test".into(),
        claim: "A linear displacement field is reproduced to round-off on any cloud.".into(),
        command: "mtled verify patch --suite quick".into(),
        checks: vec![
            exact("patch/cube/field", "largest error, h < 1 & more", 3.21e-14, 1e-12, "1"),
            exact("patch/cube/force", "sum of the internal forces", 1.7e-13, 1e-10, "N"),
            exact("patch/cube/moment", "sum of their moments", 4.4e-15, 1e-10, "N m"),
        ],
        tables: vec![],
        notes: vec!["The jitter of the cloud is 30 % of the spacing.".into()],
        wall_seconds: 0.342,
        ..Study::default()
    }
}

fn convergence() -> Study {
    let sizes = [0.1, 0.05, 0.025, 0.0125, 0.00625];
    let power = |a: f64, p: f64| sizes.iter().map(|&h: &f64| (h, a * h.powf(p))).collect();
    let series = |name: &str, points: Vec<(f64, f64)>| Series {
        error_bars: points.iter().map(|p| 0.2 * p.1).collect(),
        ..curve(name, points)
    };
    let figure = Plot {
        title: "Error over spacing".into(),
        caption: "Relative error in displacement and stress, median of five clouds; bars: scatter."
            .into(),
        x: axis("nodal spacing", "m", true),
        y: axis("relative L2 error", "1", true),
        series: vec![
            series("displacement, h < 1 & more", power(2.0, 2.4)),
            series("displacement, linear basis", power(1.0, 1.9)),
            series("stress", power(0.8, 0.98)),
        ],
        slopes: vec![2.0, 1.0],
    };
    Study {
        id: "convergence".into(),
        title: "Observed order on a manufactured solution".into(),
        claim: "The displacement converges with order two in the spacing.".into(),
        command: "mtled verify convergence".into(),
        checks: vec![
            check(
                "convergence/order/u",
                "observed order",
                Kind::Exact,
                1.93,
                Bound::Between(1.8, 2.4),
                "1",
            ),
            check(
                "convergence/cost",
                "steps taken",
                Kind::Regression,
                6154.0,
                Bound::AtMost(6200.0),
                "1",
            ),
            check(
                "convergence/none",
                "order of the energy",
                Kind::Exact,
                f64::NAN,
                Bound::AtLeast(1.8),
                "1",
            ),
        ],
        tables: vec![refinement()],
        figures: vec![Figure::Plot(figure)],
        wall_seconds: 41.2,
        ..Study::default()
    }
}

/// Errors on three clouds.
fn refinement() -> Table {
    let row = |basis: &str, h: f64, nodes: f64, e: f64, p: f64| {
        vec![
            Cell::Text(basis.into()),
            Cell::Number(h),
            Cell::Number(nodes),
            Cell::Number(e),
            Cell::Number(p),
        ]
    };
    Table {
        title: "Refinement".into(),
        columns: vec![
            text("basis"),
            number("spacing", "m"),
            number("nodes", "1"),
            number("error", "1"),
            number("order", "1"),
        ],
        rows: vec![
            row("linear", 0.1, 1331.0, 1.26e-2, f64::NAN),
            row("linear", 0.05, 9261.0, 3.37e-3, 1.9),
            row("linear", 0.025, 68_921.0, 9.03e-4, 1.9),
        ],
    }
}

fn cantilever() -> Study {
    let swing = |phase: f64| {
        (0..=400)
            .map(|i| f64::from(i) * 0.005)
            .map(|t| (t, -0.0636 - 0.0652 * (TAU * 1.0995 * t + phase).cos()))
            .collect::<Vec<_>>()
    };
    let few = swing(0.0).into_iter().step_by(25).collect();
    let history = Plot {
        title: "Tip of the flag".into(),
        caption: "Vertical displacement of the tip over time.".into(),
        x: axis("time", "s", false),
        y: axis("displacement", "m", false),
        series: vec![
            styled("reference", few, SeriesStyle::Points),
            styled("mtled, h = 5 mm", swing(0.1), SeriesStyle::Line),
            styled("mtled, h = 2.5 mm", swing(0.02), SeriesStyle::Line),
        ],
        slopes: vec![],
    };
    let strain = (0..20).map(|i| (f64::from(i) * 0.05, 3.1e-5 * (f64::from(i) * 0.05).powi(2)));
    let energy = Plot {
        title: "Strain energy".into(),
        caption: "Grows with the square of the load.".into(),
        x: axis("load", "N", false),
        y: axis("strain energy", "J", false),
        series: vec![styled("", strain.collect(), SeriesStyle::LineAndPoints)],
        slopes: vec![],
    };
    let tip = |id: &str, name: &str, value: f64, low: f64, high: f64| {
        check(id, name, Kind::Reference, value, Bound::Between(low, high), "m")
    };
    Study {
        id: "flag".into(),
        title: "Swinging flag of Turek and Hron (CSM3)".into(),
        claim: "Mean and amplitude of the tip agree with the published values within 1 %.".into(),
        command: "mtled verify flag --nodes 4000".into(),
        checks: vec![
            tip("flag/csm3/mean", "mean of the tip displacement", -63.8e-3, -64.3e-3, -63.0e-3),
            tip(
                "flag/csm3/amplitude",
                "amplitude of the tip displacement",
                65.1e-3,
                64.5e-3,
                65.9e-3,
            ),
        ],
        figures: vec![Figure::Plot(history), Figure::Plot(energy)],
        wall_seconds: 112.0,
        ..Study::default()
    }
}

/// Ratios of two codes, a row per case.
fn ratios() -> Plot {
    let names = vec!["brain slice, h < 1 & more".to_string(), "cube".to_string()];
    let bound =
        |style, at: (f64, f64)| Series { colour: Some(0), ..styled("bound", vec![at], style) };
    Plot {
        title: "Time of another code over ours".into(),
        caption: "Right of 1 we take less.".into(),
        x: axis("ratio", "1", true),
        y: names_axis("case", names),
        series: vec![
            styled("equal", vec![(3.0, 0.0)], SeriesStyle::Points),
            bound(SeriesStyle::AtMost, (2.0, 1.0)),
            bound(SeriesStyle::AtLeast, (5.0, 1.0)),
        ],
        slopes: vec![],
    }
}

/// Error over time of two cases, with a floor that one point is below.
fn costs() -> Panels {
    let panel = |title: &str, floor: f64| {
        Figure::Plot(Plot {
            title: title.into(),
            caption: String::new(),
            x: axis("time", "s", true),
            y: axis("error", "1", true),
            series: vec![
                curve("meshes", vec![(1.0, 1e-2), (10.0, 1e-3), (100.0, 1e-9)]),
                styled("below the error bar", vec![(1.0, floor)], SeriesStyle::Floor),
            ],
            slopes: vec![],
        })
    };
    let panels = vec![panel("cube", 1e-4), panel("slice", 1e-6)];
    Panels { title: "Error over time".into(), caption: "Lower left is better.".into(), panels }
}

/// A displacement in two bands.
fn bands() -> Drawing {
    let band = |band: usize, radius: f64| Layer {
        name: String::new(),
        style: LayerStyle::Band,
        colour: band,
        closed: true,
        lines: vec![outline(radius, 0.0)],
    };
    let edge = Layer { name: "edge".into(), style: LayerStyle::Outline, ..band(0, 0.05) };
    Drawing {
        title: "Displacement".into(),
        caption: "Of the slice.".into(),
        unit: "m".into(),
        layers: vec![band(0, 0.07), band(1, 0.04), edge],
        scale: Some(ColourScale {
            label: "displacement".into(),
            unit: "mm".into(),
            edges: vec![0.0, 2.5, 5.0],
        }),
    }
}

/// A wobbly outline like a slice of a brain.
fn outline(radius: f64, push: f64) -> Vec<[f64; 2]> {
    let place = |a: f64| {
        let r = radius * (1.0 + 0.05 * (5.0 * a).cos() + 0.02 * (11.0 * a).sin());
        let squeeze = push * (-((a - 0.8).powi(2)) * 3.0).exp();
        [1.15 * r * a.cos() - squeeze * a.cos(), (r - squeeze) * a.sin()]
    };
    (0..240).map(|i| place(TAU * f64::from(i) / 240.0)).collect()
}

fn brain() -> Study {
    let layer = |name: &str, style, colour, lines| Layer {
        name: name.into(),
        style,
        colour,
        closed: true,
        lines,
    };
    let nodes: Vec<[f64; 2]> = (0..900)
        .map(|i| [f64::from(i % 30) * 0.005 - 0.0725, f64::from(i / 30) * 0.005 - 0.0725])
        .filter(|p| p[0].hypot(p[1]) < 0.06)
        .collect();
    let drawing = Drawing {
        title: "Brain slice under a 10 mm indentation".into(),
        caption: "Outlines before and after, ventricle and tumour, nodes at rest.".into(),
        unit: "m".into(),
        layers: vec![
            layer("parenchyma", LayerStyle::Filled, 5, vec![outline(0.07, 0.012)]),
            layer("nodes", LayerStyle::Dots, 6, vec![nodes]),
            layer("before", LayerStyle::Dashed, 6, vec![outline(0.07, 0.0)]),
            layer("tumour", LayerStyle::Filled, 1, vec![outline(0.012, 0.001)]),
            layer("finite elements", LayerStyle::Outline, 0, vec![outline(0.07, 0.0125)]),
        ],
        scale: None,
    };
    let contour = Drawing {
        title: "Ventricles".into(),
        caption: "Reference dashed.".into(),
        layers: vec![
            layer("mtled", LayerStyle::Outline, 0, vec![outline(0.02, 0.002)]),
            layer("reference", LayerStyle::Dashed, 1, vec![outline(0.02, 0.0021)]),
        ],
        ..drawing.clone()
    };
    Study {
        id: "brain".into(),
        title: "Indentation of a brain slice".into(),
        claim: "Centres of mass move as in a finite-element solution.".into(),
        command: "mtled verify brain".into(),
        checks: shifts(),
        figures: vec![
            Figure::Plot(ratios()),
            Figure::Panels(costs()),
            Figure::Drawing(drawing),
            Figure::Drawing(contour),
            Figure::Drawing(bands()),
        ],
        leading: 4,
        notes: vec!["Horton 2007 reports 1.8 to 9.6 % of the displacement.".into()],
        wall_seconds: 37.0,
        ..Study::default()
    }
}

fn shifts() -> Vec<Check> {
    vec![
        check(
            "brain/tumour/shift",
            "difference of the tumour's shift",
            Kind::Reference,
            0.0312,
            Bound::AtMost(0.02),
            "mm",
        ),
        check(
            "brain/ventricle/shift",
            "difference of the ventricles' shift",
            Kind::Reference,
            0.0101,
            Bound::AtMost(0.02),
            "mm",
        ),
        check(
            "brain/step",
            "critical time step",
            Kind::Regression,
            1.234e-5,
            Bound::AtLeast(1.2e-5),
            "s",
        ),
    ]
}
