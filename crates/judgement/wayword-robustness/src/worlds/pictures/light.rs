//! Converts between sRGB and linear light, and changes the amount and colour of the light.

use wayword_core::{Image, image::WrongPixelCount};

/// The colour temperature for which cameras are balanced, kelvin.
const BALANCED_FOR_K: f64 = 6500.0;

/// Linear light of an sRGB value, 0 to 1 (IEC 61966-2-1).
pub(super) fn linear_from_srgb(level: u8) -> f64 {
    let value = f64::from(level) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
}

/// The sRGB value of linear light (IEC 61966-2-1). Light brighter than white becomes white.
pub(super) fn srgb_from_linear(light: f64) -> u8 {
    let light = light.clamp(0.0, 1.0);
    let value = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * libm::pow(light, 1.0 / 2.4) - 0.055 };
    (value * 255.0 + 0.5) as u8
}

/// Multiplies the linear light of a picture by one factor for each of red, green and blue.
pub(super) fn scale_light(image: &Image, gains: [f64; 3]) -> Result<Image, WrongPixelCount> {
    let table = |gain: f64| -> Vec<u8> {
        (0..=u8::MAX).map(|level| srgb_from_linear(gain * linear_from_srgb(level))).collect()
    };
    let [red, green, blue] = gains.map(table);
    let pixel = |rgb: &[u8]| [red[usize::from(rgb[0])], green[usize::from(rgb[1])], blue[usize::from(rgb[2])]];
    Image::new(image.width_px(), image.height_px(), image.rgb_bytes().chunks_exact(3).flat_map(pixel).collect())
}

/// The factors for linear red, green and blue under light of a colour temperature, for a camera that is balanced for 6500 K. They follow
/// von Kries' rule in the camera's own colours, and are scaled so that a grey keeps its luminance.
pub(super) fn temperature_gains(kelvin: f64) -> [f64; 3] {
    let (light, set) = (blackbody_rgb(kelvin), blackbody_rgb(BALANCED_FOR_K));
    let gains: [f64; 3] = std::array::from_fn(|colour| (light[colour] / set[colour]).max(0.0));
    let luminance = 0.2126 * gains[0] + 0.7152 * gains[1] + 0.0722 * gains[2];
    gains.map(|gain| gain / luminance)
}

/// Linear sRGB of a blackbody with luminance 1. The chromaticity is by the polynomials of Kim et al., "Design of
/// advanced color temperature control system for HDTV applications", Journal of the Korean Physical Society 41, 2002,
/// for 1667 to 25000 K; the matrix is that of IEC 61966-2-1.
fn blackbody_rgb(kelvin: f64) -> [f64; 3] {
    let (x, y) = blackbody_xy(kelvin.clamp(1667.0, 25_000.0));
    let xyz = [x / y, 1.0, (1.0 - x - y) / y];
    let rows = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]];
    rows.map(|row| row.iter().zip(xyz).map(|(factor, value)| factor * value).sum())
}

/// CIE 1931 x and y of a blackbody.
fn blackbody_xy(kelvin: f64) -> (f64, f64) {
    let inverse = 1000.0 / kelvin;
    let x = if kelvin <= 4000.0 {
        evaluate_cubic([-0.266_123_9, -0.234_358_9, 0.877_695_6, 0.179_910], inverse)
    } else {
        evaluate_cubic([-3.025_846_9, 2.107_037_9, 0.222_634_7, 0.240_390], inverse)
    };
    let y = if kelvin <= 2222.0 {
        evaluate_cubic([-1.106_381_4, -1.348_110_20, 2.185_558_32, -0.202_196_83], x)
    } else if kelvin <= 4000.0 {
        evaluate_cubic([-0.954_947_6, -1.374_185_93, 2.091_370_15, -0.167_488_67], x)
    } else {
        evaluate_cubic([3.081_758_0, -5.873_386_70, 3.751_129_97, -0.370_014_83], x)
    };
    (x, y)
}

/// A polynomial of degree 3, the highest power first.
fn evaluate_cubic([a, b, c, d]: [f64; 4], at: f64) -> f64 {
    ((a * at + b) * at + c) * at + d
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_comes_back_from_linear_light() {
        assert!((0..=u8::MAX).all(|level| srgb_from_linear(linear_from_srgb(level)) == level));
    }

    #[test]
    fn blackbodies_have_the_published_colours() {
        // Standard illuminant A is a blackbody of 2856 K: x 0.44758, y 0.40745 (CIE 15). The polynomials are off by
        // 0.0005.
        let (x, y) = blackbody_xy(2856.0);
        assert!((x - 0.447_58).abs() < 1e-3 && (y - 0.407_45).abs() < 1e-3, "{x} {y}");
        // The pieces of the polynomials meet.
        for kelvin in [2222.0, 4000.0] {
            let ((x, y), (next_x, next_y)) = (blackbody_xy(kelvin), blackbody_xy(kelvin + 1e-6));
            assert!((x - next_x).abs() < 1e-3 && (y - next_y).abs() < 1e-3, "{kelvin}");
        }
    }

    #[test]
    fn a_candle_is_orange_and_the_sky_is_blue() {
        let [red, _, blue] = temperature_gains(2500.0);
        assert!(red > 1.2 && blue < 0.5);
        let [red, _, blue] = temperature_gains(12_000.0);
        assert!(red < 1.0 && blue > 1.2);
        assert_eq!(temperature_gains(6500.0).map(|gain| (gain * 1e9).round()), [1e9; 3]);
    }
}
