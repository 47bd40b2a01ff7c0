//! Decodes ROS pictures into RGB (encodings of `sensor_msgs/include/sensor_msgs/image_encodings.hpp`).

use super::messages::{self, MessageKind, RawPicture};
use crate::picture_size;
use wayword_core::Image;
use wayword_world::files;

/// The reason why messages with this encoding cannot be read as pictures; `None` if they can.
pub(crate) fn unfit_reason(kind: MessageKind, encoding: &str) -> Option<String> {
    let known = match kind {
        // Depth is `16UC1; compressedDepth png`. If the format does not name depth, the first bytes of the file
        // decide later.
        MessageKind::Compressed => {
            !encoding.contains("compressedDepth") && !is_depth(encoding.split(';').next()?.trim())
        }
        _ => RosPixelLayout::from_encoding(encoding).is_some(),
    };
    let depth = is_depth(encoding.split(';').next()?.trim()) || encoding.contains("compressedDepth");
    (!known).then(|| format!("{encoding:?}{}", if depth { ", which is depth" } else { ", which is not read" }))
}

fn is_depth(encoding: &str) -> bool {
    matches!(encoding, "16UC1" | "16SC1" | "32FC1" | "64FC1")
}

/// Decodes a message of a camera.
pub(crate) fn decode_picture(kind: MessageKind, message: &[u8]) -> Result<Image, String> {
    if kind == MessageKind::Raw {
        return decode_raw(&RawPicture::read(message)?);
    }
    let (format, bytes) = messages::read_compressed(message)?;
    match unfit_reason(kind, &format) {
        Some(why) => Err(format!("has the format {why}")),
        None => files::decode_picture(bytes).map_err(|why| format!("{why} (its format is {format:?})")),
    }
}

/// How the pixels of a row are written.
#[derive(Clone, Copy)]
enum RosPixelLayout {
    /// Bytes per pixel, and which of them are red, green and blue.
    Plain { bytes: usize, rgb: [usize; 3] },
    /// 16 bits of grey.
    Grey16,
    /// Two pixels in four bytes: offsets of the first Y and of U.
    Yuv422 { y: usize, u: usize },
    /// One colour per pixel: column and row of red in each block of 2 x 2.
    Bayer { red: [usize; 2] },
}

impl RosPixelLayout {
    fn from_encoding(encoding: &str) -> Option<Self> {
        Some(match encoding {
            "rgb8" => Self::Plain { bytes: 3, rgb: [0, 1, 2] },
            // `8UC3` has OpenCV's order: `cv_bridge` writes it without naming the colours.
            "bgr8" | "8UC3" => Self::Plain { bytes: 3, rgb: [2, 1, 0] },
            "rgba8" => Self::Plain { bytes: 4, rgb: [0, 1, 2] },
            "bgra8" | "8UC4" => Self::Plain { bytes: 4, rgb: [2, 1, 0] },
            "mono8" | "8UC1" => Self::Plain { bytes: 1, rgb: [0; 3] },
            "mono16" => Self::Grey16,
            "yuv422" | "uyvy" => Self::Yuv422 { y: 1, u: 0 },
            "yuv422_yuy2" | "yuyv" => Self::Yuv422 { y: 0, u: 1 },
            "bayer_rggb8" => Self::Bayer { red: [0, 0] },
            "bayer_grbg8" => Self::Bayer { red: [1, 0] },
            "bayer_gbrg8" => Self::Bayer { red: [0, 1] },
            "bayer_bggr8" => Self::Bayer { red: [1, 1] },
            _ => return None,
        })
    }

    fn bytes_per_pixel(self) -> usize {
        match self {
            Self::Plain { bytes, .. } => bytes,
            Self::Grey16 | Self::Yuv422 { .. } => 2,
            Self::Bayer { .. } => 1,
        }
    }
}

