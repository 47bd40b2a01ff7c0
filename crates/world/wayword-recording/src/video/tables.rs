//! Reads the tables of `stbl`, which list the places of a track's samples and their times (ISO/IEC 14496-12, sections 8.6
//! and 8.7).

use super::boxes::{BoxFields, find_box, in_box, need_box};

/// Most samples of a track, nearly four days at 30 a second; more are an error.
pub(super) const MAX_SAMPLES: u64 = 10_000_000;

/// One coded picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TrackSample {
    /// Offset in the file, bytes.
    pub(super) offset: u64,
    pub(super) bytes: u32,
    /// Time at which it is shown, ticks of the track.
    pub(super) shown: i64,
    /// Whether decoding can begin with it according to the container.
    pub(super) is_key: bool,
}

/// The samples in a track's tables, in the order of decoding; none in a fragmented file.
pub(super) fn read_samples(stbl: &[u8], file_bytes: u64) -> Result<Vec<TrackSample>, String> {
    let sizes = read_sizes(need_box(stbl, b"stsz")?, file_bytes).map_err(in_box("stsz"))?;
    if sizes.len() == 0 {
        return Ok(Vec::new());
    }
    let offsets = read_offsets(stbl, &sizes)?;
    let shown = read_shown_times(stbl, sizes.len())?;
    let keys = read_keys(stbl)?;
    let mut samples = Vec::with_capacity(sizes.len());
    for (at, (offset, shown)) in offsets.into_iter().zip(shown).enumerate() {
        let is_key = keys.as_ref().is_none_or(|keys| keys.binary_search(&(at as u64 + 1)).is_ok());
        samples.push(TrackSample { offset, bytes: sizes.get(at), shown, is_key });
    }
    // An empty sample codes no picture: the picture before stays.
    samples.retain(|sample| sample.bytes > 0);
    Ok(samples)
}

/// The length of each sample, bytes.
enum SampleSizes {
    /// All samples have the same length.
    All { bytes: u32, count: usize },
    /// Each sample has its own.
    Each(Vec<u32>),
}

impl SampleSizes {
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

/// Reads the box `stsz`.
fn read_sizes(stsz: &[u8], file_bytes: u64) -> Result<SampleSizes, String> {
    let (mut fields, ..) = BoxFields::with_version(stsz)?;
    let bytes = fields.read_u32()?;
    if bytes == 0 {
        let sizes: Vec<u32> = fields.read_rows()?.map(u32::from_be_bytes).collect();
        check_count(sizes.len() as u64, 1, file_bytes)?;
        return Ok(SampleSizes::Each(sizes));
    }
    let count = fields.read_u32()?;
    check_count(u64::from(count), bytes, file_bytes)?;
    Ok(SampleSizes::All { bytes, count: count as usize })
}

/// Returns an error for more samples than the file can hold.
pub(super) fn check_count(count: u64, bytes: u32, file_bytes: u64) -> Result<(), String> {
    if count > MAX_SAMPLES || count.saturating_mul(u64::from(bytes)) > file_bytes {
        return Err(format!("claims {count} samples of {bytes} bytes or more, but the file has {file_bytes} bytes"));
    }
    Ok(())
}

/// The offset of each sample: chunks have listed offsets, and the samples of a chunk follow each other.
fn read_offsets(stbl: &[u8], sizes: &SampleSizes) -> Result<Vec<u64>, String> {
    let chunks: Vec<u64> = match find_box(stbl, b"stco") {
        Some(stco) => {
            let (mut fields, ..) = BoxFields::with_version(stco)?;
            fields.read_rows().map_err(in_box("stco"))?.map(|row| u64::from(u32::from_be_bytes(row))).collect()
        }
        None => {
            let (mut fields, ..) = BoxFields::with_version(need_box(stbl, b"co64")?)?;
            fields.read_rows().map_err(in_box("co64"))?.map(u64::from_be_bytes).collect()
        }
    };
    let (mut fields, ..) = BoxFields::with_version(need_box(stbl, b"stsc")?)?;
    // The first chunk of a run (counted from 1), and the number of samples in each of its chunks.
    let mut runs =
        fields.read_rows::<12>().map_err(in_box("stsc"))?.map(|row| (u64::from(word_at(&row, 0)), word_at(&row, 4)));
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

/// The time at which each sample is shown, ticks of the track: the time at which it is decoded, plus its delay.
fn read_shown_times(stbl: &[u8], count: usize) -> Result<Vec<i64>, String> {
    let (mut fields, ..) = BoxFields::with_version(need_box(stbl, b"stts")?)?;
    let durations = read_runs(&mut fields).map_err(in_box("stts"))?;
    let mut delays: Vec<(u32, i32)> = Vec::new();
    if let Some(ctts) = find_box(stbl, b"ctts") {
        let (mut fields, ..) = BoxFields::with_version(ctts)?;
        // In version 0 these are unsigned by the standard, but writers put negative numbers there.
        delays = read_runs(&mut fields)
            .map_err(in_box("ctts"))?
            .map(|(count, delay)| (count, delay.cast_signed()))
            .collect();
    }
    let mut delays =
        delays.into_iter().flat_map(|(count, delay)| std::iter::repeat_n(i64::from(delay), count as usize));
    let mut shown = Vec::with_capacity(count);
    let mut decoded = 0_i64;
    for duration in durations.flat_map(|(count, duration)| std::iter::repeat_n(duration, count as usize)).take(count) {
        shown.push(decoded + delays.next().unwrap_or(0));
        decoded += i64::from(duration);
    }
    if shown.len() < count {
        return Err(format!("has {count} samples, but times for only {} of them (`stts`)", shown.len()));
    }
    Ok(shown)
}

/// Runs of equal values: how often, and the value.
fn read_runs<'a>(fields: &mut BoxFields<'a>) -> Result<impl Iterator<Item = (u32, u32)> + use<'a>, String> {
    Ok(fields.read_rows::<8>()?.map(|row| (word_at(&row, 0), word_at(&row, 4))))
}

/// Four bytes of a row at an offset that lies within it.
fn word_at(row: &[u8], at: usize) -> u32 {
    BoxFields::new(row.get(at..).unwrap_or_default()).read_u32().unwrap_or(0)
}

/// The numbers (from 1) of the samples with which decoding can begin, ascending; `None` if it can begin with every
/// sample.
fn read_keys(stbl: &[u8]) -> Result<Option<Vec<u64>>, String> {
    let Some(stss) = find_box(stbl, b"stss") else { return Ok(None) };
    let (mut fields, ..) = BoxFields::with_version(stss)?;
    let mut keys: Vec<u64> =
        fields.read_rows().map_err(in_box("stss"))?.map(|row| u64::from(u32::from_be_bytes(row))).collect();
    keys.sort_unstable();
    Ok(Some(keys))
}
