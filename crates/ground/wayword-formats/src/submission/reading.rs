//! Reads a submission item by item, and does not stop at the first problem.

use super::{SubmissionProblems, SubmittedTrajectory, TrajectoryPose, object_name::ObjectNames};
use crate::{
    DatasetItem, FormatError,
    beginning::{FileContents, look_at_beginning},
    input, item, limits,
};
use serde_json::Value;
use std::{collections::BTreeSet, path::Path};
use wayword_core::{Heading, ViewpointId};

/// Longest name of an item, bytes: its episode's name, an underscore, and a number of at most 20 digits.
const MAX_INSTR_ID_BYTES: usize = limits::MAX_NAME_BYTES + 21;

/// The usable items of a submission, and the problems of the others.
#[derive(Debug)]
pub struct SubmissionReading {
    /// The items without a problem, in the order of the file.
    pub submitted: Vec<SubmittedTrajectory>,
    /// The names of the other items, where they have a name that no earlier item has, in the order of the file.
    pub flawed: Vec<String>,
    /// All problems: a field that is missing or wrong, a name that is given twice, and why the reader could not read
    /// the file to its end.
    pub problems: SubmissionProblems,
    /// Whether the file was read to its end. It was not where it is not JSON, a field is given twice, or it is too
    /// large.
    pub is_whole: bool,
}

/// Reads a submission, a list or JSON Lines, plain or gzip, with all its problems.
#[must_use]
pub fn read_submission(file: &Path) -> SubmissionReading {
    let mut reader = SubmissionReader::default();
    let read = refuse_other_contents(file).and_then(|()| {
        input::each_value(file, |place, value| {
            match DatasetItem::new(file, place, value) {
                Ok(item) => reader.take_item(item)?,
                Err(problem) => reader.problems.add_problem(problem),
            }
            Ok(())
        })
    });
    let is_whole = reader.problems.value_or_problem(read).is_some();
    SubmissionReading { submitted: reader.submitted, flawed: reader.flawed, problems: reader.problems, is_whole }
}

/// Refuses a file that holds something other than a list of trajectories, with what it holds.
fn refuse_other_contents(file: &Path) -> Result<(), FormatError> {
    const LIST: &str = "write a list of {\"instr_id\": ..., \"trajectory\": [...]}, one for each instruction";
    let refused = |problem: String, hint| Err(FormatError::for_document(file, problem, hint));
    match look_at_beginning(file)?.0 {
        FileContents::TrajectoriesByName => {
            refused("it is an object from names of instructions to trajectories, and no list".to_owned(), LIST)
        }
        FileContents::OtherPredictions => refused(
            "it holds predictions for VLN-CE's or RxR's leaderboard, and not trajectories of R2R or REVERIE".to_owned(),
            "positions cannot be scored here; where the path is of viewpoints, write a list of {\"instr_id\": ..., \
             \"trajectory\": [...]}",
        ),
        FileContents::WrappedList(fields) => refused(format!("it is an object with {fields}"), "write that list alone"),
        FileContents::ItemsByName => refused("it is an object with an item for each name".to_owned(), LIST),
        FileContents::Other(what) => refused(format!("it is {what}, and no submission"), LIST),
        FileContents::Dataset(_) | FileContents::Submission | FileContents::EmptyList | FileContents::Unknown => Ok(()),
    }
}

/// The items and problems of a file so far.
#[derive(Default)]
struct SubmissionReader {
    submitted: Vec<SubmittedTrajectory>,
    flawed: Vec<String>,
    problems: SubmissionProblems,
    /// The names of all items so far.
    names: BTreeSet<String>,
    /// The number of entries of all trajectories so far.
    poses: usize,
    objects: ObjectNames,
}

impl SubmissionReader {
    /// Takes an item with all its problems. An error ends the reading.
    fn take_item(&mut self, mut item: DatasetItem<'_>) -> Result<(), FormatError> {
        let name = self.take_name(&mut item);
        let before = self.problems.count();
        let trajectory = self.take_trajectory(&mut item)?;
        let object = self.problems.value_or_problem(self.objects.take_object(&mut item));
        let is_flawed = self.problems.count() > before;
        match (name, trajectory, object) {
            (Some(instr_id), Some(trajectory), Some(object)) if !is_flawed => {
                self.poses += trajectory.len();
                if self.poses > limits::MAX_POSES_IN_MEMORY {
                    let problem = "its trajectories have more than 4,000,000 entries, more than is kept in memory";
                    return Err(FormatError::for_document(item.file(), problem, "split it into parts"));
                }
                self.submitted.push(SubmittedTrajectory { instr_id, trajectory, object });
            }
            (Some(name), ..) => self.flawed.push(name),
            (None, ..) => {}
        }
        Ok(())
    }

