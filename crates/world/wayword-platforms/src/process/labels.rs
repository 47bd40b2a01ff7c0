//! Converts the objects that a child reports in a view into labels, and checks every number of them.

use super::{picture::SentPicture, protocol};
use serde::Deserialize;
use std::collections::BTreeMap;
use wayword_core::{DVec3, Heading, ObjectId, ObjectLabel, ViewGaze};

/// Most objects in one answer.
const MAX_LABELS: usize = 5000;
/// Largest absolute value of a coordinate or a distance, metres.
pub(crate) const MAX_COORDINATE_M: f64 = 1e6;
/// Two positions of one object in a view are the same centre if they are at most this far apart, metres.
const SAME_CENTRE_M: f64 = 0.1;
/// Largest absolute value of a heading, radians: 2^53. Beyond it, two numbers in a row are 2 radians apart or more.
const MAX_HEADING_RAD: f64 = 9_007_199_254_740_992.0;
/// Largest storey.
const MAX_LEVEL: u32 = 1000;
/// How far a box may reach out of its picture because of rounding, pixels.
const BOX_SLACK_PX: f64 = 1.0;

/// The answer to `observe`.
#[derive(Debug, Deserialize)]
pub(crate) struct ObserveAnswer {
    #[serde(default)]
    pub(crate) image: Option<SentPicture>,
    #[serde(default)]
    pub(crate) labels: Option<Vec<ObservedObject>>,
    #[serde(default)]
    pub(crate) room: Option<String>,
}

/// A visible object.
#[derive(Debug, Deserialize)]
pub(crate) struct ObservedObject {
    object: ObjectId,
    name: String,
    /// Its centre, metres. If there is none, `heading_rad` gives its direction.
    #[serde(default)]
    position: Option<[f64; 3]>,
    #[serde(default)]
    heading_rad: Option<f64>,
    #[serde(default)]
    elevation_rad: Option<f64>,
    #[serde(default)]
    distance_m: Option<f64>,
    #[serde(default)]
    box_px: Option<[f64; 4]>,
    #[serde(default)]
    colour: Option<String>,
}

/// The labels of a view, also of objects that have their centre outside its width.
pub(crate) fn labels_of_answer(
    seen: Vec<ObservedObject>,
    eye: DVec3,
    gaze: ViewGaze,
    size_px: (u32, u32),
) -> Result<Vec<ObjectLabel>, String> {
    if seen.len() > MAX_LABELS {
        return Err(format!("{} labels, expected at most {MAX_LABELS}", seen.len()));
    }
    let labels: Vec<ObjectLabel> =
        seen.into_iter().map(|seen| seen.into_label(eye, gaze, size_px)).collect::<Result<_, _>>()?;
    refuse_two_in_one(&labels)?;
    Ok(labels)
}

/// Refuses labels that give one object two names or two centres.
fn refuse_two_in_one(labels: &[ObjectLabel]) -> Result<(), String> {
    let mut first: BTreeMap<&ObjectId, &ObjectLabel> = BTreeMap::new();
    for label in labels {
        let other = *first.entry(&label.object).or_insert(label);
        let object = label.object.as_str();
        if other.name != label.name {
            return Err(format!(
                "object {object:?} has two `name`s in one view, {:?} and {:?}",
                other.name, label.name
            ));
        }
        let apart_m = other.position.zip(label.position).map(|(one, two)| one.distance(two));
        if apart_m.is_some_and(|apart_m| apart_m > SAME_CENTRE_M) {
            return Err(format!(
                "object {object:?} has two `position`s in one view; give each object an id of its own"
            ));
        }
    }
    Ok(())
}

/// The labels of objects that have their centre within the width of a view.
pub(crate) fn labels_in_view(mut labels: Vec<ObjectLabel>, gaze: ViewGaze) -> Vec<ObjectLabel> {
    labels.retain(|label| gaze.holds_heading(label.heading));
    labels
}

/// A position, if its coordinates are finite and at most [`MAX_COORDINATE_M`].
pub(crate) fn plausible_position(position: [f64; 3]) -> Result<DVec3, String> {
    let place = DVec3::from_array(position);
    let near = place.is_finite() && place.abs().max_element() <= MAX_COORDINATE_M;
    near.then_some(place).ok_or_else(|| format!("{position:?} is not a plausible position"))
}

