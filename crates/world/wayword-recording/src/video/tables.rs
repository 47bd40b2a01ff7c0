//! Reads the tables of `stbl`, which list the places of a track's samples and their times (ISO/IEC 14496-12, sections 8.6
//! and 8.7).

use super::boxes::{Fields, find, need, within};

/// Most samples of a track: nearly four days at 30 a second.
pub(super) const MAX_SAMPLES: u64 = 10_000_000;

/// One coded picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Sample {
    /// Offset in the file, bytes.
    pub(super) offset: u64,
    pub(super) bytes: u32,
    /// Time at which it is shown, ticks of the track.
    pub(super) shown: i64,
    /// Whether decoding can begin with it according to the container.
    pub(super) is_key: bool,
}

/// The samples in a track's tables, in the order of decoding; none in a fragmented file.
pub(super) fn samples(stbl: &[u8], file_bytes: u64) -> Result<Vec<Sample>, String> {
    let sizes = sizes(need(stbl, b"stsz")?, file_bytes).map_err(within("stsz"))?;
    if sizes.len() == 0 {
        return Ok(Vec::new());
    }
    let offsets = offsets(stbl, &sizes)?;
    let shown = shown(stbl, sizes.len())?;
    let keys = keys(stbl)?;
    let mut samples = Vec::with_capacity(sizes.len());
    for (at, (offset, shown)) in offsets.into_iter().zip(shown).enumerate() {
        let is_key = keys.as_ref().is_none_or(|keys| keys.binary_search(&(at as u64 + 1)).is_ok());
        samples.push(Sample { offset, bytes: sizes.get(at), shown, is_key });
    }
    // An empty sample codes no picture: the picture before stays.
    samples.retain(|sample| sample.bytes > 0);
    Ok(samples)
}

/// The length of each sample, bytes.
enum Sizes {
    All { bytes: u32, count: usize },
    Each(Vec<u32>),
}

impl Sizes {
    fn len(&self) -> usize {
        match self {
            Self::All { count, .. } => *count,
            Self::Each(sizes) => sizes.len(),
        }
    }

    fn get(&self, at: usize) -> u32 {
        match self {
            Self::All { bytes, .. } => *bytes,
            Self::Each(sizes) => sizes.get(at).copied().unwrap_or(0),
        }
    }
}

fn sizes(stsz: &[u8], file_bytes: u64) -> Result<Sizes, String> {
    let (mut fields, ..) = Fields::full(stsz)?;
    let bytes = fields.u32()?;
    if bytes == 0 {
        let sizes: Vec<u32> = fields.rows()?.map(u32::from_be_bytes).collect();
        believable(sizes.len() as u64, 1, file_bytes)?;
        return Ok(Sizes::Each(sizes));
    }
    let count = fields.u32()?;
    believable(u64::from(count), bytes, file_bytes)?;
    Ok(Sizes::All { bytes, count: count as usize })
}

/// Returns an error for more samples than the file can hold.
pub(super) fn believable(count: u64, bytes: u32, file_bytes: u64) -> Result<(), String> {
    if count > MAX_SAMPLES || count.saturating_mul(u64::from(bytes)) > file_bytes {
        return Err(format!("claims {count} samples of {bytes} bytes or more, but the file has {file_bytes} bytes"));
    }
    Ok(())
}

/// The offset of each sample: chunks have listed offsets, and the samples of a chunk follow each other.
fn offsets(stbl: &[u8], sizes: &Sizes) -> Result<Vec<u64>, String> {
    let chunks: Vec<u64> = match find(stbl, b"stco") {
        Some(stco) => {
            let (mut fields, ..) = Fields::full(stco)?;
            fields.rows().map_err(within("stco"))?.map(|row| u64::from(u32::from_be_bytes(row))).collect()
        }
        None => {
            let (mut fields, ..) = Fields::full(need(stbl, b"co64")?)?;
            fields.rows().map_err(within("co64"))?.map(u64::from_be_bytes).collect()
        }
    };
    let (mut fields, ..) = Fields::full(need(stbl, b"stsc")?)?;
    // The first chunk of a run (counted from 1), and the number of samples in each of its chunks.
    let mut runs = fields.rows::<12>().map_err(within("stsc"))?.map(|row| (u64::from(word(&row, 0)), word(&row, 4)));
    let mut offsets = Vec::with_capacity(sizes.len());
    let (mut in_chunk, mut next) = (0, runs.next());
    for (at, start) in chunks.into_iter().enumerate() {
        while let Some((first, samples)) = next
            && first <= at as u64 + 1
        {
            (in_chunk, next) = (samples, runs.next());
        }
        let mut offset = start;
        for _ in 0..in_chunk {
            if offsets.len() == sizes.len() {
                return Ok(offsets);
            }
            let bytes = sizes.get(offsets.len());
            offsets.push(offset);
            offset = offset.saturating_add(u64::from(bytes));
        }
    }
    if offsets.len() < sizes.len() {
        return Err(format!(
            "has {} samples, but offsets for only {} of them (`stsc`, `stco`)",
            sizes.len(),
            offsets.len()
        ));
    }
    Ok(offsets)
}

/// The time at which each sample is shown: the time at which it is decoded, plus its delay.
fn shown(stbl: &[u8], count: usize) -> Result<Vec<i64>, String> {
    let (mut fields, ..) = Fields::full(need(stbl, b"stts")?)?;
    let lengths = runs(&mut fields).map_err(within("stts"))?;
    let mut later: Vec<(u32, i32)> = Vec::new();
    if let Some(ctts) = find(stbl, b"ctts") {
        let (mut fields, ..) = Fields::full(ctts)?;
        // In version 0 these are unsigned by the standard, but writers put negative numbers there.
        later = runs(&mut fields).map_err(within("ctts"))?.map(|(count, later)| (count, later.cast_signed())).collect();
    }
    let mut later = later.into_iter().flat_map(|(count, later)| std::iter::repeat_n(i64::from(later), count as usize));
    let mut shown = Vec::with_capacity(count);
    let mut decoded = 0_i64;
    for length in lengths.flat_map(|(count, length)| std::iter::repeat_n(length, count as usize)).take(count) {
        shown.push(decoded + later.next().unwrap_or(0));
        decoded += i64::from(length);
    }
    if shown.len() < count {
        return Err(format!("has {count} samples, but times for only {} of them (`stts`)", shown.len()));
    }
    Ok(shown)
}

/// Runs of equal values: how often, and the value.
fn runs<'a>(fields: &mut Fields<'a>) -> Result<impl Iterator<Item = (u32, u32)> + use<'a>, String> {
    Ok(fields.rows::<8>()?.map(|row| (word(&row, 0), word(&row, 4))))
}

/// Four bytes of a row at an offset that lies within it.
fn word(row: &[u8], at: usize) -> u32 {
    Fields::new(row.get(at..).unwrap_or_default()).u32().unwrap_or(0)
}

/// The numbers (from 1) of the samples with which decoding can begin, ascending; `None` if it can begin with every
/// sample.
fn keys(stbl: &[u8]) -> Result<Option<Vec<u64>>, String> {
    let Some(stss) = find(stbl, b"stss") else { return Ok(None) };
    let (mut fields, ..) = Fields::full(stss)?;
    let mut keys: Vec<u64> =
        fields.rows().map_err(within("stss"))?.map(|row| u64::from(u32::from_be_bytes(row))).collect();
    keys.sort_unstable();
    Ok(Some(keys))
}
