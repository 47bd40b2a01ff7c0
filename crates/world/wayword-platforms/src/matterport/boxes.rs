//! Reads REVERIE's `BBox/SCAN_VIEWPOINT.json`: the objects near a viewpoint, with their boxes in the simulator's 36 views.
//!
//! Format (REVERIE, `tasks/REVERIE/data/BBox`): `{viewpoint: {objId: {name, visible_pos: [view 0..35], bbox2d: [[x, y,
//! w, h], ...]}}}`. View `i` looks along `(i mod 12) * 30` degrees with elevation `(i / 12 - 1) * 30` degrees; boxes
//! are in pixels of its 640x480 picture with a vertical field of view of 60 degrees.

use super::file_reading;
use serde_json::{Map, Value};
use std::{f64::consts::FRAC_PI_6, path::Path};
use wayword_core::{Heading, ObjectId, PlatformError, ViewpointId};
use wayword_world::object_names;

/// Number of the simulator's views at a viewpoint.
pub(crate) const SIMULATOR_VIEW_COUNT: usize = 36;
/// Width of the simulator's pictures, pixels.
pub(crate) const WIDTH_PX: f64 = 640.0;
/// Height of the simulator's pictures, pixels.
pub(crate) const HEIGHT_PX: f64 = 480.0;
/// Pixels per unit of the image plane: 240 / tan(30 degrees).
pub(crate) const FOCAL_PX: f64 = 415.692_193_816_530_5;

/// Most objects of a file; no real viewpoint has this many.
const MAX_OBJECTS: usize = 10_000;
/// Largest file, bytes; the largest real one has 40 kB.
const MAX_BYTES: u64 = 1 << 20;
/// The advice in errors about such a file.
const BOXES_HINT: &str = "extract the file again from REVERIE's BBox.zip";

/// An object that REVERIE lists at a viewpoint.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ListedObject {
    pub(crate) object: ObjectId,
    /// In plain words; `None` if the annotators' name has no plain words.
    pub(crate) name: Option<String>,
    /// Its boxes in the views that show it; empty if it is listed but hidden.
    pub(crate) boxes: Vec<SeenBox>,
}

/// An object's box in one of the 36 views.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SeenBox {
    /// Index of the view, less than [`SIMULATOR_VIEW_COUNT`].
    pub(crate) view: u8,
    /// x and y of the upper left corner, width and height, pixels.
    pub(crate) box_px: [f64; 4],
}

/// A direction from a viewpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ViewpointRay {
    pub(crate) heading: Heading,
    /// Up positive.
    pub(crate) elevation_rad: f64,
}

impl ListedObject {
    /// The most central of its boxes. Boxes that the edge of a picture cuts come last, because the centre of such a box
    /// is not the centre of the object.
    pub(crate) fn best_box(&self) -> Option<&SeenBox> {
        self.boxes.iter().min_by(|a, b| {
            (a.is_cut(), a.off_centre_px2())
                .partial_cmp(&(b.is_cut(), b.off_centre_px2()))
                .unwrap_or(std::cmp::Ordering::Equal)
        })
    }
}

impl SeenBox {
    fn centre_px(&self) -> (f64, f64) {
        let [x, y, width, height] = self.box_px;
        (x + width / 2.0, y + height / 2.0)
    }

    /// Squared distance of its centre from the centre of the picture, square pixels.
    fn off_centre_px2(&self) -> f64 {
        let (x, y) = self.centre_px();
        (x - WIDTH_PX / 2.0).powi(2) + (y - HEIGHT_PX / 2.0).powi(2)
    }

    /// Whether an edge of the picture cuts the box, so that a part of the object lies outside the picture.
    pub(crate) fn is_cut(&self) -> bool {
        let [x, y, width, height] = self.box_px;
        x <= 0.0 || y <= 0.0 || x + width >= WIDTH_PX || y + height >= HEIGHT_PX
    }

    /// The ray to the centre of the box.
    pub(crate) fn centre_ray(&self) -> Option<ViewpointRay> {
        let (x_px, y_px) = self.centre_px();
        ray_through(self.view, x_px, y_px)
    }
}

