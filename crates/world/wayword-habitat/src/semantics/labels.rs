//! Makes the labels of a view from the pixels of the semantic picture.

use super::{SceneSemantics, SemanticThing};
use wayword_core::{Heading, ObjectLabel, ViewGaze};
use wayword_render::{PinholeCamera, RenderError, VisibleObject, box_corners, evident_objects};

impl SceneSemantics {
    /// Labels of the visible objects, the largest first. An object counts if it has a name and the middle of its box is
    /// within the gaze. Hidden objects do not count, nor do objects of which only a sliver is visible.
    pub(crate) fn visible_labels(
        &self,
        camera: &PinholeCamera,
        gaze: ViewGaze,
    ) -> Result<Vec<ObjectLabel>, RenderError> {
        let picture = self.draw_ids(camera)?;
        let seen = evident_objects(&picture);
        let labels = seen.iter().filter_map(|each| label_for_thing(camera, each, self.thing_with_id(each.id)?));
        Ok(labels.filter(|label| gaze.holds_heading(label.heading)).collect())
    }
}

fn label_for_thing(camera: &PinholeCamera, seen: &VisibleObject, thing: &SemanticThing) -> Option<ObjectLabel> {
    let (name, (low, high)) = (thing.name.as_ref()?, thing.bounds?);
    if seen.is_sliver(camera, &box_corners(low, high)) {
        return None;
    }
    let centre = (low + high) / 2.0;
    let offset = centre - camera.position;
    let level_m = libm::sqrt(offset.x * offset.x + offset.y * offset.y);
    Some(ObjectLabel {
        object: thing.id.clone(),
        name: name.clone(),
        heading: Heading::new(libm::atan2(offset.x, offset.y)).ok()?,
        elevation_rad: libm::atan2(offset.z, level_m),
        box_px: Some(seen.bbox.map(f64::from)),
        distance_m: Some(offset.length()),
        position: Some(centre),
        colour: None,
        room: None,
    })
}
