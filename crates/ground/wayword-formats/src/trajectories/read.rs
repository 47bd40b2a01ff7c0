//! Reads trajectories, and refuses those that break a rule of the format.

use super::{FORMAT, Place, SubInstruction, Told, Trajectory};
use crate::{FormatError, Item, habitat::wayword_from_habitat, input, limits};
use serde_json::Value;
use std::{
    collections::BTreeSet,
    path::{Component, Path},
};
use wayword_core::{Action, DVec3, Heading};

/// Most actions of one walk.
const ACTIONS: usize = 25_000;
/// Most actions of all walks together that are kept in memory.
const ACTIONS_KEPT: usize = 20_000_000;

/// Reads `trajectories.jsonl`, plain or gzip.
///
/// # Errors
/// When the file cannot be read, or a line breaks a rule; the error names line and field.
pub fn read(file: &Path) -> Result<Vec<Trajectory>, FormatError> {
    let (mut all, mut names, mut kept) = (Vec::new(), BTreeSet::new(), 0);
    input::each_line(file, |mut item| {
        let trajectory = take(&mut item)?;
        if !names.insert(trajectory.id.clone()) {
            let problem = format!("{:?} was given to an earlier line", trajectory.id);
            return Err(item.wrong("trajectory_id", problem, "give each walk its own name"));
        }
        kept += trajectory.actions.len();
        if kept > ACTIONS_KEPT {
            let problem = "its walks have more than 20,000,000 actions";
            return Err(FormatError::document(file, problem, "split it into parts"));
        }
        all.push(trajectory);
        Ok(())
    })?;
    Ok(all)
}

fn take(item: &mut Item<'_>) -> Result<Trajectory, FormatError> {
    let format = item.take("format")?;
    if item.text("format", &format)? != FORMAT {
        let problem = format!("expected {FORMAT:?}, found {format}");
        return Err(item.wrong("format", problem, "read it with the version of Wayword that wrote it"));
    }
    let id = item.take("trajectory_id")?;
    let id = item.name("trajectory_id", &id)?;
    item.call(&id);
    let platform = item.take("platform")?;
    let scene = item.take("scene")?;
    let split = item.take("split")?;
    let actions = take_actions(item)?;
    let frame_steps = take_frame_steps(item, actions.len())?;
    let (positions, headings) = take_poses(item, actions.len())?;
    let off_m = item.take("off_m")?;
    let pictures = take_place(item)?;
    let sha256 = item.take("sha256")?;
    let sha256 = item.text("sha256", &sha256)?.to_owned();
    if sha256.len() != 64 || !sha256.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return Err(item.wrong("sha256", "it is no SHA-256", "write 64 hexadecimal digits"));
    }
    let instructions = take_instructions(item, &frame_steps)?;
    Ok(Trajectory {
        platform: item.name("platform", &platform)?,
        scene: item.scene("scene", &scene)?,
        split: item.name("split", &split)?,
        off_m: item.finite("off_m", &off_m)?,
        id,
        actions,
        positions,
        headings,
        frame_steps,
        pictures,
        sha256,
        instructions,
    })
}

fn take_actions(item: &mut Item<'_>) -> Result<Vec<Action>, FormatError> {
    const HINT: &str = "the last action of a walk is 0 (stop), and no other";
    let value = item.take("actions")?;
    let list = item.list("actions", &value, ACTIONS)?;
    let action = |(at, value): (usize, &Value)| item.parsed::<Action>(&format!("actions[{at}]"), value.clone());
    let actions = list.iter().enumerate().map(action).collect::<Result<Vec<_>, _>>()?;
    match actions.iter().position(|action| *action == Action::Stop) {
        Some(at) if at + 1 == actions.len() => Ok(actions),
        Some(at) => Err(item.wrong(&format!("actions[{at}]"), "it stops before the end", HINT)),
        None => Err(item.wrong("actions", "it does not end with a stop", HINT)),
    }
}

