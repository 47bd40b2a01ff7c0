//! Writes the pictures of a film as an MP4 file with H.264.

use super::FilmWriter;
use muxide::api::{Muxer, MuxerBuilder, MuxerError, VideoCodec};
use openh264::{
    OpenH264API, Timestamp,
    encoder::{Encoder, EncoderConfig, FrameRate, FrameType, IntraFramePeriod, QpRange, RateControlMode, VuiConfig},
    formats::{RgbSliceU8, YUVBuffer},
};
use std::path::{Path, PathBuf};
use wayword_core::Image;
use wayword_formats::OutputFile;
use wayword_run::error::CommandError;

/// Least frames for each second. Some players cannot show fewer, so a picture is shown several times instead.
const MIN_FPS: f64 = 10.0;
/// Most seconds between two key frames, to which players can jump.
const KEY_EVERY_S: f64 = 5.0;
/// How coarse pictures may be: quantisation on the encoder's scale of 0 to 51.
const QUANTISATION_RANGE: [u8; 2] = [18, 24];

/// Frames between two key frames of a video for training.
const TRAINING_KEY_FRAMES: u32 = 2;

/// Begins a film for people.
pub(super) fn open_video(out: &Path, fps: f64) -> Result<Box<dyn FilmWriter>, CommandError> {
    let repeats = (MIN_FPS / fps).ceil().max(1.0);
    let key_frames = (KEY_EVERY_S * fps * repeats).ceil() as u32;
    open_with(out, fps * repeats, repeats as usize, key_frames)
}

/// Begins a video in which each picture is one frame.
pub(super) fn open_frames(out: &Path, fps: f64) -> Result<Box<dyn FilmWriter>, CommandError> {
    open_with(out, fps, 1, TRAINING_KEY_FRAMES)
}

fn open_with(out: &Path, fps: f64, repeats: usize, key_frames: u32) -> Result<Box<dyn FilmWriter>, CommandError> {
    let config = EncoderConfig::new()
        .max_frame_rate(FrameRate::from_hz(fps as f32))
        .rate_control_mode(RateControlMode::Off)
        .qp(QpRange::new(QUANTISATION_RANGE[0], QUANTISATION_RANGE[1]))
        .intra_frame_period(IntraFramePeriod::from_num_frames(key_frames))
        .skip_frames(false)
        // One thread and no choice by load: the same pictures give the same file.
        .num_threads(1)
        // The colours that the conversion below gives.
        .vui(VuiConfig::bt601());
    let encoder =
        Encoder::with_api_config(OpenH264API::from_source(), config).map_err(|error| encoder_error(&error))?;
    Ok(Box::new(VideoFilm {
        encoder,
        file: Some(OutputFile::begin(out).map_err(CommandError::io(out, "write"))?),
        muxer: None,
        out: out.to_owned(),
        fps,
        repeats,
        frames: 0,
    }))
}

/// A video that is being written.
struct VideoFilm {
    encoder: Encoder,
    /// `Some` until the first picture, which sets the size.
    file: Option<OutputFile>,
    /// `Some` from the first picture on.
    muxer: Option<Muxer<OutputFile>>,
    out: PathBuf,
    /// Frames for each second.
    fps: f64,
    /// How often each picture is shown.
    repeats: usize,
    frames: usize,
}

impl FilmWriter for VideoFilm {
    fn add_picture(&mut self, picture: &Image) -> Result<(), CommandError> {
        let (rgb, [width, height]) = crop_to_even(picture);
        if let Some(file) = self.file.take() {
            let muxer = MuxerBuilder::new(file).video(VideoCodec::H264, width as u32, height as u32, self.fps);
            self.muxer = Some(muxer.build().map_err(muxer_error(&self.out))?);
        }
        let Some(muxer) = &mut self.muxer else { return Ok(()) };
        let pixels = YUVBuffer::from_rgb8_source(RgbSliceU8::new(&rgb, (width, height)));
        for _ in 0..self.repeats {
            let at_s = self.frames as f64 / self.fps;
            let time = Timestamp::from_millis((1000.0 * at_s).round() as u64);
            let encoded = self.encoder.encode_at(&pixels, time).map_err(|error| encoder_error(&error))?;
            let is_key = matches!(encoded.frame_type(), FrameType::IDR | FrameType::I);
            muxer.write_video(at_s, &encoded.to_vec(), is_key).map_err(muxer_error(&self.out))?;
            self.frames += 1;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<Vec<PathBuf>, CommandError> {
        if let Some(mut muxer) = self.muxer.take() {
            muxer.finish_in_place().map_err(muxer_error(&self.out))?;
            muxer.into_writer().finish().map_err(CommandError::io(&self.out, "write"))?;
        }
        Ok(vec![self.out])
    }
}

/// The picture with even sides, which H.264's colours need: an odd last column or row is left out, or shown twice if it
/// is the only one.
fn crop_to_even(picture: &Image) -> (Vec<u8>, [usize; 2]) {
    let given = [picture.width_px() as usize, picture.height_px() as usize];
    let size = given.map(|side| (side - side % 2).max(2));
    let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x.min(given[0] - 1), y.min(given[1] - 1))));
    let rgb = pixels.flat_map(|(x, y)| {
        let start = 3 * (y * given[0] + x);
        [0, 1, 2].map(|channel| picture.rgb_bytes()[start + channel])
    });
    (rgb.collect(), size)
}

fn encoder_error(error: &openh264::Error) -> CommandError {
    let hint = "give pictures of at most 3840 x 2160 pixels with --width";
    CommandError::usage(format!("the pictures cannot become a video: {error}"), hint)
}

fn muxer_error(out: &Path) -> impl FnOnce(MuxerError) -> CommandError {
    move |error| match error {
        MuxerError::Io(source) => CommandError::io(out, "write")(source),
        other => CommandError::usage(format!("the video cannot be written: {other}"), "report this as a bug"),
    }
}
