//! Reads the sample entry of a track, which names the codec of its pictures (ISO/IEC 14496-12, section 8.5.2).

use super::{
    boxes::{BoxFields, Mp4Box, boxes_in, find_box, in_box, kind_name, need_box},
    colour::StreamColour,
};

/// Bytes of a `VisualSampleEntry` before its boxes.
const BYTES_BEFORE_BOXES: usize = 78;
/// Common codecs that cannot be read, with their names.
const KNOWN_CODECS: [(&[u8; 4], &str); 14] = [
    (b"hvc1", "HEVC (H.265)"),
    (b"hev1", "HEVC (H.265)"),
    (b"dvh1", "Dolby Vision (HEVC)"),
    (b"dvhe", "Dolby Vision (HEVC)"),
    (b"vp08", "VP8"),
    (b"vp09", "VP9"),
    (b"mp4v", "MPEG-4 Part 2"),
    (b"jpeg", "Motion JPEG"),
    (b"mjpg", "Motion JPEG"),
    (b"png ", "PNG"),
    (b"apcn", "ProRes"),
    (b"apch", "ProRes"),
    (b"ap4h", "ProRes"),
    (b"encv", "an encrypted form"),
];

/// A codec, with the settings that its decoder needs first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum NamedCodec {
    /// `AVCDecoderConfigurationRecord` (ISO/IEC 14496-15, section 5.3.3).
    H264(Vec<u8>),
    /// `AV1CodecConfigurationRecord` (AV1 in ISOBMFF, section 2.3).
    Av1,
    /// A codec that cannot be read, by name.
    Other(String),
}

/// A sample entry.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct SampleEntry {
    pub(super) codec: NamedCodec,
    pub(super) width_px: u16,
    pub(super) height_px: u16,
    /// The colours that the container gives.
    pub(super) colour: StreamColour,
}

/// The sample entry in a track's `stsd`.
pub(super) fn read_entry(stsd: &[u8]) -> Result<SampleEntry, String> {
    let (mut fields, ..) = BoxFields::with_version(stsd)?;
    let count = fields.read_u32()?;
    if count != 1 {
        return Err(format!("lists {count} sample entries, but exactly one can be read"));
    }
    let Mp4Box { kind, body } = boxes_in(fields.remaining_bytes()).next().ok_or("lists no sample entry")?;
    let mut fields = BoxFields::new(body);
    // Reserved fields, up to the size.
    fields.read_bytes(24)?;
    let (width_px, height_px) = (fields.read_u16()?, fields.read_u16()?);
    let within_entry = body.get(BYTES_BEFORE_BOXES..).unwrap_or_default();
    let codec = match &kind {
        b"avc1" | b"avc3" => NamedCodec::H264(need_box(within_entry, b"avcC")?.to_vec()),
        b"av01" => NamedCodec::Av1,
        other => NamedCodec::Other(codec_name(other)),
    };
    Ok(SampleEntry { codec, width_px, height_px, colour: read_colour(within_entry).map_err(in_box("colr"))? })
}

/// The common name of a codec, or else its kind in the file.
fn codec_name(kind: &[u8; 4]) -> String {
    KNOWN_CODECS
        .iter()
        .find(|(known, _)| *known == kind)
        .map_or_else(|| format!("`{}`", kind_name(kind)), |(_, name)| (*name).to_owned())
}

/// Reads the colours in a `colr` box. ISO's `nclx` contains the range, QuickTime's `nclc` does not.
fn read_colour(within_entry: &[u8]) -> Result<StreamColour, String> {
    let Some(colr) = find_box(within_entry, b"colr") else { return Ok(StreamColour::default()) };
    let mut fields = BoxFields::new(colr);
    let kind = fields.read_array::<4>()?;
    if kind != *b"nclx" && kind != *b"nclc" {
        return Ok(StreamColour::default());
    }
    fields.read_bytes(4)?;
    let matrix = StreamColour::matrix_from_code(fields.read_u16()?.into());
    let full_range = if kind == *b"nclx" { Some(fields.read_u8()? & 0x80 != 0) } else { None };
    Ok(StreamColour { matrix, full_range })
}
