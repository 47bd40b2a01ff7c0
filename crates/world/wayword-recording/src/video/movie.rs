//! Reads an MP4 file's video tracks and chooses one of them.

use super::{
    boxes::{BoxFields, BoxHeader, boxes_in, find_box, in_box, need_box},
    codec::ReadableCodec,
    edits::{self, ShownPicture, TickRates},
    fragments::FragmentReader,
    h264,
    picture_turn::PictureTurn,
    sample_entry::{self, SampleEntry, read_entry},
    tables::{self, TrackSample},
};
use std::{
    fs::File,
    io::{Read, Seek, SeekFrom},
};

/// Most bytes of the boxes that describe pictures: about 50 for each of [`tables::MAX_SAMPLES`].
const MAX_DESCRIBING_BYTES: u64 = 512 << 20;

/// Most boxes of a file: two for each picture.
const MAX_BOXES: u64 = 2 * tables::MAX_SAMPLES;

/// The advice for a video that cannot be read.
pub(super) const VIDEO_HINT: &str = crate::file_kind::ENCODE_HINT;
const CAMERA_HINT: &str = "write `camera = \"NUMBER\"` into the .toml file beside it";
const CUT_HINT: &str = "copy the file again from where it was recorded; or keep what is there: \
                        ffmpeg -i IN -c:v libx264 -pix_fmt yuv420p -an OUT.mp4";
const NO_VIDEO_HINT: &str = "give a file with a video; `ffprobe FILE` lists what a file holds";

/// A video track.
#[derive(Debug)]
pub(super) struct Mp4Movie {
    pub(super) codec: ReadableCodec,
    pub(super) turn: PictureTurn,
    /// In the order of decoding.
    pub(super) samples: Vec<TrackSample>,
    /// In the order in which they are shown.
    pub(super) shown: Vec<ShownPicture>,
    /// Whether a fragmented file breaks off, so that later pictures are missing.
    pub(super) breaks_off: bool,
    /// The movie's duration from the file's header, seconds; `None` if a fragmented file has none.
    pub(super) announced_s: Option<f64>,
    /// Width and height of the coded pictures, pixels, from the file's header.
    pub(super) size_px: (u32, u32),
}

impl Mp4Movie {
    /// Reads a file's description of one camera: the track of that number, or the only one there is.
    pub(super) fn read(file: &mut File, camera: Option<&str>) -> Result<Self, Mp4Error> {
        let file_bytes = file.metadata().map_err(|error| error.to_string())?.len();
        let parts = MovieBoxes::read(file, file_bytes)?;
        let mut tracks = Vec::new();
        for trak in boxes_in(&parts.moov).filter(|found| found.kind == *b"trak") {
            tracks.extend(VideoTrack::read(trak.body)?);
        }
        let hint = if tracks.is_empty() { NO_VIDEO_HINT } else { CAMERA_HINT };
        let track = choose_track(&tracks, camera).map_err(|reason| Mp4Error { reason, hint })?;
        track
            .read_movie(&parts, file_bytes)
            .map_err(|error| Mp4Error { reason: format!("track {} {}", track.number, error.reason), hint: error.hint })
    }
}

/// The reason why a file cannot be read, and a way out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Mp4Error {
    pub(super) reason: String,
    pub(super) hint: &'static str,
}

impl From<String> for Mp4Error {
    fn from(reason: String) -> Self {
        Self { reason, hint: VIDEO_HINT }
    }
}

/// The boxes that describe the pictures of a file.
struct MovieBoxes {
    /// The box `moov`, which describes the tracks.
    moov: Vec<u8>,
    /// Each box `moof`, which describes a fragment, after its offset in the file.
    moofs: Vec<(u64, Vec<u8>)>,
    /// Whether a box goes beyond the end of the file.
    breaks_off: bool,
}

