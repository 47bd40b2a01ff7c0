//! Reads trajectories, and refuses those that break a rule of the format.

use super::{ActionTrajectory, SubInstruction, TRAJECTORY_FORMAT, TrajectoryInstruction};
use crate::{DatasetItem, FormatError, habitat::wayword_from_habitat, input, limits};
use serde_json::Value;
use std::{collections::BTreeSet, path::Path};
use wayword_core::{AgentAction, DVec3, Heading};

/// Most actions of one walk; a file with a longer one is refused.
const MAX_ACTIONS: usize = 25_000;
/// Most actions of all walks together that are kept in memory; a file with more is refused.
const MAX_ACTIONS_IN_MEMORY: usize = 20_000_000;

/// Reads `trajectories.jsonl`, plain or gzip.
///
/// # Errors
/// When the file cannot be read, or a line breaks a rule; the error names line and field.
pub fn read_trajectories(file: &Path) -> Result<Vec<ActionTrajectory>, FormatError> {
    let (mut all, mut names, mut kept) = (Vec::new(), BTreeSet::new(), 0);
    input::each_line(file, |mut item| {
        let trajectory = take_trajectory(&mut item)?;
        if !names.insert(trajectory.id.clone()) {
            let problem = format!("{:?} was given to an earlier line", trajectory.id);
            return Err(item.wrong_field("trajectory_id", problem, "give each walk its own name"));
        }
        kept += trajectory.actions.len();
        if kept > MAX_ACTIONS_IN_MEMORY {
            let problem = "its walks have more than 20,000,000 actions";
            return Err(FormatError::for_document(file, problem, "split it into parts"));
        }
        all.push(trajectory);
        Ok(())
    })?;
    Ok(all)
}

fn take_trajectory(item: &mut DatasetItem<'_>) -> Result<ActionTrajectory, FormatError> {
    let format = item.take_field("format")?;
    if item.checked_text("format", &format)? != TRAJECTORY_FORMAT {
        let problem = format!("expected {TRAJECTORY_FORMAT:?}, found {format}");
        return Err(item.wrong_field("format", problem, "read it with the version of Wayword that wrote it"));
    }
    let id = item.take_field("trajectory_id")?;
    let id = item.checked_name("trajectory_id", &id)?;
    item.set_id(&id);
    let platform = item.take_field("platform")?;
    let scene = item.take_field("scene")?;
    let split = item.take_field("split")?;
    let actions = take_actions(item)?;
    let frame_steps = take_frame_steps(item, actions.len())?;
    let (positions, headings) = take_poses(item, actions.len())?;
    let off_m = item.take_field("off_m")?;
    let above_floor_m = take_above_floor(item, actions.len())?;
    let path_sha256 = item.take_field("path_sha256")?;
    let instructions = take_instructions(item, &frame_steps)?;
    Ok(ActionTrajectory {
        platform: item.checked_name("platform", &platform)?,
        scene: item.checked_scene("scene", &scene)?,
        split: item.checked_name("split", &split)?,
        off_m: item.checked_number("off_m", &off_m)?,
        id,
        actions,
        positions,
        headings,
        frame_steps,
        above_floor_m,
        path_sha256: item.checked_name("path_sha256", &path_sha256)?,
        instructions,
    })
}

fn take_actions(item: &mut DatasetItem<'_>) -> Result<Vec<AgentAction>, FormatError> {
    const HINT: &str = "the last action of a walk is 0 (stop), and no other";
    let value = item.take_field("actions")?;
    let list = item.checked_list("actions", &value, MAX_ACTIONS)?;
    let action =
        |(at, value): (usize, &Value)| item.parse_value::<AgentAction>(&format!("actions[{at}]"), value.clone());
    let actions = list.iter().enumerate().map(action).collect::<Result<Vec<_>, _>>()?;
    match actions.iter().position(|action| *action == AgentAction::Stop) {
        Some(at) if at + 1 == actions.len() => Ok(actions),
        Some(at) => Err(item.wrong_field(&format!("actions[{at}]"), "it stops before the end", HINT)),
        None => Err(item.wrong_field("actions", "it does not end with a stop", HINT)),
    }
}

