//! The types that every layer of Wayword shares: ids, poses, headings, paths, views, labels, captions, instructions,
//! styles, and the traits between two layers.
//!
//! **World frame**: right-handed, metres, z up. A heading is in radians, 0 along +y, clockwise seen from above.
//! Elevation is positive upwards. Each platform converts its own frame to this one.
//!
//! Architecture invariant: this crate reads no file, clock or network, and does not depend on a particular model or
//! platform.
//!
//! # Where things are
//! - [`platform`], [`model`], [`detector`], [`encoder`], [`ViewAnswerer`]: the traits between layers.
//! - [`motion`]: the words for turns and climbs, and their limits in degrees and metres.
//! - [`verdict`]: the name of each check. The checks themselves are in `wayword-checks`.
//! - [`failure`]: what decides between missing, broken and lost. [`platform`] and [`model`] do this for their errors.
//! - [`condition`]: what can be known of a scene before a run.
//! - [`file_start`]: the kinds of files by their first bytes.
//! - [`depth`]: how far away a detector's find is.
//! - [`doubt`]: what a doubt consists of, and how doubts about the same words are put together.
//! - [`film_motion`], [`film_turns`]: how the camera of a film moves, and its turns.
//! - [`walk_cuts`]: all ways to divide a walk among the parts of a text.
//! - [`id`]: which names from outside are refused.

pub mod action;
pub mod ambiguity;
pub mod caption;
pub mod condition;
pub mod contain_panics;
pub mod depth;
pub mod detector;
pub mod doubt;
pub mod encoder;
pub mod failure;
pub mod file_start;
pub mod film_motion;
pub mod film_turns;
pub mod graph;
pub mod ground;
pub mod heading;
pub mod hex;
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
pub mod recent_cache;
pub mod seed;
pub mod storey_picture;
pub mod style;
pub mod survey;
pub mod verdict;
pub mod view;
pub mod walk_cuts;

pub use action::{AgentAction, NoAction};
pub use ambiguity::TextAmbiguity;
pub use caption::{
    AnswerForm, AnswerText, AnswerTrouble, Caption, DetectionSpot, DialogueExchange, FormOutcome, ObjectSighting,
    ViewAnswerer, ViewQuestion, ViewThird, WayOut, WitnessAnswer,
};
pub use condition::{GraphFit, GraphSize, RoomNames, SceneCondition, SceneLack};
pub use contain_panics::run_contained;
pub use depth::DepthImage;
pub use detector::{
    DetectedBox, DetectorGrounder, DetectorScoring, MAX_BOXES_PER_PHRASE, ObjectDetector, without_overlaps,
};
pub use doubt::{DoubtAlternative, DoubtCause, DoubtGrade, TextDoubt};
pub use encoder::{PhraseGrounder, TextEncoder};
pub use failure::FailureKind;
pub use file_start::{FILE_START_BYTES, FileGroup, FileStart};
pub use film_motion::{CameraMotion, CameraStep, MotionSource};
pub use film_turns::{FilmTurn, FilmTurnRules, find_film_turns};
pub use glam::{DMat3, DMat4, DVec3};
pub use graph::{ViewpointGraph, ViewpointRoute};
pub use ground::{GroundCover, GroundIsland, GroundRoute};
pub use heading::{CompassPoint, Heading, Side};
pub use hex::hex_text;
pub use id::{ObjectId, SceneId, ViewpointId};
pub use image::Image;
pub use instruction::{
    ChosenBy, Instruction, InstructionPart, MAX_TEXT_BYTES, MentionKind, RefinedRound, TextMention, TextProvenance,
    TextSelection, WrittenDraft,
};
pub use label::ObjectLabel;
pub use model::{
    ChatMessage, FinishReason, LanguageModel, MessageRole, ModelError, ModelReply, ModelRequest, ModelTool, ModelUsage,
    ReplySchema, SamplingOptions, tool_line,
};
pub use motion::{ClimbDirection, PathMotion, PathMove, TurnKind};
pub use observation::{CaptionedView, FrameObservation};
pub use path::{Frame, ObjectDescription, ObjectDistinction, ObjectRelation, Path, PathTarget};
pub use platform::{Ground, PathRequest, Platform, PlatformError, SceneCatalogue, SceneFiles};
pub use pose::Pose;
pub use recent_cache::RecentCache;
pub use seed::seeded_rng;
pub use storey_picture::FromAbove;
pub use style::{InstructionStyle, StyleConstraints, WordingPolicy};
pub use survey::{PlacedObject, SurveyedViewpoint, ViewpointSurvey};
pub use verdict::{CheckFinding, CheckKind, Verdict};
pub use view::{GroundTruth, View, ViewGaze};
