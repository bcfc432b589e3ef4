//! Solids and parts of space.

use super::frame::Frame;
use crate::scene::{Form, Inclusion, Part, Piece, Scene};
use anyhow::Result;
use mtled::Vector3;
use mtled::algebra::tensor::Matrix3;
use mtled::geometry::{LabelField, LabelMap, Selector, Shape, Surface};
use std::f64::consts::PI;
use std::sync::Arc;

/// Beyond a half of a box, where one face of a part must not be another's.
const BEYOND: f64 = 10.0;
/// Voxels along the longest edge.
const VOXELS: f64 = 20.0;

/// The body of a scene.
pub(crate) fn body(scene: &Scene, frame: &Frame) -> Result<Shape> {
    let (edges, middle) = (frame.edges, frame.middle());
    let flat = scene.components() == 2;
    Ok(match scene.form {
        Form::Box => box_of(frame, &Vector3::zeros(), &edges),
        Form::Ball if !flat => {
            Shape::Sphere { centre: frame.point(&middle), radius: frame.size * middle.min() }
        }
        Form::Ball => {
            disc(frame, Vector3::new(middle.xy().min(), middle.xy().min(), f64::INFINITY))
        }
        Form::Ellipsoid if !flat => ellipsoid(frame, &middle),
        Form::Ellipsoid => disc(frame, Vector3::new(middle.x, middle.y, f64::INFINITY)),
        Form::Cylinder => upright(frame, middle.xy().min()),
        Form::Corner => corner(frame)?,
        Form::Dome => Shape::Union(vec![lower_half(frame), ball_on_it(frame)]),
        Form::Bored => {
            let bore = upright(frame, 0.4 * middle.xy().min());
            box_of(frame, &Vector3::zeros(), &edges).without(bore)
        }
        Form::Rounded => Shape::Intersection(vec![
            box_of(frame, &Vector3::zeros(), &edges),
            Shape::Sphere {
                centre: frame.point(&middle),
                radius: 0.5 * frame.size * (middle.norm() + middle.max()),
            },
        ]),
        Form::Wedge => surface(wedge(frame))?,
        Form::Hollow | Form::Chamber => {
            let whole = box_of(frame, &Vector3::zeros(), &edges);
            whole.without(hole(scene, frame, 1.0))
        }
        Form::Voxels => as_voxels(scene, frame)?,
    })
}

fn box_of(frame: &Frame, lower: &Vector3, upper: &Vector3) -> Shape {
    let (a, b) = (frame.point(lower), frame.point(upper));
    Shape::Box { min: a.inf(&b), max: a.sup(&b) }
}

fn ellipsoid(frame: &Frame, radii: &Vector3) -> Shape {
    let radii = frame.length(radii).abs();
    Shape::Ellipsoid { centre: frame.point(&frame.middle()), radii }
}

/// An ellipse without ends; z stays z.
fn disc(frame: &Frame, radii: Vector3) -> Shape {
    let mut turned = frame.length(&Vector3::new(radii.x, radii.y, 0.0)).abs();
    turned.z = radii.z;
    Shape::Ellipsoid { centre: frame.point(&frame.middle()), radii: turned }
}

/// A cylinder along z through the whole box.
fn upright(frame: &Frame, radius: f64) -> Shape {
    let middle = frame.middle();
    Shape::Cylinder {
        base: frame.point(&Vector3::new(middle.x, middle.y, 0.0)),
        axis: frame.direction(&Vector3::z()),
        radius: frame.size * radius,
        height: frame.size * frame.edges.z,
    }
}

/// Half of the hole's size along an edge over that of the box \[–\].
const HOLE: f64 = 0.5;

/// What is cut out of the middle of a hollow body, so many times as large.
pub(crate) fn hole(scene: &Scene, frame: &Frame, factor: f64) -> Shape {
    let (middle, flat) = (frame.middle(), scene.components() == 2);
    let half = factor * HOLE;
    match scene.form {
        Form::Chamber => {
            let mut arm = half * middle;
            if flat {
                arm.z = BEYOND;
            }
            box_of(frame, &(middle - arm), &(middle + arm))
        }
        _ if flat => {
            let radius = half * middle.xy().min();
            disc(frame, Vector3::new(radius, radius, f64::INFINITY))
        }
        _ => {
            let radius = frame.size * half * middle.min();
            Shape::Sphere { centre: frame.point(&middle), radius }
        }
    }
}

