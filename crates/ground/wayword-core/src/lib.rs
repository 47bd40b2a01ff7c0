//! The types that every layer of Wayword shares: ids, poses, headings, paths, views, labels, captions, instructions,
//! styles, and the traits between two layers.
//!
//! **World frame**: right-handed, metres, z up. A heading is in radians, 0 along +y, clockwise seen from above.
//! Elevation is positive upwards. Each platform converts its own frame to this one.
//!
//! Architecture invariant: this crate reads no file, clock or network, and does not depend on a particular model or
//! platform.

pub mod action;
pub mod ambiguity;
pub mod caption;
pub mod condition;
pub mod contain;
pub mod depth;
pub mod detector;
pub mod doubt;
pub mod encoder;
pub mod failure;
pub mod from_above;
pub mod graph;
pub mod ground;
pub mod heading;
pub mod id;
pub mod image;
pub mod instruction;
pub mod label;
pub mod model;
pub mod motion;
pub mod observation;
pub mod path;
pub mod platform;
pub mod pose;
pub mod recent;
pub mod seed;
pub mod style;
pub mod survey;
pub mod verdict;
pub mod view;

pub use action::{Action, NoAction};
pub use ambiguity::Ambiguity;
pub use caption::{
    Answer, AnswerForm, Answerer, Ask, Caption, Exchange, Form, Sighting, Spot, Trouble, WayOut, Where, Witness,
};
pub use condition::{Condition, Fit, GraphSize, Lack, RoomNames};
pub use contain::contained;
pub use depth::Depth;
pub use detector::{Detector, Found, Grounded, MOST_BOXES, Scoring, apart};
pub use doubt::{Alternative, Cause, Doubt, Grade};
pub use encoder::{Grounder, TextEncoder};
pub use failure::Failure;
pub use from_above::FromAbove;
pub use glam::{DMat3, DVec3};
pub use graph::{Route, ViewpointGraph};
pub use ground::{Cover, Island, Way};
pub use heading::{Compass, Heading, Side};
pub use id::{ObjectId, SceneId, ViewpointId};
pub use image::Image;
pub use instruction::{Chosen, ChosenBy, Instruction, LONGEST_TEXT_BYTES, Mention, MentionKind, Provenance};
pub use label::Label;
pub use model::{
    Finish, LanguageModel, Message, ModelError, Reply, Request, Role, Sampling, Schema, Tool, Usage, tool_line,
};
pub use motion::{Climb, Motion, Move, Turn};
pub use observation::{Look, Observation};
pub use path::{Description, Distinction, Frame, Path, Relation, Target};
pub use platform::{PathRequest, Platform, PlatformError};
pub use pose::Pose;
pub use recent::Recent;
pub use seed::rng;
pub use style::{Choice, Constraints, Style};
pub use survey::{Placed, Survey, Surveyed};
pub use verdict::{Check, Finding, Verdict};
pub use view::{Gaze, GroundTruth, View};
