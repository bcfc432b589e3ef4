//! Colours of values and of regions.

pub(crate) type Colour = [f64; 3];

/// Viridis at equal steps (van der Walt, Smith 2015).
const VIRIDIS: [[u8; 3]; 10] = [
    [68, 1, 84],
    [72, 40, 120],
    [62, 74, 137],
    [49, 104, 142],
    [38, 130, 142],
    [31, 158, 137],
    [53, 183, 121],
    [110, 206, 88],
    [181, 222, 43],
    [253, 231, 37],
];

/// Okabe and Ito's (2008), paler; the first is of the body itself.
const REGIONS: [[u8; 3]; 8] = [
    [201, 205, 212],
    [230, 159, 0],
    [86, 180, 233],
    [0, 158, 115],
    [204, 121, 167],
    [240, 228, 66],
    [0, 114, 178],
    [213, 94, 0],
];

fn unit(colour: [u8; 3]) -> Colour {
    colour.map(|part| f64::from(part) / 255.0)
}

/// The colour at a fraction of the scale from 0 to 1.
pub(crate) fn viridis(fraction: f64) -> Colour {
    let last = VIRIDIS.len() - 1;
    let place = fraction.clamp(0.0, 1.0) * last as f64;
    let low = (place as usize).min(last - 1);
    let (a, b, t) = (unit(VIRIDIS[low]), unit(VIRIDIS[low + 1]), place - low as f64);
    std::array::from_fn(|n| a[n] + t * (b[n] - a[n]))
}

/// The colour of one of several regions. The last one, which is what no other has taken, is grey.
pub(crate) fn of_region(region: u16, regions: usize) -> Colour {
    let number = usize::from(region);
    if number + 1 >= regions {
        unit(REGIONS[0])
    } else {
        unit(REGIONS[1 + number % (REGIONS.len() - 1)])
    }
}

/// The colour of a region, as text.
pub(crate) fn region_colour(region: usize, regions: usize) -> String {
    hexadecimal(of_region(region as u16, regions))
}

/// `#rrggbb`.
pub(crate) fn hexadecimal(colour: Colour) -> String {
    let [r, g, b] = colour.map(byte);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// 0 to 255.
pub(crate) fn byte(part: f64) -> u8 {
    (255.0 * part.clamp(0.0, 1.0)).round() as u8
}