/// The volume of the hole, in a plane of that of the slab \[m³\].
pub(crate) fn volume_of_hole(scene: &Scene) -> f64 {
    let [x, y, z] = scene.edges;
    let unit = match (scene.form, scene.thickness) {
        (Form::Chamber, None) => HOLE.powi(3) * x * y * z,
        (Form::Chamber, Some(thickness)) => HOLE.powi(2) * x * y * thickness,
        (_, None) => PI / 6.0 * (HOLE * x.min(y).min(z)).powi(3),
        (_, Some(thickness)) => PI / 4.0 * (HOLE * x.min(y)).powi(2) * thickness,
    };
    unit * scene.size.powi(3)
}

fn lower_half(frame: &Frame) -> Shape {
    let edges = frame.edges;
    box_of(frame, &Vector3::zeros(), &Vector3::new(edges.x, 0.5 * edges.y, edges.z))
}

/// A ball, and along z in one with the section of a plane at its middle.
fn ball_on_it(frame: &Frame) -> Shape {
    let (edges, middle) = (frame.edges, frame.middle());
    let radius = (0.5 * edges.y).min(0.45 * edges.x).min(0.45 * edges.z);
    Shape::Sphere { centre: frame.point(&middle), radius: frame.size * radius }
}

/// The box without the quarter of large x and y. Where z does not stay z, of boxes.
fn corner(frame: &Frame) -> Result<Shape> {
    let (edges, middle) = (frame.edges, frame.middle());
    if frame.axis(2) != 2 {
        let quarter = box_of(
            frame,
            &Vector3::new(middle.x, middle.y, -BEYOND),
            &Vector3::new(BEYOND, BEYOND, BEYOND),
        );
        let whole = box_of(frame, &Vector3::zeros(), &edges);
        return Ok(whole.without(quarter));
    }
    let corners = [
        (0.0, 0.0),
        (edges.x, 0.0),
        (edges.x, middle.y),
        (middle.x, middle.y),
        (middle.x, edges.y),
        (0.0, edges.y),
    ];
    let point = |&(x, y): &(f64, f64)| frame.point(&Vector3::new(x, y, 0.0));
    let points: Vec<[f64; 2]> = corners.iter().map(|c| [point(c).x, point(c).y]).collect();
    let ends = [0.0, edges.z].map(|z| frame.point(&Vector3::new(0.0, 0.0, z)).z);
    let z = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    Ok(Shape::Polygon { points: points.into(), z })
}

/// The box whose upper face along y is half as long along x, as triangles.
fn wedge(frame: &Frame) -> Mesh {
    let e = frame.edges;
    hexahedron(frame, |x, y, z| {
        Vector3::new(x * e.x * if y > 0.0 { 0.5 } else { 1.0 }, y * e.y, z * e.z)
    })
}

/// Vertices \[m\] and triangles.
type Mesh = (Vec<Vector3>, Vec<[u32; 3]>);

/// Six faces of two triangles each, normals outwards also in a mirror image.
fn hexahedron(frame: &Frame, corner: impl Fn(f64, f64, f64) -> Vector3) -> Mesh {
    let bit = |n: usize, k: usize| (n >> k & 1) as f64;
    let corners: Vec<Vector3> =
        (0..8).map(|n| frame.point(&corner(bit(n, 0), bit(n, 1), bit(n, 2)))).collect();
    let faces: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mirrored = frame.turn.determinant() < 0.0;
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let triangles = triangles.map(|[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] });
    (corners, triangles.collect())
}

fn surface((corners, triangles): Mesh) -> Result<Shape> {
    Ok(Shape::Surface(Arc::new(Surface::new(corners, triangles)?)))
}

/// The wedge of a scene at home, its triangles and vertices in another order.
pub(crate) fn wedge_in_another_order(scene: &Scene) -> Result<Shape> {
    let (corners, triangles) = wedge(&Frame::home(scene));
    let last = corners.len() as u32 - 1;
    let corners = corners.into_iter().rev().collect();
    let triangles = triangles.into_iter().rev().map(|[a, b, c]| [last - b, last - c, last - a]);
    surface((corners, triangles.collect()))
}

/// The box as triangles; `None` for other forms.
pub(crate) fn as_surface(scene: &Scene, frame: &Frame) -> Option<Result<Shape>> {
    let e = frame.edges;
    let corner = |x: f64, y: f64, z: f64| Vector3::new(x, y, z).component_mul(&e);
    (scene.form == Form::Box).then(|| surface(hexahedron(frame, corner)))
}

