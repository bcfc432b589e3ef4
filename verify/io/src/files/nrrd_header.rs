//! The header of an NRRD file: lines of `field: value` up to an empty line.

use super::bytes::{ByteOrder, Scalar, start_of};
use super::error::Mistake;
use super::unit::LengthUnit;
use super::voxels;
use mtled::algebra::tensor::{Matrix3, Vector3};
use std::collections::HashMap;

/// Fields by name in lower case, as text.
pub(crate) struct Header {
    fields: HashMap<String, String>,
    /// Keys with their values, which other programs add.
    pairs: HashMap<String, String>,
    /// Length of the header with its empty line \[byte\].
    pub length: usize,
}

/// How the voxels are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Encoding {
    Raw,
    Gzip,
    Text,
}

impl Header {
    /// Splits the header into fields.
    pub(crate) fn parse(bytes: &[u8]) -> Result<Header, Mistake> {
        if !(bytes.starts_with(b"NRRD000")
            && bytes.get(7).is_some_and(|v| (b'1'..=b'5').contains(v)))
        {
            let format = "an NRRD file of version 1 to 5 (NRRD0001 to NRRD0005)";
            return Err(Mistake::WrongFormat { format, start: start_of(bytes) });
        }
        let mut header = Header { fields: HashMap::new(), pairs: HashMap::new(), length: 0 };
        for (number, line) in bytes.split_inclusive(|&b| b == b'\n').enumerate() {
            header.length += line.len();
            let line = String::from_utf8_lossy(line);
            let line = line.trim_end_matches(['\n', '\r']);
            if line.is_empty() {
                break;
            }
            if number > 0 {
                header.line(number + 1, line)?;
            }
        }
        Ok(header)
    }

    fn line(&mut self, number: usize, line: &str) -> Result<(), Mistake> {
        if line.starts_with('#') {
            return Ok(());
        }
        let colon = line.find(':');
        if let Some((key, value)) =
            colon.and_then(|at| Some((&line[..at], line[at + 1..].strip_prefix('=')?)))
        {
            self.pairs.insert(key.to_string(), value.to_string());
            return Ok(());
        }
        let Some((name, value)) = line.split_once(": ").or_else(|| line.split_once(':')) else {
            let text = line.chars().take(60).collect();
            return Err(Mistake::BadHeaderLine { line: number, text });
        };
        let name = name.trim().to_lowercase().replace([' ', '_'], "");
        self.fields.insert(name, value.trim().to_string());
        Ok(())
    }

    /// A field by its name without spaces.
    pub(crate) fn get(&self, name: &str) -> Option<&str> {
        self.fields.get(name).map(String::as_str)
    }

    fn need(&self, name: &str, field: &'static str) -> Result<&str, Mistake> {
        self.get(name).ok_or(Mistake::MissingField { field })
    }

    pub(crate) fn sizes(&self) -> Result<[usize; 3], Mistake> {
        match self.layers_and_sizes()? {
            (1, sizes) => Ok(sizes),
            _ => Err(Mistake::bad_field("dimension", "4", "3, one number per voxel")),
        }
    }

    /// Numbers of a voxel, which 3D Slicer calls layers, and voxels along the three axes.
    pub(crate) fn layers_and_sizes(&self) -> Result<(usize, [usize; 3]), Mistake> {
        let dimension = self.need("dimension", "dimension")?;
        if dimension != "3" && !(dimension == "4" && self.starts_with_layers()) {
            let expected = "3, one label per voxel, or 4, the first of layers as of 3D Slicer";
            return Err(Mistake::bad_field("dimension", dimension, expected));
        }
        let text = self.need("sizes", "sizes")?;
        let sizes: Option<Vec<usize>> = text.split_whitespace().map(|n| n.parse().ok()).collect();
        match (dimension, sizes.as_deref()) {
            ("3", Some(&[x, y, z])) => Ok((1, [x, y, z])),
            ("4", Some(&[layers, x, y, z])) if layers > 0 => Ok((layers, [x, y, z])),
            ("4", _) => Err(Mistake::bad_field("sizes", text, "four whole numbers")),
            _ => Err(Mistake::bad_field("sizes", text, "three whole numbers")),
        }
    }

    /// Whether the first of four axes is none of space.
    fn starts_with_layers(&self) -> bool {
        self.get("spacedirections").is_some_and(|text| text.starts_with("none"))
    }

