//! Decodes H.264 with Cisco's OpenH264.
//!
//! A stream consists of NAL units: parts of pictures, and parameter sets that describe the stream. In an MP4 file the length of
//! each unit comes before it; OpenH264 wants a start code there.

use super::{
    boxes::{BoxFields, in_box},
    colour::{ChromaPlanes, PicturePlane, PicturePlanes, StreamColour},
    decoder::{CodedSample, SampleDecoder, TakePlanes, check_picture_size},
    sps::SequenceParameters,
};
use h264_reader::nal::sps::ChromaFormat;
use openh264::{
    OpenH264API,
    decoder::{DecodedYUV, Decoder, DecoderConfig, Flush},
    formats::YUVSource,
};
use std::collections::BTreeSet;

const START_CODE: [u8; 4] = [0, 0, 0, 1];
/// The error of OpenH264 itself has only a number.
const CANNOT_DECODE: &str = "cannot be decoded; it may be damaged";
/// Types of NAL units (ITU-T H.264, table 7-1).
const IDR_UNIT: u8 = 5;
const SPS_UNIT: u8 = 7;

/// The settings before the stream: `AVCDecoderConfigurationRecord` (ISO/IEC 14496-15, section 5.3.3.1).
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct H264Setup {
    /// Bytes in which the length of a NAL unit is written.
    length_bytes: usize,
    /// Parameter sets, each after a start code.
    parameters: Vec<u8>,
    colour: StreamColour,
}

impl H264Setup {
    /// Reads an `avcC` box. `colour` has the container's colours; they count if the stream leaves them open.
    pub(super) fn read(record: &[u8], colour: StreamColour) -> Result<Self, String> {
        let (length_bytes, units) = split_record(record).map_err(in_box("avcC"))?;
        let mut setup = Self { length_bytes, parameters: Vec::new(), colour };
        for unit in units {
            if unit_kind(unit) == SPS_UNIT {
                setup.colour = read_decodable_sps(unit)?.colour.or(setup.colour);
            }
            setup.parameters.extend_from_slice(&START_CODE);
            setup.parameters.extend_from_slice(unit);
        }
        Ok(setup)
    }

    /// The NAL units of a sample.
    fn nal_units<'a>(&self, sample: &'a [u8]) -> impl Iterator<Item = Result<&'a [u8], String>> {
        let mut fields = BoxFields::new(sample);
        let length_bytes = self.length_bytes;
        std::iter::from_fn(move || {
            if fields.remaining_bytes().is_empty() {
                return None;
            }
            let unit = fields.read_bytes(length_bytes).and_then(|length| {
                let length = length.iter().fold(0, |length, byte| length << 8 | usize::from(*byte));
                fields.read_bytes(length)
            });
            if unit.is_err() {
                fields = BoxFields::new(&[]);
            }
            Some(unit.map_err(|_| "holds a NAL unit that is longer than the sample".to_owned()))
        })
    }

    /// Whether decoding can begin with a sample. The container's mark is not enough, because it also marks samples that are
    /// followed by wrong pictures at first.
    pub(super) fn can_begin_with(&self, sample: &[u8]) -> bool {
        self.nal_units(sample).any(|unit| unit.is_ok_and(|unit| unit_kind(unit) == IDR_UNIT))
    }
}

/// The number of bytes of a length, and the parameter sets.
fn split_record(record: &[u8]) -> Result<(usize, Vec<&[u8]>), String> {
    let mut fields = BoxFields::new(record);
    fields.read_bytes(4)?;
    let length_bytes = usize::from(fields.read_u8()? & 3) + 1;
    let mut units = Vec::new();
    // Sequence parameter sets, with their number in 5 bits, then picture parameter sets, with theirs in 8.
    for mask in [31, 255] {
        for _ in 0..fields.read_u8()? & mask {
            let length = fields.read_u16()?;
            units.push(fields.read_bytes(length.into())?);
        }
    }
    Ok((length_bytes, units))
}

/// The type of a NAL unit.
fn unit_kind(unit: &[u8]) -> u8 {
    unit.first().map_or(0, |first| first & 31)
}

