//! Recognises files by their first bytes, to name a file that cannot be read and suggest how to convert it.

use crate::names::sorted_entries;
use std::{collections::BTreeMap, fs::File, io::Read, path::Path};
use wayword_core::PlatformError;
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

/// Bytes that are read from the beginning of a file to recognise its kind.
const HEAD_BYTES: u64 = 512;
/// Most files of a folder that are looked into; the others are ignored.
const MAX_EXAMINED_FILES: usize = 200;

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
    const fn recording_kind(name: &'static str, hint: &'static str) -> Self {
        Self { name, hint, is_recording: true }
    }

    const fn other_kind(name: &'static str, hint: &'static str) -> Self {
        Self { name, hint, is_recording: false }
    }

    /// The kind of a file; `None` where it is not known.
    pub(crate) fn from_file(file: &Path) -> Option<Self> {
        if !file.is_file() {
            return None;
        }
        let mut head = Vec::new();
        File::open(file).ok()?.take(HEAD_BYTES).read_to_end(&mut head).ok()?;
        Self::from_head(&head)
    }

    /// The kind of a file that begins with these bytes.
    fn from_head(head: &[u8]) -> Option<Self> {
        if head.is_empty() {
            return Some(EMPTY_KIND);
        }
        let begins = |at: usize, bytes: &[u8]| head.get(at..).is_some_and(|rest| rest.starts_with(bytes));
        // Packets of a transport stream are 188 bytes long, and each begins with "G".
        if [0, 188, 376].iter().all(|at| begins(*at, b"G")) && head_text(head).is_none() {
            return Some(Self::recording_kind("an MPEG transport stream", ENCODE_HINT));
        }
        // Matroska's header, within the first 60 bytes, names the kind of document that follows: `webm` or `matroska`.
        if begins(0, MATROSKA_MAGIC) && head.windows(4).take(60).any(|four| four == b"webm") {
            return Some(Self::recording_kind("a WebM video", ENCODE_HINT));
        }
        if begins(0, b"BM") && is_bitmap(head) {
            return Some(Self::recording_kind("a BMP picture", CONVERT_PICTURE_HINT));
        }
        // See `KNOWN_STARTS`: at 4 is the type of an MP4 box, and at 8 that of a RIFF file.
        let start_fits = |at: usize| match at {
            4 => is_box(head),
            8 => begins(0, b"RIFF"),
            _ => true,
        };
        let known =
            KNOWN_STARTS.iter().find(|(at, bytes, _)| begins(*at, bytes) && start_fits(*at)).map(|(.., kind)| *kind);
        known.or_else(|| kind_of_text_file(head))
    }
}

