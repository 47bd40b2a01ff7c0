//! Passes of a picture, as the build encodes them.

use image::{ExtendedColorType, ImageEncoder, codecs};
use wayword_render::RenderedPicture;

/// Near and far plane of TDW's cameras, metres.
const PLANES_M: [f32; 2] = [0.1, 100.0];

/// One pass: mask, bytes, extension.
pub(super) struct EncodedPass(pub(super) i32, pub(super) Vec<u8>, pub(super) u8);

/// The passes of a drawn picture that the build would send for `names`. Unknown passes are left out. In the `_id` pass,
/// pixels that show no object are black.
pub(super) fn encode_passes(
    picture: &RenderedPicture,
    names: &[String],
    png: bool,
    is_object: impl Fn(u32) -> bool,
) -> Vec<EncodedPass> {
    let colour = |id: &u32| if is_object(*id) { id_colour(*id) } else { [0; 3] };
    let colours = || picture.ids.iter().flat_map(colour).collect::<Vec<u8>>();
    let pass = |name: &String| {
        Some(match name.as_str() {
            "_img" if png => EncodedPass(1, png_file((picture.width, picture.height), &picture.rgb), 1),
            "_img" => EncodedPass(1, as_jpeg(picture), 2),
            "_id" => EncodedPass(2, png_file((picture.width, picture.height), &colours()), 1),
            "_depth" => EncodedPass(16, encode_depth(picture), 1),
            _ => return None,
        })
    };
    names.iter().filter_map(pass).collect()
}

/// The colour of an object in the `_id` pass: a different one for each id. Black (id 0) means no object.
pub(crate) fn id_colour(id: u32) -> [u8; 3] {
    let [r, g, b, _] = id.wrapping_mul(0x009e_3779).to_le_bytes();
    [r, g, b]
}

/// RGB pixels as a PNG, with fast compression.
pub(crate) fn png_file((width, height): (u32, u32), rgb: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let (compression, filter) = (codecs::png::CompressionType::Fast, codecs::png::FilterType::Sub);
    let encoder = codecs::png::PngEncoder::new_with_quality(&mut bytes, compression, filter);
    // This cannot fail, because it writes to memory and the size fits the pixels.
    let _ = encoder.write_image(rgb, width, height, ExtendedColorType::Rgb8);
    bytes
}

fn as_jpeg(picture: &RenderedPicture) -> Vec<u8> {
    let mut bytes = Vec::new();
    let encoder = codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 90);
    let _ = encoder.write_image(&picture.rgb, picture.width, picture.height, ExtendedColorType::Rgb8);
    bytes
}

/// Raw pixels, the bottom row first: `depth = (r + g / 256 + b / 65536) * (far - near) / 256`
/// (`TDWUtils.get_depth_values`).
fn encode_depth(picture: &RenderedPicture) -> Vec<u8> {
    let [near, far] = PLANES_M;
    let rows = picture.depth_m.chunks(picture.width.max(1) as usize).rev();
    let encoded = |depth_m: &f32| {
        let share = (depth_m.min(far) / (far - near)).clamp(0.0, 1.0 - f32::EPSILON);
        let [_, r, g, b] = ((f64::from(share) * f64::from(1 << 24)) as u32).to_be_bytes();
        [r, g, b]
    };
    rows.flatten().flat_map(encoded).collect()
}
