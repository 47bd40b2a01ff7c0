//! Where frames are to be: marks along the way or the time, and the pictures near each.

use super::{INTERVAL_M, INTERVAL_S, MOST_LEFT_OUT};
use crate::reel::Recording;
use wayword_core::DVec3;

/// Pictures that are looked at for one mark.
const MOST_CANDIDATES: usize = 5;
/// Pictures so near to a mark may stand for it, share of the interval.
const NEAR: f64 = 0.2;
/// What is left at the end gets a mark of its own from this share of the interval on; less moves the last mark to the end.
const LEFT_OVER: f64 = 0.5;

/// A place or time at which there is to be a frame.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mark {
    /// The picture at it.
    pub(super) at: usize,
    /// Pictures that may stand for it, ascending, itself among them.
    pub(super) candidates: Vec<usize>,
    /// Whether nobody knows how the camera came here from the mark before.
    pub(super) after_gap: bool,
}

/// The marks of a recording, and how many pictures have no pose although others do.
pub(super) fn of(recording: &Recording) -> (Vec<Mark>, usize) {
    let times_s = recording.reel.times_s();
    let Some(track) = &recording.track else {
        let interval_s = recording.described.interval_s.unwrap_or(INTERVAL_S);
        let all: Vec<usize> = (0..times_s.len()).collect();
        let off = |a: usize, b: usize| (times_s[a] - times_s[b]).abs();
        return (spread(&all, interval_s, &off), 0);
    };
    let places: Vec<Option<DVec3>> = times_s.iter().map(|time_s| track.at(*time_s).map(|fix| fix.position)).collect();
    let posed: Vec<usize> = (0..times_s.len()).filter(|at| places[*at].is_some()).collect();
    let place = |at: usize| places[at].unwrap_or_default();
    let interval_m = recording.described.interval_m.unwrap_or(INTERVAL_M);
    let off = |a: usize, b: usize| place(a).distance(place(b));
    let mut marks = spread(&posed, interval_m, &off);
    // Where the tracker was lost, and found again far away.
    let leap_m = (MOST_LEFT_OUT + 1) as f64 * interval_m;
    let leaps = posed.windows(2).filter(|pair| pair[1] - pair[0] > 1 && off(pair[0], pair[1]) > leap_m);
    let found_again: Vec<usize> = leaps.map(|pair| pair[1]).collect();
    let mut passed = 0;
    for mark in &mut marks {
        let until = found_again.partition_point(|at| *at <= mark.at);
        mark.after_gap = until > passed;
        passed = until;
    }
    (marks, times_s.len() - posed.len())
}

/// Marks that lie about one interval apart: a tracker trembles while a robot stands, so what counts is how far it got
/// from the last mark, and not how long its track is.
fn spread(pictures: &[usize], interval: f64, off: &dyn Fn(usize, usize) -> f64) -> Vec<Mark> {
    let (Some(first), Some(last)) = (pictures.first(), pictures.last()) else { return Vec::new() };
    // Places in `pictures`, not numbers of pictures.
    let mut marks = vec![0];
    let mut from = *first;
    for (at, picture) in pictures.iter().enumerate() {
        let over = off(from, *picture) - interval;
        if over < 0.0 {
            continue;
        }
        // Of pictures that are far apart the one before may lie nearer to where a frame is due.
        let before = at.saturating_sub(1);
        if marks.last() != Some(&before) && interval - off(from, pictures[before]) < over {
            marks.push(before);
            from = pictures[before];
        }
        if off(from, *picture) >= interval {
            marks.push(at);
            from = *picture;
        }
    }
    let end = pictures.len() - 1;
    if marks.last() != Some(&end) {
        let moves = off(from, *last) < LEFT_OVER * interval && marks.len() > 1;
        if moves {
            marks.pop();
        }
        if off(from, *last) > 0.0 || moves {
            marks.push(end);
        }
    }
    let candidates = |mark: usize| {
        let near = |at: &usize| off(pictures[*at], pictures[mark]) <= NEAR * interval;
        let before = (0..mark).rev().take_while(near).count();
        let after = (mark + 1..pictures.len()).take_while(near).count();
        thinned(mark - before..=mark + after, mark).map(|at| pictures[at]).collect()
    };
    let mark = |at: &usize| Mark { at: pictures[*at], candidates: candidates(*at), after_gap: false };
    marks.iter().map(mark).collect()
}

/// At most so many of a range, evenly spread, `kept` among them.
fn thinned(range: std::ops::RangeInclusive<usize>, kept: usize) -> impl Iterator<Item = usize> {
    let length = range.end() - range.start() + 1;
    let step = length.div_ceil(MOST_CANDIDATES).max(1);
    let phase = kept % step;
    range.filter(move |at| at % step == phase)
}
