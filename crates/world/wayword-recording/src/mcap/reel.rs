//! The pictures of one topic.

use super::{
    HINT,
    contents::Stretch,
    gather::Place,
    messages::Kind,
    pixels,
    records::{MESSAGE, Records},
};
use crate::reel::{Reel, Take};
use std::{fs::File, path::PathBuf};
use wayword_core::{PlatformError, contained};
use wayword_world::files;

/// Largest message of a picture: 64 megapixels of four bytes.
const MAX_MESSAGE_BYTES: u64 = 257 << 20;

/// Pictures that are read from the file when they are wanted.
pub(crate) struct Pictures {
    pub(crate) file: PathBuf,
    pub(crate) topic: String,
    pub(crate) kind: Kind,
    pub(crate) stretches: Vec<Stretch>,
    /// Where each picture is.
    pub(crate) places: Vec<Place>,
    /// When each was taken, after the first.
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
        let opened = File::open(&self.file).map_err(|error| files::wrong(&self.file, error.to_string(), HINT))?;
        // What is open: pictures mostly lie one behind the other, and a chunk can only be read from its front.
        let mut open: Option<(usize, Records<'_>)> = None;
        let mut message = Vec::new();
        for &number in wanted {
            let wrong = |why: String| {
                let reason = format!("picture {number} of {}: {why}", self.topic);
                files::wrong(&self.file, reason, "repair the file with `mcap recover`, or leave this part out")
            };
            let place = self.places.get(number).ok_or_else(|| wrong("there is no such picture".to_owned()))?;
            let mut records = match open.take() {
                Some((stretch, records)) if stretch == place.stretch && records.is_ahead(place.at) => records,
                _ => self.stretches[place.stretch].open(&opened).map_err(wrong)?,
            };
            read(&mut records, place.at, &mut message).map_err(wrong)?;
            let decoded = contained(|| pixels::picture(self.kind, &message));
            let decoded = decoded.unwrap_or_else(|| Err("is broken".to_owned()));
            let picture = decoded.map_err(|why| wrong(format!("message at {}: {why}", records.place(place.at))))?;
            take(number, picture)?;
            open = Some((place.stretch, records));
        }
        Ok(())
    }
}

fn read(records: &mut Records<'_>, at: u64, message: &mut Vec<u8>) -> Result<(), String> {
    match records.go(at)? {
        Some(found) if found.opcode == MESSAGE => records.message()?,
        _ => return Err(format!("{}: there is no message any more", records.place(at))),
    };
    if records.left() > MAX_MESSAGE_BYTES {
        return Err(format!("{}: has {} bytes, more than 64 megapixels", records.place(at), records.left()));
    }
    records.body(MAX_MESSAGE_BYTES, message)
}
