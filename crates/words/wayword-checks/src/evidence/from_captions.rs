//! Makes evidence from captions: which rooms and objects witnesses saw, guessed or denied from each frame.

use super::{
    Evidence, EvidenceSource, FrameEvidence, SeenThing,
    identity::{WalkEyes, group_sightings},
};
use wayword_core::{
    Caption, CaptionedView, FormOutcome, FrameObservation, ObjectSighting, Path, ViewThird, WitnessAnswer,
};
use wayword_language::lexicon::{kinds_of, names_agree, normalise_name};

impl Evidence {
    /// Evidence from captions, one observation per frame of the path. `None` where no caption names a room or an
    /// object.
    #[must_use]
    pub fn from_captions(path: &Path, observations: &[FrameObservation]) -> Option<Self> {
        let mut frames: Vec<FrameEvidence> = path
            .frames
            .iter()
            .zip(observations)
            .map(|(frame, seen)| {
                let off_rad = |look: &CaptionedView| frame.pose.heading.turn_to(look.gaze.heading);
                frame_from_looks(&seen.looks, &off_rad)
            })
            .collect();
        move_doubtful_things(path, &mut frames);
        let is_known = |frame: &FrameEvidence| {
            let FrameEvidence { rooms, things, perhaps, denied, .. } = frame;
            !(rooms.is_empty() && things.is_empty() && perhaps.things.is_empty() && denied.is_empty())
        };
        let known = frames.iter().any(is_known);
        known.then(|| Self::from_frames(path, frames, EvidenceSource::Captions))
    }

    /// Evidence from a detector's finds and misses alone: captions without words, one observation per frame. `None`
    /// where it looked for no names.
    #[must_use]
    pub fn from_detector(path: &Path, observations: &[FrameObservation]) -> Option<Self> {
        Some(Self { source: EvidenceSource::Detector, ..Self::from_captions(path, observations)? })
    }
}

/// Moves doubtful things to the guesses: of one thing, witnesses were unsure at least as often as they were sure. A doubt about another
/// thing of its name does not count.
fn move_doubtful_things(path: &Path, frames: &mut [FrameEvidence]) {
    let listed = |frame: usize, is_sure: bool, things: &[SeenThing]| {
        let list: Vec<(usize, bool, SeenThing)> = things.iter().map(|thing| (frame, is_sure, thing.clone())).collect();
        list
    };
    let all: Vec<(usize, bool, SeenThing)> = frames
        .iter()
        .enumerate()
        .flat_map(|(at, frame)| {
            let mut seen = listed(at, true, &frame.things);
            seen.extend(listed(at, false, &frame.perhaps.things));
            seen
        })
        .collect();
    if all.iter().all(|(_, is_sure, _)| *is_sure) {
        return;
    }
    let sightings: Vec<(usize, &SeenThing)> = all.iter().map(|(frame, _, thing)| (*frame, thing)).collect();
    let mut doubtful = vec![false; all.len()];
    for group in group_sightings(&sightings, frames, &WalkEyes::along(path)) {
        let sure = group.members.iter().filter(|member| all[**member].1).count();
        let is_doubtful = group.members.len() - sure >= sure;
        group.members.iter().for_each(|member| doubtful[*member] = is_doubtful);
    }
    let mut doubtful = doubtful.into_iter();
    for frame in frames {
        let guesses = frame.perhaps.things.len();
        let is_doubtful: Vec<bool> = doubtful.by_ref().take(frame.things.len()).collect();
        doubtful.by_ref().take(guesses).for_each(drop);
        let mut kept = is_doubtful.iter();
        let (moved, sure): (Vec<_>, Vec<_>) = frame.things.drain(..).partition(|_| kept.next() == Some(&true));
        frame.things = sure;
        frame.perhaps.things.extend(moved);
    }
}

/// The evidence of a frame from the captions of its views. `off_rad` gives the direction of a view from the heading,
/// radians, positive right.
fn frame_from_looks(looks: &[CaptionedView], off_rad: &dyn Fn(&CaptionedView) -> f64) -> FrameEvidence {
    // A caption with a room and no object comes from a witness that looked; a caption without both may not.
    let has_looked = |look: &CaptionedView| look.caption.room.is_some() || !look.caption.sightings.is_empty();
    let knows_things = !looks.is_empty() && looks.iter().all(has_looked);
    let mut evidence = FrameEvidence { knows_things, ..FrameEvidence::default() };
    evidence.lists_things = knows_things && looks.iter().all(is_list);
    for look in looks {
        evidence.rooms.extend(look.caption.room.clone().filter(|room| !evidence.rooms.contains(room)));
        evidence.perhaps.rooms.extend(look.caption.perhaps_rooms.iter().cloned());
        evidence.perhaps.rooms.extend(look.caption.ways.iter().filter_map(|way| way.leads_to.clone()));
        for sighting in &look.caption.sightings {
            match sighting.witness {
                WitnessAnswer::Seen => evidence.things.push(seen_thing(sighting, look, off_rad(look))),
                WitnessAnswer::Unsure => evidence.perhaps.things.push(seen_thing(sighting, look, off_rad(look))),
                WitnessAnswer::Denied => evidence.denied.push(sighting.name.clone()),
            }
        }
    }
    // A thing that one view of a frame shows is there, even if the caption of another view denies it.
    let FrameEvidence { things, perhaps, denied, .. } = &mut evidence;
    let is_named = |name: &str| things.iter().chain(&perhaps.things).any(|thing| names_agree(&thing.name, name));
    denied.retain(|name| !is_named(name));
    evidence
}

