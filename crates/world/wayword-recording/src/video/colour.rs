//! Turns the planes of a decoder into RGB, with the colours that the stream gives (ITU-T H.273). Only integers are used,
//! so that every machine makes the same picture.

use wayword_core::Image;

/// The number 1.0 in fixed point, with 16 bits after the point.
const FIXED_POINT_ONE: f64 = 65536.0;
/// The value of `matrix_coefficients` that leaves the matrix open.
const UNSPECIFIED_MATRIX: u32 = 2;

/// The colours that a stream or its container gives; `None` for those that it leaves open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct StreamColour {
    /// `matrix_coefficients` of H.273, table 4.
    pub(super) matrix: Option<u32>,
    /// Whether black is 0 and white the largest number.
    pub(super) full_range: Option<bool>,
}

impl StreamColour {
    /// A matrix as streams write it; `None` where it is unspecified.
    pub(super) fn matrix_from_code(matrix: u32) -> Option<u32> {
        (matrix != UNSPECIFIED_MATRIX).then_some(matrix)
    }

    /// The colours of `self`, and those of `other` for the ones that `self` leaves open.
    pub(super) fn or(self, other: Self) -> Self {
        Self { matrix: self.matrix.or(other.matrix), full_range: self.full_range.or(other.full_range) }
    }

    /// Weights of red and blue in the brightness. The default is BT.601, because ffmpeg, OpenCV and so LeRobot write it
    /// at every picture size.
    fn brightness_weights(self) -> Result<(f64, f64), String> {
        match self.matrix.unwrap_or(6) {
            1 => Ok((0.2126, 0.0722)),
            4 => Ok((0.30, 0.11)),
            5 | 6 => Ok((0.299, 0.114)),
            7 => Ok((0.212, 0.087)),
            9 | 10 => Ok((0.2627, 0.0593)),
            other => Err(format!("has colours of a kind that cannot be read (matrix {other} of H.273)")),
        }
    }
}

/// One plane: rows from the top.
#[derive(Debug, Clone, Copy)]
pub(super) struct PicturePlane<'a> {
    pub(super) bytes: &'a [u8],
    /// Distance from one row to the next, bytes.
    pub(super) stride: usize,
}

impl<'a> PicturePlane<'a> {
    fn row(self, y: usize, bytes: usize) -> Option<&'a [u8]> {
        let start = self.stride.checked_mul(y)?;
        self.bytes.get(start..start.checked_add(bytes)?)
    }
}

/// Planes of colour differences. A shift is the number of bits by which the plane is smaller in that direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct ChromaPlanes<'a> {
    pub(super) blue: PicturePlane<'a>,
    pub(super) red: PicturePlane<'a>,
    pub(super) shift_x: u32,
    pub(super) shift_y: u32,
}

/// A decoded picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct PicturePlanes<'a> {
    pub(super) width_px: u32,
    pub(super) height_px: u32,
    /// Bits of a sample: 8 take one byte, more take two.
    pub(super) bits: u32,
    pub(super) brightness: PicturePlane<'a>,
    /// `None` if all is grey.
    pub(super) chroma: Option<ChromaPlanes<'a>>,
    pub(super) colour: StreamColour,
}

/// The numbers with which samples become RGB.
struct RgbFactors {
    /// The brightness sample of black.
    black: i32,
    /// The sample of a colour difference of 0.
    grey: i32,
    /// Factors in fixed point, from here on: of the brightness, and of the differences of red and blue in each colour.
    brightness: i32,
    red: i32,
    green_of_red: i32,
    green_of_blue: i32,
    blue: i32,
}

impl RgbFactors {
    /// The factors for samples of `bits` bits (H.273, section 8.3, equations 21 to 23 and 39 to 44).
    #[allow(clippy::cast_possible_truncation, reason = "a factor is at most 3.0, whatever the file has")]
    fn new(colour: StreamColour, bits: u32) -> Result<Self, String> {
        let (red_weight, blue_weight) = colour.brightness_weights()?;
        let green_weight = 1.0 - red_weight - blue_weight;
        let unit = 1 << (bits - 8);
        // Without the full range, brightness goes from 16 to 235 and colour differences from 16 to 240, in 8 bits.
        let (black, steps, chroma_steps) = match colour.full_range {
            Some(true) => (0, (1 << bits) - 1, (1 << bits) - 1),
            _ => (16 * unit, 219 * unit, 224 * unit),
        };
        let chroma = 255.0 / f64::from(chroma_steps);
        let fixed = |factor: f64| (factor * FIXED_POINT_ONE).round() as i32;
        Ok(Self {
            black,
            grey: 128 * unit,
            brightness: fixed(255.0 / f64::from(steps)),
            red: fixed(2.0 * (1.0 - red_weight) * chroma),
            green_of_red: fixed(-2.0 * (1.0 - red_weight) * red_weight / green_weight * chroma),
            green_of_blue: fixed(-2.0 * (1.0 - blue_weight) * blue_weight / green_weight * chroma),
            blue: fixed(2.0 * (1.0 - blue_weight) * chroma),
        })
    }

    fn to_rgb(&self, brightness: i32, blue: i32, red: i32) -> [u8; 3] {
        let base = (brightness - self.black) * self.brightness + (1 << 15);
        let (blue, red) = (blue - self.grey, red - self.grey);
        let byte = |fixed: i32| u8::try_from((fixed >> 16).max(0)).unwrap_or(u8::MAX);
        [
            byte(base + red * self.red),
            byte(base + red * self.green_of_red + blue * self.green_of_blue),
            byte(base + blue * self.blue),
        ]
    }
}

