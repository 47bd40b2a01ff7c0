//! Reads the pictures of walks from folders or shards, and checks their hash.

use crate::{DatasetItem, FormatError, item::is_path_below};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest as _, Sha256};
use std::{
    fs::File,
    io::{self, Read},
    path::Path,
};
use wayword_core::hex_text;

/// Largest picture that is read, bytes: 32 MiB. A larger one is an error.
const MAX_PICTURE_BYTES: u64 = 32 << 20;
/// Most files of one shard that are looked at; pictures behind them count as missing.
const MAX_SHARD_FILES: usize = 4_000_000;
const REWRITE_HINT: &str = "remove this folder or shard, and `wayword export` draws it again";

/// A depth picture counts millimetres.
pub const DEPTH_PER_M: f64 = 1000.0;

/// What a picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum PictureKind {
    /// Colours, a JPEG file.
    Rgb,
    /// Depths, a PNG file of 16 bits: millimetres along the camera's axis.
    Depth,
}

impl PictureKind {
    /// Its name in folders and shards.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Rgb => "rgb",
            Self::Depth => "depth",
        }
    }

    /// The file name of the n-th picture of a walk, from 0.
    #[must_use]
    pub fn file_name(self, number: usize) -> String {
        match self {
            Self::Rgb => format!("{number:04}.jpg"),
            Self::Depth => format!("{number:04}.png"),
        }
    }
}

/// The pictures of one kind along a walk.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PictureSet {
    /// Where they are.
    pub place: PictureLocation,
    /// SHA-256 of the pictures, one after the other ([`PictureDigest`]).
    pub sha256: String,
}

/// Where the pictures of a walk are, below the folder of `trajectories.jsonl`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PictureLocation {
    /// A folder: `cameras/125cm_0deg/rgb/ID`.
    Folder(String),
    /// A sample of a shard.
    Sample {
        /// `cameras/125cm_0deg/shards/000000.tar`.
        shard: String,
        /// `000012`.
        key: String,
    },
}

/// Takes a set of pictures: in a folder or shard with a path of at most 512 bytes that does not leave the folder.
pub(super) fn take_picture_set(
    item: &DatasetItem<'_>,
    field: &'static str,
    value: Value,
) -> Result<PictureSet, FormatError> {
    let set: PictureSet = item.parse_value(field, value)?;
    let (path, key) = match &set.place {
        PictureLocation::Folder(folder) => (folder, None),
        PictureLocation::Sample { shard, key } => (shard, Some(key)),
    };
    let refused = |part: &str, problem, hint| Err(item.wrong_field(&format!("{field}.{part}"), problem, hint));
    if !is_path_below(path) {
        return refused(
            "place",
            "it leads out of the folder",
            "write cameras/NAME/rgb/ID or cameras/NAME/shards/000000.tar",
        );
    }
    if key.is_some_and(|key| key.is_empty() || !key.bytes().all(|byte| byte.is_ascii_alphanumeric())) {
        return refused("place.sample.key", "it is no key of a sample", "write digits, as in 000012");
    }
    if set.sha256.len() != 64 || !set.sha256.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return refused("sha256", "it is no SHA-256", "write 64 hexadecimal digits");
    }
    Ok(set)
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

/// The first `count` pictures of a walk, checked against their hash. `folder` holds `trajectories.jsonl`.
///
/// # Errors
/// When one is missing or cannot be read, or they are not those that were written.
pub fn read_pictures(
    folder: &Path,
    set: &PictureSet,
    kind: PictureKind,
    count: usize,
) -> Result<Vec<Vec<u8>>, FormatError> {
    let (place, pictures) = match &set.place {
        PictureLocation::Folder(images) => {
            let place = folder.join(images);
            let each = (0..count).map(|number| {
                let file = place.join(kind.file_name(number));
                picture_bytes(File::open(&file)).map_err(|source| FormatError::from_io(&file, "read", source))
            });
            (place.clone(), each.collect::<Result<Vec<_>, _>>()?)
        }
        PictureLocation::Sample { shard, key } => {
            let file = folder.join(shard);
            let pictures = sample_pictures(&file, key, kind, count)
                .map_err(|source| FormatError::from_io(&file, "read", source))?;
            (file, pictures)
        }
    };
    if pictures.len() != count || PictureDigest::from_pictures(&pictures) != set.sha256 {
        return Err(FormatError::for_document(&place, "these pictures are not those that were written", REWRITE_HINT));
    }
    Ok(pictures)
}

/// The bytes of a picture, which are bounded.
fn picture_bytes(file: io::Result<impl Read>) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file?.take(MAX_PICTURE_BYTES + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MAX_PICTURE_BYTES {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "a picture is larger than 32 MiB"));
    }
    Ok(bytes)
}

/// The first `count` pictures of a kind in one sample of a shard, which lie in their order.
fn sample_pictures(file: &Path, key: &str, kind: PictureKind, count: usize) -> io::Result<Vec<Vec<u8>>> {
    let mut archive = tar::Archive::new(io::BufReader::new(File::open(file)?));
    let mut pictures = Vec::new();
    // It steps over the files of other samples without reading them.
    for entry in archive.entries_with_seek()?.take(MAX_SHARD_FILES) {
        let entry = entry?;
        let name = entry.path()?.to_string_lossy().into_owned();
        if pictures.len() >= count {
            break;
        }
        if name == sample_file(key, kind, pictures.len()) {
            pictures.push(picture_bytes(Ok(entry))?);
        }
    }
    Ok(pictures)
}

/// The name of a picture in a shard.
pub(super) fn sample_file(key: &str, kind: PictureKind, number: usize) -> String {
    format!("{key}.{}.{}", kind.name(), kind.file_name(number))
}