/// A list of so many things may leave some out.
const LONG_LIST: usize = 9;

/// Whether a caption lists all that its view shows: it is made from an answer in the form that was asked for, and not cut short.
fn is_list(look: &CaptionedView) -> bool {
    let Caption { is_structured, form, sightings, .. } = &look.caption;
    *is_structured && *form != Some(FormOutcome::Broken) && sightings.len() < LONG_LIST
}

/// A thing that a caption names, in a direction from the heading where the caption places it in its view.
fn seen_thing(sighting: &ObjectSighting, look: &CaptionedView, off_rad: f64) -> SeenThing {
    let of_place = |place: ViewThird| place.turn_rad(look.gaze.horizontal_fov_rad);
    let within_rad = sighting.spot.map(|spot| spot.off_rad).or_else(|| sighting.place.map(of_place));
    SeenThing {
        name: sighting.name.clone(),
        colour: sighting.colour.clone(),
        more_colours: sighting.more_colours.clone(),
        material: sighting.material.clone(),
        detail: sighting.detail.clone(),
        stands_out: sighting.stands_out,
        turn_slack_rad: if sighting.spot.is_some() { 0.0 } else { look.gaze.horizontal_fov_rad / 6.0 },
        is_far: sighting.is_far,
        several: sighting.several,
        distance_m: sighting.spot.and_then(|spot| spot.distance_m),
        turn_rad: within_rad.map(|within_rad| off_rad + within_rad),
        ..SeenThing::default()
    }
}

