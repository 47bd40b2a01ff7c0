//! From views to words: the dialogue, prompts, styles, writing and repair, and the roles that need no model.
//!
//! Architecture invariant: no module here opens a file or a connection, and none knows more of a platform than the
//! trait [`wayword_core::Platform`].
//!
//! # Where things are
//! - [`observe`]: looks along a path and gives each frame its captions; [`walk`]: a path with the result.
//! - `dialogue/questions.rs`, `mod.rs`: which questions are asked, and when a dialogue ends.
//! - `dialogue/trouble.rs` and `faults.rs`: unusable answers and captions.
//! - `dialogue/answers/`: how an answer is read.
//! - [`seeing`]: the structured request about a view (`schema.json`), and how its answer is read.
//! - [`detection`]: what a detector is asked, and what its finds change in captions. `detection/nouns.txt` has the
//!   names that a detector looks for even where no caption mentions them.
//! - [`perception`]: how well captions fit labels.
//! - [`models`]: how a model plays a role, a file for each. [`offline`]: how labels do.
//! - `offline/describe/`: what tells a target from everything else in its building.
//! - [`prompts`]: the texts in `prompts/templates/`, the values in `writing.rs`, `move_words.rs` and `corrections.rs`,
//!   the limits of a user's own templates in `bounds.rs`.
//! - `style/builtin/`: the styles, with the shapes and shares of the writer's clauses; `style/profile.rs`: the measured
//!   properties of a style.
//! - `writer/route/`: which parts of a way a text mentions, and in which order; `writer/landmarks.rs`: which things.
//! - `writer/naming.rs`, `draft.rs`: the words for these parts and things.
//! - `writer/place.rs`, `task.rs`, `object.rs`: places and tasks.
//! - [`repair`]: how a text that failed is written again; `repair/choose.rs`: how one of several texts is chosen.

pub mod detection;
pub mod dialogue;
pub mod models;
pub mod observe;
pub mod offline;
pub mod perception;
pub mod prompts;
pub mod repair;
pub mod seeing;
pub mod style;
pub mod walk;
mod weighted_draw;
pub mod writer;
