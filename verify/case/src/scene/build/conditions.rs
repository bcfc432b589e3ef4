//! Conditions, loads and obstacles of a case file → those of the solver.

use crate::scene::build::builder::Builder;
use crate::scene::build::data::near;
use crate::scene::format::{
    AmplitudeFormat, BeyondFormat, CaseFormat, DisplacementFormat, FluidFormat, FormulaFormat,
    ObstacleFormat, PrescribeFormat, RigidMotionFormat, RotationFormat, Triple,
};
use mtled::algebra::tensor::Vector3;
use mtled::geometry::{Field, Selector};
use mtled::problem::{
    Amplitude, BodyForce, Cavity, EssentialCondition, Fluid, Friction, Loads, Obstacle, Prescribed,
    Pressure, RigidMotion, RigidWay, Spring, Traction,
};

impl Builder<'_> {
    pub(crate) fn conditions(&mut self, rows: &[PrescribeFormat]) -> Vec<EssentialCondition> {
        let rows = rows.iter().enumerate();
        rows.filter_map(|(n, row)| self.condition(&format!("prescribe[{n}]"), row)).collect()
    }

    fn condition(&mut self, key: &str, row: &PrescribeFormat) -> Option<EssentialCondition> {
        let part = self.selector(&format!("{key}.where"), &row.part);
        let amplitude = self.amplitude(&format!("{key}.amplitude"), &row.amplitude);
        if let Some(release) = row.release {
            self.positive(&format!("{key}.release"), release);
        }
        let given = [
            ("displacement", row.displacement.is_some()),
            ("rotation", row.rotation.is_some()),
            ("formula", row.formula.is_some()),
            ("data", row.data.is_some()),
        ];
        let mut given = given.into_iter().filter(|(_, given)| *given).map(|(name, _)| name);
        let Some(first) = given.next() else {
            let message =
                "prescribes nothing; it needs a displacement, a rotation, a formula or data";
            self.mistake(key, message);
            return None;
        };
        if let Some(second) = given.next() {
            let message = format!("cannot be given together with {first}; remove one");
            self.mistake(&format!("{key}.{second}"), message);
            return None;
        }
        let at = format!("{key}.{first}");
        let (mut part, mut prescribed) = (part, None);
        if let Some(displacement) = &row.displacement {
            prescribed = Some(self.displacement(&at, displacement));
        } else if let Some(rotation) = &row.rotation {
            prescribed = Some(self.rotation(&at, rotation));
        } else if let Some(formula) = &row.formula {
            prescribed = self.formula(&at, formula).map(Prescribed::Field);
        } else if let Some(data) = &row.data {
            let scattered = self.displacements(&at, data)?;
            if data.beyond == BeyondFormat::Free {
                part = part.map(|part| Selector::Intersection(vec![part, near(&scattered)]));
            }
            prescribed = Some(Prescribed::Field(Field::Scattered(scattered)));
        }
        let prescribed = prescribed?;
        let (name, extent, release) = (row.name.clone(), row.of.into(), row.release);
        Some(EssentialCondition { name, extent, part: part?, prescribed, amplitude, release })
    }

    fn displacement(&mut self, key: &str, format: &DisplacementFormat) -> Prescribed {
        let components = [format.x, format.y, format.z];
        if components.iter().all(Option::is_none) {
            self.mistake(key, "has no component; give at least one of x, y, z");
        }
        if self.is_plane() && format.z.is_some() {
            let message = "there is no motion along z in plane strain; remove it";
            self.mistake(&format!("{key}.z"), message);
        }
        Prescribed::Displacement(components)
    }

    fn rotation(&mut self, key: &str, format: &RotationFormat) -> Prescribed {
        let (point, axis) = self.axis(key, format);
        Prescribed::Rotation { point, axis, angle: format.angle }
    }

    /// A point on the axis of a rotation \[m\], and its direction.
    fn axis(&mut self, key: &str, format: &RotationFormat) -> (Vector3, Vector3) {
        let axis = self.direction(&format!("{key}.axis"), &format.axis);
        if self.is_plane() && (axis.x != 0.0 || axis.y != 0.0) {
            let message = format!("is {:?}; in plane strain it must be along z", format.axis);
            self.mistake(&format!("{key}.axis"), message);
        }
        (Vector3::from(format.point), axis)
    }

    pub(super) fn amplitude(&mut self, key: &str, format: &AmplitudeFormat) -> Amplitude {
        let amplitude = match format {
            AmplitudeFormat::Constant => Amplitude::Constant,
            AmplitudeFormat::Linear { duration } => Amplitude::Linear { duration: *duration },
            AmplitudeFormat::Smooth { duration } => Amplitude::Smooth { duration: *duration },
            AmplitudeFormat::Table(rows) => Amplitude::Table(rows.clone()),
        };
        self.refused(amplitude.check(), |field| format!("{key}.{field}"));
        amplitude
    }

    pub(crate) fn loads(&mut self, format: &CaseFormat) -> Loads {
        let mut loads = Loads::default();
        for (n, row) in format.body_force.iter().enumerate() {
            let key = format!("body_force[{n}]");
            let amplitude = self.amplitude(&format!("{key}.amplitude"), &row.amplitude);
            let acceleration = self.vector(&key, "acceleration", (row.acceleration, &row.formula));
            let part = match &row.part {
                None => Some(Selector::All),
                Some(part) => self.selector(&format!("{key}.where"), part),
            };
            let found = part.zip(acceleration);
            loads.body_forces.extend(found.map(|(part, acceleration)| BodyForce {
                part,
                acceleration,
                amplitude,
            }));
        }
        for (n, row) in format.traction.iter().enumerate() {
            let key = format!("traction[{n}]");
            let amplitude = self.amplitude(&format!("{key}.amplitude"), &row.amplitude);
            let part = self.selector(&format!("{key}.where"), &row.part);
            let traction = self.vector(&key, "traction", (row.traction, &row.formula));
            let (name, found) = (row.name.clone(), part.zip(traction));
            loads.tractions.extend(found.map(|(part, traction)| Traction {
                name,
                part,
                traction,
                amplitude,
            }));
        }
        for (n, row) in format.pressure.iter().enumerate() {
            let key = format!("pressure[{n}]");
            let amplitude = self.amplitude(&format!("{key}.amplitude"), &row.amplitude);
            let part = self.selector(&format!("{key}.where"), &row.part);
            let (name, pressure) = (row.name.clone(), row.pressure);
            loads.pressures.extend(part.map(|part| Pressure { name, part, pressure, amplitude }));
        }
        self.springs(format, &mut loads);
        self.cavities(format, &mut loads);
        for (n, row) in format.initial_velocity.iter().enumerate() {
            let key = format!("initial_velocity[{n}]");
            let part = self.selector(&format!("{key}.where"), &row.part);
            let velocity = self.vector(&key, "velocity", (row.velocity, &row.formula));
            loads.initial_velocities.extend(part.zip(velocity));
        }
        loads
    }

    fn springs(&mut self, format: &CaseFormat, loads: &mut Loads) {
        for (n, row) in format.spring.iter().enumerate() {
            let key = format!("spring[{n}]");
            let part = self.selector(&format!("{key}.where"), &row.part);
            let (name, normal, tangential) = (row.name.clone(), row.normal, row.tangential);
            let spring = part.map(|part| Spring { name, part, normal, tangential });
            let mistakes = spring.as_ref().map_or(Vec::new(), Spring::check);
            self.refused(mistakes, |field| format!("{key}.{field}"));
            loads.springs.extend(spring);
        }
    }

    fn cavities(&mut self, format: &CaseFormat, loads: &mut Loads) {
        for (n, row) in format.cavity.iter().enumerate() {
            let key = format!("cavity[{n}]");
            let part = self.selector(&format!("{key}.where"), &row.part);
            let fluid = row.fluid.as_ref().map(|row| self.fluid(&format!("{key}.fluid"), row));
            let (name, opening) = (row.name.clone(), row.opening.map(Vector3::from));
            loads.cavities.extend(part.map(|part| Cavity { name, part, opening, fluid }));
        }
    }

    fn fluid(&mut self, key: &str, row: &FluidFormat) -> Fluid {
        let amplitude = self.amplitude(&format!("{key}.amplitude"), &row.amplitude);
        let fluid = Fluid { bulk_modulus: row.bulk_modulus, inflow: row.inflow, amplitude };
        self.refused(fluid.check(), |field| format!("{key}.{field}"));
        fluid
    }

    /// A vector that is uniform, under the key `name`, or a formula.
    fn vector(
        &mut self,
        key: &str,
        name: &str,
        given: (Option<Triple>, &Option<FormulaFormat>),
    ) -> Option<Field> {
        match given {
            (Some(uniform), None) => {
                self.no_z(&format!("{key}.{name}"), &uniform);
                Some(Field::Uniform(uniform.into()))
            }
            (None, Some(formula)) => self.formula(&format!("{key}.formula"), formula),
            (None, None) => {
                self.mistake(&format!("{key}.{name}"), "is missing; give it, or a formula");
                None
            }
            (Some(_), Some(_)) => {
                let message = format!("stands beside {name}; give one of them");
                self.mistake(&format!("{key}.formula"), message);
                None
            }
        }
    }

    /// How an obstacle moves.
    fn rigid_motion(&mut self, key: &str, row: &RigidMotionFormat) -> Option<RigidMotion> {
        let amplitude = self.amplitude(&format!("{key}.amplitude"), &row.amplitude);
        let way = match (&row.displacement, &row.rotation) {
            (Some(displacement), None) => {
                self.no_z(&format!("{key}.displacement"), displacement);
                RigidWay::Translation((*displacement).into())
            }
            (None, Some(format)) => {
                let (point, axis) = self.axis(&format!("{key}.rotation"), format);
                RigidWay::Rotation { point, axis, angle: format.angle }
            }
            (None, None) => {
                self.mistake(key, "does not say how; it needs a displacement or a rotation");
                return None;
            }
            (Some(_), Some(_)) => {
                let message = "stands beside displacement; make it a motion of its own";
                self.mistake(&format!("{key}.rotation"), message);
                return None;
            }
        };
        Some(RigidMotion { way, amplitude })
    }

    pub(crate) fn obstacles(&mut self, rows: &[ObstacleFormat]) -> Vec<Obstacle> {
        let obstacle = |(n, row): (usize, &ObstacleFormat)| {
            let key = format!("obstacle[{n}]");
            let friction = Friction::from(row.friction);
            self.refused(friction.check(), |field| format!("{key}.friction.{field}"));
            let motions = row.motion.iter().enumerate();
            let motions: Vec<RigidMotion> = motions
                .filter_map(|(m, row)| self.rigid_motion(&format!("{key}.motion[{m}]"), row))
                .collect();
            Some(Obstacle {
                name: row.name.clone(),
                shape: self.solid(&format!("{key}.shape"), &row.shape)?,
                offset: row.offset,
                side: row.side.into(),
                friction,
                motions,
            })
        };
        rows.iter().enumerate().filter_map(obstacle).collect()
    }
}
