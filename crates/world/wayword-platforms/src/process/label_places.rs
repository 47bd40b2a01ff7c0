//! Compares where a world program's labels say that objects are: by their positions or headings, by their boxes in the picture, and
//! in the views in other directions from the same place. A world that mirrors its pictures, or turns the other way, contradicts
//! itself there.

use std::collections::BTreeMap;
use wayword_core::{DVec3, Heading, ObjectId, ObjectLabel, SceneId, ViewGaze};

/// A box lies elsewhere if it is farther than this share of the picture's width from where the object should be. Its centre may be
/// hidden.
const MARGIN_SHARE: f64 = 0.1;
/// An object may be seen in part if its centre is at most this far outside the view, radians.
const NEAR_VIEW_RAD: f64 = 0.35;
/// A box touches an edge of the picture if it is at most this far from it, pixels.
const EDGE_PX: f64 = 2.0;
/// In two views from one place, an object has the same heading, up to this, radians.
const SAME_HEADING_RAD: f64 = 0.26;
/// Contradictions are an error if there are at least this many, and twice as many as labels that agree.
const MIN_CONTRADICTIONS: usize = 6;
/// Most objects that are remembered at a place.
const MAX_OBJECTS: usize = 5000;

/// What the labels of a world program said until now.
#[derive(Debug, Default)]
pub(crate) struct LabelPlaces {
    boxes: PlaceVotes,
    turns: PlaceVotes,
    /// The place of the last view, and the headings of the objects that were seen from there, each with the view's heading.
    here: Option<(SceneId, DVec3)>,
    headings: BTreeMap<ObjectId, (Heading, Heading)>,
}

/// The number of labels that agree with something else, and of those that do not.
#[derive(Debug, Default)]
struct PlaceVotes {
    agree: usize,
    /// They would agree if left and right were swapped.
    mirrored: usize,
    elsewhere: usize,
}

/// What a box says about its label.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum BoxVote {
    Agrees,
    Mirrored,
    Elsewhere,
    Unclear,
}

impl LabelPlaces {
    /// Takes in the labels of a view, also those of objects outside it.
    ///
    /// # Errors
    /// When labels contradict each other again and again; gives the reason.
    pub(crate) fn check_view(
        &mut self,
        scene: &SceneId,
        eye: DVec3,
        gaze: ViewGaze,
        width_px: u32,
        labels: &[ObjectLabel],
    ) -> Result<(), String> {
        for label in labels {
            let vote = label.box_px.map_or(BoxVote::Unclear, |box_px| box_vote(label.heading, box_px, gaze, width_px));
            match vote {
                BoxVote::Agrees => self.boxes.agree += 1,
                BoxVote::Mirrored => self.boxes.mirrored += 1,
                BoxVote::Elsewhere => self.boxes.elsewhere += 1,
                BoxVote::Unclear => {}
            }
        }
        self.compare_turns(scene, eye, gaze, labels);
        self.find_contradiction().map_or(Ok(()), Err)
    }

    /// Compares the headings of objects with those in other views from the same place.
    fn compare_turns(&mut self, scene: &SceneId, eye: DVec3, gaze: ViewGaze, labels: &[ObjectLabel]) {
        if self.here.as_ref().is_none_or(|(there, place)| there != scene || *place != eye) {
            self.here = Some((scene.clone(), eye));
            self.headings.clear();
        }
        for label in labels {
            let Some((seen, by)) = self.headings.get(&label.object) else {
                if self.headings.len() < MAX_OBJECTS {
                    self.headings.insert(label.object.clone(), (label.heading, gaze.heading));
                }
                continue;
            };
            if by.turn_to(gaze.heading).abs() > SAME_HEADING_RAD {
                let is_same = seen.turn_to(label.heading).abs() <= SAME_HEADING_RAD;
                *(if is_same { &mut self.turns.agree } else { &mut self.turns.elsewhere }) += 1;
            }
        }
    }

    /// The reason why the labels cannot be right, if there is one.
    fn find_contradiction(&self) -> Option<String> {
        if self.boxes.is_contradiction() {
            let PlaceVotes { agree, mirrored, elsewhere } = self.boxes;
            let how = if mirrored > elsewhere {
                "as if left and right were swapped: the pictures and boxes, or the positions, are mirrored"
            } else {
                "as if the view were in another direction: a heading is clockwise from +y, and not counter-clockwise or from +x"
            };
            return Some(format!(
                "`box_px` contradicts `position` or `heading_rad` in {} of {} labels, {how}",
                mirrored + elsewhere,
                agree + mirrored + elsewhere
            ));
        }
        self.turns.is_contradiction().then(|| {
            format!(
                "in {} of {} labels, an object that was seen from the same place in two views has another direction in each; turning \
                 right has to move things to the left of the picture, and `heading_rad` is that of the world, and not of the view",
                self.turns.elsewhere,
                self.turns.elsewhere + self.turns.agree
            )
        })
    }
}

impl PlaceVotes {
    fn is_contradiction(&self) -> bool {
        let wrong = self.mirrored + self.elsewhere;
        wrong >= MIN_CONTRADICTIONS && wrong > 2 * self.agree
    }
}

