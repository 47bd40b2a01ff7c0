//! Worlds with a thing removed, added or recoloured, in their labels only. Pictures stay as they are, so these changes affect only
//! observers that read labels.

use super::{Alter, altered::Look, labels::with_labels};
use std::collections::BTreeSet;
use wayword_core::{Frame, Heading, Label, ObjectId, PlatformError, SceneId, View};

/// A world without some of its objects.
#[derive(Debug, Clone)]
pub struct Removed {
    /// The removed objects.
    pub objects: BTreeSet<ObjectId>,
}

/// A world with one object more.
#[derive(Debug, Clone)]
pub struct Added {
    /// The scene that it is in.
    pub scene: SceneId,
    /// The object, with its name, colour and position. Direction and distance are filled in for each view.
    pub object: Label,
    /// The frames from which it is visible.
    pub seen_from: Vec<Frame>,
}

/// A world in which objects have another colour.
#[derive(Debug, Clone)]
pub struct Recoloured {
    /// The recoloured objects.
    pub objects: BTreeSet<ObjectId>,
    /// The word for their new colour.
    pub colour: String,
}

impl Alter for Removed {
    fn view_after(&self, _: Look<'_>, before: View) -> Result<View, PlatformError> {
        Ok(with_labels(before, |labels| labels.retain(|label| !self.objects.contains(&label.object))))
    }
}

impl Alter for Recoloured {
    fn view_after(&self, _: Look<'_>, before: View) -> Result<View, PlatformError> {
        let recolour = |labels: &mut Vec<Label>| {
            for label in labels.iter_mut().filter(|label| self.objects.contains(&label.object)) {
                label.colour = Some(self.colour.clone());
            }
        };
        Ok(with_labels(before, recolour))
    }
}

impl Alter for Added {
    fn view_after(&self, look: Look<'_>, before: View) -> Result<View, PlatformError> {
        let is_here =
            *look.scene == self.scene && self.seen_from.iter().any(|frame| frame.place() == look.from.place());
        let Some(label) = is_here.then(|| self.seen(look)).flatten() else { return Ok(before) };
        Ok(with_labels(before, |labels| labels.push(label)))
    }
}

impl Added {
    /// Its label in a view; `None` if the view does not include it.
    fn seen(&self, look: Look<'_>) -> Option<Label> {
        let (eye, position) = (look.from.pose.position, self.object.position?);
        let heading = Heading::towards(eye, position).filter(|heading| look.gaze.holds(*heading))?;
        let (level_m, rise_m) = ((position - eye).truncate().length(), position.z - eye.z);
        Some(Label {
            heading,
            elevation_rad: libm::atan2(rise_m, level_m),
            distance_m: Some(position.distance(eye)),
            ..self.object.clone()
        })
    }
}