/// The ray through a pixel of a view; `None` straight up or down, because there is no heading.
pub(crate) fn ray_through(view: u8, x_px: f64, y_px: f64) -> Option<ViewpointRay> {
    let (right, up) = ((x_px - WIDTH_PX / 2.0) / FOCAL_PX, (HEIGHT_PX / 2.0 - y_px) / FOCAL_PX);
    let tilt = FRAC_PI_6 * (f64::from(view / 12) - 1.0);
    let (sin, cos) = (libm::sin(tilt), libm::cos(tilt));
    let (ahead, above) = (cos - up * sin, sin + up * cos);
    let flat = libm::hypot(right, ahead);
    if !(flat > 1e-9 && above.is_finite()) {
        return None;
    }
    let heading = Heading::new(FRAC_PI_6 * f64::from(view % 12) + libm::atan2(right, ahead)).ok()?;
    Some(ViewpointRay { heading, elevation_rad: libm::atan2(above, flat) })
}

/// Reads the objects that are listed at a viewpoint; `None` if there is no such file.
///
/// # Errors
/// If the file does not have this format; the message names the object and the field.
pub(crate) fn read_boxes(file: &Path, viewpoint: &ViewpointId) -> Result<Option<Vec<ListedObject>>, PlatformError> {
    let Some(bytes) = file_reading::json_if_there(file, MAX_BYTES, BOXES_HINT)? else {
        return Ok(None);
    };
    parse_boxes(&bytes, viewpoint).map(Some).map_err(|reason| file_reading::file_error(file, reason, BOXES_HINT))
}

fn parse_boxes(bytes: &[u8], viewpoint: &ViewpointId) -> Result<Vec<ListedObject>, String> {
    let all: Map<String, Value> =
        serde_json::from_slice(bytes).map_err(|error| format!("is not a JSON object of viewpoints: {error}"))?;
    let objects = all.get(viewpoint.as_str()).ok_or_else(|| format!("viewpoint {viewpoint} is missing"))?;
    let objects = objects.as_object().ok_or_else(|| format!("viewpoint {viewpoint} does not hold a JSON object"))?;
    if objects.len() > MAX_OBJECTS {
        return Err(format!("lists {} objects, expected at most {MAX_OBJECTS}", objects.len()));
    }
    objects
        .iter()
        .map(|(object, entry)| {
            parse_listed_object(object, entry).map_err(|reason| format!("object {object:.40}: {reason}"))
        })
        .collect()
}

fn parse_listed_object(object: &str, entry: &Value) -> Result<ListedObject, String> {
    let views = file_reading::list_field(entry, "visible_pos")?;
    let boxes = file_reading::list_field(entry, "bbox2d")?;
    if views.len() != boxes.len() || views.len() > SIMULATOR_VIEW_COUNT {
        let (views, boxes) = (views.len(), boxes.len());
        return Err(format!(
            "fields `visible_pos` and `bbox2d` have {views} and {boxes} entries, expected equal numbers up to {SIMULATOR_VIEW_COUNT}"
        ));
    }
    Ok(ListedObject {
        object: ObjectId::new(object).map_err(|error| error.to_string())?,
        name: object_names::plain_name(file_reading::text_field(entry, "name")?),
        boxes: views.iter().zip(boxes).map(|(view, found)| parse_seen_box(view, found)).collect::<Result<_, _>>()?,
    })
}