    /// The segments that 3D Slicer names: layer, label, name.
    pub(crate) fn segments(&self) -> Vec<(usize, u32, String)> {
        let of = |segment: usize, what: &str| self.pairs.get(&format!("Segment{segment}_{what}"));
        let segment = |segment: usize| {
            let layer = of(segment, "Layer")?.trim().parse().ok()?;
            let label = of(segment, "LabelValue")?.trim().parse().ok()?;
            let name = of(segment, "Name").cloned().unwrap_or_default();
            Some((layer, label, name))
        };
        (0..).map_while(segment).collect()
    }

    pub(crate) fn scalar(&self) -> Result<Scalar, Mistake> {
        let text = self.need("type", "type")?;
        Ok(match text.to_lowercase().as_str() {
            "signed char" | "int8" | "int8_t" => Scalar::I8,
            "uchar" | "unsigned char" | "uint8" | "uint8_t" => Scalar::U8,
            "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => {
                Scalar::I16
            }
            "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => {
                Scalar::U16
            }
            "int" | "signed int" | "int32" | "int32_t" => Scalar::I32,
            "uint" | "unsigned int" | "uint32" | "uint32_t" => Scalar::U32,
            "longlong"
            | "long long"
            | "long long int"
            | "signed long long"
            | "signed long long int"
            | "int64"
            | "int64_t" => Scalar::I64,
            "ulonglong"
            | "unsigned long long"
            | "unsigned long long int"
            | "uint64"
            | "uint64_t" => Scalar::U64,
            "float" => Scalar::F32,
            "double" => Scalar::F64,
            _ => {
                return Err(Mistake::bad_field(
                    "type",
                    text,
                    "a type of whole numbers such as `unsigned char`",
                ));
            }
        })
    }

    pub(crate) fn encoding(&self) -> Result<Encoding, Mistake> {
        let text = self.need("encoding", "encoding")?;
        match text.to_lowercase().as_str() {
            "raw" => Ok(Encoding::Raw),
            "gzip" | "gz" => Ok(Encoding::Gzip),
            "ascii" | "text" | "txt" => Ok(Encoding::Text),
            _ => Err(Mistake::bad_field(
                "encoding",
                text,
                "raw, gzip or ascii; save it in one of these",
            )),
        }
    }

    /// Byte order, which numbers of one byte and text need not state.
    pub(crate) fn byte_order(
        &self,
        scalar: Scalar,
        encoding: Encoding,
    ) -> Result<ByteOrder, Mistake> {
        match self.get("endian").map(str::to_lowercase).as_deref() {
            Some("little") => Ok(ByteOrder::Little),
            Some("big") => Ok(ByteOrder::Big),
            Some(other) => Err(Mistake::bad_field("endian", other, "little or big")),
            None if scalar.size() == 1 || encoding == Encoding::Text => Ok(ByteOrder::Little),
            None => Err(Mistake::MissingField { field: "endian" }),
        }
    }

    /// A count such as `byte skip`, 0 if absent; -1 is `None`.
    pub(crate) fn skip(&self, name: &str, field: &'static str) -> Result<Option<u64>, Mistake> {
        match self.get(name) {
            None => Ok(Some(0)),
            Some("-1") => Ok(None),
            Some(text) => text
                .parse()
                .map(Some)
                .map_err(|_| Mistake::bad_field(field, text, "a whole number or -1")),
        }
    }

    /// Signs of x, y, z that turn the file's world into RAS.
    fn to_ras(&self) -> Result<Vector3, Mistake> {
        let Some(text) = self.get("space") else {
            return Ok(Vector3::repeat(1.0));
        };
        match text.to_lowercase().as_str() {
            "right-anterior-superior" | "ras" => Ok(Vector3::new(1.0, 1.0, 1.0)),
            "left-anterior-superior" | "las" => Ok(Vector3::new(-1.0, 1.0, 1.0)),
            "left-posterior-superior" | "lps" => Ok(Vector3::new(-1.0, -1.0, 1.0)),
            "scanner-xyz" | "3d-right-handed" | "3d-left-handed" => Ok(Vector3::repeat(1.0)),
            _ => Err(Mistake::bad_field("space", text, "RAS, LAS or LPS, without time")),
        }
    }

    /// Centre of the first voxel and steps along the indices in RAS \[m\]; `unit` overrides the file's.
    pub(crate) fn frame(&self, unit: Option<LengthUnit>) -> Result<(Vector3, Matrix3), Mistake> {
        let signs = self.to_ras()?;
        let origin = match self.get("spaceorigin") {
            Some(text) => {
                vectors(text).filter(|found| found.len() == 1).map(|found| found[0]).ok_or_else(
                    || Mistake::bad_field("space origin", text, "one vector such as (1,2,3)"),
                )?
            }
            None => Vector3::zeros(),
        };
        let directions = self.get("spacedirections").map(|text| text.trim_start_matches("none"));
        let directions = match (directions, self.get("spacings")) {
            (Some(text), _) => vectors(text)
                .filter(|found| found.len() == 3)
                .map(|found| Matrix3::from_columns(&found))
                .ok_or_else(|| {
                    Mistake::bad_field("space directions", text, "three vectors such as (1,0,0)")
                })?,
            (None, Some(text)) => {
                let steps: Option<Vec<f64>> = numbers(text).filter(|steps| steps.len() == 3);
                let steps =
                    steps.ok_or_else(|| Mistake::bad_field("spacings", text, "three numbers"))?;
                Matrix3::from_diagonal(&Vector3::from_vec(steps))
            }
            (None, None) => return Err(Mistake::MissingField { field: "space directions" }),
        };
        if voxels::are_singular(&directions) {
            let (field, text) = match self.get("spacedirections") {
                Some(text) => ("space directions", text),
                None => ("spacings", self.get("spacings").unwrap_or_default()),
            };
            return Err(Mistake::bad_field(field, text, "three steps that span a volume"));
        }
        let flip = Matrix3::from_diagonal(&signs);
        let metres = self.metres(unit)?;
        Ok((flip * origin * metres, flip * directions * metres))
    }

    /// The unit of length \[m\]; `unit` overrides the file's.
    pub(crate) fn metres(&self, unit: Option<LengthUnit>) -> Result<f64, Mistake> {
        Ok(unit.map_or_else(|| self.unit(), Ok)?.in_metres())
    }

    /// What turns the components of a vector into RAS: the columns of the measurement frame, or
    /// the axes of the space without one.
    pub(crate) fn measurement_frame(&self) -> Result<Matrix3, Mistake> {
        let space = Matrix3::from_diagonal(&self.to_ras()?);
        let Some(text) = self.get("measurementframe") else {
            return Ok(space);
        };
        let columns = vectors(text)
            .filter(|found| found.len() == 3)
            .map(|found| Matrix3::from_columns(&found));
        let frame = columns.filter(|frame| !voxels::are_singular(frame)).ok_or_else(|| {
            let expected = "three vectors such as (1,0,0) that span a volume";
            Mistake::bad_field("measurement frame", text, expected)
        })?;
        Ok(space * frame)
    }

    /// Reasons to doubt where the voxels lie.
    pub(crate) fn doubts(&self) -> Vec<String> {
        let none = "the header has no `space`, so that the file does not say which way its voxels \
                    run: x is taken as R, y as A, z as S; other programs may mirror such an image";
        if self.get("space").is_some() { Vec::new() } else { vec![none.to_string()] }
    }

    /// Unit of length, millimetres if absent.
    fn unit(&self) -> Result<LengthUnit, Mistake> {
        let Some(text) = self.get("spaceunits").or(self.get("units")) else {
            return Ok(LengthUnit::Millimetre);
        };
        let mut names: Vec<&str> = text.split(['"', ' ']).filter(|part| !part.is_empty()).collect();
        names.dedup();
        match names[..] {
            ["mm" | "millimeter" | "millimetre"] => Ok(LengthUnit::Millimetre),
            ["m" | "meter" | "metre"] => Ok(LengthUnit::Metre),
            ["um" | "µm" | "micrometer" | "micrometre"] => Ok(LengthUnit::Micrometre),
            _ => Err(Mistake::bad_field(
                "space units",
                text,
                "the same \"mm\", \"m\" or \"um\" three times",
            )),
        }
    }
}

fn numbers(text: &str) -> Option<Vec<f64>> {
    let parts = text.split([',', ' ', '\t']).filter(|part| !part.is_empty());
    parts.map(|part| part.parse().ok().filter(|value: &f64| value.is_finite())).collect()
}

/// `(1,0,0) (0,1,0)` as vectors.
fn vectors(text: &str) -> Option<Vec<Vector3>> {
    let parts = text.split(')').map(str::trim).filter(|part| !part.is_empty());
    parts
        .map(|part| {
            let three = numbers(part.strip_prefix('(')?)?;
            (three.len() == 3).then(|| Vector3::from_vec(three))
        })
        .collect()
}
