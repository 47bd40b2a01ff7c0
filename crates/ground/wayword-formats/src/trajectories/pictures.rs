//! Reads the pictures of walks from folders or shards, and checks their hash.

use super::{ActionTrajectory, PictureLocation};
use crate::FormatError;
use sha2::{Digest as _, Sha256};
use std::{
    fs::File,
    io::{self, Read},
    path::Path,
};
use wayword_core::hex_text;

/// Largest picture that is read, bytes: 16 MiB. A larger one is an error.
const MAX_PICTURE_BYTES: u64 = 16 << 20;
/// Most files of one shard that are looked at; pictures behind them count as missing.
const MAX_SHARD_FILES: usize = 4_000_000;
const REWRITE_HINT: &str = "write the trajectories again: the same command goes on where it stopped";

/// The name of the n-th picture of a walk, from 0.
#[must_use]
pub fn picture_name(number: usize) -> String {
    format!("{number:04}.jpg")
}

/// The hash of a walk's pictures: of the length of each (8 bytes, little-endian) and its bytes, one after the other.
#[derive(Debug, Clone, Default)]
pub struct PictureDigest(Sha256);

impl PictureDigest {
    /// The hash of all pictures of a walk.
    #[must_use]
    pub fn from_pictures(pictures: &[Vec<u8>]) -> String {
        let mut digest = Self::default();
        pictures.iter().for_each(|picture| digest.take_picture(picture));
        digest.finish()
    }

    /// Takes the next picture.
    fn take_picture(&mut self, picture: &[u8]) {
        self.0.update((picture.len() as u64).to_le_bytes());
        self.0.update(picture);
    }

    /// The hash, in hexadecimal digits.
    fn finish(self) -> String {
        hex_text(self.0.finalize())
    }
}

/// The pictures of a walk, checked against its number of actions and its hash. `folder` holds `trajectories.jsonl`.
///
/// # Errors
/// When one is missing or cannot be read, or they are not those that were written.
pub fn read_pictures(folder: &Path, trajectory: &ActionTrajectory) -> Result<Vec<Vec<u8>>, FormatError> {
    let count = trajectory.actions.len();
    let (file, pictures) = match &trajectory.pictures {
        PictureLocation::Folder(images) => {
            let place = folder.join(images);
            let each = (0..count).map(|number| {
                let file = place.join(picture_name(number));
                picture_bytes(File::open(&file)).map_err(|source| FormatError::from_io(&file, "read", source))
            });
            (place.clone(), each.collect::<Result<Vec<_>, _>>()?)
        }
        PictureLocation::Sample { shard, key } => {
            let file = folder.join(shard);
            let pictures =
                sample_pictures(&file, key, count).map_err(|source| FormatError::from_io(&file, "read", source))?;
            (file, pictures)
        }
    };
    if pictures.len() != count || PictureDigest::from_pictures(&pictures) != trajectory.sha256 {
        let problem = format!("the pictures of walk {} are not those that were written", trajectory.id);
        return Err(FormatError::for_document(&file, problem, REWRITE_HINT));
    }
    Ok(pictures)
}

/// The bytes of a picture, which are bounded.
fn picture_bytes(file: io::Result<impl Read>) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file?.take(MAX_PICTURE_BYTES + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MAX_PICTURE_BYTES {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "a picture is larger than 16 MiB"));
    }
    Ok(bytes)
}

/// The first `count` pictures of one sample of a shard, which lie in their order.
fn sample_pictures(file: &Path, key: &str, count: usize) -> io::Result<Vec<Vec<u8>>> {
    let mut archive = tar::Archive::new(io::BufReader::new(File::open(file)?));
    let mut pictures = Vec::new();
    for entry in archive.entries()?.take(MAX_SHARD_FILES) {
        let entry = entry?;
        let name = entry.path()?.to_string_lossy().into_owned();
        if pictures.len() >= count {
            break;
        }
        if name == format!("{key}.{}", picture_name(pictures.len())) {
            pictures.push(picture_bytes(Ok(entry))?);
        }
    }
    Ok(pictures)
}
