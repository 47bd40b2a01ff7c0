//! The pictures of one topic, which are read from the file and decoded one by one.

use super::{MCAP_HINT, messages::MessageKind, pixels, record::RecordPlace, records::RecordReader};
use crate::reel::{PictureReel, TakePicture};
use mcap::records::Record;
use std::{fs::File, ops::ControlFlow, path::PathBuf};
use wayword_core::{Image, PlatformError, contain_panics::run_decoder};
use wayword_world::files;

/// Largest message of a picture: 64 megapixels of four bytes.
const MAX_MESSAGE_BYTES: u64 = 257 << 20;

/// Pictures that are read from the file on demand.
pub(crate) struct TopicReel {
    pub(crate) file: PathBuf,
    pub(crate) topic: String,
    pub(crate) kind: MessageKind,
    /// Place of each picture in the file.
    pub(crate) places: Vec<RecordPlace>,
    /// Time of each picture after the first, seconds.
    pub(crate) times_s: Vec<f64>,
}

impl PictureReel for TopicReel {
    fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    fn picture_name(&self, number: usize) -> String {
        format!("{number:06}")
    }

    fn hand_out_pictures(&self, wanted: &[usize], take: &mut TakePicture<'_>) -> Result<(), PlatformError> {
        let unreadable = |error: std::io::Error| files::file_error(&self.file, error.to_string(), MCAP_HINT);
        let file = File::open(&self.file).map_err(unreadable)?;
        let length = file.metadata().map_err(unreadable)?.len();
        // One reader serves all pictures: they mostly follow each other, and a compressed chunk can only be read from
        // its start.
        let mut records =
            RecordReader::new(&file, 0, length).map_err(|why| files::file_error(&self.file, why, MCAP_HINT))?;
        for &number in wanted {
            let place = self.places.get(number).ok_or_else(|| "there is no such picture".to_owned());
            let picture = place.and_then(|place| self.read_picture(&mut records, *place)).map_err(|why| {
                let reason = format!("picture {number} of {}: {why}", self.topic);
                files::file_error(&self.file, reason, "repair the file with `mcap recover`, or leave this part out")
            })?;
            take(number, picture)?;
        }
        Ok(())
    }
}

impl TopicReel {
    fn read_picture(&self, records: &mut RecordReader<'_>, place: RecordPlace) -> Result<Image, String> {
        let mut picture = Err("the message is no longer there".to_owned());
        records.go_to(place)?;
        let read = records.each_record(&|_| MAX_MESSAGE_BYTES, &mut |found| {
            if found.place == place
                && let Record::Message { data, .. } = found.parse_record()?
            {
                picture = run_decoder(|| pixels::decode_picture(self.kind, &data));
            }
            Ok(if found.place < place { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
        });
        read.and(picture.map_err(|why| format!("message at {place}: {why}")))
    }
}
