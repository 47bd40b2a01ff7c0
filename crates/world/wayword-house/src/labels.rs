//! Finds the labels of a view from its pixels: each pixel carries the number of the object that it shows.

use super::{
    model::HouseRoom,
    objects::{NumberedObject, ObjectRole},
    scene::HouseScene,
};
use wayword_core::{DVec3, Heading, ObjectId, ObjectLabel, ViewGaze};
use wayword_render::{PinholeCamera, RenderError, VisibleObject, box_corners, evident_objects};

/// The largest drawing from which labels are taken, pixels. It can be small, because an object counts by its share of a picture.
pub(super) const LABELS_SIZE_PX: [u32; 2] = [320, 240];

/// Labels of the visible furniture, doors, windows and stairs, the largest first, with boxes in a picture of `size` pixels. The
/// middle of an object's box must lie within the gaze.
///
/// An object that is hidden behind others, or that shows only a sliver of itself, gets no label.
///
/// # Errors
/// When the numbers of the camera are not usable.
pub(super) fn visible_labels(
    scene: &HouseScene,
    eye: DVec3,
    gaze: ViewGaze,
    size: [u32; 2],
) -> Result<Vec<ObjectLabel>, RenderError> {
    let shrink = (0..2).map(|side| f64::from(LABELS_SIZE_PX[side]) / f64::from(size[side].max(1))).fold(1.0, f64::min);
    let drawn_size = size.map(|side| (f64::from(side) * shrink).round() as u32);
    let camera = PinholeCamera::for_level_gaze(eye, gaze, drawn_size);
    let visible = evident_objects(&scene.render_object_ids(&camera)?);
    let scale: [f64; 2] = std::array::from_fn(|side| f64::from(size[side]) / f64::from(drawn_size[side]));
    let labels = visible.iter().filter_map(|each| {
        let object = scene.objects.get(&each.id).filter(|object| object.role != ObjectRole::Shell)?;
        let (low, high) = object.bounds_m;
        let is_sliver = each.is_sliver(&camera, &box_corners(low, high));
        // A door belongs to two rooms.
        let room = scene.house.rooms.get(object.room).filter(|_| object.role == ObjectRole::Furniture);
        (!is_sliver).then(|| label_for_object(&camera, each, (object, room), scale)).flatten()
    });
    Ok(labels.filter(|label| gaze.holds_heading(label.heading)).collect())
}

/// The label of an object in a room. `scale` leads from the pixels of the drawing, across and down, to those of the picture.
fn label_for_object(
    camera: &PinholeCamera,
    seen: &VisibleObject,
    (object, room): (&NumberedObject, Option<&HouseRoom>),
    [across, down]: [f64; 2],
) -> Option<ObjectLabel> {
    let centre = object.centre_m();
    let offset = centre - camera.position;
    let [left, top, width, height] = seen.bbox.map(f64::from);
    let level_m = libm::sqrt(offset.x * offset.x + offset.y * offset.y);
    Some(ObjectLabel {
        object: ObjectId::new(seen.id.to_string()).ok()?,
        name: object.name.clone(),
        heading: Heading::new(libm::atan2(offset.x, offset.y)).ok()?,
        elevation_rad: libm::atan2(offset.z, level_m),
        box_px: Some([left * across, top * down, width * across, height * down]),
        distance_m: Some(offset.length()),
        position: Some(centre),
        colour: object.colour.map(str::to_owned),
        room: room.map(|room| room.kind.word().to_owned()),
    })
}

#[cfg(test)]
mod tests {
    use super::super::{catalogue::FurnitureKind, generate_house, model::House};
    use super::*;

    fn names(house: House, eye: DVec3, heading_rad: f64) -> Vec<String> {
        let scene = HouseScene::new(house).unwrap();
        let gaze = ViewGaze::quarter_view(Heading::new(heading_rad).unwrap());
        visible_labels(&scene, eye, gaze, [160, 120]).unwrap().into_iter().map(|label| label.name).collect()
    }

    /// A house with a refrigerator in the middle of its living room and no other furniture, and an eye south of it.
    fn refrigerator_alone() -> (House, DVec3) {
        let mut house = generate_house(1);
        let room = house.furniture.iter().find(|piece| piece.kind == FurnitureKind::Sofa).unwrap().room;
        let mut piece = house.furniture.iter().find(|piece| piece.kind == FurnitureKind::Refrigerator).unwrap().clone();
        let (x, y) = house.rooms[room].outline.centre();
        piece.room = room;
        piece.quarter_turns = 0;
        piece.footprint = super::super::rect::RectCm::new(x - 38, y, x + 38, y + 70);
        house.furniture = vec![piece];
        (house, DVec3::new(f64::from(x) / 100.0, f64::from(y) / 100.0 - 1.8, 1.5))
    }

    #[test]
    fn labels_name_objects_in_view_and_none_behind_the_eye() {
        let (house, eye) = refrigerator_alone();
        assert!(names(house.clone(), eye, 0.0).contains(&"refrigerator".to_owned()));
        assert!(!names(house, eye, std::f64::consts::PI).contains(&"refrigerator".to_owned()));
    }

    #[test]
    fn labels_leave_out_hidden_objects() {
        let (mut house, eye) = refrigerator_alone();
        let mut vase = house.furniture[0].clone();
        (vase.kind, vase.name, vase.id) = (FurnitureKind::Vase, "vase".into(), vase.id + 1);
        let (x, y) = vase.footprint.centre();
        vase.footprint = super::super::rect::RectCm::new(x - 11, y + 60, x + 11, y + 82);
        (vase.base_cm, vase.height_cm) = (60, 44);
        house.furniture.push(vase);
        let seen = names(house, eye, 0.0);
        assert!(seen.contains(&"refrigerator".to_owned()) && !seen.contains(&"vase".to_owned()), "{seen:?}");
    }
}
