//! Makes the labels at a viewpoint of Matterport3D, from REVERIE's boxes or else from the `.house` file.

use super::{
    boxes::{ListedObject, ViewpointRay},
    house_file::MatterportHouseFile,
};
use glam::DVec3;
use std::collections::BTreeMap;
use wayword_core::{Heading, ObjectLabel, ViewpointId};

/// Objects of a `.house` file count as visible within this distance and in the same region, metres. REVERIE's paper
/// gives this distance for its own annotations. Walls within the region are not known.
const HOUSE_REACH_M: f64 = 3.0;

/// Labels from REVERIE's boxes; `eye` and `centres` are in the world frame.
///
/// A label's direction is that of the object's most central box. If the edges of all pictures cut the object, it surrounds
/// the viewer or continues below the lowest view, and no box shows its direction. Then the direction of its centre is
/// used, if the centre is known. The distance is to the centre.
pub(crate) fn from_boxes(listed: &[ListedObject], eye: DVec3, centres: &BTreeMap<String, DVec3>) -> Vec<ObjectLabel> {
    let mut labels: Vec<ObjectLabel> = listed
        .iter()
        .filter_map(|entry| {
            let object_box = entry.best_box()?;
            let centre = centres.get(entry.object.as_str()).copied();
            let by_centre = centre.and_then(|centre| ray_to(eye, centre));
            let ray =
                if object_box.is_cut() { by_centre.or(object_box.centre_ray()) } else { object_box.centre_ray() }?;
            Some(ObjectLabel {
                object: entry.object.clone(),
                name: entry.name.clone()?,
                heading: ray.heading,
                elevation_rad: ray.elevation_rad,
                box_px: None,
                distance_m: centre.map(|centre| eye.distance(centre)),
                position: centre,
                colour: None,
                room: None,
            })
        })
        .collect();
    labels.sort_by(|a, b| a.object.cmp(&b.object));
    labels
}

/// Labels from the centres of the objects in a viewpoint's region.
pub(crate) fn from_house(house: &MatterportHouseFile, viewpoint: &ViewpointId, eye: DVec3) -> Vec<ObjectLabel> {
    let mut labels: Vec<ObjectLabel> = house
        .objects_around(viewpoint)
        .filter(|object| eye.distance(object.centre) <= HOUSE_REACH_M)
        .filter_map(|object| {
            let ray = ray_to(eye, object.centre)?;
            Some(ObjectLabel {
                object: object.id.clone(),
                name: object.name.clone()?,
                heading: ray.heading,
                elevation_rad: ray.elevation_rad,
                box_px: None,
                distance_m: Some(eye.distance(object.centre)),
                position: Some(object.centre),
                colour: None,
                room: None,
            })
        })
        .collect();
    labels.sort_by(|a, b| a.object.cmp(&b.object));
    labels
}

/// The ray from an eye to a point; `None` if the point lies straight above or below.
fn ray_to(eye: DVec3, point: DVec3) -> Option<ViewpointRay> {
    let to = point - eye;
    let flat_m = libm::hypot(to.x, to.y);
    if flat_m <= 1e-6 {
        return None;
    }
    let heading = Heading::new(libm::atan2(to.x, to.y)).ok()?;
    Some(ViewpointRay { heading, elevation_rad: libm::atan2(to.z, flat_m) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matterport::boxes::SeenBox;
    use wayword_core::ObjectId;

    fn listed(boxes: &[SeenBox]) -> ListedObject {
        ListedObject { object: ObjectId::new("3").unwrap(), name: Some("lamp".into()), boxes: boxes.to_vec() }
    }

    fn centres(at: DVec3) -> BTreeMap<String, DVec3> {
        BTreeMap::from([("3".to_owned(), at)])
    }

    const WHOLE: SeenBox = SeenBox { view: 15, box_px: [300.0, 200.0, 40.0, 80.0] };
    const CUT: SeenBox = SeenBox { view: 15, box_px: [0.0, 0.0, 640.0, 480.0] };

    #[test]
    fn a_whole_box_gives_the_direction_and_the_centre_the_distance() {
        let labels = from_boxes(&[listed(&[WHOLE])], DVec3::ZERO, &centres(DVec3::new(3.0, 0.2, 0.0)));
        assert!((labels[0].heading.deg() - 90.0).abs() < 1e-9);
        assert!((labels[0].distance_m.unwrap() - 3.0067).abs() < 1e-3);
    }

    #[test]
    fn a_cut_box_leaves_the_direction_to_the_centre() {
        let labels = from_boxes(&[listed(&[CUT])], DVec3::ZERO, &centres(DVec3::new(0.0, 2.0, 0.0)));
        assert!(labels[0].heading.rad().abs() < 1e-9);
        let without = from_boxes(&[listed(&[CUT])], DVec3::ZERO, &BTreeMap::new());
        assert!((without[0].heading.deg() - 90.0).abs() < 1e-9);
        assert_eq!(without[0].distance_m, None);
    }

    #[test]
    fn from_boxes_skips_objects_without_a_box() {
        assert_eq!(from_boxes(&[listed(&[])], DVec3::ZERO, &centres(DVec3::Y)), []);
    }
}
