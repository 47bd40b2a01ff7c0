//! Recognises files by their first bytes, to name a file that cannot be read and suggest how to convert it.

use crate::names::sorted_entries;
use std::{collections::BTreeMap, fs::File, io::Read, path::Path};
use wayword_core::{FILE_START_BYTES, FileGroup, FileStart, PlatformError, file_start::head_text};
#[cfg(any(feature = "mcap", feature = "video"))]
use wayword_world::files;

/// The advice for a video: a command that converts any video that ffmpeg reads. It encodes the pictures again, because only
/// H.264 and AV1 could be copied, and few videos hold these. An odd width or height loses its last pixels, because yuv420p has
/// none; an even one stays.
pub(crate) const ENCODE_HINT: &str = "if a video player shows it, convert it: ffmpeg -i IN -c:v libx264 -pix_fmt yuv420p -vf \
                                      \"crop=trunc(iw/2)*2:trunc(ih/2)*2\" -an OUT.mp4";
const CONVERT_PICTURE_HINT: &str = "convert it: ffmpeg -i IN -frames:v 1 OUT.png";
const CONVERT_HEIC_HINT: &str = "convert it: heif-convert IN OUT.jpg (package libheif-examples), \
                            or on macOS: sips -s format jpeg IN --out OUT.jpg";
const ROS1_BAG_HINT: &str =
    "convert it: rosbags-convert --src IN.bag --dst OUT --dst-storage mcap --dst-typestore ros2_humble (PyPI rosbags)";
const ROS2_BAG_HINT: &str = "convert it: rosbags-convert --src FOLDER --dst OUT --dst-storage mcap (PyPI rosbags)";
const GIT_LFS_HINT: &str = "fetch the file itself: git lfs pull";
const COPY_AGAIN_HINT: &str = "copy or record it again";

/// Most files of a folder that are looked into; the others are ignored.
const MAX_EXAMINED_FILES: usize = 200;

const RAW_HINT: &str = "make a JPEG of it";
const DOCUMENT_HINT: &str = "give the file or the folder of the recording";

/// The kind of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RecordedFileKind {
    /// Its name with an article, to follow "is".
    pub(crate) name: &'static str,
    /// A way to use it, or to get an intact file.
    pub(crate) hint: &'static str,
    /// Whether it holds pictures or a recording, and not something useless.
    pub(crate) is_recording: bool,
}

impl RecordedFileKind {
    const fn other_kind(name: &'static str, hint: &'static str) -> Self {
        Self { name, hint, is_recording: false }
    }

    /// The kind of a file; `None` where it is not known.
    pub(crate) fn from_file(file: &Path) -> Option<Self> {
        if !file.is_file() {
            return None;
        }
        let mut head = Vec::new();
        File::open(file).ok()?.take(FILE_START_BYTES as u64).read_to_end(&mut head).ok()?;
        Self::from_head(&head)
    }

    /// The kind of a file that begins with these bytes.
    fn from_head(head: &[u8]) -> Option<Self> {
        if head.is_empty() {
            return Some(EMPTY_KIND);
        }
        FileStart::from_bytes(head).map(Self::from_start).or_else(|| kind_of_text_file(head))
    }

    /// A kind with what its group is good for.
    const fn from_start(FileStart { name, group }: FileStart) -> Self {
        let (hint, is_recording) = match group {
            FileGroup::Png => ("rename it to end in .png", true),
            FileGroup::Jpeg => ("rename it to end in .jpg", true),
            FileGroup::Heic => (CONVERT_HEIC_HINT, true),
            FileGroup::RawPicture => (RAW_HINT, true),
            FileGroup::Picture => (CONVERT_PICTURE_HINT, true),
            FileGroup::Mp4 => ("rename it to end in .mp4", true),
            FileGroup::Video => (ENCODE_HINT, true),
            FileGroup::Ros1Bag => (ROS1_BAG_HINT, true),
            FileGroup::Database => (ROS2_BAG_HINT, true),
            FileGroup::Mcap => ("rename it to end in .mcap", true),
            FileGroup::Archive => ("unpack it", false),
            FileGroup::LfsPointer => (GIT_LFS_HINT, false),
            FileGroup::ProgramData | FileGroup::Document | FileGroup::Utf16 => (DOCUMENT_HINT, false),
        };
        Self { name, hint, is_recording }
    }
}

/// A file without any bytes: its writer did not finish.
const EMPTY_KIND: RecordedFileKind = RecordedFileKind::other_kind("empty", COPY_AGAIN_HINT);

/// The kind of a file that is text: a web page, or any other text.
fn kind_of_text_file(head: &[u8]) -> Option<RecordedFileKind> {
    let text = head_text(head)?;
    let start = text.trim_start().to_ascii_lowercase();
    if start.starts_with("<!doctype html") || start.starts_with("<html") {
        return Some(RecordedFileKind::other_kind(
            "a web page",
            "a server sent this page instead of the file; fetch the file again",
        ));
    }
    Some(RecordedFileKind::other_kind("text", COPY_AGAIN_HINT))
}