/// The picture in RGB. Pixels that share a colour all get that colour without interpolation, as players do by default.
pub(super) fn rgb_picture(planes: &PicturePlanes<'_>) -> Result<Image, String> {
    let factors = RgbFactors::new(planes.colour, planes.bits)?;
    let mut rgb = vec![0; planes.width_px as usize * planes.height_px as usize * 3];
    let rows = rgb.chunks_exact_mut((planes.width_px as usize * 3).max(1));
    for (y, row) in rows.enumerate() {
        let written = if planes.bits == 8 {
            convert_row::<1>(planes, &factors, y, row)
        } else {
            convert_row::<2>(planes, &factors, y, row)
        };
        written.ok_or("its decoder gave fewer pixels than it announced")?;
    }
    Image::new(planes.width_px, planes.height_px, rgb).map_err(|error| error.to_string())
}

/// Turns one row into RGB, from samples of `BYTES` bytes; `None` if there are too few samples.
fn convert_row<const BYTES: usize>(
    planes: &PicturePlanes<'_>,
    factors: &RgbFactors,
    y: usize,
    rgb: &mut [u8],
) -> Option<()> {
    let width = planes.width_px as usize;
    let brightness = planes.brightness.row(y, width * BYTES)?;
    let pixels = rgb.chunks_exact_mut(3).enumerate();
    let Some(chroma) = planes.chroma else {
        for (x, pixel) in pixels {
            pixel.copy_from_slice(&factors.to_rgb(sample_at::<BYTES>(brightness, x)?, factors.grey, factors.grey));
        }
        return Some(());
    };
    let narrow = width.div_ceil(1 << chroma.shift_x);
    let blue = chroma.blue.row(y >> chroma.shift_y, narrow * BYTES)?;
    let red = chroma.red.row(y >> chroma.shift_y, narrow * BYTES)?;
    for (x, pixel) in pixels {
        let shared = x >> chroma.shift_x;
        let (blue, red) = (sample_at::<BYTES>(blue, shared)?, sample_at::<BYTES>(red, shared)?);
        pixel.copy_from_slice(&factors.to_rgb(sample_at::<BYTES>(brightness, x)?, blue, red));
    }
    Some(())
}

/// A sample of one byte, or of two in the byte order of this machine; `None` after the end of the row.
fn sample_at<const BYTES: usize>(row: &[u8], at: usize) -> Option<i32> {
    match BYTES {
        1 => row.get(at).map(|byte| i32::from(*byte)),
        _ => row.as_chunks::<2>().0.get(at).map(|bytes| i32::from(u16::from_ne_bytes(*bytes))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(colour: StreamColour, bits: u32, [y, cb, cr]: [u16; 3]) -> [u8; 3] {
        let bytes = |number: u16| if bits == 8 { vec![number as u8] } else { number.to_ne_bytes().to_vec() };
        let (y, cb, cr) = (bytes(y), bytes(cb), bytes(cr));
        let plane = |bytes| PicturePlane { bytes, stride: 2 };
        let chroma = ChromaPlanes { blue: plane(&cb), red: plane(&cr), shift_x: 1, shift_y: 1 };
        let planes =
            PicturePlanes { width_px: 1, height_px: 1, bits, brightness: plane(&y), chroma: Some(chroma), colour };
        rgb_picture(&planes).unwrap().rgb_bytes().try_into().unwrap()
    }

    #[test]
    fn picture_converts_black_white_and_red_by_the_standards() {
        let said = |matrix, full_range| StreamColour { matrix: Some(matrix), full_range: Some(full_range) };
        assert_eq!(pixel(StreamColour::default(), 8, [16, 128, 128]), [0, 0, 0]);
        assert_eq!(pixel(StreamColour::default(), 8, [235, 128, 128]), [255, 255, 255]);
        assert_eq!(pixel(said(6, true), 8, [255, 128, 128]), [255, 255, 255]);
        // Pure red: BT.601 limited (81, 90, 240), BT.709 limited (63, 102, 240), both within rounding.
        let near = |[r, g, b]: [u8; 3]| r >= 253 && g <= 2 && b <= 2;
        assert!(near(pixel(said(6, false), 8, [81, 90, 240])));
        assert!(near(pixel(said(1, false), 8, [63, 102, 240])));
        assert!(!near(pixel(said(1, false), 8, [81, 90, 240])));
        assert!(near(pixel(said(1, false), 10, [250, 409, 960])));
    }

    #[test]
    fn pixels_that_are_not_there_are_an_error_and_no_panic() {
        let plane = PicturePlane { bytes: &[0; 7], stride: 4 };
        let colour = StreamColour::default();
        let planes = PicturePlanes { width_px: 4, height_px: 2, bits: 8, brightness: plane, chroma: None, colour };
        assert!(rgb_picture(&planes).is_err());
        assert!(rgb_picture(&PicturePlanes { width_px: 3, ..planes }).is_ok());
        let colour = StreamColour { matrix: Some(0), ..colour };
        assert!(rgb_picture(&PicturePlanes { width_px: 3, colour, ..planes }).unwrap_err().contains("H.273"));
    }
}
