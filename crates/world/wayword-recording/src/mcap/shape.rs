//! Whether the lengths that stand in a record stay within it.
//!
//! The crate `mcap` takes as much memory for a text as its length says before it looks whether the text is there: a schema of a few
//! bytes could ask for gigabytes.

use super::records::{CHANNEL, CHUNK, Found, Records, SCHEMA};
use std::fs::File;

const HEADER: u8 = 1;
const FOOTER: u8 = 2;
const CHUNK_INDEX: u8 = 8;
const ATTACHMENT_INDEX: u8 = 10;
const METADATA: u8 = 12;
const METADATA_INDEX: u8 = 13;
/// Bytes of a footer, of what stands before it, and of the file's last bytes.
const FOOTER_BYTES: u64 = 20 + 9 + 8;

/// A part of a record (mcap.dev/spec, "Records").
#[derive(Clone, Copy)]
enum Part {
    /// So many bytes.
    Bytes(usize),
    /// Bytes behind their number.
    Counted,
    /// Pairs of texts behind the number of their bytes.
    Texts,
}

/// The parts of a record up to the last one that has a length of its own.
fn parts(opcode: u8) -> &'static [Part] {
    use Part::{Bytes, Counted, Texts};
    match opcode {
        HEADER => &[Counted, Counted],
        SCHEMA => &[Bytes(2), Counted, Counted, Counted],
        CHANNEL => &[Bytes(4), Counted, Counted, Texts],
        CHUNK_INDEX => &[Bytes(32), Counted, Bytes(8), Counted],
        ATTACHMENT_INDEX => &[Bytes(40), Counted, Counted],
        METADATA => &[Counted, Texts],
        METADATA_INDEX => &[Bytes(16), Counted],
        _ => &[],
    }
}

/// Whether every length in a record leads no farther than its end.
pub(crate) fn fits(opcode: u8, body: &[u8]) -> bool {
    let mut rest = body;
    parts(opcode).iter().all(|part| match part {
        Part::Bytes(count) => taken(&mut rest, *count).is_some(),
        Part::Counted => counted(&mut rest).is_some(),
        Part::Texts => counted(&mut rest).is_some_and(|mut texts| {
            while !texts.is_empty() {
                if counted(&mut texts).is_none() {
                    return false;
                }
            }
            true
        }),
    })
}

fn taken<'a>(rest: &mut &'a [u8], count: usize) -> Option<&'a [u8]> {
    let (taken, behind) = rest.split_at_checked(count)?;
    *rest = behind;
    Some(taken)
}

fn counted<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    let count = taken(rest, 4)?.first_chunk().copied().map(u32::from_le_bytes)?;
    taken(rest, usize::try_from(count).ok()?)
}

/// Whether this holds for every record of the summary at the end of a file; false where there is none.
pub(crate) fn summary_fits(file: &File, length: u64, most_bytes: u64) -> bool {
    summary(file, length, most_bytes).is_ok_and(|fits| fits)
}

fn summary(file: &File, length: u64, most_bytes: u64) -> Result<bool, String> {
    let mut body = Vec::new();
    let Some(footer) = length.checked_sub(FOOTER_BYTES) else { return Ok(false) };
    let mut records = Records::in_file(file, footer, length)?;
    if !matches!(records.next()?, Some(Found { opcode: FOOTER, .. })) {
        return Ok(false);
    }
    records.body(most_bytes, &mut body)?;
    let Some(start) = body.first_chunk().copied().map(u64::from_le_bytes).filter(|start| *start > 0) else {
        return Ok(false);
    };
    let mut records = Records::in_file(file, start, footer)?;
    while let Some(found) = records.next()? {
        if found.opcode == CHUNK || records.left() > most_bytes {
            return Ok(false);
        }
        records.body(most_bytes, &mut body)?;
        if !fits(found.opcode, &body) {
            return Ok(false);
        }
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(text: &str) -> Vec<u8> {
        [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat()
    }

    #[test]
    fn lengths_that_lead_out_of_a_record_are_found_wherever_they_stand() {
        let pairs = [text("key"), text("value")].concat();
        let counted_pairs = [(pairs.len() as u32).to_le_bytes().to_vec(), pairs].concat();
        let channel = [vec![1, 0, 2, 0], text("/camera"), text("cdr"), counted_pairs].concat();
        assert!(fits(CHANNEL, &channel));
        for length_at in [4, 4 + 4 + 7, 4 + 4 + 7 + 4 + 3, 4 + 4 + 7 + 4 + 3 + 4, 4 + 4 + 7 + 4 + 3 + 4 + 4 + 3] {
            let mut broken = channel.clone();
            broken[length_at + 3] = 0x65;
            assert!(!fits(CHANNEL, &broken), "the length at byte {length_at} was believed");
        }
        assert!((0..channel.len()).all(|end| !fits(CHANNEL, &channel[..end])));
    }

    #[test]
    fn the_summaries_of_other_programs_are_believed() {
        for name in ["messages_zstd", "odometry_lz4", "odometry_zstd", "poses_zstd", "tree_chunks"] {
            let path = format!("{}/fixtures/mcap/{name}.mcap", env!("CARGO_MANIFEST_DIR"));
            let file = File::open(path).unwrap();
            let length = file.metadata().unwrap().len();
            assert!(summary_fits(&file, length, 1 << 20), "{name}");
            assert!(!summary_fits(&file, length - 1, 1 << 20), "{name} without its last byte");
        }
    }
}
