//! Evidence from captions.

use super::{Evidence, FrameEvidence, SeenThing, Source};
use std::collections::BTreeSet;
use wayword_core::{Form, Look, Observation, Path, Sighting, Where, Witness};
use wayword_language::lexicon::{agree, kinds, normal};

impl Evidence {
    /// Evidence from captions, one observation per frame of the path. `None` where no caption names a room or an
    /// object.
    #[must_use]
    pub fn from_captions(path: &Path, observations: &[Observation]) -> Option<Self> {
        let frames: Vec<FrameEvidence> = path
            .frames
            .iter()
            .zip(observations)
            .map(|(frame, seen)| {
                let off_rad = |look: &Look| frame.pose.heading.turn_to(look.gaze.heading);
                of_looks(&seen.looks, &off_rad)
            })
            .collect();
        let mut frames = frames;
        doubt(&mut frames);
        let known = frames
            .iter()
            .any(|frame| !frame.rooms.is_empty() || !frame.things.is_empty() || !frame.perhaps.things.is_empty());
        known.then(|| Self::of(path, frames, Source::Captions))
    }
}

/// A name of which witnesses were unsure at least as often as they were sure is only perhaps there, wherever it was named.
fn doubt(frames: &mut [FrameEvidence]) {
    let count = |of: fn(&FrameEvidence) -> &Vec<SeenThing>, frames: &[FrameEvidence], name: &str| {
        frames.iter().filter(|frame| of(frame).iter().any(|thing| normal(&thing.name) == name)).count()
    };
    let names: BTreeSet<String> =
        frames.iter().flat_map(|frame| &frame.perhaps.things).map(|thing| normal(&thing.name)).collect();
    let is_doubtful = |name: &String| {
        count(|frame| &frame.perhaps.things, frames, name) >= count(|frame| &frame.things, frames, name)
    };
    let doubtful: BTreeSet<String> = names.into_iter().filter(is_doubtful).collect();
    for frame in frames {
        let (doubted, sure) = frame.things.drain(..).partition(|thing| doubtful.contains(&normal(&thing.name)));
        frame.things = sure;
        let mut doubted: Vec<SeenThing> = doubted;
        frame.perhaps.things.append(&mut doubted);
    }
}

fn of_looks(looks: &[Look], off_rad: &dyn Fn(&Look) -> f64) -> FrameEvidence {
    // A witness that names the room and no object has looked; one that says nothing may not have.
    let has_looked = |look: &Look| look.caption.room.is_some() || !look.caption.sightings.is_empty();
    let knows_things = !looks.is_empty() && looks.iter().all(has_looked);
    let mut evidence = FrameEvidence { knows_things, ..FrameEvidence::default() };
    evidence.lists_things = knows_things && looks.iter().all(is_list);
    for look in looks {
        evidence.rooms.extend(look.caption.room.clone().filter(|room| !evidence.rooms.contains(room)));
        evidence.perhaps.rooms.extend(look.caption.perhaps_rooms.iter().cloned());
        evidence.perhaps.rooms.extend(look.caption.ways.iter().filter_map(|way| way.leads_to.clone()));
        for sighting in &look.caption.sightings {
            match sighting.witness {
                Witness::Seen => evidence.things.push(seen_thing(sighting, look, off_rad(look))),
                Witness::Unsure => evidence.perhaps.things.push(seen_thing(sighting, look, off_rad(look))),
                Witness::Denied => evidence.denied.push(sighting.name.clone()),
            }
        }
    }
    // What one view of a frame shows is there, whatever was said of another.
    let FrameEvidence { things, perhaps, denied, .. } = &mut evidence;
    let is_named = |name: &str| things.iter().chain(&perhaps.things).any(|thing| agree(&thing.name, name));
    denied.retain(|name| !is_named(name));
    evidence
}

/// Whether a caption lists what its view shows: an answer of the form that was asked for, with something in it.
fn is_list(look: &Look) -> bool {
    let names_something = look.caption.sightings.iter().any(|sighting| sighting.witness != Witness::Denied);
    look.caption.is_structured && look.caption.form != Some(Form::Broken) && names_something
}

fn seen_thing(sighting: &Sighting, look: &Look, off_rad: f64) -> SeenThing {
    let turn_rad = |place: Where| off_rad + place.turn_rad(look.gaze.horizontal_fov_rad);
    SeenThing {
        name: sighting.name.clone(),
        colour: sighting.colour.clone(),
        more_colours: sighting.more_colours.clone(),
        turn_rad: sighting.place.map(turn_rad),
        ..SeenThing::default()
    }
}

/// Whether a denial of one name denies another: "no chair" denies a dining chair, but "no dining chair" no chair.
pub(super) fn denies(denied: &str, name: &str) -> bool {
    let general = kinds(denied);
    normal(denied) == normal(name) || kinds(name).contains(&general[0])
}
