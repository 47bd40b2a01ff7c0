//! Keeps four rules while a file is read: no two items have the same name, a `path_id` names one path of a scene, the
//! values that stay in memory are no more than [`limits::MAX_VALUES_IN_MEMORY`], and headings are radians.

use crate::{DatasetItem, Episode, FormatError, heading_units::HeadingUnits, limits};
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::{SceneId, ViewpointId};

/// What the paths of a scene have in common that have one `path_id`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SharedPathId {
    /// All their viewpoints.
    WholePath,
    /// Their start. REVERIE's own paths end at different viewpoints, each near its object.
    Start,
}

/// The names and the number of values of a file so far.
#[derive(Default)]
pub(crate) struct ReadTally {
    names: BTreeSet<String>,
    /// The first path of each `path_id` of a scene.
    paths: BTreeMap<(SceneId, String), Vec<ViewpointId>>,
    values: usize,
    headings: HeadingUnits,
}

impl ReadTally {
    /// Refuses a name that was given before, because the field's loaders would silently drop one of the two items.
    pub(crate) fn claim_name(
        &mut self,
        item: &DatasetItem<'_>,
        field: &str,
        episode: &Episode,
    ) -> Result<(), FormatError> {
        if self.names.insert(episode.id.clone()) {
            return Ok(());
        }
        let problem = format!("{:?} was given to an earlier item", episode.id);
        Err(item.wrong_field(field, problem, "give each item its own name"))
    }

    /// Refuses a path whose `path_id` names another path of its scene, because texts are compared by path. Scenes may
    /// use the same numbers.
    pub(crate) fn claim_path(
        &mut self,
        item: &DatasetItem<'_>,
        episode: &Episode,
        shared: SharedPathId,
    ) -> Result<(), FormatError> {
        let Episode { scene, path_id, viewpoints, .. } = episode;
        let first = self.paths.entry((scene.clone(), path_id.clone())).or_insert_with(|| viewpoints.clone());
        let (fits, other) = match shared {
            SharedPathId::WholePath => (first == viewpoints, "with another path"),
            SharedPathId::Start => (first.first() == viewpoints.first(), "whose path starts at another viewpoint"),
        };
        if fits {
            return Ok(());
        }
        let problem = format!("{path_id:?} was given to an earlier item of scan {scene}, {other}");
        Err(item.wrong_field("path_id", problem, "correct the path, or give it a path_id of its own"))
    }

    /// Completes an episode with the fields of its item that its reader did not take.
    pub(crate) fn finish_episode(
        &mut self,
        mut episode: Episode,
        item: DatasetItem<'_>,
    ) -> Result<Episode, FormatError> {
        if let Some(heading) = episode.as_read.get("heading").and_then(Value::as_f64) {
            self.headings.note_heading(&item, heading);
        }
        let lists = episode.viewpoints.len() + episode.floor_positions.len() + episode.instructions.len();
        episode.extra = self.take_rest(item, lists + values_in(&episode.as_read))?;
        Ok(episode)
    }

    /// The episodes of a file that was read to its end.
    pub(crate) fn finish_file(self, episodes: Vec<Episode>) -> Result<Vec<Episode>, FormatError> {
        self.headings.refuse_degrees()?;
        Ok(episodes)
    }

    /// The fields that were not taken; `kept` is the number of values that were taken and are kept in memory. Values are
    /// bounded and not bytes, because a short value takes up to thirty times its length in the file.
    pub(crate) fn take_rest(&mut self, item: DatasetItem<'_>, kept: usize) -> Result<Map<String, Value>, FormatError> {
        let file = item.file();
        let rest = item.into_rest();
        self.values += kept + values_in(&rest);
        if self.values > limits::MAX_VALUES_IN_MEMORY {
            let problem = "it holds more than 20,000,000 values, more than is kept in memory";
            return Err(FormatError::for_document(file, problem, "split it into parts"));
        }
        Ok(rest)
    }
}

fn values_in(map: &Map<String, Value>) -> usize {
    map.values().map(count_values).sum()
}

/// An object counts as eight values, because even a short one takes as much memory as eight numbers.
fn count_values(value: &Value) -> usize {
    match value {
        Value::Array(list) => 1 + list.iter().map(count_values).sum::<usize>(),
        Value::Object(map) => 8 + values_in(map),
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ItemPlace;
    use serde_json::json;
    use std::path::Path;

    #[test]
    fn values_are_counted_at_every_depth() {
        assert_eq!(count_values(&json!({"a": [1, 2, {"b": null}], "c": "text"})), 8 + 3 + (8 + 1) + 1);
    }

    #[test]
    fn take_rest_limits_the_values_in_memory() {
        let mut tally = ReadTally::default();
        let item = || DatasetItem::new(Path::new("big.json"), ItemPlace::Item(0), json!({"a": [0, 0]})).unwrap();
        assert_eq!(tally.take_rest(item(), limits::MAX_VALUES_IN_MEMORY - 3).unwrap().len(), 1);
        let error = tally.take_rest(item(), 0).unwrap_err().to_string();
        assert!(error.starts_with("big.json: it holds more than 20,000,000 values"), "{error}");
    }
}
