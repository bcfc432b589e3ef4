//! Pixels of triangles: what is nearest to the viewer, shaded by a lamp beside him.
#![allow(non_snake_case)]

use super::camera::Camera;
use super::colours::{Colour, byte};
use super::surface::Triangle;
use anyhow::Result;
use mtled::algebra::tensor::Vector3;

/// Pixels that are averaged along each axis of one that is shown.
const FINER: usize = 2;

/// What part of a plane is seen, and in how many pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Window {
    /// Middle, to the right and upwards \[m\].
    pub middle: [f64; 2],
    /// Length of a pixel \[m\].
    pub pixel: f64,
    /// Width and height \[pixel\].
    pub size: [usize; 2],
}

/// Colours with opacity.
#[derive(Debug, Clone)]
pub(crate) struct Pixels {
    pub size: [usize; 2],
    /// From the left, then from the top: red, green, blue, opacity.
    pub bytes: Vec<u8>,
}

/// A picture before pixels are averaged.
struct Fine {
    size: [usize; 2],
    depth: Vec<f64>,
    colour: Vec<[u8; 3]>,
}

/// Draws triangles, the colour of which is a function of value and region.
pub(crate) fn draw(
    triangles: &[Triangle],
    camera: &Camera,
    window: &Window,
    colour: impl Fn(f64, u16) -> Colour,
) -> Pixels {
    let size = window.size.map(|n| n * FINER);
    let count = size[0] * size[1];
    let mut fine =
        Fine { size, depth: vec![f64::NEG_INFINITY; count], colour: vec![[0; 3]; count] };
    let pixel = window.pixel / FINER as f64;
    for triangle in triangles {
        let seen = triangle.corners.map(|corner| {
            let x = camera.seen(&corner.at);
            let column = (x.x - window.middle[0]) / pixel + 0.5 * size[0] as f64;
            let row = 0.5 * size[1] as f64 - (x.y - window.middle[1]) / pixel;
            Vector3::new(column, row, x.z)
        });
        let lights = triangle.corners.map(|corner| light(&corner.normal, camera));
        let values = triangle.corners.map(|corner| corner.value);
        let mean = |weights: [f64; 3], of: &[f64; 3]| -> f64 {
            weights[0] * of[0] + weights[1] * of[1] + weights[2] * of[2]
        };
        fine.fill(&seen, |weights| {
            let light = mean(weights, &lights);
            colour(mean(weights, &values), triangle.region).map(|part| part * light)
        });
    }
    fine.averaged(window.size)
}

/// How bright a face with this normal is, seen from either side \[–\].
fn light(normal: &Vector3, camera: &Camera) -> f64 {
    let lamp = (camera.towards + 0.45 * camera.up - 0.35 * camera.right).normalize();
    let normal = normal.try_normalize(0.0).unwrap_or(camera.towards);
    let facing = if normal.dot(&camera.towards) < 0.0 { -normal } else { normal };
    0.42 + 0.62 * facing.dot(&lamp).max(0.0)
}

impl Fine {
    /// Fills a triangle where it is nearest; `colour` takes the weights of its corners.
    fn fill(&mut self, at: &[Vector3; 3], colour: impl Fn([f64; 3]) -> Colour) {
        let [a, b, c] = at;
        let twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if twice == 0.0 || !twice.is_finite() {
            return;
        }
        let inverse = 1.0 / twice;
        let range = |axis: usize| {
            let (low, high) = at.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| {
                (l.min(p[axis]), h.max(p[axis]))
            });
            let end = self.size[axis] as f64;
            (low - 0.5).ceil().clamp(0.0, end) as usize
                ..(high + 0.5).floor().clamp(0.0, end) as usize
        };
        for row in range(1) {
            for column in range(0) {
                let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                let part = |p: &Vector3, q: &Vector3| {
                    ((q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x)) * inverse
                };
                let weights = [part(b, c), part(c, a), part(a, b)];
                if weights.iter().any(|weight| *weight < 0.0) {
                    continue;
                }
                let depth: f64 = (0..3).map(|n| weights[n] * at[n].z).sum();
                let place = row * self.size[0] + column;
                if depth > self.depth[place] {
                    self.depth[place] = depth;
                    self.colour[place] = colour(weights).map(byte);
                }
            }
        }
    }

    fn averaged(&self, size: [usize; 2]) -> Pixels {
        let mut bytes = Vec::with_capacity(4 * size[0] * size[1]);
        for place in 0..size[0] * size[1] {
            let (column, row) = (place % size[0], place / size[0]);
            let (mut sum, mut covered) = ([0.0; 3], 0.0);
            for n in 0..FINER * FINER {
                let (i, j) = (FINER * column + n % FINER, FINER * row + n / FINER);
                let place = j * self.size[0] + i;
                if self.depth[place] > f64::NEG_INFINITY {
                    covered += 1.0;
                    (0..3).for_each(|k| sum[k] += f64::from(self.colour[place][k]) / 255.0);
                }
            }
            bytes.extend(sum.map(|part| byte(part / f64::max(covered, 1.0))));
            bytes.push(byte(covered / (FINER * FINER) as f64));
        }
        Pixels { size, bytes }
    }
}

impl Pixels {
    /// Whether a pixel is at least half covered.
    fn covered(&self, column: usize, row: usize) -> bool {
        self.bytes[4 * (row * self.size[0] + column) + 3] >= 128
    }

    /// Draws the outline of another picture of the same size above this one.
    pub(crate) fn outline(&mut self, other: &Pixels) {
        let [width, height] = self.size;
        for row in 1..height.saturating_sub(1) {
            for column in 1..width.saturating_sub(1) {
                let near = [(0, 1), (2, 1), (1, 0), (1, 2)]
                    .iter()
                    .filter(|(i, j)| other.covered(column + i - 1, row + j - 1))
                    .count();
                if near > 0 && !other.covered(column, row) {
                    let at = 4 * (row * width + column);
                    self.bytes[at..at + 4].copy_from_slice(&[110, 118, 130, 255]);
                }
            }
        }
    }

    /// A PNG file.
    pub(crate) fn png(&self) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let [width, height] = self.size.map(|n| n as u32);
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        encoder.write_header()?.write_image_data(&self.bytes)?;
        Ok(bytes)
    }
}
