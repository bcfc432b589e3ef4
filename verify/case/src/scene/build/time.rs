//! Time, probes and output of a case file.

use crate::scene::build::builder::Builder;
use crate::scene::case::{Outputs, Probe, ProbeKind, lattice, place};
use crate::scene::format::{
    CaseFormat, LatticeFormat, MethodFormat, OutputFormat, PointsFormat, ProbeFormat, SolverFormat,
    TimeFormat,
};
use mtled::algebra::tensor::Vector3;
use mtled::problem::{Dimension, Motion, Newton, Relaxation, StepControl};
use mtled_io::files::LengthUnit;
use mtled_io::files::points::{Landmark, read_named_points};
use std::collections::HashSet;

/// The most positions of a probe, samples of its history and frames of the fields.
const MOST_POSITIONS: f64 = 1e6;
const MOST_SAMPLES: f64 = 1e6;
const MOST_FRAMES: f64 = 1e5;
/// Of the size of a body, in distances from it \[–\].
const ROUND_OFF: f64 = 1e-9;
/// Distance of a probe from the body over the spacing from which it is said \[–\]: a field changes
/// by less than its error bar over a smaller one.
const EXTRAPOLATED: f64 = 0.05;

impl Builder<'_> {
    pub(crate) fn motion(&mut self, format: &TimeFormat) -> Motion {
        self.keys_of_method(format);
        let motion = match format.method {
            MethodFormat::Dynamic => {
                if format.end.is_none() {
                    self.mistake("time.end", "is missing; method = \"dynamic\" needs it");
                }
                let (end, damping) = (format.end.unwrap_or(1.0), format.damping.unwrap_or(0.0));
                Motion::Dynamic { end, step: step(format), damping }
            }
            MethodFormat::Static => match format.solver {
                Some(SolverFormat::Newton) => self.newton(format),
                Some(SolverFormat::Relaxation) => Motion::Relaxed(relaxation(format)),
                None | Some(SolverFormat::Auto) => Motion::Static(relaxation(format)),
            },
        };
        self.refused(motion.check(), |field| match field {
            "step.fixed" => "time.fixed_step".into(),
            _ => format!("time.{}", field.trim_start_matches("step.")),
        });
        motion
    }

    fn newton(&mut self, format: &TimeFormat) -> Motion {
        let keys = [
            ("load_steps", format.load_steps.is_some()),
            ("max_steps", format.max_steps.is_some()),
            ("safety_factor", format.safety_factor.is_some()),
            ("reevaluate_every", format.reevaluate_every.is_some()),
            ("fixed_step", format.fixed_step.is_some()),
        ];
        for (name, _) in keys.into_iter().filter(|(_, given)| *given) {
            let message = "does not belong to solver = \"newton\", which takes no time steps";
            self.mistake(&format!("time.{name}"), message);
        }
        let preset = Newton::default();
        Motion::Newton(Newton {
            load_end: format.load_end.unwrap_or(preset.load_end),
            tolerance: format.tolerance.unwrap_or(preset.tolerance),
            parts: format.parts.unwrap_or(preset.parts),
        })
    }

    /// Refuses keys that belong to the other method.
    fn keys_of_method(&mut self, format: &TimeFormat) {
        let is_static = format.method == MethodFormat::Static;
        let keys = [
            ("end", format.end.is_some(), !is_static),
            ("damping", format.damping.is_some(), !is_static),
            ("mass_scaling", format.mass_scaling.is_some(), !is_static),
            ("solver", format.solver.is_some(), is_static),
            ("load_end", format.load_end.is_some(), is_static),
            ("load_steps", format.load_steps.is_some(), is_static),
            ("tolerance", format.tolerance.is_some(), is_static),
            ("max_steps", format.max_steps.is_some(), is_static),
            ("parts", format.parts.is_some(), is_static),
        ];
        let other = if is_static { "dynamic" } else { "static" };
        for (name, given, belongs) in keys {
            if given && !belongs {
                self.mistake(&format!("time.{name}"), format!("belongs to method = \"{other}\""));
            }
        }
    }

    pub(crate) fn probes(&mut self, format: &CaseFormat) -> Vec<Probe> {
        let regions: Vec<&str> = if format.region.is_empty() {
            vec!["body"]
        } else {
            format.region.iter().map(|region| region.name.as_str()).collect()
        };
        let spacing = format.discretisation.spacing.filter(|spacing| *spacing > 0.0);
        let mut probes = Vec::new();
        for (n, row) in format.probe.iter().enumerate() {
            let key = format!("probe[{n}]");
            let mut read = match (&row.points, &row.point, &row.lattice, &row.centre_of_mass) {
                (Some(points), None, None, None) => self.points(&key, &row.name, points),
                _ => self.probe(&key, row, &regions).into_iter().collect(),
            };
            self.leave_out(&mut read);
            if let Some(spacing) = spacing {
                self.in_the_body(&key, &read, 0.5 * spacing);
            }
            probes.extend(read);
        }
        if let Some(spacing) = spacing {
            self.note_extrapolated(&probes, spacing);
        }
        probes
    }

    /// A probe for each point of a file.
    fn points(&mut self, key: &str, name: &str, format: &PointsFormat) -> Vec<Probe> {
        let (key, path) = (format!("{key}.points.file"), self.resolve(&format.file));
        let points = match read_named_points(&path, format.unit.map(LengthUnit::from)) {
            Ok(points) => points,
            Err(error) => {
                self.mistake(&key, error);
                return Vec::new();
            }
        };
        self.hash_file(&key, &path);
        self.at_most(&key, "positions", points.len() as f64, MOST_POSITIONS);
        let mut names = HashSet::new();
        let repeated = points.iter().find(|point| !names.insert(point.name.as_str()));
        if let Some(point) = repeated {
            self.mistake(&key, format!("has several points called `{}`", point.name));
        }
        self.refuse_if(names.contains(""), &key, "has a point without a name");
        let probe = |point: &Landmark| Probe {
            name: format!("{name}.{}", point.name),
            kind: ProbeKind::Point(self.in_the_plane(&point.position.into())),
        };
        points.iter().map(probe).collect()
    }

    fn probe(&mut self, key: &str, row: &ProbeFormat, regions: &[&str]) -> Option<Probe> {
        let one = row.points.is_none();
        let kind = match (&row.point, &row.lattice, &row.centre_of_mass) {
            (Some(point), None, None) if one => ProbeKind::Point(self.in_the_plane(point)),
            (None, Some(lattice), None) if one => {
                self.lattice(&format!("{key}.lattice"), lattice)?
            }
            (None, None, Some(region)) if one => {
                if !regions.contains(&region.as_str()) {
                    let key = format!("{key}.centre_of_mass");
                    self.unknown_name(&key, "region", region, regions);
                }
                ProbeKind::CentreOfMass { region: region.clone() }
            }
            _ => {
                self.mistake(key, "needs exactly one of point, points, lattice, centre_of_mass");
                return None;
            }
        };
        Some(Probe { name: row.name.clone(), kind })
    }

    /// Leaves out the positions of lattices that lie outside the body, and round-off of its size
    /// does not count. The spacing of the nodes has no say, so that clouds of a study record the
    /// same positions. A lattice without any in the body is refused like a point.
    fn leave_out(&self, probes: &mut [Probe]) {
        let Some(body) = &self.section else { return };
        let size = body.bounding_box().map_or(0.0, |(lower, upper)| {
            (upper - lower).iter().filter(|edge| edge.is_finite()).fold(0.0, |a, b| b.max(a))
        });
        for probe in probes {
            let ProbeKind::Lattice { positions, left_out } = &mut probe.kind else { continue };
            let inside = |position: &&Vector3| body.signed_distance(position) <= ROUND_OFF * size;
            let kept: Vec<Vector3> = positions.iter().filter(inside).copied().collect();
            if !kept.is_empty() {
                *left_out = positions.len() - kept.len();
                *positions = kept;
            }
        }
    }

    /// Refuses positions further outside the body than `margin` \[m\], where
    /// there is no displacement to record.
    fn in_the_body(&mut self, key: &str, probes: &[Probe], margin: f64) {
        let Some(body) = self.section.clone() else { return };
        let mut outside = probes.iter().filter_map(|probe| {
            let far = |position: Vector3| {
                let distance = body.signed_distance(&position);
                (distance > margin).then_some((&probe.name, position, distance))
            };
            probe.kind.positions().into_iter().find_map(far)
        });
        let Some((name, position, distance)) = outside.next() else { return };
        let place_of = position.iter().map(|x| in_few_digits(*x)).collect::<Vec<_>>().join(", ");
        let distance =
            if distance < FAR { format!("{distance:.3}") } else { in_few_digits(distance) };
        let found = format!("({place_of}) m lies {distance} m outside the body");
        let message = match (probes.len(), outside.count()) {
            (1, _) => found,
            (_, 0) => format!("`{name}` at {found}"),
            (all, more) => format!("`{name}` at {found}, and so do {more} more of {all}"),
        };
        self.mistake(key, message + &place(&body));
    }

    /// Says which points lie outside the body by so much that their displacement is extrapolated.
    fn note_extrapolated(&mut self, probes: &[Probe], spacing: f64) {
        let Some(body) = self.section.clone() else { return };
        let points = probes.iter().filter(|probe| matches!(probe.kind, ProbeKind::Point(_)));
        let distance = |probe: &Probe| {
            let positions = probe.kind.positions();
            positions.iter().map(|position| body.signed_distance(position)).fold(0.0, f64::max)
        };
        let outside: Vec<(&str, f64)> = points
            .map(|probe| (probe.name.as_str(), distance(probe)))
            .filter(|(_, far)| *far > EXTRAPOLATED * spacing && *far <= 0.5 * spacing)
            .collect();
        let Some((name, far)) = outside.iter().max_by(|a, b| a.1.total_cmp(&b.1)) else { return };
        let which = match outside.len() {
            1 => format!("probe `{name}` lies"),
            count => format!("{count} probes lie outside the body, `{name}` farthest:"),
        };
        self.notes.push(format!(
            "{which} {far:.3e} m ({:.2} spacings) outside the body: its displacement is extrapolated \
             and belongs to no material; move it onto the body",
            far / spacing
        ));
    }

    fn lattice(&mut self, key: &str, format: &LatticeFormat) -> Option<ProbeKind> {
        for n in 0..3 {
            let (min, max) = (format.min[n], format.max[n]);
            if max < min {
                let message = format!("is {max}; it must not be smaller than min, which is {min}");
                self.mistake(&format!("{key}.max[{n}]"), message);
            }
            self.at_least_one(&format!("{key}.counts[{n}]"), format.counts[n]);
        }
        let count: f64 = format.counts.iter().map(|&n| n as f64).product();
        self.at_most(&format!("{key}.counts"), "positions", count, MOST_POSITIONS);
        if self.is_plane() && format.counts[2] != 1 {
            self.mistake(&format!("{key}.counts[2]"), "must be 1 in plane strain");
        }
        let (min, max) = (self.in_the_plane(&format.min), self.in_the_plane(&format.max));
        (count <= MOST_POSITIONS).then(|| ProbeKind::Lattice {
            positions: lattice(&min, &max, &format.counts),
            left_out: 0,
        })
    }

    /// A point, in plane strain moved along z into the cross-section.
    fn in_the_plane(&self, point: &[f64; 3]) -> Vector3 {
        match self.dimension {
            Dimension::Three => Vector3::from(*point),
            Dimension::PlaneStrain { z, .. } => Vector3::new(point[0], point[1], z),
        }
    }

    pub(crate) fn outputs(&mut self, format: &OutputFormat, time: &TimeFormat) -> Outputs {
        let times = format.times.clone().unwrap_or_default();
        let states = format.states.clone().unwrap_or_default();
        let both = format.times.is_some() && format.frames.is_some();
        self.refuse_if(both, "output.times", "takes the place of output.frames: give one");
        self.check_times("output.times", format.times.as_deref(), time);
        self.check_times("output.states", format.states.as_deref(), time);
        let outputs = Outputs {
            // With one more for the end.
            frames: format.times.as_ref().map_or(format.frames.unwrap_or(20), |t| t.len() + 1),
            times,
            states,
            history: format.history.unwrap_or(200),
            moment_about: Vector3::from(format.moment_about.unwrap_or_default()),
            volumes: format.volumes,
        };
        self.at_least_one("output.history", outputs.history);
        self.at_most("output.history", "samples", outputs.history as f64, MOST_SAMPLES);
        self.at_most("output.frames", "frames", outputs.frames as f64, MOST_FRAMES);
        outputs
    }

    fn check_times(&mut self, key: &str, times: Option<&[f64]>, time: &TimeFormat) {
        let Some(times) = times else { return };
        self.refuse_if(times.is_empty(), key, "is empty; it needs at least one time");
        let is_static = matches!(time.method, MethodFormat::Static);
        self.refuse_if(
            is_static,
            key,
            "belongs to method = \"dynamic\"; a static run has no times",
        );
        let end = time.end.unwrap_or(f64::INFINITY);
        let mut before = 0.0;
        for (n, &at) in times.iter().enumerate() {
            let message = format!("is {at}; it must be larger than {before} and at most {end}");
            self.refuse_if(!(at > before && at <= end), &format!("{key}[{n}]"), message);
            before = at;
        }
    }
}

