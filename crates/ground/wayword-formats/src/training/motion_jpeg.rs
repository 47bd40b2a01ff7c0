//! Videos of JPEG pictures as they are (Motion JPEG in AVI): no picture is decoded, and none loses quality.
//!
//! Source: Microsoft's description of RIFF and AVI 1.0 (`hdrl`, `strl`, `movi`, `idx1`). A file of this form is at most 1 GiB.

#![allow(
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "it writes what this program made, and reads nothing from a file"
)]

use std::io;

/// A chunk of a RIFF file: its name, its length and its contents, padded to an even length.
fn chunk(name: [u8; 4], contents: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(contents.len() + 9);
    bytes.extend(name);
    bytes.extend((contents.len() as u32).to_le_bytes());
    bytes.extend(contents);
    if contents.len() % 2 == 1 {
        bytes.push(0);
    }
    bytes
}

/// A list of chunks.
fn list(kind: [u8; 4], chunks: &[u8]) -> Vec<u8> {
    chunk(*b"LIST", &[&kind[..], chunks].concat())
}

fn numbers(values: &[u32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// The bytes of an AVI file that shows JPEG pictures of one size, `fps` each second.
///
/// # Errors
/// When the pictures together are larger than such a file can be.
pub fn motion_jpeg_video(pictures: &[Vec<u8>], [width, height]: [u32; 2], fps: u32) -> io::Result<Vec<u8>> {
    /// The video has an index.
    const HAS_INDEX: u32 = 0x10;
    /// A picture that needs no other.
    const KEY_PICTURE: u32 = 0x10;
    const MAX_BYTES: usize = 1 << 30;
    if pictures.iter().map(Vec::len).sum::<usize>() > MAX_BYTES {
        return Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "a video of this form holds at most 1 GiB of pictures",
        ));
    }
    let largest = pictures.iter().map(Vec::len).max().unwrap_or_default() as u32;
    let count = pictures.len() as u32;
    let header = chunk(
        *b"avih",
        &numbers(&[
            1_000_000 / fps.max(1),
            largest * fps,
            0,
            HAS_INDEX,
            count,
            0,
            1,
            largest,
            width,
            height,
            0,
            0,
            0,
            0,
        ]),
    );
    // Kind, codec, flags, priority and language, initial frames, scale, rate, start, length, buffer, quality, sample size, frame.
    let mut stream = b"vidsMJPG".to_vec();
    stream.extend(numbers(&[0, 0, 0, 1, fps, 0, count, largest, u32::MAX, 0]));
    stream.extend([0, 0, width as u16, height as u16].iter().flat_map(|value| value.to_le_bytes()));
    // A bitmap's header: size, width, height, planes and bits, codec, bytes, then four numbers that do not matter.
    let format =
        [&numbers(&[40, width, height, 1 | (24 << 16)])[..], b"MJPG", &numbers(&[3 * width * height, 0, 0, 0, 0])]
            .concat();
    let headers = list(*b"strl", &[chunk(*b"strh", &stream), chunk(*b"strf", &format)].concat());
    let (mut movie, mut index) = (Vec::new(), Vec::new());
    for picture in pictures {
        index.extend(b"00dc");
        // Counted from the name of the list.
        index.extend(numbers(&[KEY_PICTURE, movie.len() as u32 + 4, picture.len() as u32]));
        movie.extend(chunk(*b"00dc", picture));
    }
    let parts = [list(*b"hdrl", &[header, headers].concat()), list(*b"movi", &movie), chunk(*b"idx1", &index)].concat();
    Ok(chunk(*b"RIFF", &[&b"AVI "[..], &parts].concat()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_index_leads_to_each_picture() {
        let pictures = vec![b"first".to_vec(), b"second".to_vec()];
        let video = motion_jpeg_video(&pictures, [4, 2], 1).unwrap();
        assert_eq!(u32::from_le_bytes(video[4..8].try_into().unwrap()) as usize, video.len() - 8);
        let at = |name: &[u8]| video.windows(4).rposition(|bytes| bytes == name).unwrap();
        let (movie, index) = (at(b"movi"), at(b"idx1") + 8);
        for (number, picture) in pictures.iter().enumerate() {
            let entry: Vec<u32> = video[index + 16 * number..index + 16 * (number + 1)]
                .chunks(4)
                .map(|bytes| u32::from_le_bytes(bytes.try_into().unwrap()))
                .collect();
            let from = movie + entry[2] as usize;
            assert_eq!(&video[from..from + 4], b"00dc");
            assert_eq!(&video[from + 8..from + 8 + entry[3] as usize], picture.as_slice());
        }
    }
}
