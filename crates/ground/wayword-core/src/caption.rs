//! Captions: a view in words, the sightings behind them with their sources, and the dialogue that led to them.
//!
//! The witness is the model, the labels or the detector that answered the questions about a view.

use crate::{DetectedBox, ModelError, ReplySchema, Side, View};
use serde::{Deserialize, Serialize};

/// A view in words, with the evidence behind them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Caption {
    /// One or two sentences. They name no object that the witness denied.
    pub text: String,
    /// The room, where one was named.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub room: Option<String>,
    /// The rooms that the view may show, where the witness was not sure of one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub perhaps_rooms: Vec<String>,
    /// Objects that a witness saw, denied or was not sure of.
    pub sightings: Vec<ObjectSighting>,
    /// The ways out of the room that were named.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ways: Vec<WayOut>,
    /// The whole dialogue.
    pub transcript: Vec<DialogueExchange>,
    /// The writer of the text, where it is not the run's summariser: that failed, or the dialogue had no usable
    /// answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by: Option<String>,
    /// Whether it was made from a structured answer: a list of what the view shows, and how sure the witness was of
    /// each.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_structured: bool,
    /// The outcome of asking for answers in a form ([`AnswerForm`]), where an answer did not have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form: Option<FormOutcome>,
}

/// The outcome of asking for an [`AnswerForm`], where the first answer did not have it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FormOutcome {
    /// The second answer had it.
    Mended,
    /// No answer had it: the last one was read as words.
    Broken,
}

/// A way out of the room that a view shows.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct WayOut {
    /// The name: "doorway", "stairs".
    pub name: String,
    /// Where in the view the witness placed it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<ViewThird>,
    /// The room that is seen through it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub leads_to: Option<String>,
}

/// One object, and what a witness answered about it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ObjectSighting {
    /// Its name as the witness gave it.
    pub name: String,
    /// Seen, denied or unsure.
    pub witness: WitnessAnswer,
    /// Where in the view the witness placed it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<ViewThird>,
    /// Its colour, as the witness named it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colour: Option<String>,
    /// Further colours that the witness named.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub more_colours: Vec<String>,
    /// Its material, as the witness named it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Its pattern, or what it shows, as the witness put it: "checkered", "of a ship".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detail: Option<String>,
    /// Whether the witness called it far away, or it was measured to be.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_far: bool,
    /// Whether the witness thought that it catches the eye of a person who walks there.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stands_out: bool,
    /// Whether the witness saw several.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub several: bool,
    /// Where a detector found it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spot: Option<DetectionSpot>,
    /// The witness (`labels`, `provider/model`).
    pub by: String,
}

/// Where in a view a detector found an object.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DetectionSpot {
    /// Its box in the view's picture, and how sure the detector was.
    pub found: DetectedBox,
    /// The direction of the box's middle from that of the view, radians, positive right.
    pub off_rad: f64,
    /// Horizontal distance from the eye to the object, metres, where the platform knows the depth of the picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distance_m: Option<f64>,
}

impl DetectionSpot {
    /// A detection in a picture that is `width_px` wide and shows `horizontal_fov_rad`, as a pinhole camera does. Its
    /// distance is not known.
    #[must_use]
    pub fn new(found: DetectedBox, width_px: u32, horizontal_fov_rad: f64) -> Self {
        let half_px = f64::from(width_px) / 2.0;
        let [left, _, right, _] = found.box_px.map(f64::from);
        // From the picture's middle, in half widths: -1 is its left edge, 1 its right edge.
        let off_middle = ((left + right) / 2.0 - half_px) / half_px.max(0.5);
        Self { found, off_rad: libm::atan(off_middle * libm::tan(horizontal_fov_rad / 2.0)), distance_m: None }
    }
}

impl ObjectSighting {
    /// A sighting with a name, an answer and its witness, and no further details.
    #[must_use]
    pub fn new(name: impl Into<String>, witness: WitnessAnswer, by: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            witness,
            place: None,
            colour: None,
            more_colours: Vec::new(),
            material: None,
            detail: None,
            is_far: false,
            stands_out: false,
            several: false,
            spot: None,
            by: by.into(),
        }
    }
}

/// A witness's answer about an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WitnessAnswer {
    /// It is there.
    Seen,
    /// It is not there.
    Denied,
    /// The witness does not know.
    Unsure,
}

/// A third of a view.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ViewThird {
    /// The left third.
    Left,
    /// The middle.
    Middle,
    /// The right third.
    Right,
}

impl ViewThird {
    /// The side of a robot that looks along the view; the middle is ahead.
    #[must_use]
    pub fn to_side(self) -> Side {
        match self {
            Self::Left => Side::Left,
            Self::Middle => Side::Ahead,
            Self::Right => Side::Right,
        }
    }

    /// The direction of its middle from that of a view of this width, radians, positive right.
    #[must_use]
    pub fn turn_rad(self, horizontal_fov_rad: f64) -> f64 {
        match self {
            Self::Left => -horizontal_fov_rad / 3.0,
            Self::Middle => 0.0,
            Self::Right => horizontal_fov_rad / 3.0,
        }
    }

    /// The third of a view of this width in which a direction lies. The direction is `off_rad` from the view's own,
    /// positive right.
    #[must_use]
    pub fn from_offset(off_rad: f64, horizontal_fov_rad: f64) -> Self {
        let sixth = horizontal_fov_rad / 6.0;
        if off_rad < -sixth {
            Self::Left
        } else if off_rad > sixth {
            Self::Right
        } else {
            Self::Middle
        }
    }
}

/// A question and its answer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DialogueExchange {
    /// The question.
    pub question: String,
    /// The answer; empty where no answer could be used.
    pub answer: String,
    /// Why the question was asked again in other words, where it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trouble: Option<AnswerTrouble>,
}

impl DialogueExchange {
    /// A question that was answered at once.
    #[must_use]
    pub fn new(question: impl Into<String>, answer: impl Into<String>) -> Self {
        Self { question: question.into(), answer: answer.into(), trouble: None }
    }
}

/// Why an answer cannot be used (the first four are known of BLIP-2: ChatCaptioner #4 and #7).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AnswerTrouble {
    /// There is no answer.
    Empty,
    /// It repeats the question.
    Echo,
    /// It repeats the same words over and over.
    Loop,
    /// It is the answer to another question, word for word.
    Repeat,
    /// It does not have the form that was asked for.
    Form,
    /// It is no answer but a refusal.
    Refusal,
}

/// A question about a view, with the dialogue so far.
#[derive(Debug, Clone, Copy)]
pub struct ViewQuestion<'a> {
    /// The view that the question is about.
    pub view: &'a View,
    /// The question.
    pub question: &'a str,
    /// The dialogue so far.
    pub history: &'a [DialogueExchange],
    /// The form that the answer should have.
    pub answer: AnswerForm,
}

/// Which form an answer should have.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum AnswerForm {
    /// A sentence or two.
    #[default]
    Words,
    /// JSON of this form, whatever else surrounds it.
    Json(ReplySchema),
}

/// The words of an answer.
pub type AnswerText = String;

/// The role `see`: answers questions about views.
///
/// Blocking, object-safe and batching; threads belong to the caller.
pub trait ViewAnswerer: Send + Sync {
    /// `provider/model`, or `labels`.
    fn name(&self) -> &str;

    /// One result per question, in their order. One that fails does not fail the others.
    fn answer_questions(&self, asks: &[ViewQuestion<'_>]) -> Vec<Result<AnswerText, ModelError>>;
}
