//! Evidence from captions.

use super::{Evidence, FrameEvidence, SeenThing, Source};
use wayword_core::{Look, Observation, Path, Where, Witness};

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
                // A witness that names the room and no object has looked; one that says nothing may not have.
                let has_looked = |look: &Look| look.caption.room.is_some() || !look.caption.sightings.is_empty();
                let knows_things = !seen.looks.is_empty() && seen.looks.iter().all(has_looked);
                let mut evidence = FrameEvidence { knows_things, ..FrameEvidence::default() };
                for look in &seen.looks {
                    evidence.rooms.extend(look.caption.room.clone().filter(|room| !evidence.rooms.contains(room)));
                    let off_rad = frame.pose.heading.turn_to(look.gaze.heading);
                    for sighting in &look.caption.sightings {
                        if sighting.witness == Witness::Seen {
                            let turn_rad = |place: Where| off_rad + place.turn_rad(look.gaze.horizontal_fov_rad);
                            evidence.things.push(SeenThing {
                                name: sighting.name.clone(),
                                object: None,
                                colour: sighting.colour.clone(),
                                turn_rad: sighting.place.map(turn_rad),
                                ..SeenThing::default()
                            });
                        }
                    }
                }
                evidence
            })
            .collect();
        let known = frames.iter().any(|frame| !frame.rooms.is_empty() || !frame.things.is_empty());
        known.then(|| Self::of(path, frames, Source::Captions))
    }
}
