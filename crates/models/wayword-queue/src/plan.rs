//! The plan of a run: the items, their chunks, and the settings that all workers must agree on.

use crate::{QueueError, put_new};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::{collections::BTreeMap, fs, io::ErrorKind, ops::Range, path::Path};

/// The plan's file in a run folder.
pub const PLAN_FILE: &str = "plan.json";
/// The file that records whether shards or a queue hand out the chunks.
pub const WORKERS_FILE: &str = "workers.json";
/// The version of the plan's format that this program writes and reads.
const PLAN_FORMAT: u32 = 1;
/// Largest plan that is read, bytes: enough for ten million items.
const MAX_PLAN_BYTES: u64 = 1 << 30;

/// Everything that all workers of a run must agree on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChunkPlan {
    format: u32,
    /// The run's name.
    pub run: String,
    /// Items in a chunk; the last one may have fewer.
    pub chunk: usize,
    /// The settings as a run folder stores them, with hashes of the inputs.
    pub config: String,
    /// Hashes of the scenes' files, by scene.
    pub data: BTreeMap<String, String>,
    /// The estimate of the run's calls and cost.
    pub estimate: serde_json::Value,
    /// The items' names, in their order.
    pub items: Vec<String>,
}

impl ChunkPlan {
    /// A plan.
    #[must_use]
    pub fn new(run: String, chunk: usize, config: String, items: Vec<String>) -> Self {
        let (data, estimate) = (BTreeMap::new(), serde_json::Value::Null);
        Self { format: PLAN_FORMAT, run, chunk: chunk.max(1), config, data, estimate, items }
    }

    /// Writes the plan, unless the folder has one. Returns whether this one was written.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write_plan(&self, folder: &Path) -> Result<bool, QueueError> {
        let path = folder.join(PLAN_FILE);
        let mut bytes = serde_json::to_vec(self)
            .map_err(|error| QueueError::Broken { path: path.clone(), problem: error.to_string() })?;
        bytes.push(b'\n');
        put_new(&path, &bytes)
    }

    /// The plan of a folder; `None` if it has none.
    ///
    /// # Errors
    /// When it cannot be read, or is of another format.
    pub fn find_plan(folder: &Path) -> Result<Option<Self>, QueueError> {
        let path = folder.join(PLAN_FILE);
        let broken = |problem: String| QueueError::Broken { path: path.clone(), problem };
        let about = match fs::metadata(&path) {
            Ok(about) => about,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(QueueError::Io { path, doing: "read", source }),
        };
        if !about.is_file() || about.len() > MAX_PLAN_BYTES {
            return Err(broken("this is no plan, or one of more than 1 GiB".to_owned()));
        }
        let bytes = fs::read(&path).map_err(QueueError::for_file(&path, "read"))?;
        let plan: Self = serde_json::from_slice(&bytes).map_err(|error| broken(error.to_string()))?;
        if plan.format != PLAN_FORMAT {
            return Err(broken(format!("its format is {}, and this program reads {PLAN_FORMAT}", plan.format)));
        }
        if plan.chunk == 0 {
            return Err(broken("its chunks hold no item".to_owned()));
        }
        Ok(Some(plan))
    }

    /// The plan of a folder.
    ///
    /// # Errors
    /// As for [`ChunkPlan::find_plan`], and when there is none.
    pub fn for_folder(folder: &Path) -> Result<Self, QueueError> {
        Self::find_plan(folder)?.ok_or_else(|| QueueError::NoPlan(folder.to_owned()))
    }

    /// How many chunks there are.
    #[must_use]
    pub fn chunk_count(&self) -> usize {
        self.items.len().div_ceil(self.chunk)
    }

    /// The indices of a chunk's items in [`ChunkPlan::items`].
    #[must_use]
    pub fn chunk_range(&self, chunk: usize) -> Range<usize> {
        let end = self.items.len();
        (chunk * self.chunk).min(end)..((chunk + 1) * self.chunk).min(end)
    }

    /// A hash of the whole plan, as 32 hexadecimal digits: equal plans have equal hashes.
    #[must_use]
    pub fn plan_hash(&self) -> String {
        let mut hash = Sha256::new();
        hash.update(serde_json::to_vec(self).unwrap_or_default());
        hash.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_in_one_chunk_and_the_first_plan_stays() {
        let folder = tempfile::tempdir().unwrap();
        let items: Vec<String> = (0..10).map(|number| format!("item-{number}")).collect();
        let plan = ChunkPlan::new("run".into(), 4, "seed = 1\n".into(), items);
        let ranges: Vec<_> = (0..plan.chunk_count()).map(|chunk| plan.chunk_range(chunk)).collect();
        assert_eq!(ranges, [0..4, 4..8, 8..10]);
        assert!(plan.write_plan(folder.path()).unwrap());
        assert!(!ChunkPlan { chunk: 5, ..plan.clone() }.write_plan(folder.path()).unwrap());
        assert_eq!(ChunkPlan::for_folder(folder.path()).unwrap(), plan);
        assert!(matches!(ChunkPlan::for_folder(&folder.path().join("no")), Err(QueueError::NoPlan(_))));
    }

    #[test]
    fn a_plan_that_was_changed_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        for text in ["", "{}", "{\"format\":9}"] {
            fs::write(folder.path().join(PLAN_FILE), text).unwrap();
            assert!(matches!(ChunkPlan::for_folder(folder.path()), Err(QueueError::Broken { .. })), "{text}");
        }
    }
}
