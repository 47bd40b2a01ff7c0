//! A scripted eye that guesses on which side a thing lies.

use super::draws::EyeDraws;
use wayword_core::{DVec3, Frame, Heading, ObjectLabel, PlatformError, View, ViewGaze};

/// Gazes that differ by less than this are equal, radians.
const SAME_RAD: f64 = 1e-9;

/// Returns the labels that the eye reports for a view. For each thing, a random draw decides whether the eye reports it left or right of
/// the frame's heading. A thing that gets the wrong side is reported where it would be if the world were mirrored at that heading. So it
/// may leave this view, and things of the mirrored view, which `look` gives, may enter it.
pub(super) fn guess_sides(
    draws: &EyeDraws<'_>,
    from: &Frame,
    gaze: ViewGaze,
    known: &View,
    look: impl Fn(ViewGaze) -> Result<View, PlatformError>,
) -> Result<Vec<ObjectLabel>, PlatformError> {
    let axis = MirrorPlane { eye: known.pose.position, heading: from.pose.heading };
    let other_gaze = ViewGaze { heading: axis.mirrored_heading(gaze.heading), ..gaze };
    let is_same = gaze.heading.turn_to(other_gaze.heading).abs() < SAME_RAD;
    let other = if is_same { known.clone() } else { look(other_gaze)? };
    let width_px = other.image.as_ref().map(|image| f64::from(image.width_px()));
    let right_by_draw = |label: &ObjectLabel| draws.draw_for_label("side", label) < 0.5;
    let kept = listed_labels(known).filter(|label| axis.is_right(label.heading) == right_by_draw(label)).cloned();
    // A thing of the mirrored view appears in this one if its drawn side is wrong.
    let moved = listed_labels(&other).filter(|label| axis.is_right(label.heading) != right_by_draw(label));
    Ok(kept.chain(moved.map(|label| axis.mirrored_label(label, width_px))).collect())
}

/// The labels of a view; none without ground truth.
fn listed_labels(view: &View) -> impl Iterator<Item = &ObjectLabel> {
    view.ground_truth().into_iter().flat_map(|truth| &truth.labels)
}

/// The vertical plane through an eye along a heading.
struct MirrorPlane {
    eye: DVec3,
    heading: Heading,
}

impl MirrorPlane {
    /// The mirror image of a heading.
    fn mirrored_heading(&self, heading: Heading) -> Heading {
        self.heading.turned_by(-self.heading.turn_to(heading))
    }

    /// Whether a heading points to the right of the plane.
    fn is_right(&self, heading: Heading) -> bool {
        self.heading.turn_to(heading) > 0.0
    }

    /// Mirrors a label at the plane. `width_px` is the width of the view, in which its box is mirrored too.
    fn mirrored_label(&self, label: &ObjectLabel, width_px: Option<f64>) -> ObjectLabel {
        let heading = self.mirrored_heading(label.heading);
        let moved = |position: DVec3| {
            let flat_m = (position - self.eye).truncate().length();
            let mirrored = self.eye + heading.unit_vector() * flat_m;
            mirrored.with_z(position.z)
        };
        let box_px = label.box_px.zip(width_px).map(|([x, y, width, height], all)| [all - x - width, y, width, height]);
        ObjectLabel { heading, position: label.position.map(moved), box_px, ..label.clone() }
    }
}