impl MovieBoxes {
    fn read(file: &mut File, file_bytes: u64) -> Result<Self, String> {
        let (mut moov, mut moofs) = (None, Vec::new());
        let (mut start, mut describing, mut count) = (0, 0, 0);
        let mut breaks_off = false;
        while start < file_bytes && count < MAX_BOXES {
            count += 1;
            let Some(header) = header_at(file, start, file_bytes)? else { break };
            let end = start.saturating_add(header.bytes);
            breaks_off |= end > file_bytes;
            if matches!(&header.kind, b"moov" | b"moof") {
                // This is the last fragment of a recording that was cut off.
                if end > file_bytes {
                    break;
                }
                describing += header.bytes;
                if describing > MAX_DESCRIBING_BYTES {
                    return Err(format!("byte {start}: describes more pictures than any camera takes"));
                }
                let body = bytes_at(file, start + header.length as u64, header.bytes - header.length as u64)?;
                match header.kind {
                    kind if kind == *b"moof" => moofs.push((start, body)),
                    _ => moov = Some(body),
                }
            }
            start = end;
        }
        let moov = moov.ok_or_else(|| {
            "is not a complete MP4 file: it has no box `moov`, which recorders write when they stop".to_owned()
        })?;
        Ok(Self { moov, moofs, breaks_off })
    }
}

/// The header of the box at a place of a file; `None` if there is none.
fn header_at(file: &mut File, start: u64, file_bytes: u64) -> Result<Option<BoxHeader>, String> {
    let left = file_bytes - start;
    let bytes = bytes_at(file, start, left.min(BoxHeader::MAX_BYTES as u64))?;
    Ok(BoxHeader::read(&bytes, left))
}

/// Bytes of a file. The caller has checked that the file has them.
pub(super) fn bytes_at(file: &mut File, start: u64, count: u64) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let read = file.seek(SeekFrom::Start(start)).and_then(|_| file.take(count).read_to_end(&mut bytes));
    let read = read.map_err(|error| error.to_string())?;
    if (read as u64) < count {
        return Err(format!("ends at byte {}, in the middle of what begins at byte {start}", start + read as u64));
    }
    Ok(bytes)
}

/// A track with pictures, and the data to choose among several tracks.
struct VideoTrack<'a> {
    number: u32,
    /// The track's box `trak`, and the box `stbl` in it with the tables of samples.
    trak: &'a [u8],
    stbl: &'a [u8],
    ticks_per_s: u32,
    entry: SampleEntry,
}

impl<'a> VideoTrack<'a> {
    /// Reads a track; `None` if it holds sound or other things.
    fn read(trak: &'a [u8]) -> Result<Option<Self>, String> {
        let Some(mdia) = find_box(trak, b"mdia") else { return Ok(None) };
        let Some(hdlr) = find_box(mdia, b"hdlr") else { return Ok(None) };
        // The kind of the track, after version, flags and a reserved number.
        if hdlr.get(8..12) != Some(b"vide") {
            return Ok(None);
        }
        let number = || -> Result<u32, String> {
            let (mut fields, version, _) = BoxFields::with_version(need_box(trak, b"tkhd")?)?;
            // Two times come first.
            fields.read_bytes(if version == 0 { 8 } else { 16 })?;
            fields.read_u32()
        };
        let number = number().map_err(in_box("tkhd"))?;
        let read = || -> Result<Self, String> {
            let ticks_per_s = ticks_per_s(need_box(mdia, b"mdhd")?).map_err(in_box("mdhd"))?;
            let stbl = need_box(need_box(mdia, b"minf")?, b"stbl")?;
            let entry = read_entry(need_box(stbl, b"stsd")?).map_err(in_box("stsd"))?;
            Ok(Self { number, trak, stbl, ticks_per_s, entry })
        };
        read().map(Some).map_err(|reason| format!("track {number}: {reason}"))
    }

