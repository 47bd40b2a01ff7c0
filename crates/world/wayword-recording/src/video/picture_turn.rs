//! Turns a picture before it is shown. Phones do not turn their pictures, but record how the camera was turned
//! (ISO/IEC 14496-12, section 8.3.2, `matrix`).

use super::boxes::BoxFields;
use wayword_core::Image;

/// A turn by quarters, with or without a mirror. The fields are the steps in the shown picture, as (right, down), that
/// correspond to a step to the right and a step down in the coded one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PictureTurn {
    right: (i32, i32),
    down: (i32, i32),
}

impl PictureTurn {
    pub(super) const NO_TURN: Self = Self { right: (1, 0), down: (0, 1) };

    /// Reads the turn from `tkhd`; a matrix that is no turn by quarters counts as no turn.
    pub(super) fn read(tkhd: &[u8]) -> Result<Self, String> {
        let (mut fields, version, _) = BoxFields::with_version(tkhd)?;
        // Times, number, duration; then layer, group, volume.
        fields.read_bytes(if version == 0 { 20 } else { 32 } + 16)?;
        // The matrix has rows of three, of which the third number is not needed.
        let (a, b) = (fields.read_i32()?, fields.read_i32()?);
        fields.read_i32()?;
        let (c, d) = (fields.read_i32()?, fields.read_i32()?);
        let turn = Self { right: (a.signum(), b.signum()), down: (c.signum(), d.signum()) };
        let is_turn = (b == 0 && c == 0 && a != 0 && d != 0) || (a == 0 && d == 0 && b != 0 && c != 0);
        Ok(if is_turn { turn } else { Self::NO_TURN })
    }

    /// The picture as it should be shown.
    pub(super) fn apply_to(self, coded: Image) -> Image {
        if self == Self::NO_TURN {
            return coded;
        }
        let (width_px, height_px) = (coded.width_px(), coded.height_px());
        let (shown_width_px, shown_height_px) =
            if self.right.0 == 0 { (height_px, width_px) } else { (width_px, height_px) };
        let (width, height) = (width_px as usize, height_px as usize);
        // The inverse of a turn is its transpose; where a step leads backwards, counting starts from the far end.
        let (x, y) = (TurnAxis::new(self.right, width), TurnAxis::new(self.down, height));
        let pixels = coded.rgb_bytes().as_chunks::<3>().0;
        let mut rgb: Vec<u8> = Vec::with_capacity(coded.rgb_bytes().len());
        for shown_y in 0..shown_height_px as usize {
            for shown_x in 0..shown_width_px as usize {
                let at = y.coded_at(shown_x, shown_y) * width + x.coded_at(shown_x, shown_y);
                rgb.extend(pixels.get(at).copied().unwrap_or_default());
            }
        }
        Image::new(shown_width_px, shown_height_px, rgb).unwrap_or(coded)
    }
}

/// One coordinate of the coded picture.
struct TurnAxis {
    /// Whether it runs along the rows of the shown picture.
    along_x: bool,
    /// The last coordinate, where it runs backwards.
    from_end: Option<usize>,
}

impl TurnAxis {
    fn new((x, y): (i32, i32), length: usize) -> Self {
        Self { along_x: x != 0, from_end: (x + y < 0).then(|| length.saturating_sub(1)) }
    }

    fn coded_at(&self, shown_x: usize, shown_y: usize) -> usize {
        let at = if self.along_x { shown_x } else { shown_y };
        self.from_end.map_or(at, |end| end - at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Turns a picture of one row: 1, 2, 3.
    fn turned(matrix: [i32; 4]) -> (u32, Vec<u8>) {
        let [a, b, c, d] = matrix;
        let words = [a, b, 0, c, d, 0, 0, 0, 1 << 30].map(i32::to_be_bytes).concat();
        let turn = PictureTurn::read(&[vec![0; 40], words].concat()).unwrap();
        let shown = turn.apply_to(Image::new(3, 1, vec![1, 1, 1, 2, 2, 2, 3, 3, 3]).unwrap());
        (shown.width_px(), shown.rgb_bytes().chunks(3).map(|pixel| pixel[0]).collect())
    }

    #[test]
    fn apply_turns_pictures_of_an_upright_phone() {
        const ONE: i32 = 1 << 16;
        assert_eq!(turned([ONE, 0, 0, ONE]), (3, vec![1, 2, 3]));
        // A quarter clockwise: the left becomes the top.
        assert_eq!(turned([0, ONE, -ONE, 0]), (1, vec![1, 2, 3]));
        assert_eq!(turned([0, -ONE, ONE, 0]), (1, vec![3, 2, 1]));
        assert_eq!(turned([-ONE, 0, 0, -ONE]), (3, vec![3, 2, 1]));
        // Not turns by quarters.
        assert_eq!(turned([ONE, ONE, -ONE, ONE]), (3, vec![1, 2, 3]));
        assert_eq!(turned([0; 4]), (3, vec![1, 2, 3]));
    }
}
