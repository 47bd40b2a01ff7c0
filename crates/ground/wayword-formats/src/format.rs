//! Reads files of any dataset format, and recognises their format.

use crate::{
    DatasetFormat, Episode, FormatError,
    beginning::{BeginningFailure, FileContents, look_at_beginning},
    json_fault::JsonFault,
    jsonl, r2r, reverie, rxr,
    training::{episode_lines, navila, streamvln},
    vlnce,
};
use std::path::{Path, PathBuf};

impl DatasetFormat {
    /// Reads a file of this format.
    ///
    /// # Errors
    /// The same as the format's own `read`.
    pub fn read_file(self, file: &Path) -> Result<Vec<Episode>, FormatError> {
        match self {
            Self::R2r => r2r::read_r2r_file(file),
            Self::Reverie => reverie::read_reverie_file(file),
            Self::Rxr => rxr::read_rxr_file(file),
            Self::Vlnce => vlnce::read_vlnce_file(file).map(|dataset| dataset.episodes),
            Self::Wayword => jsonl::read_records(file).map(|records| jsonl::episodes_from_records(&records)),
            Self::Streamvln => streamvln::read_streamvln_episodes(&file_in_dataset(file)),
            Self::Navila => navila::read_navila_episodes(&file_in_dataset(file)),
            Self::Internnav => episode_lines::read_internnav_episodes(&file_in_dataset(file)),
            #[cfg(feature = "parquet")]
            Self::Lerobot => crate::training::lerobot_texts::read_lerobot_episodes(file),
            #[cfg(not(feature = "parquet"))]
            Self::Lerobot => {
                let hint = "build Wayword with `cargo build --release --features full`";
                Err(FormatError::for_document(
                    file,
                    "this build reads no tables, in which a LeRobot dataset has its texts",
                    hint,
                ))
            }
        }
    }
}

/// Reads a file of any of the formats.
///
/// # Errors
/// When its format is not recognised, and when the format's own `read` fails.
pub fn read_any_format(file: &Path) -> Result<Vec<Episode>, FormatError> {
    detect_format(file)?.read_file(file)
}

/// The file with the texts of a dataset's folder, which people name instead of it; `path` itself if it is no such folder.
#[must_use]
pub fn file_in_dataset(path: &Path) -> PathBuf {
    let inside = ["annotations.json", "meta/episodes.jsonl"].map(|name| path.join(name));
    inside.into_iter().find(|file| file.is_file()).unwrap_or_else(|| path.to_owned())
}

/// Recognises a file's format by its beginning, or that of a folder that holds a dataset for training:
///
/// - an item of a list or a line is RxR's where it has `instruction_id`, REVERIE's where it has an object (`objId`) or an
///   `id` that begins with its `path_id`, else R2R's;
/// - an item with `video` and `actions` is StreamVLN's, one with `video_id` and `frames` NaVILA's, and a line with `episode_index` and
///   `tasks` LeRobot's;
/// - an object or line with `format` is Wayword's, one with `episodes` or `instruction_vocab` VLN-CE's.
///
/// # Errors
/// When it cannot be read, or its beginning is none of these. A submission, and other files of the field that are no
/// datasets, are named.
pub fn detect_format(file: &Path) -> Result<DatasetFormat, FormatError> {
    let in_dataset = file_in_dataset(file);
    if in_dataset == file && file.join("meta/info.json").is_file() {
        return Ok(DatasetFormat::Lerobot);
    }
    let file = in_dataset.as_path();
    const FORMATS: &str = "give a file in one of the formats r2r, reverie, rxr, vlnce, wayword";
    let (contents, failure) = look_at_beginning(file)?;
    let refused = |problem: &str, hint| Err(FormatError::for_document(file, problem, hint));
    match contents {
        FileContents::Dataset(format) => Ok(format),
        FileContents::Submission | FileContents::TrajectoriesByName | FileContents::OtherPredictions => refused(
            "it holds what an agent walked, and no episodes",
            "give the dataset that the agent walked; what it walked is for `wayword evaluate`",
        ),
        FileContents::WrappedList(fields) => refused(
            &format!("its beginning does not fit any known format: it is an object with {fields}"),
            "write that list alone",
        ),
        FileContents::ItemsByName => {
            refused("it is an object with an item for each name, and no list", "write its items as a list")
        }
        FileContents::Other(what) => refused(&format!("it is {what}, and no dataset that can be read"), FORMATS),
        FileContents::EmptyList => {
            refused("its beginning does not fit any known format: it is an empty list", "give a file with items")
        }
        FileContents::Unknown => Err(unknown_format(file, failure.as_ref())),
    }
}

/// The error for a file whose beginning says nothing.
fn unknown_format(file: &Path, failure: Option<&BeginningFailure>) -> FormatError {
    const HINT: &str = "give a file in one of the formats r2r, reverie, rxr, vlnce, wayword";
    let unfit = |why: &str, hint| {
        FormatError::for_document(file, format!("its beginning does not fit any known format: {why}"), hint)
    };
    let Some(BeginningFailure { error, field }) = failure else {
        return unfit("it is neither a list of objects nor an object with a field of a known format", HINT);
    };
    if error.is_eof() && (error.line(), error.column()) == (1, 0) {
        return unfit("it is empty", HINT);
    }
    let JsonFault { problem, hint } = JsonFault::new(error);
    let place = format!("line {}, column {}", error.line(), error.column());
    if error.is_eof() {
        return FormatError::for_document(file, format!("{problem} at {place}"), hint);
    }
    let field = field.as_ref().map_or_else(String::new, |field| format!("field \"{field:.40}\": "));
    let place = if error.is_io() { String::new() } else { format!(" ({place})") };
    unfit(&format!("{field}{problem}{place}"), if error.is_data() { HINT } else { hint })
}
