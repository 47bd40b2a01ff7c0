//! Decodes AV1 with rav1d, a port of dav1d to Rust.

use super::{
    colour::{ChromaPlanes, PicturePlane, PicturePlanes, StreamColour},
    decoder::{CodedSample, SampleDecoder, TakePlanes, check_picture_size},
};
use crate::picture_size::MAX_PIXELS;
use re_rav1d::dav1d::{Decoder, Error, Picture, PixelLayout, PlanarImageComponent, Settings, pixel::YUVRange};

/// A decoder of one stream.
pub(super) struct Av1Decoder {
    decoder: Decoder,
    /// The colours that the container gives.
    colour: StreamColour,
}

impl Av1Decoder {
    pub(super) fn new(colour: StreamColour) -> Result<Self, String> {
        let mut settings = Settings::new();
        // With one thread and no delay, no picture stays in the decoder.
        settings.set_n_threads(1);
        settings.set_max_frame_delay(1);
        settings.set_frame_size_limit(MAX_PIXELS);
        let decoder = Decoder::with_settings(&settings).map_err(|error| format!("cannot be decoded: {error}"))?;
        Ok(Self { decoder, colour })
    }

    /// Hands out all pictures that the decoder has ready.
    fn drain_pictures(&mut self, out: &mut TakePlanes<'_>) -> Result<(), String> {
        loop {
            match self.decoder.get_picture() {
                Ok(picture) => hand_out_picture(&picture, self.colour, out)?,
                Err(Error::Again) => return Ok(()),
                Err(error) => return Err(format!("cannot be decoded: {error}")),
            }
        }
    }
}

impl SampleDecoder for Av1Decoder {
    fn feed(&mut self, coded: CodedSample<'_>, out: &mut TakePlanes<'_>) -> Result<(), String> {
        // The number of the sample serves as its timestamp, which the decoder gives back with the picture.
        let sample = i64::try_from(coded.sample).ok();
        let mut sent = self.decoder.send_data(coded.bytes.to_vec(), None, sample, None);
        loop {
            self.drain_pictures(out)?;
            match sent {
                Ok(()) => return Ok(()),
                Err(Error::Again) => sent = self.decoder.send_pending_data(),
                Err(error) => return Err(format!("cannot be decoded: {error}")),
            }
        }
    }

    fn finish(&mut self, out: &mut TakePlanes<'_>) -> Result<(), String> {
        self.drain_pictures(out)
    }
}

/// Hands out a decoded picture with the number of its sample.
fn hand_out_picture(picture: &Picture, container_colour: StreamColour, out: &mut TakePlanes<'_>) -> Result<(), String> {
    let sample = picture
        .timestamp()
        .and_then(|sample| usize::try_from(sample).ok())
        .ok_or("its decoder gave a picture that belongs to no sample")?;
    check_picture_size(picture.width(), picture.height())?;
    let shifts = match picture.pixel_layout() {
        PixelLayout::I400 => None,
        PixelLayout::I420 => Some((1, 1)),
        PixelLayout::I422 => Some((1, 0)),
        PixelLayout::I444 => Some((0, 0)),
    };
    use PlanarImageComponent::{U, V, Y};
    let brightness = picture.plane(Y);
    let chroma = shifts.map(|shifts| (picture.plane(U), picture.plane(V), shifts));
    let stride = |component| picture.stride(component) as usize;
    let chroma = chroma.as_ref().map(|(blue, red, (shift_x, shift_y))| ChromaPlanes {
        blue: PicturePlane { bytes: blue.as_ref(), stride: stride(U) },
        red: PicturePlane { bytes: red.as_ref(), stride: stride(V) },
        shift_x: *shift_x,
        shift_y: *shift_y,
    });
    let bits = u32::try_from(picture.bit_depth()).map_err(|_| "its decoder gave samples of an impossible size")?;
    let planes = PicturePlanes {
        width_px: picture.width(),
        height_px: picture.height(),
        bits,
        brightness: PicturePlane { bytes: brightness.as_ref(), stride: stride(Y) },
        chroma,
        // What the stream gives counts before what the container gives.
        colour: stream_colour(picture).or(container_colour),
    };
    out(sample, &planes)
}

/// The colours that the stream gives.
fn stream_colour(picture: &Picture) -> StreamColour {
    let full_range = Some(picture.color_range() == YUVRange::Full);
    let matrix = StreamColour::matrix_from_code(picture.matrix_coefficients() as u32);
    StreamColour { matrix, full_range }
}
