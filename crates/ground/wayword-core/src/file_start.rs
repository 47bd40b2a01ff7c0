//! The kinds of files by their first bytes, for messages about a file that is another one than its name says.

/// Bytes of a file's beginning that decide.
pub const FILE_START_BYTES: usize = 512;

/// What a file can be used for. Each reader of files has its own advice for each of these.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileGroup {
    /// A PNG picture.
    Png,
    /// A JPEG picture.
    Jpeg,
    /// A picture as iPhones take them.
    Heic,
    /// A raw picture of a camera, in a form that few programs read.
    RawPicture,
    /// Another picture.
    Picture,
    /// An MP4 video.
    Mp4,
    /// Another video.
    Video,
    /// A bag of ROS 1.
    Ros1Bag,
    /// A database, as bags of ROS 2 are.
    Database,
    /// An MCAP file.
    Mcap,
    /// Files that are packed together, or one that is packed.
    Archive,
    /// Numbers, tables or objects in a form for programs.
    ProgramData,
    /// A document or a 3D model.
    Document,
    /// A pointer of git-lfs in the place of a file.
    LfsPointer,
    /// Text in UTF-16.
    Utf16,
}

/// The kind of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileStart {
    /// Its name with an article, to follow "is".
    pub name: &'static str,
    /// What it can be used for.
    pub group: FileGroup,
}

/// EBML's magic number, with which Matroska and WebM begin.
const MATROSKA_MAGIC: &[u8] = &[0x1a, 0x45, 0xdf, 0xa3];
const HEIC: (&str, FileGroup) = ("an HEIC picture", FileGroup::Heic);
const MP4: (&str, FileGroup) = ("an MP4 video", FileGroup::Mp4);
const TIFF: (&str, FileGroup) = ("a TIFF or raw picture", FileGroup::Picture);
const PICKLE: (&str, FileGroup) = ("a pickle of Python", FileGroup::ProgramData);
const UTF_16: (&str, FileGroup) = ("text in UTF-16", FileGroup::Utf16);

/// Offset and bytes that show a kind; the first that fits counts. Bytes at offset 4 are the type of an MP4 box, and those at offset
/// 8 the type of a RIFF file, so the start of the file has to fit as well.
const KNOWN_STARTS: [(usize, &[u8], (&str, FileGroup)); 49] = [
    (0, b"\x89PNG\r\n\x1a\n", ("a PNG picture", FileGroup::Png)),
    (0, &[0xff, 0xd8, 0xff], ("a JPEG picture", FileGroup::Jpeg)),
    (0, b"GIF87a", ("a GIF picture", FileGroup::Picture)),
    (0, b"GIF89a", ("a GIF picture", FileGroup::Picture)),
    (0, b"II*\0", TIFF),
    (0, b"MM\0*", TIFF),
    (8, b"WEBP", ("a WebP picture", FileGroup::Picture)),
    (4, b"ftypavif", ("an AVIF picture", FileGroup::Picture)),
    (4, b"ftypavis", ("an AVIF picture", FileGroup::Picture)),
    (4, b"ftyphei", HEIC),
    (4, b"ftyphev", HEIC),
    (4, b"ftypmif1", HEIC),
    (4, b"ftypmsf1", HEIC),
    (4, b"ftypcrx ", ("a raw picture", FileGroup::RawPicture)),
    (4, b"ftyp", MP4),
    (4, b"moov", MP4),
    (4, b"mdat", MP4),
    (4, b"wide", MP4),
    (4, b"free", MP4),
    (8, b"AVI ", ("an AVI video", FileGroup::Video)),
    (0, MATROSKA_MAGIC, ("a Matroska video", FileGroup::Video)),
    (0, b"FLV\x01", ("a Flash video", FileGroup::Video)),
    (0, &[0x30, 0x26, 0xb2, 0x75, 0x8e, 0x66, 0xcf, 0x11], ("a Windows Media video", FileGroup::Video)),
    (0, b"OggS", ("an Ogg video", FileGroup::Video)),
    (0, &[0, 0, 1, 0xba], ("an MPEG video", FileGroup::Video)),
    (0, &[0, 0, 0, 1], ("a bare video stream", FileGroup::Video)),
    (0, b"#ROSBAG V", ("a ROS 1 bag", FileGroup::Ros1Bag)),
    (0, b"SQLite format 3\0", ("an SQLite database", FileGroup::Database)),
    (0, b"\x89MCAP0\r\n", ("an MCAP file", FileGroup::Mcap)),
    (0, &[0x1f, 0x8b], ("packed by gzip", FileGroup::Archive)),
    (0, b"PK\x03\x04", ("a zip archive, or a file that is one inside (.xlsx, .npz, .pt)", FileGroup::Archive)),
    (0, b"BZh", ("packed by bzip2", FileGroup::Archive)),
    (0, b"\xfd7zXZ\0", ("packed by xz", FileGroup::Archive)),
    (0, b"\x28\xb5\x2f\xfd", ("packed by zstd", FileGroup::Archive)),
    (0, b"7z\xbc\xaf\x27\x1c", ("a 7z archive", FileGroup::Archive)),
    (0, b"Rar!\x1a\x07", ("a rar archive", FileGroup::Archive)),
    (257, b"ustar", ("a tar archive", FileGroup::Archive)),
    (0, b"\x80\x02", PICKLE),
    (0, b"\x80\x03", PICKLE),
    (0, b"\x80\x04", PICKLE),
    (0, b"\x80\x05", PICKLE),
    (0, b"PAR1", ("a Parquet table", FileGroup::ProgramData)),
    (0, b"\x89HDF\r\n", ("an HDF5 file", FileGroup::ProgramData)),
    (0, b"\x93NUMPY", ("an array of NumPy", FileGroup::ProgramData)),
    (0, b"%PDF-", ("a PDF document", FileGroup::Document)),
    (0, b"glTF", ("a 3D model (glTF)", FileGroup::Document)),
    (0, b"version https://git-lfs", ("a pointer of git-lfs", FileGroup::LfsPointer)),
    (0, b"\xff\xfe", UTF_16),
    (0, b"\xfe\xff", UTF_16),
];

