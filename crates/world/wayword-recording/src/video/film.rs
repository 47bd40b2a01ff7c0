//! Decodes the pictures of an MP4 file, numbered in the order in which they are shown.

use super::{
    colour,
    decoder::{CodedSample, SampleDecoder},
    edits::ShownPicture,
    movie::{Mp4Movie, VIDEO_HINT, bytes_at},
    tables::TrackSample,
};
use crate::{file_kind, reel::TakePicture};
use std::{
    collections::{BTreeMap, btree_map::Entry},
    fs::File,
    ops::Range,
    path::{Path, PathBuf},
};
use wayword_core::{Image, PlatformError, contain_panics::run_decoder};
use wayword_world::files;

/// Most decoded pictures that wait for an earlier one; more mean a broken file. A decoder holds back at most so many
/// (ITU-T H.264, annex A.3.1).
const MAX_WAITING_PICTURES: usize = 17;

/// One camera's pictures in an MP4 file.
#[derive(Debug)]
pub(crate) struct Mp4Film {
    file: PathBuf,
    movie: Mp4Movie,
    times_s: Vec<f64>,
    /// What the user has to be told about the file.
    remarks: Vec<String>,
}

impl Mp4Film {
    /// Opens a file and reads the list of its pictures, but decodes none. `camera` is the number of the track as the
    /// file counts them (`"1"`); it is needed only if there are several.
    ///
    /// # Errors
    /// When it is not an MP4 file, is broken, has no such camera, or its pictures are in a codec that cannot be read.
    pub(crate) fn open(file: &Path, camera: Option<&str>) -> Result<Self, PlatformError> {
        let mut opened = files::open_plain_file(file, VIDEO_HINT)?;
        let movie = Mp4Movie::read(&mut opened, camera);
        let movie =
            movie.map_err(|refusal| file_kind::refuse_file(file, "an MP4 video", (refusal.reason, refusal.hint)))?;
        let times_s: Vec<f64> = movie.shown.iter().map(|shown| shown.time_s).collect();
        let remarks = describe_loss(&movie, &times_s).map(|loss| format!("{}: {loss}", file.display()));
        Ok(Self { file: file.to_owned(), movie, times_s, remarks: remarks.into_iter().collect() })
    }

    /// What the user has to be told about the file, one line each.
    pub(crate) fn remarks(&self) -> &[String] {
        &self.remarks
    }

    /// Width and height of the coded pictures, pixels, from the file's header.
    #[cfg(feature = "lerobot")]
    pub(crate) fn size_px(&self) -> (u32, u32) {
        self.movie.size_px
    }

    /// The time at which each picture is shown, seconds from the start of the video, ascending (equal times may follow).
    pub(crate) fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// Hands out the wanted pictures: indices into [`Mp4Film::read_times_s`], ascending and without repetition. Decodes from
    /// the key picture before the first of them to the last, but skips stretches without a wanted picture.
    ///
    /// # Errors
    /// When the file has changed or is broken there, or `take` fails.
    pub(crate) fn decode_pictures(&self, wanted: &[usize], take: &mut TakePicture<'_>) -> Result<(), PlatformError> {
        let wrong = |reason: String| files::file_error(&self.file, reason, VIDEO_HINT);
        let mut file = File::open(&self.file).map_err(|error| wrong(error.to_string()))?;
        let mut buffer = PictureBuffer::new(&self.movie, wanted);
        let mut decoder = self.movie.codec.new_decoder().map_err(wrong)?;
        for run in self.decode_runs(&mut file, wanted).map_err(wrong)? {
            for sample in run {
                let fed = self.feed_sample(&mut file, sample, decoder.as_mut(), &mut buffer);
                let offset = self.movie.samples.get(sample).map_or(0, |sample| sample.offset);
                fed.map_err(|reason| wrong(format!("picture at byte {offset}: {reason}")))?;
                buffer.hand_over(take)?;
            }
        }
        run_decoder(|| decoder.finish(&mut |sample, planes| buffer.put_picture(sample, planes))).map_err(wrong)?;
        buffer.hand_over(take)?;
        match buffer.first_missing() {
            Some(number) => Err(wrong(format!("picture {number} (counted from 0) could not be decoded"))),
            None => Ok(()),
        }
    }

    /// Feeds one sample to a decoder.
    fn feed_sample(
        &self,
        file: &mut File,
        sample: usize,
        decoder: &mut dyn SampleDecoder,
        buffer: &mut PictureBuffer<'_>,
    ) -> Result<(), String> {
        let bytes = self.read_sample(file, sample)?;
        let coded = CodedSample { sample, shown: self.find_sample(sample)?.shown, bytes: &bytes };
        run_decoder(|| decoder.feed(coded, &mut |sample, planes| buffer.put_picture(sample, planes)))
    }