    fn take_name(&mut self, item: &mut DatasetItem<'_>) -> Option<String> {
        const WHAT: &str = "the name of an instruction, such as 4332_0";
        const HINT: &str = "write the item's id, an underscore, and the place of the instruction in the item";
        let field = "instr_id";
        let value = self.problems.value_or_problem(item.take_field(field))?;
        let name = item::name_of(&value)
            .filter(|name| !name.is_empty() && name.len() <= MAX_INSTR_ID_BYTES && !name.chars().any(char::is_control));
        let Some(name) = name else {
            self.problems.add_problem(item.expected_kind(field, WHAT, &value, HINT));
            return None;
        };
        item.set_id(&name);
        if self.names.insert(name.clone()) {
            return Some(name);
        }
        let twice = "it was given to an earlier item";
        self.problems.add_problem(item.wrong_field(field, twice, "give one trajectory for each instruction"));
        None
    }

    /// Takes the trajectory. An error ends the reading: the form of the whole file is another.
    fn take_trajectory(&mut self, item: &mut DatasetItem<'_>) -> Result<Option<Vec<TrajectoryPose>>, FormatError> {
        let field = "trajectory";
        let Some(value) = self.problems.value_or_problem(item.take_field(field)) else { return Ok(None) };
        refuse_other_form(item, field, &value)?;
        let entries = item.checked_list(field, &value, limits::MAX_TRAJECTORY_POSES);
        let Some(entries) = self.problems.value_or_problem(entries) else { return Ok(None) };
        if entries.is_empty() {
            self.problems.add_problem(item.wrong_field(field, "it is empty", "a trajectory has at least its start"));
            return Ok(None);
        }
        let mut trajectory = Vec::with_capacity(entries.len());
        for (index, entry) in entries.iter().enumerate() {
            let poses = entry_poses(item, &format!("{field}[{index}]"), entry);
            trajectory.extend(self.problems.value_or_problem(poses).into_iter().flatten());
        }
        Ok(Some(trajectory))
    }
}

/// Refuses trajectories of other benchmarks, whose form is the same in all items of a file.
fn refuse_other_form(item: &DatasetItem<'_>, field: &str, value: &Value) -> Result<(), FormatError> {
    const POSITIONS: &str = "positions, as VLN-CE has them, are not scored here; give the viewpoints of the walk";
    if value.get("path").is_some() {
        let problem = "it is an object with \"path\", as VLN-DUET writes it for SOON, and no list";
        let hint = "write the list in its \"path\" as the trajectory, in all items; SOON's direction of the object \
                    (\"obj_heading\", \"obj_elevation\") is not scored here";
        return Err(item.wrong_field(field, problem, hint));
    }
    let first = value.get(0);
    let is_position = |entry: &Value| entry.get("position").is_some() || entry.get(0).is_some_and(Value::is_number);
    if first.is_some_and(is_position) {
        return Err(item.wrong_field(&format!("{field}[0]"), "it is a position, and no viewpoint", POSITIONS));
    }
    Ok(())
}

/// The places that an entry of a trajectory gives: one, with or without directions, or several.
fn entry_poses(item: &DatasetItem<'_>, field: &str, entry: &Value) -> Result<Vec<TrajectoryPose>, FormatError> {
    const WHAT: &str = "[viewpoint, heading, elevation]";
    const HINT: &str = "write the viewpoint's id in quotes, and both angles in radians";
    match entry {
        Value::String(_) => Ok(vec![undirected_pose(item, field, entry)?]),
        Value::Array(parts) => match parts.as_slice() {
            [viewpoint, heading, elevation] if !heading.is_string() => Ok(vec![TrajectoryPose {
                heading: item.checked_heading(&format!("{field}[1]"), heading)?,
                elevation_rad: item.checked_number(&format!("{field}[2]"), elevation)?,
                ..undirected_pose(item, &format!("{field}[0]"), viewpoint)?
            }]),
            [viewpoint, heading] if !heading.is_string() => Ok(vec![TrajectoryPose {
                heading: item.checked_heading(&format!("{field}[1]"), heading)?,
                ..undirected_pose(item, &format!("{field}[0]"), viewpoint)?
            }]),
            [] => Err(item.expected_kind(field, WHAT, entry, HINT)),
            several => {
                let several = several.iter().enumerate();
                several.map(|(at, part)| undirected_pose(item, &format!("{field}[{at}]"), part)).collect()
            }
        },
        other => Err(item.expected_kind(field, WHAT, other, HINT)),
    }
}

/// A viewpoint without directions, which looks north and level.
fn undirected_pose(item: &DatasetItem<'_>, field: &str, value: &Value) -> Result<TrajectoryPose, FormatError> {
    let viewpoint = ViewpointId::new(item.checked_text(field, value)?)
        .map_err(|error| item.wrong_field(field, error.to_string(), "give the viewpoint's bare name"))?;
    Ok(TrajectoryPose { viewpoint, heading: Heading::NORTH, elevation_rad: 0.0 })
}
