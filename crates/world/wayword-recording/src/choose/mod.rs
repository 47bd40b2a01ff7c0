//! Which pictures of a recording become frames of its path: at equal distances, or at equal times where no pose is known; the
//! blurred and the doubled left out.

mod look;
mod marks;

use crate::reel::Recording;
use look::Look;
use marks::Mark;
use wayword_core::{Heading, Image, PlatformError};

/// Distance between frames unless the user says otherwise, metres.
pub(crate) const INTERVAL_M: f64 = 1.0;
/// Time between frames unless the user says otherwise, seconds: at a walk of 0.7 m/s a bit more than a metre.
pub(crate) const INTERVAL_S: f64 = 2.0;
/// A picture with less than this share of the recording's usual sharpness is blurred.
const BLURRED: f64 = 0.3;
/// A picture that differs by less than this from the one before it shows the same, levels of 255 on average.
const ALIKE: f64 = 2.0;
/// A camera that looks farther than this off the way that was just walked does not show what is ahead, radians.
const TURNED_AWAY_RAD: f64 = 60.0 * std::f64::consts::PI / 180.0;

/// The frames of a recording, and what was left out.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Choice {
    /// Numbers of pictures, ascending.
    pub(crate) stops: Vec<usize>,
    /// Places that were left out because every picture there is blurred.
    pub(crate) blurred: usize,
    /// Places whose picture shows what the one before it shows.
    pub(crate) alike: usize,
    /// Places at which the camera looked away from the direction of travel.
    pub(crate) turned_away: usize,
    /// Pictures at whose time no pose is known, where others have one.
    pub(crate) without_pose: usize,
}

/// Chooses the frames. `each` is handed every picture that was looked at, so that whoever needs it later has it.
///
/// # Errors
/// When a picture cannot be read.
pub(crate) fn choose(recording: &Recording, each: &mut dyn FnMut(usize, &Image)) -> Result<Choice, PlatformError> {
    let (marks, without_pose) = marks::of(recording);
    let mut wanted: Vec<usize> = marks.iter().flat_map(|mark| mark.candidates.iter().copied()).collect();
    wanted.sort_unstable();
    wanted.dedup();
    let mut looks = Vec::with_capacity(wanted.len());
    recording.reel.pictures(&wanted, &mut |number, image| {
        each(number, &image);
        looks.push((number, Look::at(&image)));
        Ok(())
    })?;
    Ok(Choice { without_pose, ..among(recording, &marks, &looks) })
}

/// The same, once every candidate has been looked at.
fn among(recording: &Recording, marks: &[Mark], looks: &[(usize, Look)]) -> Choice {
    let look = |number: usize| {
        let found = looks.binary_search_by_key(&number, |(number, _)| *number).ok();
        found.map(|at| &looks[at].1)
    };
    let least = BLURRED * usual_sharpness(looks);
    let mut choice = Choice::default();
    let mut last: Option<&Look> = None;
    for (at, mark) in marks.iter().enumerate() {
        // Without its ends a path is another one.
        let is_end = at == 0 || at + 1 == marks.len();
        let faces = |number: &&usize| is_end || faces_the_way(recording, marks, at, **number);
        let facing: Vec<usize> = mark.candidates.iter().filter(faces).copied().collect();
        if facing.is_empty() {
            choice.turned_away += 1;
            continue;
        }
        let is_sharp = |number: &&usize| look(**number).is_some_and(|look| look.sharpness >= least);
        let nearest = |number: &&usize| number.abs_diff(mark.at);
        let sharpest = || facing.iter().max_by(|a, b| sharpness(look(**a)).total_cmp(&sharpness(look(**b))));
        let sharp = facing.iter().filter(is_sharp).min_by_key(nearest);
        let Some(number) = sharp.or_else(|| if is_end { sharpest() } else { None }) else {
            choice.blurred += 1;
            continue;
        };
        let Some(seen) = look(*number) else { continue };
        if last.is_some_and(|last| last.difference(seen) < ALIKE) {
            choice.alike += 1;
            if at + 1 < marks.len() || choice.stops.len() < 2 {
                continue;
            }
            choice.stops.pop();
        }
        choice.stops.push(*number);
        last = Some(seen);
    }
    choice
}

fn sharpness(look: Option<&Look>) -> f64 {
    look.map_or(0.0, |look| look.sharpness)
}

/// The median.
fn usual_sharpness(looks: &[(usize, Look)]) -> f64 {
    let mut all: Vec<f64> = looks.iter().map(|(_, look)| look.sharpness).collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(0.0)
}

/// Whether a picture was taken along the way from the mark before; true where that is not known.
fn faces_the_way(recording: &Recording, marks: &[Mark], at: usize, number: usize) -> bool {
    let heading = || {
        let track = recording.track.as_ref()?;
        let looking = track.at(recording.reel.times_s()[number])?.heading?;
        let walked = Heading::towards(marks.get(at.checked_sub(1)?)?.position?, marks[at].position?)?;
        Some(looking.turn_to(walked).abs() <= TURNED_AWAY_RAD)
    };
    heading().unwrap_or(true)
}

#[cfg(test)]
mod tests;
