//! Reads the samples of fragmented files. Recorders write these so that a recording survives a loss of power (ISO/IEC
//! 14496-12, section 8.8).

use super::{
    boxes::{BoxFields, Mp4Box, boxes_in, find_box, in_box, need_box},
    tables::{TrackSample, check_count},
};

/// Flags of the box `tfhd`: which fields it has, and whether offsets count from the fragment's beginning.
const BASE_OFFSET: u32 = 0x1;
const DEFAULT_DURATION: u32 = 0x8;
const DEFAULT_SIZE: u32 = 0x10;
const DEFAULT_FLAGS: u32 = 0x20;
const DEFAULT_BASE_IS_MOOF: u32 = 0x2_0000;
/// Flags of the box `trun`: which fields it has, for the run and for each sample.
const DATA_OFFSET: u32 = 0x1;
const FIRST_SAMPLE_FLAGS: u32 = 0x4;
const HAS_DURATIONS: u32 = 0x100;
const HAS_SIZES: u32 = 0x200;
const HAS_FLAGS: u32 = 0x400;
const HAS_DELAYS: u32 = 0x800;
/// `sample_is_non_sync_sample` among a sample's flags.
const NOT_A_KEY: u32 = 0x1_0000;

/// Values for samples without their own.
#[derive(Debug, Clone, Copy, Default)]
struct SampleDefaults {
    /// Ticks of the track.
    duration: u32,
    bytes: u32,
    flags: u32,
}

impl SampleDefaults {
    /// The defaults in `mvex` of a movie.
    fn from_movie(moov: &[u8], track: u32) -> Result<Self, String> {
        for trex in find_box(moov, b"mvex").into_iter().flat_map(boxes_in).filter(|found| found.kind == *b"trex") {
            let (mut fields, ..) = BoxFields::with_version(trex.body)?;
            if fields.read_u32()? == track {
                fields.read_u32()?;
                return Ok(Self { duration: fields.read_u32()?, bytes: fields.read_u32()?, flags: fields.read_u32()? });
            }
        }
        Ok(Self::default())
    }
}

/// Adds the samples of one track, fragment by fragment.
#[derive(Debug)]
pub(super) struct FragmentReader {
    track: u32,
    /// The movie's defaults; a fragment can have its own.
    usual: SampleDefaults,
    file_bytes: u64,
    /// Time at which the next sample is decoded, ticks.
    decoded: i64,
    /// Offset at which the last run of samples ended.
    end: u64,
}

impl FragmentReader {
    pub(super) fn new(moov: &[u8], track: u32, file_bytes: u64) -> Result<Self, String> {
        let usual = SampleDefaults::from_movie(moov, track).map_err(in_box("trex"))?;
        Ok(Self { track, usual, file_bytes, decoded: 0, end: 0 })
    }

    /// Adds the samples of a fragment; its box `moof` begins at `start`.
    pub(super) fn add_fragment(
        &mut self,
        moof: &[u8],
        start: u64,
        samples: &mut Vec<TrackSample>,
    ) -> Result<(), String> {
        self.end = start;
        for traf in boxes_in(moof).filter(|found| found.kind == *b"traf") {
            self.add_track(traf.body, start, samples)?;
        }
        Ok(())
    }

    /// Adds the samples of one box `traf`, which describes one track of a fragment.
    fn add_track(&mut self, traf: &[u8], start: u64, samples: &mut Vec<TrackSample>) -> Result<(), String> {
        let (mut fields, _, flags) = BoxFields::with_version(need_box(traf, b"tfhd")?)?;
        if fields.read_u32()? != self.track {
            return Ok(());
        }
        let mut optional = |flag: u32| if flags & flag != 0 { fields.read_u32().map(Some) } else { Ok(None) };
        let base = match (optional(BASE_OFFSET)?, flags & BASE_OFFSET) {
            (Some(high), _) => u64::from(high) << 32 | u64::from(optional(BASE_OFFSET)?.unwrap_or(0)),
            (None, _) if flags & DEFAULT_BASE_IS_MOOF != 0 => start,
            (None, _) => self.end,
        };
        // The number of the sample entry, which is not needed.
        optional(0x2)?;
        let usual = SampleDefaults {
            duration: optional(DEFAULT_DURATION)?.unwrap_or(self.usual.duration),
            bytes: optional(DEFAULT_SIZE)?.unwrap_or(self.usual.bytes),
            flags: optional(DEFAULT_FLAGS)?.unwrap_or(self.usual.flags),
        };
        if let Some(tfdt) = find_box(traf, b"tfdt") {
            let (mut fields, version, _) = BoxFields::with_version(tfdt)?;
            // Larger numbers could overflow in the additions later.
            let decoded = fields.read_versioned(version).map_err(in_box("tfdt"))?.min(1 << 56);
            self.decoded = decoded.cast_signed();
        }
        self.end = base;
        for Mp4Box { body, .. } in boxes_in(traf).filter(|found| found.kind == *b"trun") {
            self.add_run(body, base, usual, samples).map_err(in_box("trun"))?;
        }
        Ok(())
    }

    /// Adds the samples of one box `trun`. Their bytes lie one after another in the file.
    fn add_run(
        &mut self,
        trun: &[u8],
        base: u64,
        usual: SampleDefaults,
        samples: &mut Vec<TrackSample>,
    ) -> Result<(), String> {
        let (mut fields, _, flags) = BoxFields::with_version(trun)?;
        let count = fields.read_u32()?;
        if flags & HAS_SIZES == 0 && usual.bytes == 0 {
            return Ok(());
        }
        // A run without sizes claims bytes of the file; a run with sizes has four bytes for each sample.
        check_count(u64::from(count) + samples.len() as u64, 1, self.file_bytes)?;
        if flags & DATA_OFFSET != 0 {
            self.end = base.saturating_add_signed(i64::from(fields.read_i32()?));
        }
        let first = if flags & FIRST_SAMPLE_FLAGS != 0 { Some(fields.read_u32()?) } else { None };
        for at in 0..count {
            let mut field = |flag: u32| if flags & flag != 0 { fields.read_u32().map(Some) } else { Ok(None) };
            let duration = field(HAS_DURATIONS)?.unwrap_or(usual.duration);
            let bytes = field(HAS_SIZES)?.unwrap_or(usual.bytes);
            let sample_flags = field(HAS_FLAGS)?.or(first.filter(|_| at == 0)).unwrap_or(usual.flags);
            let delay = field(HAS_DELAYS)?.unwrap_or(0).cast_signed();
            if bytes > 0 {
                let shown = self.decoded + i64::from(delay);
                samples.push(TrackSample { offset: self.end, bytes, shown, is_key: sample_flags & NOT_A_KEY == 0 });
            }
            self.decoded += i64::from(duration);
            self.end = self.end.saturating_add(u64::from(bytes));
        }
        Ok(())
    }
}