/// Recordings that cannot be read, in words, and what to do about the most frequent kind.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct UnreadRecordings {
    /// For a file its kind, as "a WebM video"; for a folder its files, as "1.heic is an HEIC picture (and 3 more)".
    pub(crate) what: String,
    pub(crate) hint: &'static str,
}

/// Finds the recordings of known kinds at a path where nothing could be read: a file, or the files of a folder and of some of
/// its `subfolders`. `None` where there are none.
///
/// # Errors
/// When a folder cannot be read.
pub(crate) fn find_unread(path: &Path, subfolders: &[&str]) -> Result<Option<UnreadRecordings>, PlatformError> {
    if !path.is_dir() {
        let kind = RecordedFileKind::from_file(path).filter(|kind| kind.is_recording);
        return Ok(kind.map(|kind| UnreadRecordings { what: kind.name.to_owned(), hint: kind.hint }));
    }
    let folders = std::iter::once(path.to_owned()).chain(subfolders.iter().map(|name| path.join(name)));
    // For each kind: the number of its files, the name of the first of them, and the hint.
    let mut counts: BTreeMap<&str, (usize, String, &'static str)> = BTreeMap::new();
    for folder in folders.filter(|folder| folder.is_dir()) {
        let names = sorted_entries(&folder)?.into_iter().filter(|name| !name.starts_with('.'));
        for name in names.take(MAX_EXAMINED_FILES) {
            if let Some(kind) = RecordedFileKind::from_file(&folder.join(&name)).filter(|kind| kind.is_recording) {
                counts.entry(kind.name).or_insert((0, name, kind.hint)).0 += 1;
            }
        }
    }
    let Some(hint) = counts.values().max_by_key(|(count, ..)| *count).map(|(.., hint)| *hint) else { return Ok(None) };
    let parts = counts.iter().map(|(kind, (count, name, _))| match count {
        1 => format!("{name} is {kind}"),
        more => format!("{name} is {kind} (and {} more)", more - 1),
    });
    Ok(Some(UnreadRecordings { what: parts.collect::<Vec<_>>().join("; "), hint }))
}

/// The error for a file that should be of kind `expected`, but that the reader for this kind refused with `reason`. If the
/// first bytes show another kind, the error names that kind instead.
#[cfg(any(feature = "mcap", feature = "video"))]
pub(crate) fn refuse_file(file: &Path, expected: &str, (reason, hint): (String, &'static str)) -> PlatformError {
    match RecordedFileKind::from_file(file).filter(|kind| kind.name != expected) {
        Some(kind) if kind.hint.starts_with("rename") => {
            files::file_error(file, format!("is {}, although its name says otherwise", kind.name), kind.hint)
        }
        Some(kind) => files::file_error(file, format!("is {}, not {expected}", kind.name), kind.hint),
        None => files::file_error(file, reason, hint),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(head: &[u8]) -> &'static str {
        RecordedFileKind::from_head(head).map_or("?", |kind| kind.name)
    }

    #[test]
    fn text_and_empty_files_are_named_beside_the_known_kinds() {
        assert_eq!(name(b""), "empty");
        assert_eq!(name("It was no video, but a caf\u{e9}".as_bytes()), "text");
        assert_eq!(name(&"\u{e9}".as_bytes()[..1]), "text", "the last character is cut");
        assert_eq!(name(b"<!DOCTYPE html><title>404"), "a web page");
        assert_eq!(name(b"BM is short for bitmap"), "text");
        assert_eq!(name(b"The wide h\xe4ll"), "?", "Latin-1");
    }

    #[test]
    fn only_recordings_can_be_used_and_each_kind_has_advice() {
        let kind = |head: &[u8]| RecordedFileKind::from_head(head).unwrap();
        for (head, hint) in [
            (b"\0\0\0\x20ftypisom\0\0\x02\0".as_slice(), "rename it to end in .mp4"),
            (b"#ROSBAG V2.0\n", "rosbags-convert"),
            (b"SQLite format 3\0", "rosbags-convert"),
            (b"OggS", "libx264"),
        ] {
            assert!(kind(head).is_recording && kind(head).hint.contains(hint), "{head:?}");
        }
        for head in [b"%PDF-1.4".as_slice(), b"PK\x03\x04", b"\x93NUMPY", b"glTF", b"\xff\xfea\0"] {
            assert!(!kind(head).is_recording && !kind(head).hint.contains("rename"), "{head:?}");
        }
    }

    #[test]
    fn conversion_commands_encode_videos_again() {
        for hint in [ENCODE_HINT, CONVERT_PICTURE_HINT, CONVERT_HEIC_HINT, ROS1_BAG_HINT, ROS2_BAG_HINT] {
            assert!(!hint.contains("copy "), "{hint}");
        }
    }
}