fn decode_raw(raw: &RawPicture<'_>) -> Result<Image, String> {
    let layout =
        RosPixelLayout::from_encoding(&raw.encoding).ok_or_else(|| format!("has the encoding {:?}", raw.encoding))?;
    let (width_px, height_px) = (raw.width_px, raw.height_px);
    if !picture_size::is_possible(width_px, height_px) || width_px == 0 || height_px == 0 {
        return Err(format!("has {width_px} x {height_px} pixels, but only 1 x 1 to 64 megapixels can be read"));
    }
    let (width, height, stride) = (width_px as usize, height_px as usize, raw.row_bytes as usize);
    let row_bytes = width * layout.bytes_per_pixel();
    // The last row may end without the padding between rows.
    let needed = stride.checked_mul(height - 1).and_then(|before| before.checked_add(row_bytes));
    if stride < row_bytes || needed.is_none_or(|needed| needed > raw.pixels.len()) {
        let (encoding, bytes) = (&raw.encoding, raw.pixels.len());
        return Err(format!("has {bytes} bytes in rows of {stride} for {width} x {height} pixels of {encoding}"));
    }
    let row = |y: usize| raw.pixels.get(y * stride..y * stride + row_bytes).unwrap_or_default();
    let mut rgb = Vec::with_capacity(width * height * 3);
    for y in 0..height {
        match layout {
            RosPixelLayout::Plain { bytes, rgb: [r, g, b] } => {
                let level = |pixel: &[u8], at: usize| pixel.get(at).copied().unwrap_or_default();
                rgb.extend(row(y).chunks_exact(bytes).flat_map(|pixel| [r, g, b].map(|at| level(pixel, at))));
            }
            RosPixelLayout::Grey16 => {
                let high = usize::from(!raw.big_endian);
                rgb.extend(row(y).iter().skip(high).step_by(2).flat_map(|level| [*level; 3]));
            }
            RosPixelLayout::Yuv422 { y: first, u } => decode_yuv422(row(y), [first, u], &mut rgb),
            RosPixelLayout::Bayer { red } => {
                let rows = [row(y.saturating_sub(1)), row(y), row((y + 1).min(height - 1))];
                decode_bayer(rows, y, red, &mut rgb);
            }
        }
    }
    Image::new(width_px, height_px, rgb).map_err(|error| error.to_string())
}

/// A row in which each two pixels share their colour (ITU-R BT.601, studio range, as OpenCV's `COLOR_YUV2RGB_UYVY`).
fn decode_yuv422(row: &[u8], [first, u]: [usize; 2], rgb: &mut Vec<u8>) {
    for pair in row.chunks(4) {
        // The last pixel of an odd row has a U but no V, so it becomes grey.
        let chroma = |at: usize| pair.get(at).filter(|_| pair.len() == 4).map_or(0, |level| i32::from(*level) - 128);
        let (blue, red) = (chroma(u), chroma(u + 2));
        for y in pair.iter().skip(first).step_by(2) {
            // The factors of the standard in 256ths.
            let light = 298 * (i32::from(*y) - 16) + 128;
            let colours = [light + 409 * red, light - 100 * blue - 208 * red, light + 516 * blue];
            rgb.extend(colours.map(|colour| u8::try_from((colour >> 8).max(0)).unwrap_or(u8::MAX)));
        }
    }
}