impl FileStart {
    /// The kind of a file that begins with these bytes, at most [`FILE_START_BYTES`]; `None` where it is not known. Text is of no
    /// kind here, except in UTF-16.
    #[must_use]
    pub fn from_bytes(head: &[u8]) -> Option<Self> {
        let begins = |at: usize, bytes: &[u8]| head.get(at..).is_some_and(|rest| rest.starts_with(bytes));
        let kind = |(name, group): (&'static str, FileGroup)| Some(Self { name, group });
        // Packets of a transport stream are 188 bytes long, and each begins with "G".
        if [0, 188, 376].iter().all(|at| begins(*at, b"G")) && head_text(head).is_none() {
            return kind(("an MPEG transport stream", FileGroup::Video));
        }
        // Matroska's header, within the first 60 bytes, names the kind of document that follows: `webm` or `matroska`.
        if begins(0, MATROSKA_MAGIC) && head.windows(4).take(60).any(|four| four == b"webm") {
            return kind(("a WebM video", FileGroup::Video));
        }
        if begins(0, b"BM") && is_bitmap(head) {
            return kind(("a BMP picture", FileGroup::Picture));
        }
        let start_fits = |at: usize| match at {
            4 => is_box(head),
            8 => begins(0, b"RIFF"),
            _ => true,
        };
        let known = KNOWN_STARTS.iter().find(|(at, bytes, _)| begins(*at, bytes) && start_fits(*at));
        known.and_then(|(.., found)| kind(*found))
    }
}

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

/// The beginning of a file as text; `None` where it is no text. The last character may be cut.
#[must_use]
pub fn head_text(head: &[u8]) -> Option<&str> {
    let text = match std::str::from_utf8(head) {
        Ok(text) => text,
        Err(error) if error.error_len().is_none() => std::str::from_utf8(head.get(..error.valid_up_to())?).ok()?,
        Err(_) => return None,
    };
    text.chars().all(|c| !c.is_control() || matches!(c, '\n' | '\r' | '\t')).then_some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(head: &[u8]) -> &'static str {
        FileStart::from_bytes(head).map_or("?", |kind| kind.name)
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
        assert_eq!(name(b"version https://git-lfs.github.com/spec/v1\noid"), "a pointer of git-lfs");
        assert_eq!(name(b"#ROSBAG V2.0\n"), "a ROS 1 bag");
        assert_eq!(name(b"%PDF-1.7\n"), "a PDF document");
        assert_eq!(name(b"\x02\x03\x04\x05 nothing"), "?");
        let tar: Vec<u8> = [b'a'; 257].into_iter().chain(*b"ustar\0").collect();
        assert_eq!(name(&tar), "a tar archive");
    }

    #[test]
    fn text_is_of_no_kind() {
        for words in ["The wide hall", "Are free seats", "F\u{fc} wide hall", "The old WEBP files", "The old AVI files"]
        {
            assert_eq!(name(words.as_bytes()), "?", "{words}");
        }
        assert_eq!(name(b"The wide h\xe4ll"), "?", "Latin-1");
        assert_eq!(name(b"\0\0\0\x02wide"), "?", "no box is two bytes long");
        assert_eq!(name(b"BM is short for bitmap"), "?");
        assert_eq!(name("G".repeat(400).as_bytes()), "?");
        assert_eq!(head_text(&"a\u{e9}".as_bytes()[..2]), Some("a"), "the last character is cut");
        assert_eq!(head_text(b"\0"), None);
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
}
