//! How the camera of a recording moves from picture to picture: by its track, or by an estimate from its pictures.
//!
//! - `panorama`: a picture unrolled onto a cylinder, where a turn of a level camera shifts every column alike.
//! - `patches`: small patches of one picture, found in the next.
//! - `pair`: the turn on which most patches of a pair agree, and on no other.
//! - `follower`: takes the pictures of a film one by one.

mod follower;
mod pair;
mod panorama;
mod patches;

use crate::{reel::Recording, track::CameraTrack};
use follower::FilmFollower;
use wayword_core::{CameraStep, Heading, Image, PlatformError};

/// Pictures that are nearer in time are left out, seconds: a camera does not turn far in between.
const MIN_GAP_S: f64 = 0.19;
/// A camera that moves by less between two pictures stands still, metres.
const STILL_M: f64 = 0.01;
/// A camera that turns by less between two pictures stands still, radians.
const STILL_RAD: f64 = 0.01;
/// A way of at least this length has a direction, metres.
const DIRECTED_M: f64 = 0.05;

/// The pictures by which the motion is told, ascending: the first, and each that is late enough after the one before.
pub(crate) fn sampled_pictures(times_s: &[f64]) -> Vec<usize> {
    let mut wanted = Vec::new();
    let mut last_s = f64::NEG_INFINITY;
    for (number, time_s) in times_s.iter().enumerate() {
        if time_s - last_s >= MIN_GAP_S {
            wanted.push(number);
            last_s = *time_s;
        }
    }
    wanted
}

/// The steps between these times by the poses of the track. What lies in a gap of the track is not known.
pub(crate) fn steps_by_poses(track: &CameraTrack, times_s: &[f64]) -> Vec<CameraStep> {
    let fixes: Vec<_> = times_s.iter().map(|time_s| track.fix_at(*time_s)).collect();
    // A track without orientations looks where it goes.
    let mut looking: Option<Heading> = None;
    let headings: Vec<Option<Heading>> = fixes
        .iter()
        .zip(fixes.iter().skip(1).chain([&None]))
        .map(|(fix, next)| {
            let fix = fix.as_ref()?;
            let along = next.as_ref().filter(|next| next.position.distance(fix.position) >= DIRECTED_M);
            looking = fix.heading.or_else(|| Heading::towards(fix.position, along?.position)).or(looking);
            looking
        })
        .collect();
    // Odometry over a floor has one height for all places, which says nothing of stairs.
    let mut heights = fixes.iter().flatten().map(|fix| fix.position.z);
    let first = heights.next();
    let knows_heights = heights.any(|height| Some(height) != first);
    let pairs = fixes.windows(2).zip(headings.windows(2));
    let step = |(fixes, headings): (&[Option<crate::track::TrackFix>], &[Option<Heading>])| {
        let ([Some(from), Some(to)], [from_heading, to_heading]) = (fixes, headings) else {
            return CameraStep::default();
        };
        let turn_rad = from_heading.zip(*to_heading).map(|(from, to)| from.turn_to(to));
        let way = to.position - from.position;
        let length_m = way.truncate().length();
        CameraStep {
            turn_rad,
            length_m: Some(length_m),
            rise_m: knows_heights.then_some(way.z),
            is_still: length_m < STILL_M && turn_rad.is_none_or(|turn| turn.abs() < STILL_RAD),
        }
    };
    pairs.map(step).collect()
}

/// The steps between these pictures by what they show.
///
/// # Errors
/// When one cannot be read.
pub(crate) fn steps_by_pictures(
    recording: &Recording,
    wanted: &[usize],
    horizontal_fov_rad: f64,
) -> Result<Vec<CameraStep>, PlatformError> {
    let mut follower = FilmFollower::new(horizontal_fov_rad);
    recording.reel.hand_out_pictures(wanted, &mut |_, picture| {
        follower.add_picture(&picture);
        Ok(())
    })?;
    Ok(follower.into_steps())
}

/// The steps between consecutive pictures of one camera, by what they show. `horizontal_fov_rad` is its field of view, radians; a wrong one
/// scales the turns.
pub fn estimate_film_steps<'a>(
    pictures: impl IntoIterator<Item = &'a Image>,
    horizontal_fov_rad: f64,
) -> Vec<CameraStep> {
    let mut follower = FilmFollower::new(horizontal_fov_rad);
    pictures.into_iter().for_each(|picture| follower.add_picture(picture));
    follower.into_steps()
}

#[cfg(test)]
mod tests;
