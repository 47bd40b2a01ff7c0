//! Small Basis files.

use base64::{Engine, prelude::BASE64_STANDARD};

/// 16 x 16 texels in ETC1S, made by the reference encoder (basis_universal 1.16) from a picture of our own.
const ETC1S: &str = "c0ITAE0AvwSIAAAAIxABAAABAAAAEQAAAAAAAAAAAAAAAAAAAAAAAwBkAAAALwAAAwCTAAAADQAAoAAAAC8AAABNAAAAAAAAAAAAAAAAAAAA\
    ABAAEAAEAAQAzwAAAAYAAADe6CBA3AABAAAASF6Q3QUwJQAAAAAAgGQHPAATAgQAAAAAyAEZACYABAAAAACQYjwDBAAAAKiqqqpSVVVVBRTA\
    hAABAAAAALJBBoAJAAAAAAAQZCXA1IABAABhABaonNwJEABMAAAAAAAAIIAA43s0aJ4G";
/// Bytes of the header, and of a slice's description behind it.
const HEADER: usize = 77;
const SLICE: usize = 23;

/// The file in ETC1S.
pub fn etc1s() -> Vec<u8> {
    BASE64_STANDARD.decode(ETC1S).expect("base64")
}

/// One slice of 8 x 8 texels in another format: its blocks are bytes that count up.
fn plain(format: u8, blocks: [u16; 2], bytes: usize) -> Vec<u8> {
    let mut file = vec![0; HEADER + SLICE];
    let mut put = |at: usize, value: &[u8]| file[at..at + value.len()].copy_from_slice(value);
    put(0, &[0x73, 0x42, 0x13, 0, HEADER as u8, 0]);
    put(8, &((SLICE + bytes) as u32).to_le_bytes());
    // One slice, one image.
    put(14, &[1, 0, 0, 1, 0, 0, format]);
    put(65, &(HEADER as u32).to_le_bytes());
    put(HEADER + 5, &[8, 0, 8, 0]);
    put(HEADER + 9, &[blocks[0].to_le_bytes(), blocks[1].to_le_bytes()].concat());
    put(HEADER + 13, &((HEADER + SLICE) as u32).to_le_bytes());
    put(HEADER + 17, &(bytes as u32).to_le_bytes());
    file.extend((0..bytes).map(|byte| byte as u8));
    file
}

/// A file of every format that the decoder knows by number: ETC1S, UASTC, HDR, raw ASTC and packed ASTC.
pub fn all() -> Vec<Vec<u8>> {
    let mut all = vec![etc1s()];
    all.extend((1..=4).map(|format| plain(format, [2, 2], 64)));
    all.extend([5, 6, 9, 18, 19, 23, 32].map(|format| plain(format, [2, 2], 64)));
    all
}