fn take_poses(item: &mut Item<'_>, count: usize) -> Result<(Vec<DVec3>, Vec<Heading>), FormatError> {
    let (positions, rotations) = (item.take("positions")?, item.take("rotations")?);
    for (field, value) in [("positions", &positions), ("rotations", &rotations)] {
        let found = item.list(field, value, ACTIONS)?.len();
        if found != count {
            let problem = format!("expected {count} entries, one for each action, found {found}");
            return Err(item.wrong(field, problem, "write where the agent is before each action"));
        }
    }
    let each = |field: &'static str, value: &Value| {
        let list = value.as_array().cloned().unwrap_or_default();
        list.into_iter().enumerate().map(move |(at, value)| (format!("{field}[{at}]"), value))
    };
    let place = |(field, value): (String, Value)| item.position(&field, &value).map(wayword_from_habitat);
    let positions = each("positions", &positions).map(place).collect::<Result<_, _>>()?;
    let heading = |(field, value): (String, Value)| {
        super::heading(item.numbers(&field, &value)?)
            .ok_or_else(|| item.wrong(&field, "it gives no heading", "write a quaternion of length 1 as x, y, z, w"))
    };
    let headings = each("rotations", &rotations).map(heading).collect::<Result<_, _>>()?;
    Ok((positions, headings))
}

fn take_frame_steps(item: &mut Item<'_>, actions: usize) -> Result<Vec<usize>, FormatError> {
    let value = item.take("frame_steps")?;
    item.list("frame_steps", &value, limits::PATH_NODES)?;
    let steps: Vec<usize> = item.parsed("frame_steps", value)?;
    if steps.is_empty() || !steps.is_sorted() || steps.last().is_some_and(|last| *last >= actions) {
        let problem = "expected the numbers of actions, in order, one for each frame";
        return Err(item.wrong("frame_steps", problem, "count actions from 0"));
    }
    Ok(steps)
}

fn take_place(item: &mut Item<'_>) -> Result<Place, FormatError> {
    let value = item.take("pictures")?;
    let place: Place = item.parsed("pictures", value)?;
    let (path, key) = match &place {
        Place::Folder(folder) => (folder, None),
        Place::Sample { shard, key } => (shard, Some(key)),
    };
    let is_below = path.len() <= limits::LINE_BYTES.min(512)
        && Path::new(path).components().all(|part| matches!(part, Component::Normal(_)))
        && !path.is_empty();
    if !is_below {
        return Err(item.wrong("pictures", "it leads out of the folder", "write images/ID or shards/000000.tar"));
    }
    if key.is_some_and(|key| key.is_empty() || !key.bytes().all(|byte| byte.is_ascii_alphanumeric())) {
        return Err(item.wrong("pictures.sample.key", "it is no key of a sample", "write digits, as in 000012"));
    }
    Ok(place)
}

fn take_instructions(item: &mut Item<'_>, frame_steps: &[usize]) -> Result<Vec<Told>, FormatError> {
    let value = item.take("instructions")?;
    let list = item.list("instructions", &value, limits::INSTRUCTIONS)?;
    if list.is_empty() {
        return Err(item.wrong("instructions", "it is empty", "a walk without an instruction teaches nothing"));
    }
    let mut all = Vec::with_capacity(list.len());
    for (number, value) in list.iter().enumerate() {
        let field = format!("instructions[{number}]");
        let told: Told = item.parsed(&field, value.clone())?;
        if told.text.len() > limits::INSTRUCTION_BYTES {
            let problem = format!("it has {} bytes, more than {}", told.text.len(), limits::INSTRUCTION_BYTES);
            return Err(item.wrong(&format!("{field}.text"), problem, "shorten it: an instruction is a few sentences"));
        }
        for (part, sub) in told.sub_instructions.iter().enumerate() {
            if let Some((what, problem)) = fault(sub, &told.text, frame_steps) {
                let field = format!("{field}.sub_instructions[{part}].{what}");
                return Err(item.wrong(&field, problem, "docs/FORMATS.md says what it should be"));
            }
        }
        all.push(told);
    }
    Ok(all)
}

/// The first field of a part that is wrong, and the problem.
fn fault(sub: &SubInstruction, text: &str, frame_steps: &[usize]) -> Option<(&'static str, &'static str)> {
    let ([from, to], [first, last]) = (sub.span, sub.frames);
    if text.get(from..to) != Some(sub.text.as_str()) {
        return Some(("span", "the instruction has other words there"));
    }
    if first > last || last >= frame_steps.len() {
        return Some(("frames", "the walk has no such frames"));
    }
    (sub.steps != [frame_steps[first], frame_steps[last]])
        .then_some(("steps", "the agent comes to these frames before other actions"))
}