fn relaxation(format: &TimeFormat) -> Relaxation {
    let preset = Relaxation::default();
    Relaxation {
        load_end: format.load_end.unwrap_or(preset.load_end),
        load_steps: format.load_steps.unwrap_or(preset.load_steps),
        tolerance: format.tolerance.unwrap_or(preset.tolerance),
        max_steps: format.max_steps.unwrap_or(preset.max_steps),
        step: step(format),
        mass: preset.mass,
        parts: format.parts.unwrap_or(preset.parts),
    }
}

fn step(format: &TimeFormat) -> StepControl {
    let undamped = format.method == MethodFormat::Dynamic && format.damping.unwrap_or(0.0) == 0.0;
    let preset = if undamped { StepControl::UNDAMPED } else { StepControl::default() };
    StepControl {
        safety_factor: format.safety_factor.unwrap_or(preset.safety_factor),
        reevaluate_every: format.reevaluate_every.unwrap_or(preset.reevaluate_every),
        fixed: format.fixed_step,
        mass_scaling: format.mass_scaling.unwrap_or(preset.mass_scaling),
    }
}

/// Numbers from here on are written with an exponent.
const FAR: f64 = 1e9;

/// A number as it is written, and a large one without hundreds of zeros.
fn in_few_digits(x: f64) -> String {
    if x.abs() < FAR { x.to_string() } else { format!("{x:e}") }
}

