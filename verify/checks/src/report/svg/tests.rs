use super::*;
use crate::report::sample;
use crate::study::{Drawing, Layer, LayerStyle, Plot, Series, SeriesStyle, axis};

fn plot(log: bool, points: Vec<(f64, f64)>) -> Figure {
    let styles = [SeriesStyle::Line, SeriesStyle::Points, SeriesStyle::LineAndPoints];
    let series = styles.map(|style| Series {
        name: format!("{style:?}"),
        error_bars: vec![0.1; points.len()],
        points: points.clone(),
        style,
        colour: None,
    });
    Figure::Plot(Plot {
        title: "title".into(),
        caption: String::new(),
        x: axis("x", "m", log),
        y: axis("y", "m", log),
        series: series.to_vec(),
        slopes: vec![1.0, -2.0, f64::NAN, 0.0],
    })
}

fn drawing(lines: Vec<Vec<[f64; 2]>>) -> Figure {
    use LayerStyle::{Dashed, Dots, Filled, Outline};
    let layers = [Outline, Dashed, Filled, Dots].map(|style| Layer {
        name: format!("{style:?}"),
        style,
        colour: 17,
        closed: true,
        lines: lines.clone(),
    });
    Figure::Drawing(Drawing {
        title: "title".into(),
        caption: String::new(),
        unit: "m".into(),
        layers: layers.to_vec(),
        scale: None,
    })
}

/// Reads the text as XML and fails on a coordinate that is not a number.
fn assert_sound(svg: &str) {
    let mut reader = quick_xml::Reader::from_str(svg);
    loop {
        match reader.read_event() {
            Ok(quick_xml::events::Event::Eof) => break,
            Ok(_) => {}
            Err(error) => panic!("{error} in {svg}"),
        }
    }
    for bad in ["NaN", "inf", "\"\""] {
        assert!(!svg.contains(bad), "{bad} in {svg}");
    }
}

#[test]
fn degenerate_data_give_a_picture() {
    let (nan, infinite) = (f64::NAN, f64::INFINITY);
    let degenerate = [
        vec![],
        vec![(1.0, 1.0)],
        vec![(0.0, 0.0)],
        vec![(-3.0, -3.0), (-3.0, -3.0)],
        vec![(nan, 1.0), (1.0, infinite), (2.0, 3.0)],
        vec![(1e-300, 1e300), (1e300, -1e300)],
        vec![(f64::MIN, f64::MAX), (f64::MAX, f64::MIN)],
        vec![(1.0, 1.0), (1.0 + 1e-15, 1.0 + 1e-15)],
        vec![(1.0, 5e-324), (2.0, 1e-320)],
        vec![(1e9, 1.0), (1e9 + 1.0, 1.0 + 1e-8)],
    ];
    for points in degenerate {
        let line: Vec<[f64; 2]> = points.iter().map(|&(x, y)| [x, y]).collect();
        assert_sound(&to_svg(&plot(false, points.clone())));
        assert_sound(&to_svg(&plot(true, points)));
        assert_sound(&to_svg(&drawing(vec![line])));
    }
    assert_sound(&to_svg(&drawing(vec![])));
}

#[test]
fn names_are_escaped_and_every_sample_figure_is_sound() {
    let report = sample::report();
    let figures = || report.studies.iter().flat_map(|study| &study.figures);
    for figure in figures() {
        assert_sound(&to_svg(figure));
        assert_sound(&to_svg_file(figure));
    }
    assert!(figures().any(|figure| to_svg(figure).contains("h &lt; 1 &amp; more")));
}

#[test]
fn decades_are_labelled_with_powers_of_ten() {
    let svg = to_svg(&plot(true, vec![(1e-3, 1e-8), (1.0, 1e-2)]));
    for label in [">10⁻³<", ">10⁻²<", ">1<", ">10⁻⁸<"] {
        assert!(svg.contains(label), "{label} in {svg}");
    }
}

#[test]
fn a_small_linear_axis_takes_the_power_into_its_title() {
    let svg = to_svg(&plot(false, vec![(0.0, 0.0), (1.0, 4e-5)]).without_bars());
    assert!(svg.contains("y [10⁻⁶ m]"), "{svg}");
    assert!(svg.contains(">20<"), "{svg}");
}