/// Reads a parameter set; an error if OpenH264 cannot decode the stream, or its pictures are too large.
fn read_decodable_sps(unit: &[u8]) -> Result<SequenceParameters, String> {
    let sps = SequenceParameters::read(unit).ok_or("has a broken sequence parameter set")?;
    check_picture_size(sps.width_px, sps.height_px)?;
    let cannot = |what: &str| Err(format!("is H.264 {what}, which is not read"));
    match sps {
        SequenceParameters { bits: 9.., .. } => cannot(&format!("with {} bits", sps.bits)),
        SequenceParameters { is_interlaced: true, .. } => cannot("with interlaced pictures"),
        SequenceParameters { chroma_format: ChromaFormat::Monochrome | ChromaFormat::YUV420, .. } => Ok(sps),
        _ => cannot("with 4:2:2 or 4:4:4 colours"),
    }
}

/// A decoder of one stream.
pub(super) struct H264Decoder {
    setup: H264Setup,
    decoder: Decoder,
    /// Samples that were fed and have not come out as pictures, in the order in which they are shown. OpenH264 returns no
    /// times, but its pictures come in this order.
    inside: BTreeSet<(i64, usize)>,
    has_begun: bool,
}

impl H264Decoder {
    pub(super) fn new(setup: &H264Setup) -> Result<Self, String> {
        // Flushing after each picture would give the pictures in the order of decoding, and lose some.
        let config = DecoderConfig::new().flush_after_decode(Flush::NoFlush);
        let decoder = Decoder::with_api_config(OpenH264API::from_source(), config);
        let decoder = decoder.map_err(|_| "cannot be decoded: OpenH264 did not start")?;
        Ok(Self { setup: setup.clone(), decoder, inside: BTreeSet::new(), has_begun: false })
    }

    /// A sample with start codes instead of lengths.
    fn add_start_codes(&mut self, sample: &[u8]) -> Result<Vec<u8>, String> {
        let mut stream = if self.has_begun { Vec::new() } else { self.setup.parameters.clone() };
        let mut colour = self.setup.colour;
        for unit in self.setup.nal_units(sample) {
            let unit = unit?;
            if unit_kind(unit) == SPS_UNIT {
                colour = read_decodable_sps(unit)?.colour.or(colour);
            }
            stream.extend_from_slice(&START_CODE);
            stream.extend_from_slice(unit);
        }
        self.setup.colour = colour;
        self.has_begun = true;
        Ok(stream)
    }
}

impl SampleDecoder for H264Decoder {
    fn feed(&mut self, coded: CodedSample<'_>, out: &mut TakePlanes<'_>) -> Result<(), String> {
        let stream = self.add_start_codes(coded.bytes)?;
        self.inside.insert((coded.shown, coded.sample));
        let decoded = self.decoder.decode(&stream).map_err(|_| CANNOT_DECODE)?;
        match decoded {
            Some(decoded) => hand_out(&mut self.inside, self.setup.colour, &decoded, out),
            None => Ok(()),
        }
    }

    fn finish(&mut self, out: &mut TakePlanes<'_>) -> Result<(), String> {
        let rest = self.decoder.flush_remaining().map_err(|_| CANNOT_DECODE)?;
        for decoded in &rest {
            hand_out(&mut self.inside, self.setup.colour, decoded, out)?;
        }
        // After a lost picture, all later ones would get the number of another picture.
        if self.inside.is_empty() {
            Ok(())
        } else {
            Err(format!("lost {} of its pictures in decoding", self.inside.len()))
        }
    }
}

/// Hands out a picture as that of the sample that is shown next.
fn hand_out(
    inside: &mut BTreeSet<(i64, usize)>,
    colour: StreamColour,
    decoded: &DecodedYUV<'_>,
    out: &mut TakePlanes<'_>,
) -> Result<(), String> {
    let (_, sample) = inside.pop_first().ok_or("its decoder gave more pictures than it was fed")?;
    let (width, height) = decoded.dimensions();
    let (stride, stride_blue, stride_red) = decoded.strides();
    let chroma = ChromaPlanes {
        blue: PicturePlane { bytes: decoded.u(), stride: stride_blue },
        red: PicturePlane { bytes: decoded.v(), stride: stride_red },
        shift_x: 1,
        shift_y: 1,
    };
    let brightness = PicturePlane { bytes: decoded.y(), stride };
    let (Ok(width_px), Ok(height_px)) = (u32::try_from(width), u32::try_from(height)) else {
        return Err("its decoder gave a picture of an impossible size".to_owned());
    };
    out(sample, &PicturePlanes { width_px, height_px, bits: 8, brightness, chroma: Some(chroma), colour })
}