#[cfg(test)]
mod tests {
    use crate::scene::parse_case;
    use std::path::Path;

    /// Notes on a block of 0.1 m and 0.02 m spacing with probes at these heights \[m\].
    fn notes(heights: &[f64]) -> Vec<String> {
        let mut text = r#"title = "block"
geometry.shape = { box = { min = [0.0, 0.0, 0.0], max = [0.1, 0.1, 0.1] } }
time.method = "static"
discretisation = { cloud = "regular", spacing = 0.02 }
[material.tissue]
law = "neo_hookean_log_j"
density = 1000.0
young_modulus = 3000.0
poisson_ratio = 0.3
[[prescribe]]
name = "ground"
of = "surface"
where = { plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0], tolerance = 1e-6 } }
displacement = { x = 0.0, y = 0.0, z = 0.0 }
"#
        .to_string();
        for (n, z) in heights.iter().enumerate() {
            text += &format!("[[probe]]\nname = \"p{n}\"\npoint = [0.05, 0.05, {z:?}]\n");
        }
        parse_case(&text, "block.toml", Path::new(".")).unwrap().notes
    }

    #[test]
    fn a_probe_outside_of_the_body_is_said_to_be_extrapolated_with_its_distance() {
        assert!(notes(&[0.1, 0.05, 0.1 + 1e-4]).is_empty());
        let found = notes(&[0.1, 0.104, 0.106]);
        assert_eq!(found.len(), 1);
        for part in ["2 probes", "`p2`", "6.000e-3 m (0.30 spacings)", "extrapolated"] {
            assert!(found[0].contains(part), "{part}: {}", found[0]);
        }
    }
}
