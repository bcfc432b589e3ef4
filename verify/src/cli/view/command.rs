//! `mtled view` from its arguments to the picture.

use super::arguments::ViewArgs;
use crate::cli::common::Common;
use anyhow::{Context, Result, bail, ensure};
use mtled_checks::report::write_atomically;
use mtled_io::files::points::{MeshFile, read_mesh};
use mtled_run::display::Mesh;
use mtled_run::picture::{Body, Choice, Field, Shown, panels, picture_svg};
use mtled_run::run::last_body_frame;

pub(crate) fn view(arguments: &ViewArgs, common: &Common) -> Result<u8> {
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
        shown = Shown::usual(&body.mesh);
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
    let field = |array: mtled_io::files::points::NamedArray| Field {
        name: array.name,
        components: array.components,
        values: array.values,
    };
    Body { mesh, fields: file.point_data.into_iter().map(field).collect() }
}