/// Whether a denial of one name denies another: "no chair" denies a dining chair, but "no dining chair" no chair.
pub(super) fn denies_name(denied: &str, name: &str) -> bool {
    let denied_kinds = kinds_of(denied);
    normalise_name(denied) == normalise_name(name) || kinds_of(name).contains(&denied_kinds[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CheckSubject, check_own_text, check_text};
    use wayword_core::{CheckKind, DVec3, InstructionStyle, PathMotion, SceneId, Verdict, ViewGaze, path::PathStop};

    /// A path straight ahead, with these captions of its frames.
    fn evidence(captions: Vec<Caption>) -> Evidence {
        let stop =
            |at: usize| PathStop { position: DVec3::new(0.0, 2.0 * at as f64, 1.5), viewpoint: None, level: None };
        let frames = Path::frames_along((0..captions.len()).map(stop).collect(), None);
        let seen = frames.iter().zip(captions).map(|(frame, caption)| FrameObservation {
            looks: vec![CaptionedView { gaze: ViewGaze::quarter_view(frame.pose.heading), caption }],
            ..FrameObservation::default()
        });
        let seen: Vec<FrameObservation> = seen.collect();
        let path =
            Path { id: "p".into(), scene: SceneId::new("s").unwrap(), frames, motion: PathMotion::Known, target: None };
        Evidence::from_captions(&path, &seen).unwrap()
    }

    fn listed(room: &str, things: &[(&str, WitnessAnswer)]) -> Caption {
        let sighting = |(name, witness): &(&str, WitnessAnswer)| ObjectSighting::new(*name, *witness, "test");
        let sightings = things.iter().map(sighting).collect();
        Caption { room: Some(room.into()), sightings, is_structured: true, ..Caption::default() }
    }

    fn known() -> Evidence {
        use WitnessAnswer::{Denied, Seen, Unsure};
        let cream = ObjectSighting { colour: Some("cream".into()), ..ObjectSighting::new("rug", Seen, "test") };
        let mut hall = listed("hallway", &[("bench", Seen), ("lamp", Unsure), ("vase", Denied)]);
        hall.sightings.push(cream);
        evidence(vec![
            hall,
            listed("hallway", &[("plant", Seen), ("mirror", Seen)]),
            listed("kitchen", &[("stove", Seen), ("table", Unsure), ("table", Denied)]),
        ])
    }

    fn places(text: &str, own: bool) -> Verdict {
        let style = InstructionStyle { name: "s".into(), ..InstructionStyle::default() };
        let evidence = known();
        let subject = CheckSubject::closed_world(&evidence, &style, None);
        let checked = if own { check_own_text(text, subject) } else { check_text(text, subject) };
        let of_places = checked.findings.iter().filter(|finding| finding.check == CheckKind::Landmarks);
        of_places.map(|finding| finding.verdict).max().unwrap()
    }

    #[test]
    fn doubt_and_silence_make_nothing_wrong_and_denials_do() {
        for (text, wanted) in [
            ("Walk past the bench.", Verdict::Pass),
            ("Walk past the lamp.", Verdict::Unverified),
            // It was named as a guess and denied in the same frame.
            ("Walk past the table.", Verdict::Unverified),
            ("Walk past the clock.", Verdict::Unverified),
            ("Walk past the vase.", Verdict::Fail),
            // A list of every frame would hardly leave one out.
            ("Walk past the sofa.", Verdict::Fail),
            ("Walk past the beige rug.", Verdict::Pass),
            ("Walk past the black rug.", Verdict::Fail),
        ] {
            assert_eq!(places(text, false), wanted, "{text}");
        }
    }

    #[test]
    fn a_doubt_farther_off_is_about_another_thing() {
        use WitnessAnswer::{Seen, Unsure};
        let lamp = |witness| listed("hallway", &[("lamp", witness)]);
        let none = || listed("hallway", &[]);
        let sure = |captions: Vec<Caption>| evidence(captions).frames_with_thing("lamp");
        assert_eq!(sure(vec![lamp(Unsure), lamp(Seen)]), [0; 0]);
        assert_eq!(sure(vec![lamp(Unsure), none(), none(), lamp(Seen)]), [3]);
    }

    #[test]
    fn a_long_list_may_leave_things_out() {
        let named = |count: usize| {
            let names: Vec<String> = (0..count).map(|number| format!("vase {number}")).collect();
            let things: Vec<_> = names.iter().map(|name| (name.as_str(), WitnessAnswer::Seen)).collect();
            evidence(vec![listed("hallway", &things); 2]).frames[1].lists_things
        };
        assert!(named(LONG_LIST - 1) && !named(LONG_LIST));
    }

    #[test]
    fn a_text_from_captions_may_not_add_to_them() {
        assert_eq!(places("Walk past the clock.", true), Verdict::Fail);
        assert_eq!(places("Walk past the lamp.", true), Verdict::Unverified);
    }

    #[test]
    fn a_text_ends_where_its_last_landmark_is_seen() {
        for (text, wanted) in [
            ("Stop next to the stove.", Verdict::Pass),
            ("Stop next to the plant.", Verdict::Pass),
            ("Stop next to the bench.", Verdict::Fail),
            ("Stop next to the clock.", Verdict::Fail),
            ("Stop next to the table.", Verdict::Unverified),
            ("Stop in the kitchen.", Verdict::Pass),
            ("Stop in the bedroom.", Verdict::Fail),
            ("Walk past the bench and stop in the kitchen.", Verdict::Pass),
        ] {
            assert_eq!(places(text, false), wanted, "{text}");
        }
    }

    /// What pictures show and what belongs to a thing may be named, and a verb behind "the top" names nothing.
    #[test]
    fn details_of_things_are_there_too() {
        let with = |name: &str, detail: &str| ObjectSighting {
            detail: Some(detail.into()),
            ..ObjectSighting::new(name, WitnessAnswer::Seen, "test")
        };
        let mut hall = listed("hallway", &[("bench", WitnessAnswer::Seen)]);
        hall.sightings.extend([with("door", "with a brass knob"), with("window", "view of the sea")]);
        let tiled = ObjectSighting { material: Some("tile".into()), ..with("floor", "large") };
        hall.sightings.push(tiled);
        let evidence = evidence(vec![hall.clone(), hall]);
        let style = InstructionStyle { name: "s".into(), ..InstructionStyle::default() };
        let verdict = |text: &str| check_own_text(text, CheckSubject::closed_world(&evidence, &style, None)).verdict();
        for text in [
            "Walk past the door with the brass knob.",
            "Stop at the window with the view of the sea.",
            "At the top keep straight on past the bench.",
            "Walk over the pink tiles to the bench, and stop a few steps beyond it.",
        ] {
            assert_ne!(verdict(text), Verdict::Fail, "{text}");
        }
        assert_eq!(verdict("Walk past the door with the horn."), Verdict::Fail);
    }

    /// A doubt about a counter on the right leaves the one on the left as sure as it was seen.
    #[test]
    fn a_doubt_about_one_thing_is_none_about_another_of_its_name() {
        let counter = |place, colour: &str, witness| ObjectSighting {
            place: Some(place),
            colour: Some(colour.into()),
            ..ObjectSighting::new("counter", witness, "test")
        };
        let caption = |sightings| Caption { sightings, is_structured: true, ..listed("kitchen", &[]) };
        let evidence = evidence(vec![
            caption(vec![
                counter(ViewThird::Left, "white", WitnessAnswer::Seen),
                counter(ViewThird::Right, "red", WitnessAnswer::Unsure),
            ]),
            caption(vec![counter(ViewThird::Right, "red", WitnessAnswer::Unsure)]),
        ]);
        let colours = |things: &[SeenThing]| things.iter().filter_map(|thing| thing.colour.clone()).collect::<Vec<_>>();
        assert_eq!(colours(&evidence.frames[0].things), ["white"]);
        assert_eq!(colours(&evidence.frames[0].perhaps.things), ["red"]);
    }
}
