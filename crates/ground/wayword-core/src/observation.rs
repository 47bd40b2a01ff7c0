//! Captions of the views from one frame.

use crate::{Caption, Gaze, Heading, Side, Sighting};
use serde::{Deserialize, Serialize};

/// A captioned view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Look {
    /// The direction and width of the view.
    pub gaze: Gaze,
    /// Its caption.
    pub caption: Caption,
}

/// What was seen from one frame.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Observation {
    /// One look where the central view was captioned, four where the panorama was.
    pub looks: Vec<Look>,
    /// The frame in words: the caption of the only look, or the four condensed to under 20 words.
    pub summary: String,
    /// Who condensed them, where the run's summariser failed and another did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by: Option<String>,
}

impl Look {
    /// On which side of an agent that looks along `heading` an object of this view is said to be; `None` where the
    /// caption gives no place.
    #[must_use]
    pub fn side_of(&self, sighting: &Sighting, heading: Heading) -> Option<Side> {
        let place = sighting.place?;
        let off_rad = heading.turn_to(self.gaze.heading);
        if off_rad.abs() < 0.1 {
            return Some(place.side());
        }
        let within_rad =
            sighting.spot.map_or_else(|| place.turn_rad(self.gaze.horizontal_fov_rad), |spot| spot.off_rad);
        Some(heading.side_of(self.gaze.heading.turned(within_rad)))
    }
}
