//! Draws the digits and the few letters of a map as strokes, so that a picture needs no font.

use super::sketch::SheetPoint;

/// Width of a glyph and of the gap after it, in heights of a digit.
const ADVANCE_PER_HEIGHT: f64 = 0.78;
/// Height of a digit in font sizes, as in common fonts.
const DIGIT_HEIGHT_PER_SIZE: f64 = 0.72;

/// The strokes of a character within 0..=4 by 0..=6, from the top left; none for an unknown character.
fn character_strokes(character: char) -> &'static [&'static [[u8; 2]]] {
    match character {
        '0' => &[&[[1, 0], [3, 0], [4, 1], [4, 5], [3, 6], [1, 6], [0, 5], [0, 1], [1, 0]]],
        '1' => &[&[[1, 1], [2, 0], [2, 6]], &[[1, 6], [3, 6]]],
        '2' => &[&[[0, 1], [1, 0], [3, 0], [4, 1], [4, 2], [0, 6], [4, 6]]],
        '3' => &[
            &[[0, 1], [1, 0], [3, 0], [4, 1], [4, 2], [3, 3], [4, 4], [4, 5], [3, 6], [1, 6], [0, 5]],
            &[[2, 3], [3, 3]],
        ],
        '4' => &[&[[3, 6], [3, 0], [0, 4], [4, 4]]],
        '5' => &[&[[4, 0], [0, 0], [0, 3], [1, 2], [3, 2], [4, 3], [4, 5], [3, 6], [1, 6], [0, 5]]],
        '6' => &[&[[4, 1], [3, 0], [1, 0], [0, 1], [0, 5], [1, 6], [3, 6], [4, 5], [4, 4], [3, 3], [1, 3], [0, 4]]],
        '7' => &[&[[0, 0], [4, 0], [2, 6]]],
        '8' => &[
            &[
                [1, 0],
                [3, 0],
                [4, 1],
                [4, 2],
                [3, 3],
                [4, 4],
                [4, 5],
                [3, 6],
                [1, 6],
                [0, 5],
                [0, 4],
                [1, 3],
                [0, 2],
                [0, 1],
                [1, 0],
            ],
            &[[1, 3], [3, 3]],
        ],
        '9' => &[&[[0, 5], [1, 6], [3, 6], [4, 5], [4, 1], [3, 0], [1, 0], [0, 1], [0, 2], [1, 3], [3, 3], [4, 2]]],
        'N' => &[&[[0, 6], [0, 0], [4, 6], [4, 0]]],
        'm' => &[&[[0, 6], [0, 2]], &[[0, 3], [1, 2], [2, 3], [2, 6]], &[[2, 3], [3, 2], [4, 3], [4, 6]]],
        _ => &[],
    }
}

/// The strokes of a text around a point, or to the right of it, and how wide they are.
pub(super) fn text_strokes(text: &str, at: SheetPoint, size: f64, is_centred: bool) -> (Vec<Vec<SheetPoint>>, f64) {
    let height = DIGIT_HEIGHT_PER_SIZE * size;
    let unit = height / 6.0;
    let width = (text.chars().count() as f64 - 1.0) * ADVANCE_PER_HEIGHT * height + 4.0 * unit;
    let left = at[0] - if is_centred { width / 2.0 } else { 0.0 };
    let mut lines = Vec::new();
    for (place, character) in text.chars().enumerate() {
        let corner = [left + place as f64 * ADVANCE_PER_HEIGHT * height, at[1] - height / 2.0];
        let point = |[x, y]: &[u8; 2]| [corner[0] + f64::from(*x) * unit, corner[1] + f64::from(*y) * unit];
        lines.extend(character_strokes(character).iter().map(|stroke| stroke.iter().map(point).collect()));
    }
    (lines, 0.16 * size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_character_of_a_map_has_strokes_within_its_box() {
        for character in "0123456789Nm".chars() {
            assert!(!character_strokes(character).is_empty(), "{character}");
            for [x, y] in character_strokes(character).concat() {
                assert!(x <= 4 && y <= 6, "{character}");
            }
        }
    }

    #[test]
    fn a_number_is_around_its_point() {
        let points = text_strokes("88", [50.0, 20.0], 10.0, true).0.concat();
        let ends = |axis: usize| {
            let along = || points.iter().map(|point| point[axis]);
            along().fold(f64::INFINITY, f64::min) + along().fold(f64::NEG_INFINITY, f64::max)
        };
        assert!((ends(0) - 100.0).abs() < 1e-9 && (ends(1) - 40.0).abs() < 1e-9);
    }
}
