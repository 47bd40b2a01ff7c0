//! A walk as a film shows it: the evidence of its frames, and its motion by poses or by an estimate from its pictures.

use wayword_checks::{Evidence, FrameEvidence};
use wayword_core::{CameraMotion, FilmTurnRules, Path, PathMove, find_film_turns};
use wayword_follower::pair::{FilmedHop, FilmedPlace, FilmedWalk};

/// The film of a path, frame by frame. Turns, heights and lengths are those of its poses, where it has them.
#[must_use]
pub fn filmed_walk(path: &Path, evidence: &Evidence) -> FilmedWalk {
    let hop = |step: PathMove| FilmedHop {
        turn_rad: Some(step.turn_rad),
        rise_m: Some(step.rise_m),
        length_m: Some(step.distance_m),
    };
    let hops = match path.motion.is_known() {
        true => path.moves().into_iter().map(hop).collect(),
        false => vec![FilmedHop::default(); path.frames.len().saturating_sub(1)],
    };
    FilmedWalk { places: filmed_places(evidence), hops }
}

/// The places of the frames.
pub(crate) fn filmed_places(evidence: &Evidence) -> Vec<FilmedPlace> {
    let place = |(frame, seen): (usize, &FrameEvidence)| FilmedPlace {
        things: seen.things.iter().map(|thing| thing.name.clone()).collect(),
        perhaps: seen.perhaps.things.iter().map(|thing| thing.name.clone()).collect(),
        rooms: seen.rooms.clone(),
        perhaps_rooms: seen.perhaps.rooms.clone(),
        knows_things: seen.knows_things,
        frame,
    };
    evidence.frames.iter().enumerate().map(place).collect()
}

/// The film of a path by the motion of all pictures of its film. A camera turns between the frames too, so the places are the frames and
/// the beginnings and ends of the turns; there the walk sees what the nearest frame shows. `None` where the film lacks a frame.
pub(crate) fn walk_by_motion(path: &Path, evidence: &Evidence, film: &CameraMotion) -> Option<FilmedWalk> {
    let at = path.frames.iter().map(|frame| film.frames.get(frame.viewpoint.as_ref()?).copied());
    let at: Vec<usize> = at.collect::<Option<_>>()?;
    let known = filmed_places(evidence);
    let (first, last) = (*at.first()?, *at.last()?);
    let turns = find_film_turns(&film.turns_rad(), FilmTurnRules::at_rate(film.pictures_per_s()));
    let mut nodes: Vec<usize> =
        turns.iter().flat_map(|turn| [turn.from_frame, turn.to_frame]).chain(at.clone()).collect();
    nodes.retain(|node| (first..=last).contains(node));
    nodes.sort_unstable();
    nodes.dedup();
    let place = |node: &usize| {
        let nearest = at.iter().enumerate().min_by_key(|(_, frame)| frame.abs_diff(*node));
        known.get(nearest.map_or(0, |(frame, _)| frame)).cloned().unwrap_or_default()
    };
    let hops = nodes.windows(2).map(|pair| hop_between(film, pair[0], pair[1])).collect();
    Some(FilmedWalk { places: nodes.iter().map(place).collect(), hops })
}

/// The way between two pictures of a film, as indices among those that its motion was told by.
pub(crate) fn hop_between(film: &CameraMotion, from: usize, to: usize) -> FilmedHop {
    let steps = film.steps.get(from..to).unwrap_or_default();
    FilmedHop {
        turn_rad: steps.iter().map(|step| step.turn_rad).sum(),
        rise_m: steps.iter().map(|step| step.rise_m).sum(),
        length_m: steps.iter().map(|step| step.length_m).sum(),
    }
}
