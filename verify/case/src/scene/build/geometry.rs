//! Shapes and selectors of a case file → those of the solver.

use crate::scene::build::builder::Builder;
use crate::scene::format::{SelectorFormat, ShapeFormat, UnitFormat};
use mtled::algebra::tensor::Vector3;
use mtled::geometry::{LabelField, LabelMap, Mended, Selector, Shape, Surface};
use mtled::problem::Dimension;
use mtled_io::files::surface::SurfaceFile;
use mtled_io::files::{self, LengthUnit};
use std::path::Path;
use std::sync::Arc;

/// File of a label map, its unit if it is overridden, and the layer of overlapping segments.
type MapOf<'a> = (&'a Path, Option<UnitFormat>, Option<usize>);

impl Builder<'_> {
    /// The solid that deforms; its label map becomes that of label selectors.
    pub(crate) fn read_body(&mut self, format: &ShapeFormat) {
        let key = "geometry.shape";
        let Some(body) = self.sound_shape(key, format) else { return };
        let section = body.validate_body().and_then(|()| body.section(&self.dimension));
        self.section = section.map_err(|error| self.mistake(key, error)).ok();
        self.body_labels = first_labels(&body);
        self.body = Some(body);
    }

    /// A sound shape, in plane strain its cross-section.
    pub(crate) fn solid(&mut self, key: &str, format: &ShapeFormat) -> Option<Shape> {
        let shape = self.sound_shape(key, format)?;
        shape.section(&self.dimension).map_err(|error| self.mistake(key, error)).ok()
    }

    /// A shape that the solver accepts.
    fn sound_shape(&mut self, key: &str, format: &ShapeFormat) -> Option<Shape> {
        let before = self.count();
        let shape = self.shape(key, format).filter(|_| self.count() == before)?;
        shape.validate().map_err(|error| self.mistake(key, error)).ok()?;
        Some(shape)
    }

    /// A shape, or `None` and a mistake.
    fn shape(&mut self, key: &str, format: &ShapeFormat) -> Option<Shape> {
        match format {
            ShapeFormat::Box { min, max } => Some(self.box_shape(&format!("{key}.box"), min, max)),
            ShapeFormat::Cylinder { base, axis, radius, height } => {
                self.positive(&format!("{key}.cylinder.radius"), *radius);
                self.positive(&format!("{key}.cylinder.height"), *height);
                let axis = self.direction(&format!("{key}.cylinder.axis"), axis);
                let base = Vector3::from(*base);
                Some(Shape::Cylinder { base, axis, radius: *radius, height: *height })
            }
            ShapeFormat::Sphere { centre, radius } => {
                self.positive(&format!("{key}.sphere.radius"), *radius);
                Some(Shape::Sphere { centre: Vector3::from(*centre), radius: *radius })
            }
            ShapeFormat::Ellipsoid { centre, radii } => {
                for (n, radius) in radii.iter().enumerate() {
                    self.positive(&format!("{key}.ellipsoid.radii[{n}]"), *radius);
                }
                let (centre, radii) = (Vector3::from(*centre), Vector3::from(*radii));
                Some(Shape::Ellipsoid { centre, radii })
            }
            ShapeFormat::Polygon { points, z } => {
                Some(self.polygon(&format!("{key}.polygon"), points, z))
            }
            ShapeFormat::HalfSpace { point, normal } => {
                let normal = self.direction(&format!("{key}.half_space.normal"), normal);
                Some(Shape::HalfSpace { point: Vector3::from(*point), normal })
            }
            ShapeFormat::Union(parts) => {
                Some(Shape::Union(self.members(&format!("{key}.union"), parts)?))
            }
            ShapeFormat::Intersection(parts) => {
                Some(Shape::Intersection(self.members(&format!("{key}.intersection"), parts)?))
            }
            ShapeFormat::Difference(first, second) => {
                let first = self.shape(&format!("{key}.difference[0]"), first);
                let second = self.shape(&format!("{key}.difference[1]"), second);
                Some(first?.without(second?))
            }
            ShapeFormat::Stl { file, unit } => self.surface(&format!("{key}.stl"), file, *unit),
            ShapeFormat::LabelMap { file, labels, unit, layer, smoothing } => {
                let smoothing = smoothing.unwrap_or(LabelField::SMOOTHING);
                let of = (file.as_path(), *unit, *layer);
                self.labels(&format!("{key}.label_map"), of, labels, smoothing)
            }
        }
    }

    fn box_shape(&mut self, key: &str, min: &[f64; 3], max: &[f64; 3]) -> Shape {
        for n in 0..3 {
            if min[n] >= max[n] {
                let message =
                    format!("is {}; it must be larger than min, which is {}", max[n], min[n]);
                self.mistake(&format!("{key}.max[{n}]"), message);
            }
        }
        Shape::Box { min: Vector3::from(*min), max: Vector3::from(*max) }
    }

    fn polygon(&mut self, key: &str, points: &[[f64; 2]], z: &[f64; 2]) -> Shape {
        if points.len() < 3 {
            let message = format!("has {} corners; a polygon needs at least 3", points.len());
            self.mistake(&format!("{key}.points"), message);
        }
        if z[0] >= z[1] {
            let message = format!("is [{}, {}]; the second must be larger", z[0], z[1]);
            self.mistake(&format!("{key}.z"), message);
        }
        Shape::Polygon { points: points.to_vec().into(), z: (z[0], z[1]) }
    }

    fn members(&mut self, key: &str, parts: &[ShapeFormat]) -> Option<Vec<Shape>> {
        self.refuse_if(parts.is_empty(), key, "is empty; it needs at least one shape");
        let shapes: Vec<Option<Shape>> = (parts.iter().enumerate())
            .map(|(n, part)| self.shape(&format!("{key}[{n}]"), part))
            .collect();
        shapes.into_iter().collect()
    }

    /// A label map file, read once.
    fn map(&mut self, key: &str, (file, unit, layer): MapOf) -> Option<Arc<LabelMap>> {
        let path = self.resolve(file);
        if let Some(map) = self.maps.get(&(path.clone(), unit, layer)) {
            return Some(map.clone());
        }
        match files::read_label_map(&path, unit.map(LengthUnit::from), layer) {
            Ok(read) => {
                self.has_read(key, file, &read.files, &read.notes);
                let map = Arc::new(read.map);
                self.maps.insert((path, unit, layer), map.clone());
                Some(map)
            }
            Err(error) => {
                self.mistake(key, error);
                None
            }
        }
    }

    fn labels(&mut self, key: &str, of: MapOf, labels: &[u32], smoothing: f64) -> Option<Shape> {
        let map = self.map(&format!("{key}.file"), of)?;
        let before = self.count();
        if labels.is_empty() {
            self.mistake(&format!("{key}.labels"), "is empty; it needs at least one label");
        }
        for (n, label) in labels.iter().enumerate() {
            self.known_label(&format!("{key}.labels[{n}]"), *label, &map);
        }
        let largest = LabelField::MOST_SMOOTHING;
        if !(smoothing > 0.0 && smoothing <= largest) {
            let wanted =
                format!("must be above 0 and at most {largest} voxels, but is {smoothing}");
            self.mistake(&format!("{key}.smoothing"), wanted);
        }
        if self.count() > before {
            return None;
        }
        self.field(key, map, labels, smoothing).map(Shape::Labels)
    }

    /// The solid of some labels, made once.
    fn field(
        &mut self,
        key: &str,
        map: Arc<LabelMap>,
        labels: &[u32],
        smoothing: f64,
    ) -> Option<Arc<LabelField>> {
        let same = |made: &&Arc<LabelField>| {
            Arc::ptr_eq(made.map(), &map)
                && made.labels() == labels
                && made.smoothing() == smoothing
        };
        if let Some(made) = self.fields.iter().find(same) {
            return Some(made.clone());
        }
        let made = match self.dimension {
            Dimension::Three => LabelField::new(map, labels, smoothing),
            Dimension::PlaneStrain { z, .. } => LabelField::section(map, labels, smoothing, z),
        };
        let made = made.map_err(|error| self.mistake(key, error)).ok()?;
        self.fields.push(Arc::new(made));
        self.fields.last().cloned()
    }

    fn known_label(&mut self, key: &str, label: u32, map: &LabelMap) {
        if label == 0 {
            self.mistake(key, "is 0, which means outside; labels of the body are larger");
        } else if !map.labels.contains(&label) {
            let mut present: Vec<u32> = map.labels.iter().copied().filter(|&l| l > 0).collect();
            present.sort_unstable();
            present.dedup();
            let swapped = if present.iter().all(|label| label % 256 == 0) {
                "; if they are no multiples of 256 where they come from, the byte order of \
                         its header is wrong"
            } else {
                ""
            };
            present.truncate(20);
            let message = format!("label {label} does not occur; the map has {present:?}{swapped}");
            self.mistake(key, message);
        }
    }

    /// A part of the body, or `None` and a mistake.
    pub(crate) fn selector(&mut self, key: &str, format: &SelectorFormat) -> Option<Selector> {
        match format {
            SelectorFormat::All => Some(Selector::All),
            SelectorFormat::Plane { point, normal, tolerance } => {
                let normal = self.direction(&format!("{key}.plane.normal"), normal);
                let tolerance = self.tolerance(&format!("{key}.plane"), *tolerance);
                Some(Selector::Plane { point: Vector3::from(*point), normal, tolerance })
            }
            SelectorFormat::HalfSpace { point, normal, tolerance } => {
                let normal = self.direction(&format!("{key}.half_space.normal"), normal);
                let shape = Shape::HalfSpace { point: Vector3::from(*point), normal };
                Some(self.inside(&format!("{key}.half_space"), shape, *tolerance))
            }
            SelectorFormat::Box { min, max, tolerance } => {
                let shape = self.box_shape(&format!("{key}.box"), min, max);
                Some(self.inside(&format!("{key}.box"), shape, *tolerance))
            }
            SelectorFormat::Sphere { centre, radius, tolerance } => {
                self.positive(&format!("{key}.sphere.radius"), *radius);
                let shape = Shape::Sphere { centre: Vector3::from(*centre), radius: *radius };
                Some(self.inside(&format!("{key}.sphere"), shape, *tolerance))
            }
            SelectorFormat::Shape(shape) => {
                let key = format!("{key}.shape");
                let shape = self.sound_shape(&key, shape)?;
                Some(self.inside(&key, shape, None))
            }
            SelectorFormat::Label { value, file, unit, layer } => {
                let of = file.as_deref().map(|file| (file, *unit, *layer));
                let message = "goes with `file`; without it the layer is that of the body";
                let key = format!("{key}.label");
                let is_sound = layer.is_none() || of.is_some();
                self.refuse_if(!is_sound, &format!("{key}.layer"), message);
                self.label(&key, *value, of)
            }
            SelectorFormat::Facing { direction, angle } => {
                let key = format!("{key}.facing");
                let direction = self.direction(&format!("{key}.direction"), direction);
                let message = format!("is {angle}; it must lie in 0 < angle < π, in radians");
                let is_sound = *angle > 0.0 && *angle < std::f64::consts::PI;
                self.refuse_if(!is_sound, &format!("{key}.angle"), message);
                let body = Box::new(self.section.clone()?);
                Some(Selector::Facing { body, direction, angle: *angle })
            }
            SelectorFormat::Union(parts) => {
                self.selectors(&format!("{key}.union"), parts).map(Selector::Union)
            }
            SelectorFormat::Intersection(parts) => {
                self.selectors(&format!("{key}.intersection"), parts).map(Selector::Intersection)
            }
            SelectorFormat::Not(part) => {
                let part = self.selector(&format!("{key}.not"), part)?;
                Some(Selector::Not(Box::new(part)))
            }
        }
    }

    fn inside(&mut self, key: &str, shape: Shape, tolerance: Option<f64>) -> Selector {
        Selector::Inside { shape, tolerance: self.tolerance(key, tolerance) }
    }

    fn tolerance(&mut self, key: &str, stated: Option<f64>) -> f64 {
        self.not_negative(&format!("{key}.tolerance"), stated.unwrap_or(0.0));
        stated.unwrap_or(self.tolerance)
    }

    fn selectors(&mut self, key: &str, parts: &[SelectorFormat]) -> Option<Vec<Selector>> {
        self.refuse_if(parts.is_empty(), key, "is empty; it needs at least one selector");
        let read: Vec<Option<Selector>> = (parts.iter().enumerate())
            .map(|(n, part)| self.selector(&format!("{key}[{n}]"), part))
            .collect();
        read.into_iter().collect()
    }

    fn label(&mut self, key: &str, label: u32, of: Option<MapOf>) -> Option<Selector> {
        let map = match of {
            Some(of) => self.map(&format!("{key}.file"), of)?,
            None => match &self.body_labels {
                Some(field) => field.map().clone(),
                None => {
                    // A body that could not be read may be one.
                    let message = "needs a `file`, since the body is not made of a label map";
                    self.refuse_if(self.body.is_some(), key, message);
                    return None;
                }
            },
        };
        self.known_label(&format!("{key}.value"), label, &map);
        Some(Selector::Label { map: self.filled(map), label })
    }

    /// A map that is that of the body with the labels of the body beside its voxels, others as they are.
    fn filled(&mut self, map: Arc<LabelMap>) -> Arc<LabelMap> {
        match &self.body_labels {
            Some(field)
                if Arc::ptr_eq(field.map(), &map)
                    && self.body.as_ref().is_some_and(lies_in_labels) =>
            {
                let fill = || Arc::new(map.filled(field.labels()));
                self.filled_map.get_or_insert_with(fill).clone()
            }
            _ => map,
        }
    }

    /// A closed surface from a file.
    fn surface(&mut self, key: &str, file: &Path, unit: UnitFormat) -> Option<Shape> {
        let path = self.resolve(file);
        let key = format!("{key}.file");
        let read = files::surface::read(&path, unit.into());
        let SurfaceFile { surface, notes } =
            read.map_err(|error| self.mistake(&key, error)).ok()?;
        self.notes.extend(notes.iter().map(|note| format!("{}: {note}", file.display())));
        self.hash_file(&key, &path);
        let mended = Surface::mended(surface.vertices, surface.triangles);
        let Mended { surfaces, notes } = mended.map_err(|error| self.mistake(&key, error)).ok()?;
        self.notes.extend(notes.iter().map(|note| format!("{}: {note}", file.display())));
        let mut shapes: Vec<Shape> =
            surfaces.into_iter().map(|surface| Shape::Surface(Arc::new(surface))).collect();
        match shapes.len() {
            1 => shapes.pop(),
            _ => Some(Shape::Union(shapes)),
        }
    }
}

/// The first solid of labels in a shape.
fn first_labels(shape: &Shape) -> Option<Arc<LabelField>> {
    match shape {
        Shape::Labels(field) => Some(field.clone()),
        Shape::Union(parts) | Shape::Intersection(parts) => parts.iter().find_map(first_labels),
        Shape::Difference(first, second) => first_labels(first).or_else(|| first_labels(second)),
        _ => None,
    }
}

/// Whether a shape is a solid of labels, or a part of one.
fn lies_in_labels(shape: &Shape) -> bool {
    match shape {
        Shape::Labels(_) => true,
        Shape::Intersection(parts) => parts.iter().any(lies_in_labels),
        Shape::Difference(first, _) => lies_in_labels(first),
        _ => false,
    }
}

/// Whether the lengths of a shape were read from a file.
pub(crate) fn comes_from_a_file(shape: &Shape) -> bool {
    match shape {
        Shape::Labels(_) | Shape::Surface(_) => true,
        Shape::Union(parts) | Shape::Intersection(parts) => parts.iter().any(comes_from_a_file),
        Shape::Difference(first, second) => comes_from_a_file(first) || comes_from_a_file(second),
        _ => false,
    }
}
