//! The observation of one frame: the captions of its views, and a summary of them.

use crate::{Caption, Heading, ObjectSighting, Side, ViewGaze};
use serde::{Deserialize, Serialize};

/// A view in one direction from a frame, with its caption.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaptionedView {
    /// The direction and width of the view.
    pub gaze: ViewGaze,
    /// Its caption.
    pub caption: Caption,
}

/// All captions of one frame.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FrameObservation {
    /// One view where only the central one was captioned, four where the panorama was.
    pub looks: Vec<CaptionedView>,
    /// The frame in words: the caption of the only look, or the four condensed to under 20 words.
    pub summary: String,
    /// The summariser, where the run's own failed and another one condensed them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by: Option<String>,
}

impl CaptionedView {
    /// The side of an agent that looks along `heading` on which an object of this view lies; `None` where the caption
    /// gives no place.
    #[must_use]
    pub fn side_of(&self, sighting: &ObjectSighting, heading: Heading) -> Option<Side> {
        let place = sighting.place?;
        let off_rad = heading.turn_to(self.gaze.heading);
        // The view looks ahead (within 0.1 rad). A thing in its left third is called left, although it is less than 45
        // degrees off.
        if off_rad.abs() < 0.1 {
            return Some(place.to_side());
        }
        let within_rad =
            sighting.spot.map_or_else(|| place.turn_rad(self.gaze.horizontal_fov_rad), |spot| spot.off_rad);
        Some(heading.side_of(self.gaze.heading.turned_by(within_rad)))
    }
}
