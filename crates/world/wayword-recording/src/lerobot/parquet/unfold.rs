//! Compressed pages, as large as they were before.

use super::footer::Codec;
use std::io::Read;
use wayword_core::contained;

/// Fills `place` with what was compressed. The place's size bounds what is unfolded.
///
/// # Errors
/// In words, when it was less or more, is broken, or compressed in a way that is not read.
pub(super) fn unfold(codec: Codec, folded: &[u8], place: &mut [u8]) -> Result<(), String> {
    // Decoders of others may panic on broken bytes.
    contained(|| match codec {
        Codec::None => copied(folded, place),
        Codec::Snappy => match snap::raw::Decoder::new().decompress(folded, place) {
            Ok(written) if written == place.len() => Ok(()),
            Ok(written) => Err(format!("{written} bytes where {} are announced", place.len())),
            Err(error) => Err(error.to_string()),
        },
        Codec::Gzip => filled(flate2::read::MultiGzDecoder::new(folded), place),
        Codec::Zstandard => filled(ruzstd::StreamingDecoder::new(folded).map_err(|error| error.to_string())?, place),
        Codec::Other(number) => Err(format!("is compressed with {}, which is not read here", name(number))),
    })
    .unwrap_or_else(|| Err("is broken".to_owned()))
}

fn copied(bytes: &[u8], place: &mut [u8]) -> Result<(), String> {
    if bytes.len() != place.len() {
        return Err(format!("{} bytes where {} are announced", bytes.len(), place.len()));
    }
    place.copy_from_slice(bytes);
    Ok(())
}

fn filled(mut reader: impl Read, place: &mut [u8]) -> Result<(), String> {
    reader.read_exact(place).map_err(|error| error.to_string())?;
    match reader.read(&mut [0]) {
        Ok(0) => Ok(()),
        Ok(_) => Err(format!("more than the {} bytes that are announced", place.len())),
        Err(error) => Err(error.to_string()),
    }
}

/// By the number in `parquet.thrift`.
const fn name(codec: i64) -> &'static str {
    match codec {
        3 => "LZO",
        4 => "Brotli",
        5 | 7 => "LZ4",
        _ => "something unknown",
    }
}
