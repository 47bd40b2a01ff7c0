//! Applies edit lists: which pictures a player shows, in which order, and when (ISO/IEC 14496-12, section 8.6.6).

use super::{
    boxes::{BoxFields, find_box, in_box},
    tables::TrackSample,
};

/// One picture as it is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ShownPicture {
    /// Seconds from the start of the video.
    pub(super) time_s: f64,
    /// Its index in the order of decoding.
    pub(super) sample: usize,
}

/// The part of a track that is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TrackEdit {
    /// Time at the start without a picture, ticks of the movie.
    wait: u64,
    /// Beginning of the shown part, ticks of the track.
    start: i64,
    /// Length of the shown part, ticks of the movie; 0 means until the end.
    length: u64,
}

/// Ticks per second of the two clocks of an MP4 file: the movie's, and the track's own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TickRates {
    pub(super) movie: u32,
    pub(super) track: u32,
}

/// Reads the edit list of a track; `None` if the whole track is shown.
pub(super) fn read_edit(trak: &[u8]) -> Result<Option<TrackEdit>, String> {
    let Some(elst) = find_box(trak, b"edts").and_then(|edts| find_box(edts, b"elst")) else { return Ok(None) };
    let read = || -> Result<Vec<(u64, i64)>, String> {
        let (mut fields, version, _) = BoxFields::with_version(elst)?;
        if version == 0 {
            return Ok(fields.read_rows::<12>()?.filter_map(|row| edit_entry(&row, version)).collect());
        }
        Ok(fields.read_rows::<20>()?.filter_map(|row| edit_entry(&row, version)).collect())
    };
    let mut shown_part: Option<TrackEdit> = None;
    let mut wait = 0_u64;
    for (length, start) in read().map_err(in_box("elst"))? {
        match shown_part {
            None if start < 0 => wait = wait.saturating_add(length),
            None => shown_part = Some(TrackEdit { wait, start, length }),
            // An empty piece at the end has no pictures.
            Some(_) if start < 0 => {}
            Some(_) => return Err("has an edit list of several pieces (box `elst`), which cannot be read".to_owned()),
        }
    }
    Ok(shown_part)
}

/// Length of a piece and its start; -1 for an empty piece.
fn edit_entry(row: &[u8], version: u8) -> Option<(u64, i64)> {
    let mut fields = BoxFields::new(row);
    let length = fields.read_versioned(version).ok()?;
    let start = if version == 0 { i64::from(fields.read_i32().ok()?) } else { fields.read_u64().ok()?.cast_signed() };
    // Larger numbers could overflow in the subtraction later.
    Some((length, start.clamp(-1, 1 << 56)))
}

/// The pictures that a player shows, in its order.
pub(super) fn shown_pictures(samples: &[TrackSample], edit: Option<TrackEdit>, clocks: TickRates) -> Vec<ShownPicture> {
    let (movie, track) = (f64::from(clocks.movie), f64::from(clocks.track));
    // Without an edit list the first picture is the start, because recorders that cut a stream count from the
    // beginning of that stream.
    let first = samples.iter().map(|sample| sample.shown).min().unwrap_or(0);
    let TrackEdit { wait, start, length } = edit.unwrap_or(TrackEdit { wait: 0, start: first, length: 0 });
    // Lengths are rounded to the movie's ticks, so a picture that begins within the last tick begins after the end.
    let end_s = if length == 0 { f64::INFINITY } else { (length as f64 - 1.0) / movie };
    let mut order: Vec<(usize, i64)> = samples.iter().map(|sample| sample.shown).enumerate().collect();
    order.sort_by_key(|(_, shown)| *shown);
    let timed = order.into_iter().filter_map(|(sample, shown)| {
        let ticks = shown - start;
        let time_s = ticks as f64 / track;
        (ticks >= 0 && time_s < end_s).then(|| ShownPicture { time_s: time_s + wait as f64 / movie, sample })
    });
    timed.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLOCKS: TickRates = TickRates { movie: 1000, track: 10 };

    fn samples(shown: &[i64]) -> Vec<TrackSample> {
        shown.iter().map(|shown| TrackSample { offset: 0, bytes: 1, shown: *shown, is_key: false }).collect()
    }

    fn of(edit: Option<TrackEdit>) -> Vec<(f64, usize)> {
        let shown = shown_pictures(&samples(&[2, 6, 4, 3, 5]), edit, CLOCKS);
        shown.into_iter().map(|shown| (shown.time_s, shown.sample)).collect()
    }

    #[test]
    fn pictures_come_in_the_order_in_which_they_are_shown() {
        assert_eq!(of(None), [(0.0, 0), (0.1, 3), (0.2, 2), (0.3, 4), (0.4, 1)]);
    }

    #[test]
    fn shown_leaves_out_pictures_outside_the_edit() {
        let edit = TrackEdit { wait: 500, start: 3, length: 200 };
        assert_eq!(of(Some(edit)), [(0.5, 3), (0.6, 2)]);
    }

    #[test]
    fn a_list_is_read_and_one_of_several_pieces_refused() {
        let trak = |rows: &[[u32; 3]]| {
            let rows: Vec<u8> = rows.iter().flatten().flat_map(|word| word.to_be_bytes()).collect();
            let list = [&[0; 7], &[(rows.len() / 12) as u8][..], &rows].concat();
            let elst = [&(list.len() as u32 + 8).to_be_bytes(), &b"elst"[..], &list].concat();
            [&(elst.len() as u32 + 8).to_be_bytes(), &b"edts"[..], &elst].concat()
        };
        let rate = 1 << 16;
        let wanted = TrackEdit { wait: 40, start: 1024, length: 3000 };
        assert_eq!(read_edit(&trak(&[[40, u32::MAX, rate], [3000, 1024, rate]])), Ok(Some(wanted)));
        assert!(read_edit(&trak(&[[40, 0, rate], [3000, 1024, rate]])).unwrap_err().contains("elst"));
        assert_eq!(read_edit(b""), Ok(None));
    }
}