    /// Reads the samples of the track, and which of them are shown when.
    fn read_movie(&self, parts: &MovieBoxes, file_bytes: u64) -> Result<Mp4Movie, Mp4Error> {
        let codec = match &self.entry.codec {
            sample_entry::NamedCodec::H264(record) => {
                ReadableCodec::H264(h264::H264Setup::read(record, self.entry.colour)?)
            }
            sample_entry::NamedCodec::Av1 => ReadableCodec::Av1(self.entry.colour),
            sample_entry::NamedCodec::Other(name) => {
                return Err(format!("is in {name}, but only H.264 and AV1 can be read").into());
            }
        };
        let mut samples = tables::read_samples(self.stbl, file_bytes)?;
        let mut fragments = FragmentReader::new(&parts.moov, self.number, file_bytes)?;
        for (start, moof) in &parts.moofs {
            fragments
                .add_fragment(moof, *start, &mut samples)
                .map_err(|reason| format!("byte {start}: box `moof` {reason}"))?;
        }
        let is_fragmented = !parts.moofs.is_empty();
        let lacks_samples = check_whole(&mut samples, file_bytes, is_fragmented)?;
        let movie = find_box(&parts.moov, b"mvhd").map_or(Ok(self.ticks_per_s), ticks_per_s).map_err(in_box("mvhd"))?;
        let shown =
            edits::shown_pictures(&samples, edits::read_edit(self.trak)?, TickRates { movie, track: self.ticks_per_s });
        if shown.is_empty() {
            return Err("holds no pictures".to_owned().into());
        }
        let announced_s = if is_fragmented { announced_s(&parts.moov, movie) } else { None };
        let turn = PictureTurn::read(need_box(self.trak, b"tkhd")?).map_err(in_box("tkhd"))?;
        Ok(Mp4Movie {
            codec,
            turn,
            samples,
            shown,
            breaks_off: is_fragmented && (lacks_samples || parts.breaks_off),
            announced_s,
            size_px: (u32::from(self.entry.width_px), u32::from(self.entry.height_px)),
        })
    }

    /// The track in words: its number, codec and size.
    fn describe_track(&self) -> String {
        let codec = match &self.entry.codec {
            sample_entry::NamedCodec::H264(_) => "H.264",
            sample_entry::NamedCodec::Av1 => "AV1",
            sample_entry::NamedCodec::Other(name) => name,
        };
        format!("{} ({codec}, {} x {})", self.number, self.entry.width_px, self.entry.height_px)
    }
}

/// Ticks per second from `mdhd` or `mvhd`, which begin alike: times, then this number.
fn ticks_per_s(header: &[u8]) -> Result<u32, String> {
    let (mut fields, version, _) = BoxFields::with_version(header)?;
    fields.read_bytes(if version == 0 { 8 } else { 16 })?;
    match fields.read_u32()? {
        0 => Err("says that a second has 0 ticks".to_owned()),
        ticks => Ok(ticks),
    }
}

/// How long a fragmented movie is by its box `mehd`, seconds; `None` if it has none.
fn announced_s(moov: &[u8], ticks_per_s: u32) -> Option<f64> {
    let (mut fields, version, _) = BoxFields::with_version(find_box(find_box(moov, b"mvex")?, b"mehd")?).ok()?;
    let ticks = fields.read_versioned(version).ok().filter(|ticks| *ticks > 0)?;
    Some(ticks as f64 / f64::from(ticks_per_s))
}

/// The track that the user named, else the only one.
fn choose_track<'a, 'b>(tracks: &'b [VideoTrack<'a>], camera: Option<&str>) -> Result<&'b VideoTrack<'a>, String> {
    let names = || tracks.iter().map(VideoTrack::describe_track).collect::<Vec<_>>().join(", ");
    let wanted = camera.map(str::trim);
    let mut fitting = tracks.iter().filter(|track| match wanted {
        Some(wanted) => track.number.to_string() == wanted,
        // Cover pictures and previews do not count as a second camera.
        None => tracks.len() == 1 || !matches!(track.entry.codec, sample_entry::NamedCodec::Other(_)),
    });
    match (fitting.next(), fitting.next(), wanted) {
        (Some(track), None, _) => Ok(track),
        _ if tracks.is_empty() => Err("holds no track that says it is a video".to_owned()),
        (_, _, Some(wanted)) => Err(format!("has no video track {wanted:?}; it has {}", names())),
        _ => Err(format!("holds several video tracks: {}", names())),
    }
}

/// Checks that all samples lie in the file. A fragmented file that was cut off is read as far as it goes; returns whether it was.
fn check_whole(samples: &mut Vec<TrackSample>, file_bytes: u64, is_fragmented: bool) -> Result<bool, Mp4Error> {
    let outside = |sample: &TrackSample| sample.offset.saturating_add(u64::from(sample.bytes)) > file_bytes;
    let first = samples.iter().position(outside).and_then(|at| Some((at, samples.get(at)?.offset)));
    let Some((first, offset)) = first else { return Ok(false) };
    if is_fragmented && first > 0 {
        samples.truncate(first);
        return Ok(true);
    }
    let reason = format!(
        "is cut off: picture {first} of {} should lie at byte {offset}, but the file has only {file_bytes} bytes",
        samples.len()
    );
    Err(Mp4Error { reason, hint: CUT_HINT })
}
