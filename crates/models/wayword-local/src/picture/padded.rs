//! Prepares pictures for GLIP: the whole picture is resized until its short edge has a given length, and padded at the
//! right and at the bottom.

use super::resample::{ResampleAxis, ResampleFilter, resample_picture};
use crate::{LocalError, ModelDevice};
use candle_core::Tensor;
use wayword_core::Image;

/// The longest edge that may be asked for, pixels. A longer one is refused.
const MAX_EDGE_PX: usize = 4096;

/// Prepares pictures of any proportions, without cropping.
pub(crate) struct PaddedPictureProcessor {
    /// The length of the shorter edge, pixels.
    short: usize,
    /// The most for the longer edge, pixels.
    long: usize,
    /// Both edges are padded to multiples of this, pixels.
    multiple: usize,
    /// The colour (0 is red) of each channel, and the model's input for each value of its byte.
    channels: [(usize, [f32; 256]); 3],
}

impl PaddedPictureProcessor {
    /// The short edge becomes `short` pixels, or less where the long one would exceed `long`. Then zeros are added
    /// until both are multiples of `multiple`. `colours` has the colour of each channel; `mean` and `deviation` are in
    /// bytes.
    pub(crate) fn new(
        short: usize,
        long: usize,
        multiple: usize,
        colours: [usize; 3],
        mean: [f32; 3],
        deviation: [f32; 3],
    ) -> Result<Self, LocalError> {
        if !(1..=MAX_EDGE_PX).contains(&short) || short > long || long > MAX_EDGE_PX {
            let problem = format!("a short edge of {short} pixels is not from 1 to {}", long.min(MAX_EDGE_PX));
            return Err(LocalError::Compute { model: "pictures".to_owned(), problem });
        }
        let channel = |at: usize| {
            // As in the original, a byte is scaled to 0..1 and back, which rounds twice.
            let number = |byte: usize| (byte as f32 / 255.0 * 255.0 - mean[at]) / deviation[at];
            (colours[at], std::array::from_fn(number))
        };
        Ok(Self { short, long, multiple, channels: std::array::from_fn(channel) })
    }

    /// The most pixels of a picture for the model.
    pub(crate) fn max_pixels(&self) -> usize {
        self.short.next_multiple_of(self.multiple) * self.long.next_multiple_of(self.multiple)
    }

    /// Width and height of a picture after it is resized, rounded as Python rounds them.
    fn resized_size(&self, width: usize, height: usize) -> (usize, usize) {
        let (low, high) = (width.min(height).max(1), width.max(height).max(1));
        let mut short = self.short;
        if high as f64 / low as f64 * short as f64 > self.long as f64 {
            short = ((self.long * low) as f64 / high as f64).round_ties_even() as usize;
        }
        // A picture that is one pixel wide could otherwise exceed the longest edge.
        let short = short.max(1);
        let long = ((short * high) as f64 / low as f64) as usize;
        let long = long.min(self.long.next_multiple_of(self.multiple));
        if width < height { (short, long) } else { (long, short) }
    }

    /// A picture as a tensor [1, 3, height, width] in 32 bits, and its width and height without padding.
    ///
    /// # Errors
    /// When the picture has no pixels, or the device has no memory left.
    pub(crate) fn to_tensor(
        &self,
        image: &Image,
        device: &ModelDevice,
    ) -> Result<(Tensor, (usize, usize)), LocalError> {
        let wrong = |problem: String| LocalError::Compute { model: "pictures".to_owned(), problem };
        let (from_width, from_height) = (image.width_px() as usize, image.height_px() as usize);
        if from_width == 0 || from_height == 0 {
            return Err(wrong(format!("{image:?} has no pixels")));
        }
        let (width, height) = self.resized_size(from_width, from_height);
        let down = ResampleAxis::keep_middle(ResampleFilter::Bilinear, from_height, height, height);
        let across = ResampleAxis::keep_middle(ResampleFilter::Bilinear, from_width, width, width);
        let rgb = resample_picture(image.rgb_bytes(), &down, &across);
        let (padded_width, padded_height) =
            (width.next_multiple_of(self.multiple), height.next_multiple_of(self.multiple));
        let mut numbers = vec![0.0; 3 * padded_width * padded_height];
        for (numbers, (colour, table)) in numbers.chunks_exact_mut(padded_width * padded_height).zip(&self.channels) {
            for (numbers, row) in numbers.chunks_exact_mut(padded_width).zip(rgb.chunks_exact(3 * width)) {
                for (number, pixel) in numbers.iter_mut().zip(row.chunks_exact(3)) {
                    *number = table[usize::from(pixel[*colour])];
                }
            }
        }
        let pixels = Tensor::from_vec(numbers, (1, 3, padded_height, padded_width), &device.0);
        Ok((pixels.map_err(|error| wrong(error.to_string()))?, (width, height)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edges() -> PaddedPictureProcessor {
        PaddedPictureProcessor::new(800, 1333, 32, [2, 1, 0], [103.53, 116.28, 123.675], [57.375, 57.12, 58.395])
            .unwrap()
    }

    #[test]
    fn sizes_are_the_originals() {
        for (from, to) in [
            ((640, 480), (1066, 800)),
            ((480, 640), (800, 1066)),
            ((800, 1000), (800, 1000)),
            ((1000, 300), (1333, 400)),
            ((301, 1000), (401, 1332)),
            ((500, 500), (800, 800)),
            ((1, 100_000), (1, 1344)),
        ] {
            assert_eq!(edges().resized_size(from.0, from.1), to, "{from:?}");
        }
    }

    #[test]
    fn channels_are_reordered_and_padding_is_zero() {
        let edges = PaddedPictureProcessor::new(1, 1333, 4, [2, 1, 0], [0.0; 3], [1.0; 3]).unwrap();
        let image = Image::new(2, 1, vec![10, 20, 30, 40, 50, 60]).unwrap();
        let (pixels, size) = edges.to_tensor(&image, &ModelDevice::cpu()).unwrap();
        assert_eq!((pixels.dims(), size), (&[1, 3, 4, 4][..], (2, 1)));
        let rows = pixels.squeeze(0).unwrap().to_vec3::<f32>().unwrap();
        assert_eq!(
            [&rows[0][0], &rows[1][0], &rows[2][0]],
            [&[30.0, 60.0, 0.0, 0.0], &[20.0, 50.0, 0.0, 0.0], &[10.0, 40.0, 0.0, 0.0]]
        );
        assert!(rows.iter().flat_map(|channel| &channel[1..]).flatten().all(|number| *number == 0.0));
    }

    #[test]
    fn impossible_edges_are_refused() {
        for short in [0, 1334, 1 << 40] {
            assert!(PaddedPictureProcessor::new(short, 1333, 32, [0, 1, 2], [0.0; 3], [1.0; 3]).is_err());
        }
        let empty = Image::new(0, 7, Vec::new()).unwrap();
        assert!(edges().to_tensor(&empty, &ModelDevice::cpu()).is_err());
    }
}
