//! Tells photographs from depth maps, masks and the like by what is in a picture file.

use image::{DynamicImage, ImageFormat, ImageReader};
use std::{collections::BTreeSet, fs::File, io::BufReader, path::Path};

/// Pictures of a folder that are looked into: the first, one from the middle, and the last.
const EXAMINED_PICTURES: usize = 3;
/// A grey picture with at most this many levels is a mask. In colour it may also be a drawing or a simple simulation.
const MOST_MASK_LEVELS: usize = 24;
/// Pixels that are looked at in a picture.
const MOST_EXAMINED_PIXELS: usize = 1 << 16;
/// Longest side and most memory of a picture that is looked into.
const MAX_SIDE_PX: u32 = 16_384;
const MAX_DECODED_BYTES: u64 = 256 << 20;

/// What the pictures of a folder are, if they are no photographs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NoPhotographs {
    /// Grey with 16 bits.
    DepthMaps,
    /// A few levels of grey.
    Masks,
}

impl NoPhotographs {
    /// What the pictures are, to follow "holds".
    pub(crate) const fn words(self) -> &'static str {
        match self {
            Self::DepthMaps => "depth maps (grey with 16 bits)",
            Self::Masks => "masks (a few levels of grey)",
        }
    }

    /// What the pictures of these files are; `None` if one of the examined ones may be a photograph.
    pub(crate) fn in_folder(folder: &Path, names: &[String]) -> Option<Self> {
        let last = names.len().checked_sub(1)?;
        let examined: BTreeSet<usize> =
            (0..EXAMINED_PICTURES).map(|part| part * last / (EXAMINED_PICTURES - 1)).collect();
        let mut found = None;
        for name in examined.into_iter().filter_map(|at| names.get(at)) {
            found = Some(Self::of_file(&folder.join(name))?);
        }
        found
    }

    /// What a PNG picture is; `None` if it may be a photograph, or is not PNG. JPEG spreads the levels of a mask.
    fn of_file(file: &Path) -> Option<Self> {
        let mut reader = ImageReader::new(BufReader::new(File::open(file).ok()?)).with_guessed_format().ok()?;
        if reader.format() != Some(ImageFormat::Png) {
            return None;
        }
        let mut limits = image::Limits::default();
        limits.max_image_width = Some(MAX_SIDE_PX);
        limits.max_image_height = Some(MAX_SIDE_PX);
        limits.max_alloc = Some(MAX_DECODED_BYTES);
        reader.limits(limits);
        Self::of_image(&reader.decode().ok()?)
    }

    fn of_image(image: &DynamicImage) -> Option<Self> {
        match image {
            DynamicImage::ImageLuma16(_) => Some(Self::DepthMaps),
            DynamicImage::ImageLuma8(grey) => has_few_levels(grey.as_raw()).then_some(Self::Masks),
            _ => None,
        }
    }
}

/// Whether there are few different levels among the pixels that are looked at.
fn has_few_levels(pixels: &[u8]) -> bool {
    let step = pixels.len().div_ceil(MOST_EXAMINED_PIXELS).max(1);
    pixels.iter().step_by(step).collect::<BTreeSet<_>>().len() <= MOST_MASK_LEVELS
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageBuffer, Luma, Rgb};

    fn in_files(pictures: &[DynamicImage]) -> Option<NoPhotographs> {
        let folder = tempfile::tempdir().unwrap();
        let names: Vec<String> = (0..pictures.len()).map(|at| format!("{at}.png")).collect();
        for (name, picture) in names.iter().zip(pictures) {
            picture.save(folder.path().join(name)).unwrap();
        }
        NoPhotographs::in_folder(folder.path(), &names)
    }

    #[test]
    fn depth_maps_and_masks_are_no_photographs() {
        let depth = DynamicImage::ImageLuma16(ImageBuffer::from_fn(64, 48, |x, y| Luma([(x * y) as u16 + 300])));
        let confidence = DynamicImage::ImageLuma8(ImageBuffer::from_fn(64, 48, |x, _| Luma([(x % 3) as u8])));
        let photograph = DynamicImage::ImageRgb8(ImageBuffer::from_fn(64, 48, |x, y| Rgb([x as u8, y as u8, 7])));
        let grey = DynamicImage::ImageLuma8(ImageBuffer::from_fn(64, 48, |x, y| Luma([(x + 2 * y) as u8])));
        assert_eq!(in_files(&[depth.clone(), depth.clone()]), Some(NoPhotographs::DepthMaps));
        assert_eq!(in_files(&[confidence]), Some(NoPhotographs::Masks));
        // A robot may have a grey camera.
        assert_eq!((in_files(&[photograph]), in_files(std::slice::from_ref(&grey))), (None, None));
        assert_eq!(in_files(&[depth, grey]), None);
    }
}