/// A heading, if it is finite and at most [`MAX_HEADING_RAD`].
pub(crate) fn plausible_heading(heading_rad: f64) -> Result<Heading, String> {
    let heading_rad = bounded_number("heading_rad", heading_rad, MAX_HEADING_RAD)?;
    Heading::new(heading_rad).map_err(|error| format!("`heading_rad`: {error}"))
}

/// A storey, if one is given: from 1, the lowest, to [`MAX_LEVEL`].
pub(crate) fn plausible_level(level: Option<u32>) -> Result<Option<u32>, String> {
    match level {
        Some(level) if !(1..=MAX_LEVEL).contains(&level) => {
            Err(format!("`level` is {level}, expected 1 (the lowest storey) to {MAX_LEVEL}"))
        }
        level => Ok(level),
    }
}

impl ObservedObject {
    fn into_label(self, eye: DVec3, gaze: ViewGaze, size_px: (u32, u32)) -> Result<ObjectLabel, String> {
        let object = self.object.to_string();
        self.convert_label(eye, gaze, size_px).map_err(|reason| format!("label of object {object:?}: {reason}"))
    }

    /// Checks every number of the object and makes a label of it; the error does not name the object yet.
    fn convert_label(self, eye: DVec3, gaze: ViewGaze, size_px: (u32, u32)) -> Result<ObjectLabel, String> {
        let position = self.position.map(plausible_position).transpose()?;
        let (heading, elevation_rad) = match (position, self.heading_rad) {
            // An object straight above the eye has no heading, so any will do.
            (Some(centre), _) => (Heading::towards(eye, centre).unwrap_or(gaze.heading), elevation_rad(eye, centre)),
            (None, Some(heading)) => (
                plausible_heading(heading)?,
                bounded_number("elevation_rad", self.elevation_rad.unwrap_or(0.0), std::f64::consts::FRAC_PI_2)?,
            ),
            (None, None) => return Err("has neither `position` nor `heading_rad`".into()),
        };
        let reported_m = self.distance_m.map(|far| bounded_number("distance_m", far, MAX_COORDINATE_M)).transpose()?;
        if reported_m.is_some_and(|far| far < 0.0) {
            return Err("`distance_m` is negative".into());
        }
        Ok(ObjectLabel {
            object: self.object,
            name: protocol::checked_name("`name`", &self.name)?,
            heading,
            elevation_rad,
            box_px: self.box_px.map(|corners| box_px(corners, size_px)).transpose()?,
            distance_m: reported_m.or_else(|| position.map(|centre| eye.distance(centre))),
            position,
            colour: self.colour.map(|colour| protocol::checked_name("`colour`", &colour)).transpose()?,
            room: None,
        })
    }
}

/// The elevation of a point as seen from an eye, radians.
fn elevation_rad(eye: DVec3, centre: DVec3) -> f64 {
    let (across, up) = ((centre - eye).truncate().length(), centre.z - eye.z);
    libm::atan2(up, across)
}

/// A number that is finite and at most `max` in size; the error names the field.
fn bounded_number(field: &str, number: f64, max: f64) -> Result<f64, String> {
    let fits = number.is_finite() && number.abs() <= max;
    fits.then_some(number).ok_or_else(|| format!("`{field}` is {number:?}, which is more than {max} in size"))
}