    /// A sample by its index in the order of decoding.
    fn find_sample(&self, sample: usize) -> Result<&TrackSample, String> {
        self.movie.samples.get(sample).ok_or_else(|| format!("has no sample {sample}"))
    }

    /// The bytes of a sample.
    fn read_sample(&self, file: &mut File, sample: usize) -> Result<Vec<u8>, String> {
        let sample = self.find_sample(sample)?;
        bytes_at(file, sample.offset, sample.bytes.into())
    }

    /// The samples to decode for the wanted pictures.
    fn decode_runs(&self, file: &mut File, wanted: &[usize]) -> Result<Vec<Range<usize>>, String> {
        let mut runs: Vec<Range<usize>> = Vec::new();
        for ShownPicture { sample, .. } in wanted.iter().filter_map(|number| self.movie.shown.get(*number)) {
            let decoded_to = runs.last().map_or(0, |run| run.end);
            if *sample < decoded_to {
                continue;
            }
            let key = self.key_before(file, *sample, decoded_to)?;
            match runs.last_mut() {
                // The samples between them have to be decoded.
                Some(run) if key <= decoded_to => run.end = sample + 1,
                _ => runs.push(key..sample + 1),
            }
        }
        Ok(runs)
    }

    /// The last sample from which the wanted one can be decoded; `decoded_to`, up to which samples are decoded anyway, if there is
    /// none after it.
    fn key_before(&self, file: &mut File, wanted: usize, decoded_to: usize) -> Result<usize, String> {
        for key in (decoded_to..=wanted).rev().filter(|at| self.find_sample(*at).is_ok_and(|sample| sample.is_key)) {
            if self.movie.codec.can_begin_with(&self.read_sample(file, key)?) {
                return Ok(key);
            }
        }
        Ok(decoded_to)
    }
}

/// What a movie lacks that broke off, for the user; `None` if it is whole.
fn describe_loss(movie: &Mp4Movie, times_s: &[f64]) -> Option<String> {
    if !movie.breaks_off {
        return None;
    }
    let last_s = times_s.last().copied().unwrap_or(0.0);
    let of = movie.announced_s.map_or_else(String::new, |announced_s| format!(" of {announced_s:.1} s"));
    Some(format!(
        "the file breaks off: its {} pictures end after {last_s:.1} s{of}, and what was recorded later is missing",
        times_s.len()
    ))
}

/// Holds decoded pictures until it is their turn to be handed out.
struct PictureBuffer<'a> {
    movie: &'a Mp4Movie,
    /// The numbers of the wanted pictures, by sample.
    numbers: BTreeMap<usize, usize>,
    /// Wanted numbers that have not been handed over, in order.
    due: std::iter::Peekable<std::iter::Copied<std::slice::Iter<'a, usize>>>,
    /// Decoded pictures by their numbers.
    done: BTreeMap<usize, Image>,
}

impl<'a> PictureBuffer<'a> {
    fn new(movie: &'a Mp4Movie, wanted: &'a [usize]) -> Self {
        let number = |number: &usize| movie.shown.get(*number).map(|shown| (shown.sample, *number));
        let numbers = wanted.iter().filter_map(number).collect();
        Self { movie, numbers, due: wanted.iter().copied().peekable(), done: BTreeMap::new() }
    }

    /// Takes a picture from a decoder.
    fn put_picture(&mut self, sample: usize, planes: &colour::PicturePlanes<'_>) -> Result<(), String> {
        let Some(number) = self.numbers.get(&sample) else { return Ok(()) };
        if self.done.len() > MAX_WAITING_PICTURES {
            return Err("shows its pictures in another order than it says".to_owned());
        }
        if let Entry::Vacant(place) = self.done.entry(*number) {
            place.insert(self.movie.turn.apply_to(colour::rgb_picture(planes)?));
        }
        Ok(())
    }

    /// Hands over the pictures that are next in order.
    fn hand_over(&mut self, take: &mut TakePicture<'_>) -> Result<(), PlatformError> {
        while let Some(number) = self.due.peek() {
            let Some(picture) = self.done.remove(number) else { break };
            take(*number, picture)?;
            self.due.next();
        }
        Ok(())
    }

    /// The first wanted number that has not been decoded.
    fn first_missing(&mut self) -> Option<usize> {
        self.due.peek().copied()
    }
}
