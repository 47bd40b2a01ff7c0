//! Reads sequence parameter sets, the description of an H.264 stream (ITU-T H.264, section 7.3.2.1.1 and annex E).
//!
//! `h264-reader` reads the bits and the sampling of colours. It could read a whole parameter set too, but it refuses sets
//! with a level that is too low for their size, sets that are cut off after the colours, and sets with bytes that could be
//! a false start. Players show such videos all the same.

use super::colour::StreamColour;
use h264_reader::{
    nal::sps::{ChromaFormat, ChromaInfo, SpsError},
    rbsp::{BitRead, BitReader},
};
use wayword_core::run_contained;

/// Most bytes of a unit that are read: the needed fields come before this.
const MAX_UNIT_BYTES: usize = 1 << 14;

/// The part of a sequence parameter set that is needed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct SequenceParameters {
    /// Size as coded, which may be a little larger than the shown picture.
    pub(super) width_px: u32,
    pub(super) height_px: u32,
    pub(super) chroma_format: ChromaFormat,
    pub(super) bits: u8,
    /// Whether rows of a picture are coded in two halves.
    pub(super) is_interlaced: bool,
    pub(super) colour: StreamColour,
}

impl SequenceParameters {
    /// Reads a NAL unit of type 7; `None` if it is broken.
    pub(super) fn read(unit: &[u8]) -> Option<Self> {
        let mut zeros = 0;
        let plain = unit.iter().skip(1).take(MAX_UNIT_BYTES).copied().filter(|byte| {
            // Bytes that were put in to avoid false starts (section 7.4.1).
            let is_put_in = zeros >= 2 && *byte == 3;
            zeros = if *byte == 0 { zeros + 1 } else { 0 };
            !is_put_in
        });
        let plain: Vec<u8> = plain.collect();
        run_contained(|| read_parameters(&mut BitReader::new(plain.as_slice())).ok()).flatten()
    }
}

fn read_parameters(bits: &mut impl BitRead) -> Result<SequenceParameters, SpsError> {
    let profile = bits.read::<8, u8>("profile_idc")?;
    bits.skip(16, "level_idc")?;
    bits.read_ue("seq_parameter_set_id")?;
    let sampling = ChromaInfo::read(bits, profile.into())?;
    bits.read_ue("log2_max_frame_num_minus4")?;
    skip_order(bits)?;
    bits.read_ue("max_num_ref_frames")?;
    bits.read_bit("gaps_in_frame_num_value_allowed_flag")?;
    let width = bits.read_ue("pic_width_in_mbs_minus1")?;
    let height = bits.read_ue("pic_height_in_map_units_minus1")?;
    let is_interlaced = !bits.read_bit("frame_mbs_only_flag")?;
    if is_interlaced {
        bits.read_bit("mb_adaptive_frame_field_flag")?;
    }
    bits.read_bit("direct_8x8_inference_flag")?;
    if bits.read_bit("frame_cropping_flag")? {
        for edge in ["left_offset", "right_offset", "top_offset", "bottom_offset"] {
            bits.read_ue(edge)?;
        }
    }
    // Sizes that overflow are refused later as too large. Usability parameters that are cut off count as absent.
    let pixels = |blocks: u32, px: u32| blocks.saturating_add(1).saturating_mul(px);
    let has_usability = bits.read_bit("vui_parameters_present_flag")?;
    Ok(SequenceParameters {
        width_px: pixels(width, 16),
        height_px: pixels(height, if is_interlaced { 32 } else { 16 }),
        chroma_format: sampling.chroma_format,
        bits: 8 + sampling.bit_depth_luma_minus8.max(sampling.bit_depth_chroma_minus8),
        is_interlaced,
        colour: if has_usability { read_colours(bits).unwrap_or_default() } else { StreamColour::default() },
    })
}

/// Skips the coding of the pictures' order.
fn skip_order(bits: &mut impl BitRead) -> Result<(), SpsError> {
    match bits.read_ue("pic_order_cnt_type")? {
        0 => drop(bits.read_ue("log2_max_pic_order_cnt_lsb_minus4")?),
        1 => {
            bits.read_bit("delta_pic_order_always_zero_flag")?;
            bits.read_se("offset_for_non_ref_pic")?;
            bits.read_se("offset_for_top_to_bottom_field")?;
            for _ in 0..bits.read_ue("num_ref_frames_in_pic_order_cnt_cycle")?.min(255) {
                bits.read_se("offset_for_ref_frame")?;
            }
        }
        _ => {}
    }
    Ok(())
}

/// Annex E.1.1, up to the colours.
fn read_colours(bits: &mut impl BitRead) -> Result<StreamColour, SpsError> {
    if bits.read_bit("aspect_ratio_info_present_flag")? && bits.read::<8, u8>("aspect_ratio_idc")? == 255 {
        bits.skip(32, "sar_width")?;
    }
    if bits.read_bit("overscan_info_present_flag")? {
        bits.read_bit("overscan_appropriate_flag")?;
    }
    let mut colour = StreamColour::default();
    if bits.read_bit("video_signal_type_present_flag")? {
        bits.skip(3, "video_format")?;
        colour.full_range = Some(bits.read_bit("video_full_range_flag")?);
        if bits.read_bit("colour_description_present_flag")? {
            bits.skip(16, "colour_primaries")?;
            colour.matrix = StreamColour::matrix_from_code(bits.read::<8, u8>("matrix_coefficients")?.into());
        }
    }
    Ok(colour)
}
