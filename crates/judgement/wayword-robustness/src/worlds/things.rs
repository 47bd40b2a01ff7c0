//! Worlds with a thing less, a thing more, or a thing of another colour, by their labels. Pictures stay as they are, so
//! these changes are only for who reads labels.

use super::{Alter, altered::Look, labels::with_labels};
use std::collections::BTreeSet;
use wayword_core::{Frame, Heading, Label, ObjectId, PlatformError, SceneId, View};

/// A world without some of its objects.
#[derive(Debug, Clone)]
pub struct Removed {
    /// What is gone.
    pub objects: BTreeSet<ObjectId>,
}

/// A world with one object more.
#[derive(Debug, Clone)]
pub struct Added {
    /// The scene that it is in.
    pub scene: SceneId,
    /// The object, with its name, its colour and its place. Direction and distance are filled in where it is seen.
    pub object: Label,
    /// The frames that see it.
    pub seen_from: Vec<Frame>,
}

/// A world in which objects have another colour.
#[derive(Debug, Clone)]
pub struct Recoloured {
    /// Which.
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
    /// Its label in a view that holds it.
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