/// A box, cut to its picture; an error if it does not lie within the picture.
fn box_px([x, y, width, height]: [f64; 4], (width_px, height_px): (u32, u32)) -> Result<[f64; 4], String> {
    let cut = |from: f64, long: f64, side_px: u32| {
        let side = f64::from(side_px);
        let fits = from >= -BOX_SLACK_PX && long >= 0.0 && from + long <= side + BOX_SLACK_PX;
        let (start, end) = (from.clamp(0.0, side), (from + long).clamp(0.0, side));
        fits.then_some((start, end - start))
    };
    match (cut(x, width, width_px), cut(y, height, height_px)) {
        (Some((x, width)), Some((y, height))) => Ok([x, y, width, height]),
        _ => {
            Err(format!("`box_px` [{x}, {y}, {width}, {height}] does not lie in a picture of {width_px} x {height_px}"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::{Value, json};

    const SIZE_PX: (u32, u32) = (640, 480);

    fn labels(seen: Value) -> Result<Vec<ObjectLabel>, String> {
        let seen: Vec<ObservedObject> = serde_json::from_value(seen).map_err(|error| error.to_string())?;
        let gaze = ViewGaze::quarter_view(Heading::NORTH);
        Ok(labels_in_view(labels_of_answer(seen, DVec3::new(1.0, 2.0, 1.5), gaze, SIZE_PX)?, gaze))
    }

    #[test]
    fn a_position_gives_direction_and_distance() {
        let found =
            labels(json!([{"object": "7", "name": "lamp", "position": [2.0, 5.0, 1.5], "colour": "red"}])).unwrap();
        assert!((found[0].heading.rad() - libm::atan2(1.0, 3.0)).abs() < 1e-12);
        assert_eq!(found[0].elevation_rad, 0.0);
        assert!((found[0].distance_m.unwrap() - 10.0f64.sqrt()).abs() < 1e-12);
        let above = labels(json!([{"object": "7", "name": "lamp", "position": [1.0, 2.0, 2.5]}])).unwrap();
        assert!((above[0].elevation_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }

    #[test]
    fn labels_in_view_leaves_out_objects_outside_the_gaze() {
        let behind = json!([{"object": "1", "name": "door", "position": [1.0, -3.0, 1.0]}, {"object": "2", "name": "rug", "heading_rad": -0.5}]);
        let found = labels(behind).unwrap();
        assert_eq!(found.iter().map(|label| label.name.as_str()).collect::<Vec<_>>(), ["rug"]);
    }

    #[test]
    fn labels_in_view_names_the_object_of_an_impossible_label() {
        for (bad, says) in [
            (json!({"object": "7", "name": "lamp"}), "position"),
            (json!({"object": "7", "name": "a\nb", "heading_rad": 0}), "name"),
            (json!({"object": "a/b", "name": "lamp", "heading_rad": 0}), "separators"),
            (json!({"object": "7", "name": "lamp", "position": [0.0, 1e9, 0.0]}), "not a plausible position"),
            (json!({"object": "7", "name": "lamp", "heading_rad": 0, "distance_m": -1}), "negative"),
            (json!({"object": "7", "name": "lamp", "heading_rad": 0, "box_px": [600, 0, 100, 10]}), "640 x 480"),
            (json!({"object": "7", "name": "lamp", "heading_rad": 0, "elevation_rad": 3}), "elevation_rad"),
            (json!({"object": "7", "name": "lamp", "heading_rad": 1e308}), "`heading_rad` is 1e308"),
            (json!({"object": "7", "name": "lamp", "heading_rad": -1e17}), "`heading_rad` is -1e17"),
        ] {
            let error = labels(json!([bad])).unwrap_err();
            assert!(error.contains(says), "{bad}: {error}");
        }
    }

    #[test]
    fn one_object_has_one_name_and_one_centre_in_a_view() {
        let lamp = |name: &str, x: f64| json!({"object": "7", "name": name, "position": [x, 5.0, 1.5]});
        for (second, says) in [(lamp("chair", 1.0), "\"lamp\" and \"chair\""), (lamp("lamp", 2.0), "two `position`s")] {
            let error = labels(json!([lamp("lamp", 1.0), second])).unwrap_err();
            assert!(error.contains("object \"7\"") && error.contains(says), "{error}");
        }
        // A thing of which two parts are seen.
        assert_eq!(labels(json!([lamp("lamp", 1.0), lamp("lamp", 1.01)])).unwrap().len(), 2);
        assert!(plausible_heading(7.0 * std::f64::consts::TAU).is_ok());
    }

    #[test]
    fn a_level_is_a_storey_from_1() {
        assert_eq!((plausible_level(None), plausible_level(Some(1))), (Ok(None), Ok(Some(1))));
        for level in [0, 99_999] {
            assert!(plausible_level(Some(level)).unwrap_err().starts_with(&format!("`level` is {level}, ")));
        }
    }

    proptest! {
        #[test]
        fn labels_in_view_accepts_only_labels_within_the_view(
            position in prop::array::uniform3(-20.0..20.0f64), corners in prop::array::uniform4(-50.0..700.0f64),
        ) {
            let seen = json!([{"object": "7", "name": "lamp", "position": position, "box_px": corners}]);
            for label in labels(seen).into_iter().flatten() {
                prop_assert!(ViewGaze::quarter_view(Heading::NORTH).holds_heading(label.heading));
                let [x, y, width, height] = label.box_px.unwrap();
                prop_assert!(x >= 0.0 && y >= 0.0 && width >= 0.0 && height >= 0.0);
                prop_assert!(x + width <= 640.0 + 1e-9 && y + height <= 480.0 + 1e-9);
            }
        }
    }
}