/// A file without any bytes: its writer did not finish.
const EMPTY_KIND: RecordedFileKind = RecordedFileKind::other_kind("empty", COPY_AGAIN_HINT);
/// EBML's magic number, with which Matroska and WebM begin.
const MATROSKA_MAGIC: &[u8] = &[0x1a, 0x45, 0xdf, 0xa3];
const HEIC_KIND: RecordedFileKind = RecordedFileKind::recording_kind("an HEIC picture", CONVERT_HEIC_HINT);
const MP4_KIND: RecordedFileKind = RecordedFileKind::recording_kind("an MP4 video", "rename it to end in .mp4");
/// Offset and bytes that show a kind; the first that fits counts. Bytes at offset 4 are the type of an MP4 box, and those
/// at offset 8 the type of a RIFF file, so the start of the file has to fit as well.
const KNOWN_STARTS: &[(usize, &[u8], RecordedFileKind)] = &[
    (0, b"\x89PNG\r\n\x1a\n", RecordedFileKind::recording_kind("a PNG picture", "rename it to end in .png")),
    (0, &[0xff, 0xd8, 0xff], RecordedFileKind::recording_kind("a JPEG picture", "rename it to end in .jpg")),
    (0, b"GIF87a", RecordedFileKind::recording_kind("a GIF picture", CONVERT_PICTURE_HINT)),
    (0, b"GIF89a", RecordedFileKind::recording_kind("a GIF picture", CONVERT_PICTURE_HINT)),
    (0, b"II*\0", RecordedFileKind::recording_kind("a TIFF or raw picture", CONVERT_PICTURE_HINT)),
    (0, b"MM\0*", RecordedFileKind::recording_kind("a TIFF or raw picture", CONVERT_PICTURE_HINT)),
    (8, b"WEBP", RecordedFileKind::recording_kind("a WebP picture", CONVERT_PICTURE_HINT)),
    (4, b"ftypavif", RecordedFileKind::recording_kind("an AVIF picture", CONVERT_PICTURE_HINT)),
    (4, b"ftypavis", RecordedFileKind::recording_kind("an AVIF picture", CONVERT_PICTURE_HINT)),
    (4, b"ftyphei", HEIC_KIND),
    (4, b"ftyphev", HEIC_KIND),
    (4, b"ftypmif1", HEIC_KIND),
    (4, b"ftypmsf1", HEIC_KIND),
    (4, b"ftypcrx ", RecordedFileKind::recording_kind("a raw picture", "make a JPEG of it")),
    (4, b"ftyp", MP4_KIND),
    (4, b"moov", MP4_KIND),
    (4, b"mdat", MP4_KIND),
    (4, b"wide", MP4_KIND),
    (4, b"free", MP4_KIND),
    (8, b"AVI ", RecordedFileKind::recording_kind("an AVI video", ENCODE_HINT)),
    (0, MATROSKA_MAGIC, RecordedFileKind::recording_kind("a Matroska video", ENCODE_HINT)),
    (0, b"FLV\x01", RecordedFileKind::recording_kind("a Flash video", ENCODE_HINT)),
    (
        0,
        &[0x30, 0x26, 0xb2, 0x75, 0x8e, 0x66, 0xcf, 0x11],
        RecordedFileKind::recording_kind("a Windows Media video", ENCODE_HINT),
    ),
    (0, b"OggS", RecordedFileKind::recording_kind("an Ogg video", ENCODE_HINT)),
    (0, &[0, 0, 1, 0xba], RecordedFileKind::recording_kind("an MPEG video", ENCODE_HINT)),
    (0, &[0, 0, 0, 1], RecordedFileKind::recording_kind("a bare video stream", ENCODE_HINT)),
    (0, b"#ROSBAG V", RecordedFileKind::recording_kind("a ROS 1 bag", ROS1_BAG_HINT)),
    (0, b"SQLite format 3\0", RecordedFileKind::recording_kind("an SQLite file, as ROS 2 bags are", ROS2_BAG_HINT)),
    (0, b"\x89MCAP0\r\n", RecordedFileKind::recording_kind("an MCAP file", "rename it to end in .mcap")),
    (0, &[0x1f, 0x8b], RecordedFileKind::other_kind("an archive", "unpack it")),
    (0, b"PK\x03\x04", RecordedFileKind::other_kind("an archive", "unpack it")),
    (0, b"version https://git-lfs", RecordedFileKind::other_kind("a pointer of git-lfs", GIT_LFS_HINT)),
];

/// Whether a file can begin with a box of MP4: its length comes first; 0 means "up to the end", and 1 that the length
/// follows later.
fn is_box(head: &[u8]) -> bool {
    let Some(first) = head.first_chunk::<4>() else { return false };
    let is_length = matches!(u32::from_be_bytes(*first), 0 | 1 | 8..=0x8000_0000);
    let is_printable = first.iter().all(|byte| byte.is_ascii_graphic() || byte.is_ascii_whitespace());
    is_length && !is_printable && head_text(head).is_none()
}

