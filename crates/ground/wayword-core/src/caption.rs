//! What is said about a view, and who vouches for it.

use crate::{Found, ModelError, Schema, Side, View};
use serde::{Deserialize, Serialize};

/// A view in words, with the evidence behind them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Caption {
    /// One or two sentences. They name no object that was denied.
    pub text: String,
    /// The room, where one was named.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub room: Option<String>,
    /// The rooms that it may be, where the witness was not sure of one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub perhaps_rooms: Vec<String>,
    /// What was said to be there, not to be there, or not known.
    pub sightings: Vec<Sighting>,
    /// The ways out of the room that were named.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ways: Vec<WayOut>,
    /// The whole dialogue.
    pub transcript: Vec<Exchange>,
    /// Who wrote the text, where the run's summariser did not: it failed, or there was nothing to summarise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by: Option<String>,
    /// Whether it was made of an answer in a form: a list of what the view shows, and how sure the witness was of each.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_structured: bool,
    /// What became of the form that was asked for, where an answer did not have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form: Option<Form>,
}

/// What became of an answer that did not have the form that was asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Form {
    /// The second answer had it.
    Mended,
    /// No answer had it: the last one was read as words.
    Broken,
}

/// A way out of the room that a view shows.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct WayOut {
    /// What it is: "doorway", "stairs".
    pub name: String,
    /// Where it was said to be in the view.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<Where>,
    /// The room that is seen through it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub leads_to: Option<String>,
}

/// One object, and what a witness said of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sighting {
    /// Its name as the witness gave it.
    pub name: String,
    /// Seen, denied or unsure.
    pub witness: Witness,
    /// Where it was said to be in the view.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<Where>,
    /// The colour it was said to have.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colour: Option<String>,
    /// Further colours it was said to have.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub more_colours: Vec<String>,
    /// What it was said to be made of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Whether it was said to be far away, or is measured to be.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_far: bool,
    /// Whether it was said to stand out for somebody who walks there.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stands_out: bool,
    /// Whether several were said to be there.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub several: bool,
    /// Where a detector found it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spot: Option<Spot>,
    /// Who said so (`labels`, `provider/model`).
    pub by: String,
}

/// Where in a view a detector found an object.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spot {
    /// Its box in the view's picture, and how sure the detector was.
    pub found: Found,
    /// The direction of the box's middle from that of the view, radians, positive right.
    pub off_rad: f64,
    /// How far over the floor it is from the eye, metres, where the platform knows the depth of the picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distance_m: Option<f64>,
}

impl Spot {
    /// A find in a picture that is `width_px` wide and shows `horizontal_fov_rad`, as a pinhole camera does. Its distance is
    /// not known.
    #[must_use]
    pub fn new(found: Found, width_px: u32, horizontal_fov_rad: f64) -> Self {
        let half_px = f64::from(width_px) / 2.0;
        let [left, _, right, _] = found.box_px.map(f64::from);
        let off = ((left + right) / 2.0 - half_px) / half_px.max(0.5);
        Self { found, off_rad: libm::atan(off * libm::tan(horizontal_fov_rad / 2.0)), distance_m: None }
    }
}

impl Sighting {
    /// What a witness said of an object, and nothing more.
    #[must_use]
    pub fn new(name: impl Into<String>, witness: Witness, by: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            witness,
            place: None,
            colour: None,
            more_colours: Vec::new(),
            material: None,
            is_far: false,
            stands_out: false,
            several: false,
            spot: None,
            by: by.into(),
        }
    }
}

/// What a witness said about an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Witness {
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
pub enum Where {
    /// The left third.
    Left,
    /// The middle.
    Middle,
    /// The right third.
    Right,
}

impl Where {
    /// The side of a robot that looks along the view; the middle is ahead.
    #[must_use]
    pub fn side(self) -> Side {
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
    pub fn at(off_rad: f64, horizontal_fov_rad: f64) -> Self {
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
pub struct Exchange {
    /// What was asked.
    pub question: String,
    /// What was answered; empty where no answer could be used.
    pub answer: String,
    /// Why the question was asked again in other words, where it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trouble: Option<Trouble>,
}

impl Exchange {
    /// A question that was answered at once.
    #[must_use]
    pub fn new(question: impl Into<String>, answer: impl Into<String>) -> Self {
        Self { question: question.into(), answer: answer.into(), trouble: None }
    }
}

/// What is wrong with an answer that cannot be used (the first four are known of BLIP-2: ChatCaptioner #4 and #7).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Trouble {
    /// There is no answer.
    Empty,
    /// It repeats the question.
    Echo,
    /// It says the same words over and over.
    Loop,
    /// It is the answer to another question, word for word.
    Repeat,
    /// It does not have the form that was asked for.
    Form,
    /// It is no answer but a refusal.
    Refusal,
}

/// A question about a view, with what was said before.
#[derive(Debug, Clone, Copy)]
pub struct Ask<'a> {
    /// What is looked at.
    pub view: &'a View,
    /// What is asked.
    pub question: &'a str,
    /// The dialogue so far.
    pub history: &'a [Exchange],
    /// What the answer is to be.
    pub answer: AnswerForm,
}

/// What an answer is to be.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum AnswerForm {
    /// A sentence or two.
    #[default]
    Words,
    /// JSON of this form, whatever else surrounds it.
    Json(Schema),
}

/// What was answered.
pub type Answer = String;

/// Sees: answers questions about views.
///
/// Blocking, object-safe and batching; threads belong to the caller.
pub trait Answerer: Send + Sync {
    /// `provider/model`, or `labels`.
    fn name(&self) -> &str;

    /// One result per question, in their order. One that fails does not fail the others.
    fn answer(&self, asks: &[Ask<'_>]) -> Vec<Result<Answer, ModelError>>;
}
