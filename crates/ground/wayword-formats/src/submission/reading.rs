//! Reads a submission item by item, and does not stop at the first problem.

use super::{Posed, Problems, Submitted};
use crate::{FormatError, Item, input, item, limits};
use serde_json::Value;
use std::{collections::BTreeSet, path::Path};
use wayword_core::{Heading, ViewpointId};

/// An item's name is its episode's, followed by the place of the instruction.
const INSTR_ID_BYTES: usize = limits::NAME_BYTES + 21;

/// The usable items of a submission, and the problems of the others.
#[derive(Debug)]
pub struct Reading {
    /// The items without a problem, in the order of the file.
    pub submitted: Vec<Submitted>,
    /// The names of the other items, where they have a name that no earlier item has, in the order of the file.
    pub flawed: Vec<String>,
    /// All problems: a field that is missing or wrong, a name that is given twice, and why the reader could not read
    /// the file to its end.
    pub problems: Problems,
    /// Whether the file was read to its end. It was not where it is not JSON, a field is given twice, or it is too
    /// large.
    pub is_whole: bool,
}

/// Reads a submission, plain or gzip, with all its problems.
#[must_use]
pub fn read(file: &Path) -> Reading {
    let mut reader = Reader::default();
    let read = input::each_value(file, |place, value| {
        match Item::new(file, place, value) {
            Ok(item) => reader.take(item)?,
            Err(problem) => reader.problems.add(problem),
        }
        Ok(())
    });
    let is_whole = reader.problems.good(read).is_some();
    Reading { submitted: reader.submitted, flawed: reader.flawed, problems: reader.problems, is_whole }
}

/// The items and problems of a file so far.
#[derive(Default)]
struct Reader {
    submitted: Vec<Submitted>,
    flawed: Vec<String>,
    problems: Problems,
    names: BTreeSet<String>,
    poses: usize,
}

impl Reader {
    /// Takes an item with all its problems. An error ends the reading.
    fn take(&mut self, mut item: Item<'_>) -> Result<(), FormatError> {
        let name = self.name(&mut item);
        let before = self.problems.count();
        let trajectory = self.trajectory(&mut item);
        let object = item.take_optional("predObjId").filter(|object| !object.is_null());
        let object = object.map(|object| item.object("predObjId", &object)).transpose();
        let object = self.problems.good(object);
        let is_flawed = self.problems.count() > before;
        match (name, trajectory, object) {
            (Some(instr_id), Some(trajectory), Some(object)) if !is_flawed => {
                self.poses += trajectory.len();
                if self.poses > limits::POSES_KEPT {
                    let problem = "its trajectories have more than 4,000,000 entries, more than is kept in memory";
                    return Err(FormatError::document(item.file(), problem, "split it into parts"));
                }
                self.submitted.push(Submitted { instr_id, trajectory, object });
            }
            (Some(name), ..) => self.flawed.push(name),
            (None, ..) => {}
        }
        Ok(())
    }

    fn name(&mut self, item: &mut Item<'_>) -> Option<String> {
        const WHAT: &str = "the name of an instruction, such as 4332_0";
        const HINT: &str = "write the item's id, an underscore, and the place of the instruction in the item";
        let field = "instr_id";
        let value = self.problems.good(item.take(field))?;
        let name = item::name_of(&value)
            .filter(|name| !name.is_empty() && name.len() <= INSTR_ID_BYTES && !name.chars().any(char::is_control));
        let Some(name) = name else {
            self.problems.add(item.expected(field, WHAT, &value, HINT));
            return None;
        };
        item.call(&name);
        if self.names.insert(name.clone()) {
            return Some(name);
        }
        let twice = "it was given to an earlier item";
        self.problems.add(item.wrong(field, twice, "give one trajectory for each instruction"));
        None
    }

    fn trajectory(&mut self, item: &mut Item<'_>) -> Option<Vec<Posed>> {
        let field = "trajectory";
        let value = self.problems.good(item.take(field))?;
        let entries = self.problems.good(item.list(field, &value, limits::TRAJECTORY_POSES))?;
        if entries.is_empty() {
            self.problems.add(item.wrong(field, "it is empty", "a trajectory has at least its start"));
            return None;
        }
        let mut trajectory = Vec::with_capacity(entries.len());
        for (index, entry) in entries.iter().enumerate() {
            let poses = poses(item, &format!("{field}[{index}]"), entry);
            trajectory.extend(self.problems.good(poses).into_iter().flatten());
        }
        Some(trajectory)
    }
}

/// The places that an entry of a trajectory gives: one, with or without directions, or several.
fn poses(item: &Item<'_>, field: &str, entry: &Value) -> Result<Vec<Posed>, FormatError> {
    const WHAT: &str = "[viewpoint, heading, elevation]";
    const HINT: &str = "write the viewpoint's id in quotes, and both angles in radians";
    match entry {
        Value::String(_) => Ok(vec![undirected(item, field, entry)?]),
        Value::Array(parts) => match parts.as_slice() {
            [viewpoint, heading, elevation] if !heading.is_string() => Ok(vec![Posed {
                heading: item.heading(&format!("{field}[1]"), heading)?,
                elevation_rad: item.finite(&format!("{field}[2]"), elevation)?,
                ..undirected(item, &format!("{field}[0]"), viewpoint)?
            }]),
            [viewpoint, heading] if !heading.is_string() => Ok(vec![Posed {
                heading: item.heading(&format!("{field}[1]"), heading)?,
                ..undirected(item, &format!("{field}[0]"), viewpoint)?
            }]),
            [] => Err(item.expected(field, WHAT, entry, HINT)),
            several => {
                let several = several.iter().enumerate();
                several.map(|(at, part)| undirected(item, &format!("{field}[{at}]"), part)).collect()
            }
        },
        other => Err(item.expected(field, WHAT, other, HINT)),
    }
}

fn undirected(item: &Item<'_>, field: &str, value: &Value) -> Result<Posed, FormatError> {
    let viewpoint = ViewpointId::new(item.text(field, value)?)
        .map_err(|error| item.wrong(field, error.to_string(), "give the viewpoint's bare name"))?;
    Ok(Posed { viewpoint, heading: Heading::NORTH, elevation_rad: 0.0 })
}