/// Whether a file that begins with "BM" goes on as a bitmap: four zero bytes, and after 14 bytes a header with one of
/// the known lengths.
fn is_bitmap(head: &[u8]) -> bool {
    let number_at = |at: usize| head.get(at..)?.first_chunk::<4>().map(|bytes| u32::from_le_bytes(*bytes));
    number_at(6) == Some(0) && matches!(number_at(14), Some(12 | 40 | 52 | 56 | 64 | 108 | 124))
}

/// Bytes as text; `None` where they are not text.
fn head_text(head: &[u8]) -> Option<&str> {
    // The last character may be cut.
    let text = match std::str::from_utf8(head) {
        Ok(text) => text,
        Err(error) if error.error_len().is_none() => std::str::from_utf8(head.get(..error.valid_up_to())?).ok()?,
        Err(_) => return None,
    };
    text.chars().all(|c| !c.is_control() || matches!(c, '\n' | '\r' | '\t')).then_some(text)
}

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
    fn files_are_named_by_their_first_bytes() {
        // As heif-enc, cwebp and ffmpeg write them.
        assert_eq!(name(b"\0\0\0\x1cftypheic\0\0\0\0mif1heicmiaf"), "an HEIC picture");
        assert_eq!(name(b"\0\0\0\x1cftypavif\0\0\0\0avifmif1miaf"), "an AVIF picture");
        assert_eq!(name(b"\0\0\0\x20ftypisom\0\0\x02\0isomiso2"), "an MP4 video");
        assert_eq!(name(b"\0\0\0\x01mdat\0\0\0\0\0\0\0\x20"), "an MP4 video");
        assert_eq!(name(b"RIFF\x24\0\0\0WEBPVP8 "), "a WebP picture");
        assert_eq!(name(b"RIFF\xdc\x6d\0\0AVI LIST"), "an AVI video");
        assert_eq!(
            name(b"\x1a\x45\xdf\xa3\x9fB\x86\x81\x01B\xf7\x81\x01B\xf2\x81\x04B\xf3\x81\x08B\x82\x84webm"),
            "a WebM video"
        );
        assert_eq!(name(b"\x1a\x45\xdf\xa3\xa3B\x86\x81\x01B\xf7\x81\x01B\x82\x88matroska"), "a Matroska video");
        assert_eq!(name(b""), "empty");
        assert_eq!(name("It was no video, but a caf\u{e9}".as_bytes()), "text");
        assert_eq!(name(&"\u{e9}".as_bytes()[..1]), "text", "the last character is cut");
        assert_eq!(name(b"<!DOCTYPE html><title>404"), "a web page");
        assert_eq!(name(b"version https://git-lfs.github.com/spec/v1\noid"), "a pointer of git-lfs");
        assert_eq!(name(b"#ROSBAG V2.0\n"), "a ROS 1 bag");
        assert_eq!(name(b"\x02\x03\x04\x05 nothing"), "?");
    }

    #[test]
    fn text_is_not_taken_for_a_recording() {
        for words in ["The wide hall", "Are free seats", "F\u{fc} wide hall", "The old WEBP files", "The old AVI files"]
        {
            assert_eq!(name(words.as_bytes()), "text", "{words}");
        }
        assert_eq!(name(b"The wide h\xe4ll"), "?", "Latin-1");
        assert_eq!(name(b"\0\0\0\x02wide"), "?", "no box is two bytes long");
        assert_eq!(name(b"BM is short for bitmap"), "text");
        assert_eq!(name("G".repeat(400).as_bytes()), "text");
    }

    #[test]
    fn three_packets_make_a_transport_stream() {
        let mut packets = vec![0xff; 512];
        for at in [0, 188] {
            packets[at] = b'G';
        }
        assert_eq!(name(&packets), "?");
        packets[376] = b'G';
        assert_eq!(name(&packets), "an MPEG transport stream");
    }

    #[test]
    fn conversion_commands_encode_videos_again() {
        for (_, _, kind) in KNOWN_STARTS {
            assert!(!kind.hint.contains("copy "), "{}", kind.hint);
        }
    }
}