fn parse_seen_box(view: &Value, found: &Value) -> Result<SeenBox, String> {
    let view = view.as_u64().and_then(|view| u8::try_from(view).ok());
    let view = view.filter(|view| usize::from(*view) < SIMULATOR_VIEW_COUNT);
    let view = view.ok_or("field `visible_pos` has an entry that is not a view index (0..35)")?;
    let numbers = found.as_array().filter(|numbers| numbers.len() == 4);
    let numbers = numbers.ok_or("field `bbox2d` has an entry that is not a box of four numbers")?;
    let mut box_px = [0.0; 4];
    for (place, number) in box_px.iter_mut().zip(numbers) {
        *place = file_reading::read_coordinate(number, "bbox2d")?;
    }
    let [_, _, width, height] = box_px;
    if width < 0.0 || height < 0.0 {
        return Err("field `bbox2d` has a box of negative size".into());
    }
    Ok(SeenBox { view, box_px })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::json;

    fn viewpoint() -> ViewpointId {
        ViewpointId::new("v").unwrap()
    }

    fn parsed(entry: &Value) -> Result<Vec<ListedObject>, String> {
        parse_boxes(json!({ "v": { "7": entry } }).to_string().as_bytes(), &viewpoint())
    }

    #[test]
    fn the_middle_of_a_view_looks_along_it() {
        let ray = ray_through(15, 320.0, 240.0).unwrap();
        assert!((ray.heading.deg() - 90.0).abs() < 1e-9);
        assert!(ray.elevation_rad.abs() < 1e-12);
        let low = ray_through(0, 320.0, 240.0).unwrap();
        assert!((low.elevation_rad.to_degrees() + 30.0).abs() < 1e-9);
    }

    #[test]
    fn a_box_that_no_edge_cuts_is_preferred() {
        let entry = json!({"name": "lamp", "visible_pos": [14, 15], "bbox2d": [[200, 0, 240, 480], [10, 50, 40, 60]]});
        let read = parsed(&entry).unwrap();
        assert_eq!(read[0].best_box().unwrap().view, 15);
    }

    #[test]
    fn listed_but_hidden_objects_keep_their_name() {
        let read = parsed(&json!({"name": "bath#cabinet", "visible_pos": [], "bbox2d": []})).unwrap();
        assert_eq!((read[0].name.as_deref(), read[0].best_box()), (Some("bath cabinet"), None));
    }

    #[test]
    fn errors_name_the_object_and_the_field() {
        let bad_view = parsed(&json!({"name": "lamp", "visible_pos": [36], "bbox2d": [[0, 0, 1, 1]]})).unwrap_err();
        assert_eq!(bad_view, "object 7: field `visible_pos` has an entry that is not a view index (0..35)");
        let no_box = parsed(&json!({"name": "lamp", "visible_pos": [3], "bbox2d": []})).unwrap_err();
        assert!(no_box.contains("have 1 and 0 entries"));
        let negative = parsed(&json!({"name": "lamp", "visible_pos": [3], "bbox2d": [[0, 0, -1, 1]]})).unwrap_err();
        assert!(negative.contains("negative size"));
        assert_eq!(parse_boxes(b"{\"w\": {}}", &viewpoint()).unwrap_err(), "viewpoint v is missing");
    }

    proptest! {
        #[test]
        fn a_ray_falls_into_the_view_that_it_was_cast_from(view in 0u8..36, x in 0.0..640.0f64, y in 0.0..480.0f64) {
            let ray = ray_through(view, x, y).unwrap();
            // Project it back by the definition of the views.
            let axis = Heading::new(f64::from(view % 12) * FRAC_PI_6).unwrap();
            let tilt = (f64::from(view / 12) - 1.0) * FRAC_PI_6;
            let turn = axis.turn_to(ray.heading);
            let (right, ahead, above) =
                (turn.sin() * ray.elevation_rad.cos(), turn.cos() * ray.elevation_rad.cos(), ray.elevation_rad.sin());
            let depth = ahead * tilt.cos() + above * tilt.sin();
            let up = above * tilt.cos() - ahead * tilt.sin();
            prop_assert!(depth > 0.0);
            prop_assert!((320.0 + FOCAL_PX * right / depth - x).abs() < 1e-6);
            prop_assert!((240.0 - FOCAL_PX * up / depth - y).abs() < 1e-6);
        }

        #[test]
        fn each_box_belongs_to_one_of_the_four_views_of_a_panorama(
            view in 0u8..36, x in 0.0..600.0f64, y in 0.0..440.0f64, around in 0.0..std::f64::consts::TAU,
        ) {
            let ray = SeenBox { view, box_px: [x, y, 40.0, 40.0] }.centre_ray().unwrap();
            let around = Heading::new(around).unwrap();
            let holders = wayword_core::ViewGaze::around_heading(around).iter().filter(|gaze| gaze.holds_heading(ray.heading)).count();
            let on_seam = ((around.turn_to(ray.heading).abs() / std::f64::consts::FRAC_PI_2).fract() - 0.5).abs() < 1e-9;
            prop_assert!(holders == 1 || on_seam);
        }
    }
}