#[test]
fn a_nan_interrupts_the_line() {
    let points = vec![(0.0, 0.0), (1.0, 1.0), (2.0, f64::NAN), (3.0, 1.0), (4.0, 0.0)];
    let svg = to_svg(&plot(false, points).without_bars());
    let line = svg.lines().find(|line| line.contains("class=\"line s0\"")).unwrap();
    assert_eq!(line.matches('M').count(), 2, "{line}");
}

#[test]
fn the_scale_bar_of_a_small_drawing_is_in_millimetres() {
    let svg = to_svg(&drawing(vec![vec![[0.0, 0.0], [0.17, 0.0], [0.17, 0.14]]]));
    assert!(svg.contains(">50 mm<"), "{svg}");
}

impl Figure {
    fn without_bars(mut self) -> Figure {
        if let Figure::Plot(plot) = &mut self {
            plot.series.iter_mut().for_each(|series| series.error_bars.clear());
        }
        self
    }
}

#[test]
fn where_labels_are_close_some_are_left_out() {
    let svg = to_svg(&plot(true, vec![(0.65, 1.0), (4.6, 5.0)]));
    let written = |label: &str| svg.contains(&format!(">{label}</text>"));
    assert!(written("1") && written("2") && !written("0.9"), "{svg}");
}

/// A figure of the sample report.
fn sample_figure(title: &str) -> Figure {
    let report = sample::report();
    let mut figures = report.studies.into_iter().flat_map(|study| study.figures);
    figures.find(|figure| figure.title() == title).unwrap()
}

#[test]
fn what_is_below_a_floor_is_shaded_and_faint_and_does_not_stretch_the_scale() {
    let Figure::Panels(panels) = sample_figure("Error over time") else { panic!() };
    let shown = parts(&panels);
    for (_, svg) in &shown.panels {
        assert_eq!(svg.matches("class=\"floor\"").count(), 1, "{svg}");
        let marks = |class: &str| svg.lines().find(|line| line.contains(class)).unwrap();
        assert_eq!(marks("\"mark faint s0\"").matches('M').count(), 1, "{svg}");
        assert_eq!(marks("\"mark s0\"").matches('M').count(), 2, "{svg}");
        assert!(!svg.contains("10⁻⁹"), "{svg}");
    }
}

#[test]
fn panels_have_one_legend_and_the_same_scales() {
    let Figure::Panels(panels) = sample_figure("Error over time") else { panic!() };
    let shown = parts(&panels);
    let ticks = |svg: &str| -> Vec<String> {
        svg.lines().filter(|line| line.contains("\"tick\"")).map(str::to_string).collect()
    };
    assert_eq!(ticks(&shown.panels[0].1), ticks(&shown.panels[1].1));
    assert!(shown.plots && shown.legend.unwrap().contains(">meshes<"));
    assert!(shown.panels.iter().all(|(_, svg)| !svg.contains(">meshes<")));
    let file = to_svg_file(&Figure::Panels(panels));
    assert!(file.contains(">cube<") && file.contains(">slice<"), "{file}");
}

#[test]
fn rows_have_names_from_the_top_and_bounds_point_to_where_the_value_may_be() {
    let svg = to_svg(&sample_figure("Time of another code over ours"));
    let at = |text: &str| svg.find(text).unwrap_or_else(|| panic!("{text} in {svg}"));
    assert!(at("h &lt; 1 &amp; more") < at(">cube<"));
    let heads: Vec<&str> = svg.lines().filter(|line| line.contains("\"mark s0\"")).collect();
    // The mark of the equal ratio, both bounds, and their entries in the legend.
    assert_eq!(heads.len(), 6, "{svg}");
}

#[test]
fn bands_are_filled_from_one_end_of_the_colours_to_the_other_and_have_a_bar_with_their_unit() {
    let svg = to_svg(&sample_figure("Displacement"));
    for text in ["class=\"b0\"", "class=\"b9\"", ">2.5<", ">displacement [mm]<"] {
        assert!(svg.contains(text), "{text} in {svg}");
    }
    // Lines above bands have an edge that shows on every colour.
    assert!(svg.contains("class=\"casing\"") && svg.contains("class=\"above\""));
}
