//! Finds another path of the same building with as many hops. A text about it shows how much two unrelated texts agree by chance.

use super::record::{ArmPathRecord, UnchangedRecords};
use crate::demands::SAME_GOAL_M;
use wayword_core::{Path, PathRequest, Platform, PlatformError, seed::derive_seed};
use wayword_run::error::CommandError;

/// Most paths that are drawn at random in search of one with as many hops.
const MAX_PATH_DRAWS: u64 = 60;
/// A path that is drawn differs in length from the run's path by at most this share.
const LENGTH_TOLERANCE_SHARE: f64 = 0.25;

/// Another path of the same building.
pub(super) enum OtherPathChoice {
    /// A path of the run, which has its texts already.
    Told(Box<ArmPathRecord>),
    /// A path that was drawn, under the id of the run's path.
    New(Path),
}

/// Finds another path for a path: one of the run if possible, and otherwise one that is drawn at random.
///
/// # Errors
/// When the scene cannot be read.
pub(super) fn find_other_path(
    platform: &dyn Platform,
    path: &Path,
    unchanged: &UnchangedRecords,
    seed: u64,
) -> Result<Option<OtherPathChoice>, CommandError> {
    let candidates: Vec<&ArmPathRecord> = unchanged.values().filter(|line| is_other(path, &line.path)).collect();
    let choice = derive_seed(seed, &["robustness", "other", &path.id]).checked_rem(candidates.len() as u64);
    if let Some(line) = choice.and_then(|choice| candidates.get(usize::try_from(choice).ok()?)) {
        return Ok(Some(OtherPathChoice::Told(Box::new((*line).clone()))));
    }
    let Some(length_m) = path.length_m() else { return Ok(None) };
    let hops = path.frames.len() - 1;
    let request = PathRequest {
        hops: hops..=hops,
        length_m: length_m * (1.0 - LENGTH_TOLERANCE_SHARE)..=length_m * (1.0 + LENGTH_TOLERANCE_SHARE),
    };
    for draw in 0..MAX_PATH_DRAWS {
        let seed = derive_seed(seed, &["robustness", "other", &path.id, &draw.to_string()]);
        match platform.sample_path(&path.scene, &request, seed) {
            Ok(other) if is_other(path, &other) => {
                // The random numbers of the writing depend on the path's id, so it stays the same.
                return Ok(Some(OtherPathChoice::New(Path { id: path.id.clone(), ..other })));
            }
            Ok(_) | Err(PlatformError::NoSuchPath { .. }) => {}
            Err(error) => return Err(error.into()),
        }
    }
    Ok(None)
}

/// Whether a path of the same building has as many hops and another goal.
fn is_other(path: &Path, other: &Path) -> bool {
    let is_alike = other.scene == path.scene && other.frames.len() == path.frames.len();
    let goal = |path: &Path| path.frames.last().map(|frame| frame.pose.position);
    let is_elsewhere = goal(path).zip(goal(other)).is_some_and(|(a, b)| a.distance(b) >= SAME_GOAL_M);
    is_alike && is_elsewhere
}
