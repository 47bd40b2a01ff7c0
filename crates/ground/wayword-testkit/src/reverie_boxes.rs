//! The box files of REVERIE (`BBox/SCAN_VIEWPOINT.json`): the objects near each viewpoint, projected into the 36 views of the
//! Matterport3D simulator (12 headings at three elevations).

use crate::test_house::{self, TestHouseObject, VIEWPOINTS, viewpoint_id};
use glam::DVec3;
use serde_json::{Map, Value, json};
use std::f64::consts::FRAC_PI_6;

/// Objects within this distance of the camera are listed, metres. Those in another room are listed without boxes.
const REACH_M: f64 = 2.2;
/// Size of a view of the simulator, pixels.
const WIDTH_PX: f64 = 640.0;
const HEIGHT_PX: f64 = 480.0;
/// Smallest side of a box, pixels. Smaller boxes are not annotated.
const MIN_SIDE_PX: f64 = 4.0;

/// The contents of `SCAN_VIEWPOINT.json` for the viewpoint with this index.
pub(crate) fn box_file(index: usize) -> Value {
    let viewpoint = &VIEWPOINTS[index];
    let eye = test_house::camera_position(viewpoint);
    let mut listed = Map::new();
    for (id, object) in test_house::OBJECTS.iter().enumerate() {
        if eye.distance(test_house::object_centre(object)) <= REACH_M {
            let view_boxes = if object.room == viewpoint.room { boxes_by_view(eye, object) } else { Vec::new() };
            let (views, boxes): (Vec<usize>, Vec<[i64; 4]>) = view_boxes.into_iter().unzip();
            listed.insert(id.to_string(), json!({ "name": object.name, "visible_pos": views, "bbox2d": boxes }));
        }
    }
    json!({ viewpoint_id(index): listed })
}

/// The views in which an object is visible, with its box in each.
fn boxes_by_view(eye: DVec3, object: &TestHouseObject) -> Vec<(usize, [i64; 4])> {
    (0..36).filter_map(|view| Some((view, project_box(view, eye, object)?))).collect()
}

/// The object's box in a view (left, top, width, height; pixels), cut at the picture's edges; `None` where it is not in the view.
fn project_box(view: usize, eye: DVec3, object: &TestHouseObject) -> Option<[i64; 4]> {
    let heading = FRAC_PI_6 * (view % 12) as f64;
    let elevation = FRAC_PI_6 * ((view / 12) as f64 - 1.0);
    let forward = DVec3::new(
        libm::sin(heading) * libm::cos(elevation),
        libm::cos(heading) * libm::cos(elevation),
        libm::sin(elevation),
    );
    let right = DVec3::new(libm::cos(heading), -libm::sin(heading), 0.0);
    let up = right.cross(forward);
    // The view is 60 degrees high.
    let focal_px = HEIGHT_PX / 2.0 / libm::tan(FRAC_PI_6);
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for corner in 0..8 {
        let side = |bit: usize| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
        let to_corner = test_house::object_centre(object)
            + DVec3::from_array(object.half_m) * DVec3::new(side(0), side(1), side(2))
            - eye;
        let depth = to_corner.dot(forward);
        // Corners behind the camera, or nearly so, cannot be projected.
        if depth < 0.1 {
            return None;
        }
        let pixel = [
            WIDTH_PX / 2.0 + focal_px * to_corner.dot(right) / depth,
            HEIGHT_PX / 2.0 - focal_px * to_corner.dot(up) / depth,
        ];
        for axis in 0..2 {
            low[axis] = low[axis].min(pixel[axis]);
            high[axis] = high[axis].max(pixel[axis]);
        }
    }
    let (x, y) = (low[0].max(0.0), low[1].max(0.0));
    let (width, height) = (high[0].min(WIDTH_PX) - x, high[1].min(HEIGHT_PX) - y);
    let large_enough = width >= MIN_SIDE_PX && height >= MIN_SIDE_PX;
    large_enough.then_some([x as i64, y as i64, width as i64, height as i64])
}
