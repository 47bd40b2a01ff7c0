//! Submissions: trajectories as the evaluators of R2R and REVERIE take them.
//!
//! A JSON list of `{instr_id, trajectory: [[viewpoint, heading, elevation], ...], predObjId}`, as `tasks/R2R/eval.py`
//! of Matterport3DSimulator and `tasks/REVERIE/eval_release.py` of REVERIE read it. `predObjId` is REVERIE's, and may
//! be null or absent; VLN-DUET's `pred_objid` is the same. Entries without directions are read too: a bare viewpoint, or a list of consecutive viewpoints,
//! as VLN-DUET writes them.

mod naming;
mod object_name;
mod problems;
mod reading;

pub use naming::{InstructionNaming, name_as_episodes};
pub use problems::SubmissionProblems;
pub use reading::{SubmissionReading, read_submission};

use crate::{Episode, FormatError, item, output};
use serde_json::{Value, json};
use std::path::Path;
use wayword_core::{Heading, ObjectId, ViewpointId};

/// One submitted trajectory, for one instruction.
#[derive(Debug, Clone, PartialEq)]
pub struct SubmittedTrajectory {
    /// The instruction's name, as [`instr_id`] makes it.
    pub instr_id: String,
    /// Where the agent stood and looked, from the start; never empty where it was read from a file.
    pub trajectory: Vec<TrajectoryPose>,
    /// The object that the agent takes for the target (`predObjId`).
    pub object: Option<ObjectId>,
}

/// A viewpoint, and which way the agent looked there.
#[derive(Debug, Clone, PartialEq)]
pub struct TrajectoryPose {
    /// Where the agent stood.
    pub viewpoint: ViewpointId,
    /// Direction in the horizontal plane; north where the file gives none.
    pub heading: Heading,
    /// Radians, positive upwards; 0 where the file gives none.
    pub elevation_rad: f64,
}

/// The name of an instruction in submissions, from its item and its place there: R2R's `{path_id}_{place}`, REVERIE's
/// `{path_id}_{objId}_{place}`.
#[must_use]
pub fn instr_id(episode: &Episode, place: usize) -> String {
    format!("{}_{place}", episode.id)
}

/// Writes a submission, gzip where the name ends in `.gz`. Each item has `predObjId`, which is null where the agent
/// named no object, because REVERIE's evaluator needs the field. R2R's ignores it.
///
/// # Errors
/// When the file cannot be written.
pub fn write_submission(file: &Path, submitted: &[SubmittedTrajectory]) -> Result<(), FormatError> {
    output::write_file(file, |out| output::write_list(out, submitted.iter().map(submission_fields)))
}

fn submission_fields(submitted: &SubmittedTrajectory) -> Value {
    let pose = |posed: &TrajectoryPose| json!([posed.viewpoint.as_str(), posed.heading.rad(), posed.elevation_rad]);
    json!({
        "instr_id": submitted.instr_id,
        "trajectory": submitted.trajectory.iter().map(pose).collect::<Vec<_>>(),
        "predObjId": submitted.object.as_ref().map(|object| item::value_of(object.as_str())),
    })
}
