//! `mtled view`.

use super::common::Common;
use crate::display::Mesh;
use crate::files::points::{MeshFile, read_mesh};
use crate::picture::{Body, Choice, Direction, Field, Shown, panels, picture_svg};
use crate::run::last_body_frame;
use anyhow::{Context, Result, bail, ensure};
use clap::{Args, ValueEnum};
use mtled::algebra::tensor::Vector3;
use mtled_checks::report::write_atomically;
use std::path::PathBuf;

/// Draws the frames of the body that `mtled solve` wrote (body_*.vtu).
#[derive(Debug, Args)]
pub struct ViewArgs {
    /// Folder that `mtled solve --out` wrote.
    result: PathBuf,
    /// The picture, .svg [default: RESULT/picture.svg].
    #[arg(short, long, value_name = "FILE.svg")]
    out: Option<PathBuf>,
    /// The field that gives the colours: displacement, von_mises_stress, pressure, J,
    /// principal_green_lagrange_strain (its largest), nodal_spacing and, where there are such,
    /// displacement_error_bar, contact_pressure, contact_gap.
    #[arg(long, value_name = "NAME", default_value = "displacement")]
    field: String,
    /// Where the viewer stands, seen from the body, such as 1,-1,0.5 [default: in front, to the
    /// right and above; above a plane].
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, allow_hyphen_values = true)]
    from: Option<Direction>,
    /// What is shown, from the left [default: before,after,cut; before,after in a plane].
    #[arg(long, value_enum, value_name = "PANEL", value_delimiter = ',')]
    show: Vec<PanelName>,
    /// Number of the frame [default: the last].
    #[arg(long, value_name = "N")]
    frame: Option<usize>,
}

/// A panel of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PanelName {
    /// The body before, its regions in their colours.
    Before,
    /// The body after, coloured by the field.
    After,
    /// The body after without the half in front of its middle.
    Cut,
}

impl From<PanelName> for Shown {
    fn from(name: PanelName) -> Shown {
        match name {
            PanelName::Before => Shown::Before,
            PanelName::After => Shown::After,
            PanelName::Cut => Shown::Cut,
        }
    }
}

fn direction(text: &str) -> Result<Direction, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[x, y, z])
            if [x, y, z].iter().all(|c| c.is_finite()) && (x, y, z) != (0.0, 0.0, 0.0) =>
        {
            Ok(Direction(Vector3::new(x, y, z)))
        }
        _ => Err("expected three numbers that are not all zero, such as 1,-1,0.5".into()),
    }
}

pub fn view(arguments: &ViewArgs, common: &Common) -> Result<u8> {
    let folder = &arguments.result;
    let out = arguments.out.clone().unwrap_or_else(|| folder.join("picture.svg"));
    let is_svg = out.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("svg"));
    ensure!(is_svg, "{}: pictures are SVG; name a file that ends in .svg", out.display());
    let unreadable = || format!("cannot read the folder {}", folder.display());
    let frame = last_body_frame(folder, arguments.frame).with_context(unreadable)?;
    let Some(frame) = frame else {
        let which = arguments.frame.map_or(String::new(), |n| format!(" with the number {n}"));
        bail!(
            "{}: there is no frame of the body{which} (body_*.vtu); give the folder of a run of `mtled solve`, \
             whose case has frames",
            folder.display()
        );
    };
    let body = body_of(read_mesh(&frame)?);
    let Some(field) = body.field(&arguments.field) else {
        let known: Vec<&str> = body.fields.iter().map(|field| field.name.as_str()).collect();
        bail!(
            "{}: there is no field \"{}\"; it has {}",
            frame.display(),
            arguments.field,
            known.join(", ")
        );
    };
    let mut shown: Vec<Shown> = arguments.show.iter().map(|name| (*name).into()).collect();
    let plane = body.mesh.corners == 3;
    if shown.is_empty() {
        shown = vec![Shown::Before, Shown::After];
        shown.extend((!plane).then_some(Shown::Cut));
    }
    ensure!(
        !plane || !shown.contains(&Shown::Cut),
        "{}: a cross-section in a plane cannot be cut open; leave out `cut`",
        frame.display()
    );
    let choice = Choice { direction: arguments.from, shown };
    let (drawn, scale) = panels(&body, field, &choice)?;
    let picture = picture_svg(&drawn, &scale, &format!("{}, {}", folder.display(), field.label()));
    write_atomically(&out, picture.as_bytes())?;
    common.print_summary(
        &|| {
            Ok(serde_json::json!({
                "picture": out.display().to_string(),
                "frame": frame.display().to_string(),
                "field": field.name,
                "smallest": scale.low,
                "largest": scale.high,
            })
            .to_string())
        },
        &|| format!("{}\n", out.display()),
    )?;
    Ok(0)
}

/// The body of a frame.
fn body_of(file: MeshFile) -> Body {
    let cells = file.cells.len() / file.corners;
    let regions = file.cell_data.into_iter().find(|array| array.name == "region");
    let regions = regions.map_or(vec![0; cells], |array| {
        array.values.into_iter().map(|region| region as u16).collect()
    });
    let mesh = Mesh { corners: file.corners, vertices: file.points, cells: file.cells, regions };
    let field = |array: crate::files::points::NamedArray| Field {
        name: array.name,
        components: array.components,
        values: array.values,
    };
    Body { mesh, fields: file.point_data.into_iter().map(field).collect() }
}
