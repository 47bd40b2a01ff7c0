//! Makes evidence from the platform's own labels.

use super::{Evidence, EvidenceSource, FrameEvidence, SeenThing};
use wayword_core::{DVec3, ObjectLabel, Path, View};

impl Evidence {
    /// Evidence from ground truth: `panoramas` holds, for each frame, the views all around it. `None` where the
    /// platform has ground truth for none of them.
    #[must_use]
    pub fn from_labels(path: &Path, panoramas: &[Vec<View>]) -> Option<Self> {
        let known = panoramas.iter().flatten().any(|view| view.ground_truth().is_some());
        let frames = path.frames.iter().zip(panoramas).map(|(frame, views)| {
            let lists = |view: &View| view.ground_truth().is_some_and(|truth| truth.lists_objects);
            let knows_things = !views.is_empty() && views.iter().all(lists);
            let mut evidence = FrameEvidence { knows_things, ..FrameEvidence::default() };
            for truth in views.iter().filter_map(View::ground_truth) {
                evidence.rooms.extend(truth.room.clone().filter(|room| !evidence.rooms.contains(room)));
                evidence.things.extend(truth.labels.iter().map(|label| SeenThing {
                    name: label.name.clone(),
                    object: Some(label.object.clone()),
                    colour: label.colour.clone(),
                    turn_rad: Some(frame.pose.heading.turn_to(label.heading)),
                    distance_m: label.distance_m.or_else(|| Some(label.position?.distance(frame.pose.position))),
                    position: label.position.or_else(|| label_position(label, frame.pose.position)),
                    room: label.room.clone(),
                    ..SeenThing::default()
                }));
            }
            evidence
        });
        known.then(|| Self::from_frames(path, frames.collect(), EvidenceSource::Labels))
    }
}

/// Where a label's object is, from its direction and distance.
fn label_position(label: &ObjectLabel, eye: DVec3) -> Option<DVec3> {
    Some(eye + label.heading.raised_vector(label.elevation_rad) * label.distance_m?)
}
