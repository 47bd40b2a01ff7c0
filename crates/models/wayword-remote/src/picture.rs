//! Pictures as they are sent: scaled down and encoded as JPEG, once for all questions about a frame.

use base64::{Engine, engine::general_purpose::STANDARD};
use image::{ImageBuffer, Rgb, codecs::jpeg::JpegEncoder, imageops};
use sha2::{Digest, Sha256};
use std::sync::{Arc, Mutex, OnceLock, PoisonError, Weak};
use wayword_core::{Image, hex_text};

/// JPEG quality: high enough that a model sees no block edges as texture.
const JPEG_QUALITY: u8 = 90;

/// The most frames that are remembered: as many as are in use at the same time, and a few more. The oldest is
/// forgotten.
const MAX_REMEMBERED_FRAMES: usize = 128;

/// An encoded picture.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct EncodedPicture {
    /// JPEG, in base64.
    pub(crate) base64: String,
    /// SHA-256 of the JPEG, hex.
    pub(crate) sha256: String,
}

/// The encoded picture of one frame, or the problem with it; empty until a thread has encoded the frame.
type PictureSlot = Arc<OnceLock<Result<Arc<EncodedPicture>, String>>>;

/// Encodes pictures, and remembers the pictures of frames that are still in use.
pub(crate) struct PictureEncoder {
    longer_px: u32,
    /// The frames that are remembered, the oldest first.
    known: Mutex<Vec<(Weak<Image>, PictureSlot)>>,
}

impl PictureEncoder {
    /// An encoder that scales pictures down until their longer side is at most `longer_px` pixels.
    pub(crate) fn new(longer_px: u32) -> Self {
        Self { longer_px, known: Mutex::default() }
    }

    /// The longer side that pictures are scaled down to, pixels.
    pub(crate) fn longer_px(&self) -> u32 {
        self.longer_px
    }

    /// The picture of a frame.
    ///
    /// # Errors
    /// When the image has no pixels.
    pub(crate) fn encode(&self, image: &Arc<Image>) -> Result<Arc<EncodedPicture>, String> {
        // Other threads that need the same frame wait for this one instead of encoding it too.
        self.slot_for(image).get_or_init(|| encode_picture(image, self.longer_px).map(Arc::new)).clone()
    }

    /// The slot of a frame: the one that is remembered, or a new one.
    fn slot_for(&self, image: &Arc<Image>) -> PictureSlot {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        // A weak pointer keeps the address from being used for another image, so that equal addresses mean the same
        // frame.
        if let Some((_, slot)) = known.iter().find(|(weak, _)| std::ptr::eq(weak.as_ptr(), Arc::as_ptr(image))) {
            return Arc::clone(slot);
        }
        known.retain(|(weak, _)| weak.strong_count() > 0);
        if known.len() >= MAX_REMEMBERED_FRAMES {
            known.remove(0);
        }
        let slot = PictureSlot::default();
        known.push((Arc::downgrade(image), Arc::clone(&slot)));
        slot
    }
}

/// Scales a picture down, never up, and encodes it.
fn encode_picture(image: &Image, longer_px: u32) -> Result<EncodedPicture, String> {
    let (width, height) = (image.width_px(), image.height_px());
    if width == 0 || height == 0 {
        return Err(format!("a picture of {width} x {height} pixels is empty"));
    }
    let pixels =
        ImageBuffer::<Rgb<u8>, _>::from_raw(width, height, image.rgb_bytes()).ok_or("a picture has too few pixels")?;
    let mut jpeg = Vec::new();
    let mut encoder = JpegEncoder::new_with_quality(&mut jpeg, JPEG_QUALITY);
    let encoded = match scaled_down(width, height, longer_px) {
        Some((width, height)) => {
            // Averages whole pixels: as good as a filter for shrinking, and several times as fast.
            encoder.encode_image(&imageops::thumbnail(&pixels, width, height))
        }
        None => encoder.encode(image.rgb_bytes(), width, height, image::ExtendedColorType::Rgb8),
    };
    encoded.map_err(|error| format!("a picture cannot be encoded: {error}"))?;
    Ok(EncodedPicture { sha256: hex_text(Sha256::digest(&jpeg)), base64: STANDARD.encode(&jpeg) })
}

/// The smaller size, if the picture has to shrink.
fn scaled_down(width: u32, height: u32, longer_px: u32) -> Option<(u32, u32)> {
    let longer = width.max(height);
    let scale = |side: u32| {
        let exact = (u64::from(side) * u64::from(longer_px) + u64::from(longer) / 2) / u64::from(longer);
        u32::try_from(exact).unwrap_or(longer_px).max(1)
    };
    (longer > longer_px).then(|| (scale(width), scale(height)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(width: u32, height: u32) -> Arc<Image> {
        Arc::new(Image::new(width, height, vec![90; (width * height * 3) as usize]).unwrap())
    }

    fn size(picture: &EncodedPicture) -> (u32, u32) {
        let jpeg = STANDARD.decode(&picture.base64).unwrap();
        let image = image::load_from_memory_with_format(&jpeg, image::ImageFormat::Jpeg).unwrap();
        (image.width(), image.height())
    }

    #[test]
    fn pictures_shrink_and_never_grow() {
        let pictures = PictureEncoder::new(64);
        assert_eq!(size(&pictures.encode(&plain(128, 96)).unwrap()), (64, 48));
        assert_eq!(size(&pictures.encode(&plain(96, 1000)).unwrap()), (6, 64));
        assert_eq!(size(&pictures.encode(&plain(64, 1)).unwrap()), (64, 1));
        assert_eq!(size(&pictures.encode(&plain(3000, 1)).unwrap()), (64, 1));
        assert!(pictures.encode(&plain(0, 4)).is_err());
    }

    #[test]
    fn a_frame_is_encoded_once() {
        let pictures = PictureEncoder::new(64);
        let frame = plain(80, 80);
        assert!(Arc::ptr_eq(&pictures.encode(&frame).unwrap(), &pictures.encode(&frame).unwrap()));
        let equal = plain(80, 80);
        let other = pictures.encode(&equal).unwrap();
        assert!(!Arc::ptr_eq(&pictures.encode(&frame).unwrap(), &other));
        assert_eq!(pictures.encode(&frame).unwrap().sha256, other.sha256);
    }

    #[test]
    fn frames_that_are_gone_are_forgotten() {
        let pictures = PictureEncoder::new(8);
        for _ in 0..1000 {
            pictures.encode(&plain(4, 4)).unwrap();
        }
        let held: Vec<_> = (0..2 * MAX_REMEMBERED_FRAMES).map(|_| plain(4, 4)).collect();
        held.iter().for_each(|frame| drop(pictures.encode(frame).unwrap()));
        assert_eq!(pictures.known.lock().unwrap().len(), MAX_REMEMBERED_FRAMES);
    }
}