/// Takes where the agent is and looks before each of the `count` actions.
fn take_poses(item: &mut DatasetItem<'_>, count: usize) -> Result<(Vec<DVec3>, Vec<Heading>), FormatError> {
    let (positions, rotations) = (item.take_field("positions")?, item.take_field("rotations")?);
    for (field, value) in [("positions", &positions), ("rotations", &rotations)] {
        let found = item.checked_list(field, value, MAX_ACTIONS)?.len();
        if found != count {
            let problem = format!("expected {count} entries, one for each action, found {found}");
            return Err(item.wrong_field(field, problem, "write where the agent is before each action"));
        }
    }
    let each = |field: &'static str, value: &Value| {
        let list = value.as_array().cloned().unwrap_or_default();
        list.into_iter().enumerate().map(move |(at, value)| (format!("{field}[{at}]"), value))
    };
    let place = |(field, value): (String, Value)| item.checked_position(&field, &value).map(wayword_from_habitat);
    let positions = each("positions", &positions).map(place).collect::<Result<_, _>>()?;
    let heading = |(field, value): (String, Value)| {
        super::heading_from_rotation(item.checked_numbers(&field, &value)?).ok_or_else(|| {
            item.wrong_field(&field, "it gives no heading", "write a quaternion of length 1 as x, y, z, w")
        })
    };
    let headings = each("rotations", &rotations).map(heading).collect::<Result<_, _>>()?;
    Ok((positions, headings))
}

/// Takes, for each frame, the action before which the agent comes there.
fn take_frame_steps(item: &mut DatasetItem<'_>, actions: usize) -> Result<Vec<usize>, FormatError> {
    let value = item.take_field("frame_steps")?;
    item.checked_list("frame_steps", &value, limits::MAX_PATH_NODES)?;
    let steps: Vec<usize> = item.parse_value("frame_steps", value)?;
    if steps.is_empty() || !steps.is_sorted() || steps.last().is_some_and(|last| *last >= actions) {
        let problem = "expected the numbers of actions, in order, one for each frame";
        return Err(item.wrong_field("frame_steps", problem, "count actions from 0"));
    }
    Ok(steps)
}

/// Takes how far each position is above the floor.
fn take_above_floor(item: &mut DatasetItem<'_>, count: usize) -> Result<Vec<Option<f64>>, FormatError> {
    let value = item.take_field("above_floor_m")?;
    let found = item.checked_list("above_floor_m", &value, MAX_ACTIONS)?.len();
    if found != count {
        let problem = format!("expected {count} entries, one for each action, found {found}");
        return Err(item.wrong_field("above_floor_m", problem, "write a number or null for each position"));
    }
    item.parse_value("above_floor_m", value)
}

fn take_instructions(
    item: &mut DatasetItem<'_>,
    frame_steps: &[usize],
) -> Result<Vec<TrajectoryInstruction>, FormatError> {
    let value = item.take_field("instructions")?;
    let list = item.checked_list("instructions", &value, limits::MAX_INSTRUCTIONS)?;
    if list.is_empty() {
        return Err(item.wrong_field("instructions", "it is empty", "a walk without an instruction teaches nothing"));
    }
    let mut all = Vec::with_capacity(list.len());
    for (number, value) in list.iter().enumerate() {
        let field = format!("instructions[{number}]");
        let instruction: TrajectoryInstruction = item.parse_value(&field, value.clone())?;
        if instruction.text.len() > limits::MAX_INSTRUCTION_BYTES {
            let problem =
                format!("it has {} bytes, more than {}", instruction.text.len(), limits::MAX_INSTRUCTION_BYTES);
            return Err(item.wrong_field(
                &format!("{field}.text"),
                problem,
                "shorten it: an instruction is a few sentences",
            ));
        }
        let mut last_start = None;
        for (part, sub) in instruction.sub_instructions.iter().enumerate() {
            let grows = last_start.replace(sub.steps[0]).is_none_or(|last| last < sub.steps[0]);
            let fault = find_fault(sub, &instruction.text, frame_steps);
            if let Some((wrong, problem)) =
                fault.or_else(|| (!grows).then_some(("steps", "it begins no later than the part before")))
            {
                let field = format!("{field}.sub_instructions[{part}].{wrong}");
                return Err(item.wrong_field(&field, problem, "docs/FORMATS.md says what it should be"));
            }
        }
        all.push(instruction);
    }
    Ok(all)
}

/// The first field of a part that is wrong, and the problem.
fn find_fault(sub: &SubInstruction, text: &str, frame_steps: &[usize]) -> Option<(&'static str, &'static str)> {
    let ([from, to], [first, last]) = (sub.span, sub.frames);
    if text.get(from..to) != Some(sub.text.as_str()) {
        return Some(("span", "the instruction has other words there"));
    }
    let steps = frame_steps.get(first).zip(frame_steps.get(last)).filter(|_| first <= last);
    let Some((from_step, to_step)) = steps else {
        return Some(("frames", "the walk has no such frames"));
    };
    (sub.steps != [*from_step, *to_step]).then_some(("steps", "the agent comes to these frames before other actions"))
}
