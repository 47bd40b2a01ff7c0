//! Worlds with a thing removed, added or recoloured, in their labels only. Pictures stay as they are, so these changes affect only
//! observers that read labels.

use super::{WorldAlteration, altered_platform::AlteredLook, labels::with_labels};
use std::collections::BTreeSet;
use wayword_core::{Frame, Heading, ObjectId, ObjectLabel, PlatformError, SceneId, View};

/// A world without some of its objects.
#[derive(Debug, Clone)]
pub struct ThingRemoval {
    /// The removed objects.
    pub objects: BTreeSet<ObjectId>,
}

/// A world with one object more.
#[derive(Debug, Clone)]
pub struct ThingAddition {
    /// The scene that it is in.
    pub scene: SceneId,
    /// The object, with its name, colour and position. Direction and distance are filled in for each view.
    pub object: ObjectLabel,
    /// The frames from which it is visible.
    pub seen_from: Vec<Frame>,
}

/// A world in which objects have another colour.
#[derive(Debug, Clone)]
pub struct ThingRecolouring {
    /// The recoloured objects.
    pub objects: BTreeSet<ObjectId>,
    /// The word for their new colour.
    pub colour: String,
}

impl WorldAlteration for ThingRemoval {
    fn view_after(&self, _: AlteredLook<'_>, before: View) -> Result<View, PlatformError> {
        Ok(with_labels(before, |labels| labels.retain(|label| !self.objects.contains(&label.object))))
    }
}

impl WorldAlteration for ThingRecolouring {
    fn view_after(&self, _: AlteredLook<'_>, before: View) -> Result<View, PlatformError> {
        let recolour = |labels: &mut Vec<ObjectLabel>| {
            for label in labels.iter_mut().filter(|label| self.objects.contains(&label.object)) {
                label.colour = Some(self.colour.clone());
            }
        };
        Ok(with_labels(before, recolour))
    }
}

impl WorldAlteration for ThingAddition {
    fn view_after(&self, look: AlteredLook<'_>, before: View) -> Result<View, PlatformError> {
        let is_here =
            *look.scene == self.scene && self.seen_from.iter().any(|frame| frame.place_key() == look.from.place_key());
        let Some(label) = is_here.then(|| self.label_in_view(look)).flatten() else { return Ok(before) };
        Ok(with_labels(before, |labels| labels.push(label)))
    }
}

impl ThingAddition {
    /// Its label in a view; `None` if the view does not include it.
    fn label_in_view(&self, look: AlteredLook<'_>) -> Option<ObjectLabel> {
        let (eye, position) = (look.from.pose.position, self.object.position?);
        let heading = Heading::towards(eye, position).filter(|heading| look.gaze.holds_heading(*heading))?;
        let (level_m, rise_m) = ((position - eye).truncate().length(), position.z - eye.z);
        Some(ObjectLabel {
            heading,
            elevation_rad: libm::atan2(rise_m, level_m),
            distance_m: Some(position.distance(eye)),
            ..self.object.clone()
        })
    }
}
