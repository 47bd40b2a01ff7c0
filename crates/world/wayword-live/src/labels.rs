//! Makes labels from the pixels of a simulator's segmentation picture.
//!
//! In that picture every object has its own colour. The pixels of a colour show whether the object is visible and where;
//! the object's box, which the simulator sends once per scene, gives its position.

use std::collections::BTreeMap;
use wayword_core::{DVec3, Heading, ObjectId, ObjectLabel, ViewGaze};
use wayword_render::{PinholeCamera, RenderedPicture, VisibleObject, evident_objects};

/// Names that get no label, because these things are everywhere and distinguish no place.
const UNLABELLED_NAMES: [&str; 6] = ["floor", "wall", "walls", "ceiling", "character", "door jamb"];

/// An object of a scene.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SimulatorObject {
    pub(crate) object: ObjectId,
    /// In plain words.
    pub(crate) name: String,
    /// The middle of its box, metres, world frame.
    pub(crate) centre: DVec3,
    /// The corners of its box.
    pub(crate) corners: [DVec3; 8],
}

impl SimulatorObject {
    /// An object from the middle of its box and the vectors from there to three of its sides. `None` where the name is
    /// empty or in [`UNLABELLED_NAMES`], or a number is not finite.
    pub(crate) fn new(id: i64, name: &str, centre: DVec3, [a, b, c]: [DVec3; 3]) -> Option<Self> {
        let name = plain_name(name);
        let usable = centre.is_finite() && [a, b, c].iter().all(|side| side.is_finite());
        if name.is_empty() || UNLABELLED_NAMES.contains(&name.as_str()) || !usable {
            return None;
        }
        let sign = |n: usize, bit: usize| if n >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let corners = std::array::from_fn(|n| centre + a * sign(n, 0) + b * sign(n, 1) + c * sign(n, 2));
        Some(Self { object: ObjectId::new(id.to_string()).ok()?, name, centre, corners })
    }
}

/// The name of a 3D model in plain words: lower case, no underscores.
pub(crate) fn plain_name(name: &str) -> String {
    let words: String = name.chars().take(64).map(|c| if c.is_alphanumeric() { c } else { ' ' }).collect();
    words.split_whitespace().map(str::to_lowercase).collect::<Vec<_>>().join(" ")
}

/// The scene's objects by their colour, `0xRRGGBB`. The colour of a pixel is also its id.
pub(crate) type ObjectPalette = BTreeMap<u32, SimulatorObject>;

/// The id of a colour.
pub(crate) fn colour_id([r, g, b]: [u8; 3]) -> u32 {
    u32::from_be_bytes([0, r, g, b])
}

/// Labels of visible objects, largest first. The middle of an object's box must lie within the gaze. `ids` are the
/// colours of the picture's pixels, rows from the top.
pub(crate) fn labels_in_gaze(
    camera: &PinholeCamera,
    gaze: ViewGaze,
    ids: Vec<u32>,
    palette: &ObjectPalette,
) -> Vec<ObjectLabel> {
    let depth_m = vec![0.0; ids.len()];
    let picture = RenderedPicture { width: camera.width, height: camera.height, rgb: Vec::new(), depth_m, ids };
    let visible = evident_objects(&picture);
    let labels = visible.iter().filter_map(|each| {
        let thing = palette.get(&each.id)?;
        let is_sliver = each.is_sliver(camera, &thing.corners);
        (!is_sliver).then(|| label_object(camera, each, thing)).flatten()
    });
    labels.filter(|label| gaze.holds_heading(label.heading)).collect()
}

fn label_object(camera: &PinholeCamera, seen: &VisibleObject, thing: &SimulatorObject) -> Option<ObjectLabel> {
    let offset = thing.centre - camera.position;
    let level_m = libm::sqrt(offset.x * offset.x + offset.y * offset.y);
    Some(ObjectLabel {
        object: thing.object.clone(),
        name: thing.name.clone(),
        heading: Heading::new(libm::atan2(offset.x, offset.y)).ok()?,
        elevation_rad: libm::atan2(offset.z, level_m),
        box_px: Some(seen.bbox.map(f64::from)),
        distance_m: Some(offset.length()),
        position: Some(thing.centre),
        colour: None,
        room: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The labels of a chair two metres ahead, half a metre wide. Its pixels fill `columns` of the picture's 160 columns.
    fn seen(columns: u32) -> Vec<ObjectLabel> {
        let camera = PinholeCamera {
            position: DVec3::new(0.0, 0.0, 1.0),
            heading_rad: 0.0,
            elevation_rad: 0.0,
            vertical_fov_rad: 2.0 * libm::atan(0.75),
            width: 160,
            height: 120,
        };
        let half = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * 0.25);
        let chair = SimulatorObject::new(7, "Arm_Chair", DVec3::new(0.0, 2.0, 1.0), half).unwrap();
        let ids = (0..160 * 120).map(|n| {
            let (x, y) = (n % 160, n / 160);
            u32::from((70..70 + columns).contains(&x) && (50..70).contains(&y)) * 5
        });
        labels_in_gaze(
            &camera,
            ViewGaze::quarter_view(Heading::NORTH),
            ids.collect(),
            &ObjectPalette::from([(5, chair)]),
        )
    }

    #[test]
    fn labels_contain_visible_objects_and_no_slivers() {
        let label = seen(20).remove(0);
        assert_eq!((label.name.as_str(), label.object.as_str(), label.distance_m), ("arm chair", "7", Some(2.0)));
        assert_eq!(label.box_px, Some([70.0, 50.0, 20.0, 20.0]));
        assert!(seen(1).is_empty(), "too few pixels");
        assert!(seen(4).is_empty(), "too little of its box");
    }

    #[test]
    fn thing_new_refuses_walls_and_invalid_boxes() {
        let side = [DVec3::X; 3];
        assert_eq!(SimulatorObject::new(1, "Wall", DVec3::ZERO, side), None);
        assert_eq!(SimulatorObject::new(1, "__", DVec3::ZERO, side), None);
        assert_eq!(SimulatorObject::new(1, "chair", DVec3::NAN, side), None);
    }
}