/// The box as voxels.
pub(crate) fn as_voxels(scene: &Scene, frame: &Frame) -> Result<Shape> {
    let counts = scene.edges.map(|edge| (edge * VOXELS).round() as usize);
    let steps = Vector3::from_fn(|k, _| scene.edges[k] / counts[k] as f64);
    let directions = frame.size * frame.turn * Matrix3::from_diagonal(&steps);
    let labels = vec![1; counts.iter().product()];
    let map = LabelMap::new(counts, frame.point(&(0.5 * steps)), directions, labels)?;
    Ok(Shape::Labels(Arc::new(LabelField::new(Arc::new(map), &[1], LabelField::SMOOTHING)?)))
}

/// The volume of a form in space \[m³\], where a formula has it.
pub(crate) fn closed_form_volume(scene: &Scene) -> Option<f64> {
    let [x, y, z] = scene.edges;
    let round = 0.5 * x.min(y);
    let unit = match scene.form {
        Form::Box => x * y * z,
        Form::Ball => PI / 6.0 * x.min(y).min(z).powi(3),
        Form::Ellipsoid => PI / 6.0 * x * y * z,
        Form::Cylinder => PI * round * round * z,
        Form::Corner | Form::Wedge => 0.75 * x * y * z,
        Form::Bored => x * y * z - PI * (0.4 * round).powi(2) * z,
        Form::Hollow | Form::Chamber => x * y * z - volume_of_hole(scene) / scene.size.powi(3),
        Form::Dome | Form::Rounded | Form::Voxels => return None,
    };
    (scene.components() == 3).then(|| unit * scene.size.powi(3))
}

/// A ball about a place over the size.
pub(crate) fn ball(frame: &Frame, centre: &Vector3, radius: f64) -> Selector {
    let shape = Shape::Sphere { centre: frame.point(centre), radius: frame.size * radius };
    Selector::Inside { shape, tolerance: frame.tolerance }
}

/// What lies on one side of a plane.
fn side(frame: &Frame, point: &Vector3, normal: &Vector3) -> Selector {
    let shape = Shape::HalfSpace { point: frame.point(point), normal: frame.direction(normal) };
    Selector::Inside { shape, tolerance: frame.tolerance }
}

/// What is of another material.
pub(crate) fn piece(frame: &Frame, inclusion: &Inclusion) -> Selector {
    // Not in the middle of cells or nodes, where round-off would choose.
    let at = 0.513 * frame.edges;
    let axis = usize::from(inclusion.axis);
    let along = Vector3::ith(axis, 1.0);
    let layer = |normal: Vector3, thickness: f64| Selector::Plane {
        point: frame.point(&at),
        normal: frame.direction(&normal),
        tolerance: 0.5 * thickness * frame.edges[axis] * frame.size,
    };
    match inclusion.piece {
        Piece::Half => side(frame, &at, &along),
        Piece::Layer(thickness) => layer(along, thickness),
        Piece::Askew(thickness) => {
            let (sine, cosine) = (std::f64::consts::FRAC_PI_6).sin_cos();
            // In a plane the layer stays across it.
            let aside = Vector3::ith(if axis == 1 { 0 } else { 1 }, 1.0);
            layer(cosine * along + sine * aside, thickness)
        }
        Piece::Ball(radius) => ball(frame, &at, radius * frame.edges.min()),
    }
}

/// A part of the body of a scene.
pub(crate) fn part(scene: &Scene, frame: &Frame, part: &Part) -> Selector {
    let edges = frame.edges;
    let end = |axis: usize, upper: bool| {
        let outwards = Vector3::ith(axis, if upper { 1.0 } else { -1.0 });
        let mut place = frame.middle();
        place[axis] = if upper { edges[axis] } else { 0.0 };
        (place, outwards)
    };
    match *part {
        Part::Whole => Selector::All,
        Part::Hole => {
            Selector::Inside { shape: hole(scene, frame, 1.3), tolerance: frame.tolerance }
        }
        Part::End { axis, upper, depth } => {
            let axis = usize::from(axis);
            let (place, outwards) = end(axis, upper);
            side(frame, &(place - depth * edges[axis] * outwards), &-outwards)
        }
        Part::Spot { axis, upper, radius } => {
            let (place, _) = end(usize::from(axis), upper);
            ball(frame, &place, radius * edges[usize::from(axis)])
        }
    }
}
