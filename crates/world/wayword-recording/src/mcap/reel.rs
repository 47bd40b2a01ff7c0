//! The pictures of one topic.

use super::{HINT, found::RecordPlace, messages::MessageKind, pixels, records::Records};
use crate::reel::{Reel, Take};
use mcap::records::Record;
use std::{fs::File, ops::ControlFlow, path::PathBuf};
use wayword_core::{Image, PlatformError, contain::decoded};
use wayword_world::files;

/// Largest message of a picture: 64 megapixels of four bytes.
const MAX_MESSAGE_BYTES: u64 = 257 << 20;

/// Pictures that are read from the file on demand.
pub(crate) struct Pictures {
    pub(crate) file: PathBuf,
    pub(crate) topic: String,
    pub(crate) kind: MessageKind,
    /// Place of each picture in the file.
    pub(crate) places: Vec<RecordPlace>,
    /// Time of each picture after the first, seconds.
    pub(crate) times_s: Vec<f64>,
}

impl Reel for Pictures {
    fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    fn name(&self, number: usize) -> String {
        format!("{number:06}")
    }

    fn pictures(&self, wanted: &[usize], take: &mut Take<'_>) -> Result<(), PlatformError> {
        let unreadable = |error: std::io::Error| files::wrong(&self.file, error.to_string(), HINT);
        let file = File::open(&self.file).map_err(unreadable)?;
        let length = file.metadata().map_err(unreadable)?.len();
        // One reader serves all pictures: they mostly follow each other, and a compressed chunk can only be read from
        // its start.
        let mut records = Records::new(&file, 0, length).map_err(|why| files::wrong(&self.file, why, HINT))?;
        for &number in wanted {
            let place = self.places.get(number).ok_or_else(|| "there is no such picture".to_owned());
            let picture = place.and_then(|place| self.picture(&mut records, *place)).map_err(|why| {
                let reason = format!("picture {number} of {}: {why}", self.topic);
                files::wrong(&self.file, reason, "repair the file with `mcap recover`, or leave this part out")
            })?;
            take(number, picture)?;
        }
        Ok(())
    }
}

impl Pictures {
    fn picture(&self, records: &mut Records<'_>, place: RecordPlace) -> Result<Image, String> {
        let mut picture = Err("the message is no longer there".to_owned());
        records.go(place)?;
        let heard = records.each(&|_| MAX_MESSAGE_BYTES, &mut |found| {
            if found.place == place
                && let Record::Message { data, .. } = found.record()?
            {
                picture = decoded(|| pixels::picture(self.kind, &data));
            }
            Ok(if found.place < place { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
        });
        heard.and(picture.map_err(|why| format!("message at {place}: {why}")))
    }
}
