//! Makes evidence from the platform's own labels.

use super::{Evidence, FrameEvidence, SeenThing, Source};
use wayword_core::{DVec3, Label, Path, View};

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
                    position: label.position.or_else(|| placed(label, frame.pose.position)),
                    ..SeenThing::default()
                }));
            }
            evidence
        });
        known.then(|| Self::of(path, frames.collect(), Source::Labels))
    }
}

/// Where a label's object is, from its direction and distance.
fn placed(label: &Label, eye: DVec3) -> Option<DVec3> {
    Some(eye + label.heading.raised(label.elevation_rad) * label.distance_m?)
}
