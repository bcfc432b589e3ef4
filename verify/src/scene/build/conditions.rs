//! Conditions, loads and obstacles of a case file → those of the solver.

use crate::scene::build::builder::Builder;
use crate::scene::build::field::near;
use crate::scene::format::{
    AmplitudeFormat, BeyondFormat, CaseFormat, DisplacementFormat, ObstacleFormat, PrescribeFormat,
    RotationFormat,
};
use mtled::algebra::tensor::Vector3;
use mtled::geometry::{Field, Selector};
use mtled::problem::{
    Amplitude, BodyForce, EssentialCondition, Loads, Obstacle, Prescribed, Pressure, Traction,
};

impl Builder<'_> {
    pub fn conditions(&mut self, rows: &[PrescribeFormat]) -> Vec<EssentialCondition> {
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
            let scattered = self.scattered(&at, data)?;
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
        let axis = self.direction(&format!("{key}.axis"), &format.axis);
        if self.is_plane() && (axis.x != 0.0 || axis.y != 0.0) {
            let message = format!("is {:?}; in plane strain it must be along z", format.axis);
            self.mistake(&format!("{key}.axis"), message);
        }
        Prescribed::Rotation { point: Vector3::from(format.point), axis, angle: format.angle }
    }

    fn amplitude(&mut self, key: &str, format: &AmplitudeFormat) -> Amplitude {
        let amplitude = match format {
            AmplitudeFormat::Constant => Amplitude::Constant,
            AmplitudeFormat::Linear { duration } => Amplitude::Linear { duration: *duration },
            AmplitudeFormat::Smooth { duration } => Amplitude::Smooth { duration: *duration },
            AmplitudeFormat::Table(rows) => Amplitude::Table(rows.clone()),
        };
        self.refused(amplitude.check(), |field| format!("{key}.{field}"));
        amplitude
    }

    pub fn loads(&mut self, format: &CaseFormat) -> Loads {
        let mut loads = Loads::default();
        for (n, row) in format.body_force.iter().enumerate() {
            let key = format!("body_force[{n}]");
            self.no_z(&format!("{key}.acceleration"), &row.acceleration);
            let amplitude = self.amplitude(&format!("{key}.amplitude"), &row.amplitude);
            let acceleration = Vector3::from(row.acceleration).into();
            let part = match &row.part {
                None => Some(Selector::All),
                Some(part) => self.selector(&format!("{key}.where"), part),
            };
            loads.body_forces.extend(part.map(|part| BodyForce { part, acceleration, amplitude }));
        }
        for (n, row) in format.traction.iter().enumerate() {
            let key = format!("traction[{n}]");
            self.no_z(&format!("{key}.traction"), &row.traction);
            let amplitude = self.amplitude(&format!("{key}.amplitude"), &row.amplitude);
            let part = self.selector(&format!("{key}.where"), &row.part);
            let (name, traction) = (row.name.clone(), Vector3::from(row.traction).into());
            loads.tractions.extend(part.map(|part| Traction { name, part, traction, amplitude }));
        }
        for (n, row) in format.pressure.iter().enumerate() {
            let key = format!("pressure[{n}]");
            let amplitude = self.amplitude(&format!("{key}.amplitude"), &row.amplitude);
            let part = self.selector(&format!("{key}.where"), &row.part);
            let (name, pressure) = (row.name.clone(), row.pressure);
            loads.pressures.extend(part.map(|part| Pressure { name, part, pressure, amplitude }));
        }
        for (n, row) in format.initial_velocity.iter().enumerate() {
            let key = format!("initial_velocity[{n}]");
            self.no_z(&format!("{key}.velocity"), &row.velocity);
            let part = self.selector(&format!("{key}.where"), &row.part);
            let velocity = Vector3::from(row.velocity);
            loads.initial_velocities.extend(part.map(|part| (part, velocity)));
        }
        loads
    }

    pub fn obstacles(&mut self, rows: &[ObstacleFormat]) -> Vec<Obstacle> {
        let obstacle = |(n, row): (usize, &ObstacleFormat)| {
            Some(Obstacle {
                name: row.name.clone(),
                shape: self.solid(&format!("obstacle[{n}].shape"), &row.shape)?,
                offset: row.offset,
                side: row.side.into(),
                friction: row.friction.into(),
            })
        };
        rows.iter().enumerate().filter_map(obstacle).collect()
    }
}
