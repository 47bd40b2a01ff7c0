//! Writes the pictures of a film as an animated GIF that loops.

use super::{super::picture::picture_error, FilmWriter};
use image::{
    Delay, DynamicImage, Frame, ImageError, RgbImage,
    codecs::gif::{GifEncoder, Repeat},
};
use std::{
    io::{self, Write},
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::Image;
use wayword_formats::OutputFile;
use wayword_run::error::CommandError;

/// How quickly the 256 colours of a picture are chosen, 1 to 30. At 10 they look as good as at 1.
const GIF_QUANTISER_SPEED: i32 = 10;

/// A GIF that is being written.
pub(super) struct GifFilm {
    encoder: GifEncoder<SharedGifFile>,
    file: SharedGifFile,
    out: PathBuf,
    delay: Delay,
}

/// The file, shared because the encoder does not give it back.
#[derive(Clone)]
struct SharedGifFile(Arc<Mutex<Option<OutputFile>>>);

impl Write for SharedGifFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(file) => file.write(bytes),
            None => Err(io::ErrorKind::BrokenPipe.into()),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl GifFilm {
    pub(super) fn new(out: &Path, fps: f64) -> Result<Self, CommandError> {
        let opened = OutputFile::begin(out).map_err(CommandError::io(out, "write"))?;
        let file = SharedGifFile(Arc::new(Mutex::new(Some(opened))));
        let mut encoder = GifEncoder::new_with_speed(file.clone(), GIF_QUANTISER_SPEED);
        encoder.set_repeat(Repeat::Infinite).map_err(gif_error(out))?;
        let delay = Delay::from_numer_denom_ms((1000.0 / fps).round() as u32, 1);
        Ok(Self { encoder, file, out: out.to_owned(), delay })
    }
}

impl FilmWriter for GifFilm {
    fn add_picture(&mut self, picture: &Image) -> Result<(), CommandError> {
        let pixels = RgbImage::from_raw(picture.width_px(), picture.height_px(), picture.rgb_bytes().to_vec());
        let pixels = DynamicImage::from(pixels.unwrap_or_default()).into_rgba8();
        self.encoder.encode_frame(Frame::from_parts(pixels, 0, 0, self.delay)).map_err(gif_error(&self.out))
    }

    fn finish(self: Box<Self>) -> Result<Vec<PathBuf>, CommandError> {
        // The encoder writes the end of the file when it is dropped.
        drop(self.encoder);
        if let Some(file) = self.file.0.lock().unwrap_or_else(PoisonError::into_inner).take() {
            file.finish().map_err(CommandError::io(&self.out, "write"))?;
        }
        Ok(vec![self.out])
    }
}

/// The error for a GIF that cannot be encoded, or not be written to its place.
fn gif_error(out: &Path) -> impl FnOnce(ImageError) -> CommandError {
    move |error| match error {
        ImageError::IoError(source) => CommandError::io(out, "write")(source),
        other => picture_error(other),
    }
}