/// Compares a box with the direction of its object.
fn box_vote(heading: Heading, [x, _, box_width, _]: [f64; 4], gaze: ViewGaze, width_px: u32) -> BoxVote {
    let width = f64::from(width_px);
    let half_fov = gaze.horizontal_fov_rad / 2.0;
    let right = gaze.heading.turn_to(heading);
    if right.abs() > half_fov + NEAR_VIEW_RAD {
        let touches = if right > 0.0 { x + box_width >= width - EDGE_PX } else { x <= EDGE_PX };
        return if touches { BoxVote::Unclear } else { BoxVote::Elsewhere };
    }
    let half_width = width / 2.0;
    let off_px = half_width * libm::tan(right.clamp(-1.5, 1.5)) / libm::tan(half_fov);
    let expected = (half_width + off_px).clamp(0.0, width);
    // How far a column of the picture is from the box.
    let distance = |column: f64| (x - column).max(column - (x + box_width)).max(0.0);
    let (direct, swapped) = (distance(expected), distance(width - expected));
    let margin = MARGIN_SHARE * width;
    if direct + margin < swapped {
        BoxVote::Agrees
    } else if swapped + margin < direct {
        BoxVote::Mirrored
    } else if direct.min(swapped) > 1.5 * margin {
        BoxVote::Elsewhere
    } else {
        BoxVote::Unclear
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    const WIDTH_PX: u32 = 640;

    /// Objects all around a place, by their headings.
    fn headings() -> Vec<f64> {
        (0..12).map(|at| f64::from(at) * TAU / 12.0 + 0.1).collect()
    }

    /// Looks in eight directions. `seen` gives the heading of a label for the true one and that of the view, and where its box is in
    /// the picture that the world drew: its tangent to the right of the middle, if it is in it.
    fn turn(seen: impl Fn(f64, f64) -> (f64, Option<f64>)) -> Result<(), String> {
        let mut places = LabelPlaces::default();
        let scene = SceneId::new("s").unwrap();
        for at in 0..8 {
            let view = f64::from(at) * TAU / 8.0;
            let gaze = ViewGaze::quarter_view(Heading::new(view).unwrap());
            let label = |(number, heading): (usize, &f64)| {
                let (heading, tangent) = seen(*heading, view);
                let middle_px = 320.0 * (1.0 + tangent?);
                let edges = [(middle_px - 20.0).clamp(0.0, 640.0), (middle_px + 20.0).clamp(0.0, 640.0)];
                Some(ObjectLabel {
                    object: ObjectId::new(number.to_string()).unwrap(),
                    name: "lamp".to_owned(),
                    heading: Heading::new(heading).unwrap(),
                    elevation_rad: 0.0,
                    box_px: Some([edges[0], 200.0, edges[1] - edges[0], 40.0]),
                    distance_m: None,
                    position: None,
                    colour: None,
                    room: None,
                })
            };
            let labels: Vec<ObjectLabel> = headings().iter().enumerate().filter_map(label).collect();
            places.check_view(&scene, DVec3::ZERO, gaze, WIDTH_PX, &labels)?;
        }
        Ok(())
    }

    /// The tangent at which a heading lies in a view; `None` if it is not within 45 degrees.
    fn tangent(heading: f64, view: f64) -> Option<f64> {
        let right = (heading - view + PI).rem_euclid(TAU) - PI;
        (right.abs() < FRAC_PI_2 / 2.0).then(|| right.tan())
    }

    #[test]
    fn a_world_that_agrees_with_itself_is_taken() {
        assert_eq!(turn(|heading, view| (heading, tangent(heading, view))), Ok(()));
        // Half of each object is hidden.
        assert_eq!(turn(|heading, view| (heading, tangent(heading, view).map(|at| at + 0.08))), Ok(()));
        // It sends all objects, with boxes at the edge for those outside.
        let clamped = |heading: f64, view: f64| {
            let right = (heading - view + PI).rem_euclid(TAU) - PI;
            (heading, Some(right.clamp(-0.78, 0.78).tan()))
        };
        assert_eq!(turn(clamped), Ok(()));
    }

    #[test]
    fn mirrored_boxes_and_wrong_turns_are_found() {
        let error = turn(|heading, view| (heading, tangent(heading, view).map(|right| -right))).unwrap_err();
        assert!(error.contains("left and right were swapped"), "{error}");
        // The world turns counter-clockwise: what it draws is at the other side of north.
        let error = turn(|heading, view| (heading, tangent(heading, -view))).unwrap_err();
        assert!(error.contains("counter-clockwise"), "{error}");
        // It counts from east.
        assert!(turn(|heading, view| (heading, tangent(heading, view + FRAC_PI_2))).is_err());
        // It takes directions from a mirrored picture: boxes agree, but things turn with the view.
        let error = turn(|heading, view| {
            let right = tangent(heading, view).map(|right| -right);
            ((view + right.unwrap_or(0.0).atan()).rem_euclid(TAU), right)
        });
        assert!(error.unwrap_err().contains("another direction in each"));
        // It sends headings relative to the view.
        let relative = |heading: f64, view: f64| ((heading - view).rem_euclid(TAU), tangent(heading, view));
        assert!(turn(relative).is_err());
    }
}
