//! Bytes of voxels → labels.

use super::Mistake;

/// Type of a stored number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// Order of the bytes of a stored number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ByteOrder {
    Little,
    Big,
}

impl ByteOrder {
    pub fn name(self) -> &'static str {
        match self {
            ByteOrder::Little => "little",
            ByteOrder::Big => "big",
        }
    }
}

impl Scalar {
    /// Size \[byte\].
    pub fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::I64 | Scalar::U64 | Scalar::F64 => 8,
        }
    }

    /// The number stored in the first bytes, which must be enough.
    pub fn read(self, bytes: &[u8], order: ByteOrder) -> f64 {
        let mut word = [0u8; 8];
        let n = self.size();
        word[..n].copy_from_slice(&bytes[..n]);
        if order == ByteOrder::Big {
            word[..n].reverse();
        }
        let whole = u64::from_le_bytes(word);
        match self {
            Scalar::U8 | Scalar::U16 | Scalar::U32 | Scalar::U64 => whole as f64,
            Scalar::I8 => f64::from(whole as i8),
            Scalar::I16 => f64::from(whole as i16),
            Scalar::I32 => f64::from(whole as i32),
            Scalar::I64 => whole as i64 as f64,
            Scalar::F32 => f64::from(f32::from_bits(whole as u32)),
            Scalar::F64 => f64::from_bits(whole),
        }
    }
}

/// The largest label that makes sense.
const LARGEST: f64 = 65535.0;

/// Number of voxels of an image, refused where it is 0 or more than 2³².
pub fn voxel_count(sizes: &[usize]) -> Result<usize, Mistake> {
    let count = sizes.iter().try_fold(1usize, |product, &n| product.checked_mul(n));
    match count {
        Some(count) if count > 0 && count <= 1 << 32 => Ok(count),
        _ => Err(Mistake::BadSizes { sizes: sizes.to_vec() }),
    }
}

/// Decodes `count` numbers as labels, value = slope × stored + intercept.
pub fn labels(
    bytes: &[u8],
    count: usize,
    scalar: Scalar,
    order: ByteOrder,
    (slope, intercept): (f64, f64),
) -> Result<Vec<u32>, Mistake> {
    let expected = count * scalar.size();
    if bytes.len() < expected {
        return Err(Mistake::Truncated { expected, found: bytes.len() });
    }
    let chunks = bytes[..expected].chunks_exact(scalar.size());
    let values = chunks.map(|chunk| slope * scalar.read(chunk, order) + intercept);
    let labels: Vec<u32> = (values.enumerate())
        .map(|(voxel, value)| label(voxel, value, scalar, order))
        .collect::<Result<_, _>>()?;
    refuse_swapped_bytes(&labels, scalar, order)?;
    Ok(labels)
}

/// One label from its value.
pub fn label(voxel: usize, value: f64, scalar: Scalar, order: ByteOrder) -> Result<u32, Mistake> {
    if (0.0..=LARGEST).contains(&value) && value.fract() == 0.0 {
        return Ok(value as u32);
    }
    if scalar.size() > 1 && value > LARGEST {
        return Err(Mistake::LabelTooLarge { voxel, value, order: order.name() });
    }
    Err(Mistake::NotALabel { voxel, value })
}

/// Small labels of two bytes read the wrong way round are multiples of 256.
fn refuse_swapped_bytes(labels: &[u32], scalar: Scalar, order: ByteOrder) -> Result<(), Mistake> {
    let smallest = labels.iter().copied().filter(|&label| label > 0).min();
    match smallest {
        Some(smallest) if scalar.size() > 1 && labels.iter().all(|label| label % 256 == 0) => {
            Err(Mistake::ByteSwapped { smallest, order: order.name() })
        }
        _ => Ok(()),
    }
}
