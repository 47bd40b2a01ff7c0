//! The pictures of one topic, which are read from the file and decoded one by one.

use super::{MCAP_HINT, messages::MessageKind, pixels, record::RecordPlace, records::RecordReader};
use crate::reel::{PictureReel, TakePicture};
use mcap::records::Record;
use std::{
    fs::File,
    ops::ControlFlow,
    path::{Path, PathBuf},
};
use wayword_core::{Image, PlatformError, contain_panics::run_decoder};
use wayword_world::files;

/// Largest message of a picture: 64 megapixels of four bytes.
const MAX_MESSAGE_BYTES: u64 = 257 << 20;
const REPAIR_HINT: &str = "repair the file with `mcap recover`, or leave this part out";
const NO_PICTURE_HINT: &str = "the file itself is whole, but this message cannot be read as a picture: leave its time out with \
                               `mcap filter`, or name another camera";

/// Pictures that are read from the file on demand.
pub(crate) struct TopicReel {
    /// The files of the recording.
    pub(crate) files: Vec<PathBuf>,
    pub(crate) topic: String,
    pub(crate) kind: MessageKind,
    /// Place of each picture in the files.
    pub(crate) places: Vec<PicturePlace>,
    /// Time of each picture after the first, seconds.
    pub(crate) times_s: Vec<f64>,
    /// What the user has to be told about the recording.
    pub(crate) remarks: Vec<String>,
}

/// The place of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct PicturePlace {
    /// The index of its file.
    pub(crate) part: usize,
    pub(crate) place: RecordPlace,
}

impl PictureReel for TopicReel {
    fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    fn picture_name(&self, number: usize) -> String {
        format!("{number:06}")
    }

    fn remarks(&self) -> &[String] {
        &self.remarks
    }

    fn hand_out_pictures(&self, wanted: &[usize], take: &mut TakePicture<'_>) -> Result<(), PlatformError> {
        let part = |number: &usize| self.places.get(*number).map(|place| place.part);
        for numbers in wanted.chunk_by(|before, after| part(before) == part(after)) {
            let file = numbers.first().and_then(part).and_then(|part| self.files.get(part));
            let file =
                file.ok_or_else(|| files::file_error(Path::new(&self.topic), "there is no such picture", MCAP_HINT))?;
            self.hand_out_from(file, numbers, take)?;
        }
        Ok(())
    }
}

impl TopicReel {
    /// Hands out pictures of one file.
    fn hand_out_from(&self, path: &Path, numbers: &[usize], take: &mut TakePicture<'_>) -> Result<(), PlatformError> {
        let unreadable = |error: std::io::Error| files::file_error(path, error.to_string(), MCAP_HINT);
        let file = File::open(path).map_err(unreadable)?;
        let length = file.metadata().map_err(unreadable)?.len();
        // One reader serves all pictures: they mostly follow each other, and a compressed chunk can only be read from
        // its start.
        let mut records = RecordReader::new(&file, 0, length).map_err(|why| files::file_error(path, why, MCAP_HINT))?;
        for &number in numbers {
            let place = self.places.get(number).ok_or_else(|| ("there is no such picture".to_owned(), MCAP_HINT));
            let picture = place.and_then(|place| self.read_picture(&mut records, place.place));
            let picture = picture.map_err(|(why, hint)| {
                files::file_error(path, format!("picture {number} of {}: {why}", self.topic), hint)
            })?;
            take(number, picture)?;
        }
        Ok(())
    }

    /// Reads a picture. The error has a way out.
    fn read_picture(
        &self,
        records: &mut RecordReader<'_>,
        place: RecordPlace,
    ) -> Result<Image, (String, &'static str)> {
        let mut picture = Err("the message is no longer there".to_owned());
        records.go_to(place).map_err(|why| (why, REPAIR_HINT))?;
        let read = records.each_record(&|_| MAX_MESSAGE_BYTES, &mut |found| {
            if found.place == place
                && let Record::Message { data, .. } = found.parse_record()?
            {
                picture = run_decoder(|| pixels::decode_picture(self.kind, &data));
            }
            Ok(if found.place < place { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
        });
        read.map_err(|why| (why, REPAIR_HINT))
            .and(picture.map_err(|why| (format!("message at {place}: {why}"), NO_PICTURE_HINT)))
    }
}