/// A row of a Bayer picture: each colour of a pixel is the mean of that colour in the 3 x 3 pixels around it.
fn decode_bayer(rows: [&[u8]; 3], y: usize, [red_x, red_y]: [usize; 2], rgb: &mut Vec<u8>) {
    let [_, own_row, _] = rows;
    let width = own_row.len();
    for x in 0..width {
        // The sum and the number of the levels of each colour.
        let mut colours = [(0_u32, 0_u32); 3];
        // The rows above and below have the other parity than row `y`.
        for (row, row_parity) in rows.iter().zip([1, 0, 1]) {
            for column in x.saturating_sub(1)..=(x + 1).min(width - 1) {
                // At the edge the row itself replaces the missing one. It has other colours, so it does not count.
                let is_edge_copy = row_parity == 1 && std::ptr::eq(row.as_ptr(), own_row.as_ptr());
                if !is_edge_copy {
                    let steps_from_red = (column + red_x) % 2 + (y + row_parity + red_y) % 2;
                    if let (Some((sum, count)), Some(level)) = (colours.get_mut(steps_from_red), row.get(column)) {
                        *sum += u32::from(*level);
                        *count += 1;
                    }
                }
            }
        }
        rgb.extend(colours.map(|(sum, count)| u8::try_from(sum / count.max(1)).unwrap_or(u8::MAX)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(encoding: &str, (width_px, height_px): (u32, u32), row_bytes: u32, pixels: &[u8]) -> Result<Image, String> {
        let encoding = encoding.to_owned();
        decode_raw(&RawPicture { width_px, height_px, encoding, big_endian: false, row_bytes, pixels })
    }

    #[test]
    fn each_order_of_colours_comes_out_as_rgb() {
        assert_eq!(of("rgb8", (1, 1), 3, &[1, 2, 3]).unwrap().rgb_bytes(), [1, 2, 3]);
        assert_eq!(of("bgr8", (1, 1), 3, &[1, 2, 3]).unwrap().rgb_bytes(), [3, 2, 1]);
        assert_eq!(of("bgra8", (1, 1), 4, &[1, 2, 3, 9]).unwrap().rgb_bytes(), [3, 2, 1]);
        assert_eq!(of("mono8", (2, 1), 2, &[7, 8]).unwrap().rgb_bytes(), [7, 7, 7, 8, 8, 8]);
        assert_eq!(of("mono16", (1, 1), 2, &[7, 8]).unwrap().rgb_bytes(), [8, 8, 8]);
    }

    #[test]
    fn rows_may_be_padded_but_not_cut() {
        assert_eq!(of("mono8", (1, 2), 3, &[5, 0, 0, 6]).unwrap().rgb_bytes(), [5, 5, 5, 6, 6, 6]);
        assert!(of("mono8", (1, 2), 3, &[5, 0, 0]).unwrap_err().contains("3 bytes in rows of 3"));
        assert!(of("rgb8", (2, 1), 3, &[0; 6]).is_err());
        assert!(of("rgb8", (u32::MAX, u32::MAX), u32::MAX, &[0; 6]).unwrap_err().contains("megapixels"));
        assert!(of("rgb8", (0, 0), 0, &[]).is_err());
    }

    #[test]
    fn red_in_two_orders_of_yuv_is_red() {
        // BT.601: red is Y 82, U 90, V 240.
        for (encoding, pixels) in [("yuv422", [90, 82, 240, 82]), ("yuv422_yuy2", [82, 90, 82, 240])] {
            let image = of(encoding, (2, 1), 4, &pixels).unwrap();
            assert!(
                image.rgb_bytes().chunks(3).all(|pixel| pixel[0] > 250 && pixel[1] < 5 && pixel[2] < 5),
                "{encoding}"
            );
        }
        assert_eq!(of("yuv422", (1, 1), 2, &[128, 16]).unwrap().rgb_bytes(), [0, 0, 0]);
    }

    #[test]
    fn an_even_colour_behind_each_bayer_filter_is_that_colour() {
        for (encoding, [x, y]) in
            [("bayer_rggb8", [0, 0]), ("bayer_grbg8", [1, 0]), ("bayer_gbrg8", [0, 1]), ("bayer_bggr8", [1, 1])]
        {
            let pixels: Vec<u8> = (0..16).map(|at| [200, 100, 50][(at % 4 + x) % 2 + (at / 4 + y) % 2]).collect();
            let image = of(encoding, (4, 4), 4, &pixels).unwrap();
            assert!(
                image.rgb_bytes().chunks(3).all(|pixel| pixel == [200, 100, 50]),
                "{encoding}: {:?}",
                image.rgb_bytes()
            );
        }
        assert!(of("bayer_rggb8", (1, 1), 1, &[9]).is_ok());
    }

    #[test]
    fn depth_is_no_picture() {
        assert!(unfit_reason(MessageKind::Raw, "16UC1").unwrap().contains("depth"));
        assert!(unfit_reason(MessageKind::Compressed, "16UC1; compressedDepth png").unwrap().contains("depth"));
        assert!(unfit_reason(MessageKind::Raw, "nv12").unwrap().contains("not read"));
        for usual in ["jpeg", "png", "rgb8; jpeg compressed bgr8", ""] {
            assert_eq!(unfit_reason(MessageKind::Compressed, usual), None);
        }
    }
}
