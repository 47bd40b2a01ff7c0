//! Makes the pictures of walks and stores them: in a folder for each walk, or several walks in one tar file (shard). The pictures are
//! written first and the walk's line in `trajectories.jsonl` last, so every walk with a line is complete.

use super::{
    settings::StepExportSettings,
    walks::{ExportedWalk, trajectory_from_walk},
};
use crate::walking::WalkingScenes;
use serde_json::Value;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};
use wayword_core::FailureKind;
use wayword_formats::trajectories::{
    ActionTrajectory, PictureDigest, PictureLocation, ShardWriter, picture_name, trajectory_line,
};
use wayword_run::{
    error::CommandError,
    interrupt,
    pictures::encode_jpeg,
    run_folder::{FailedItem, Journal, file},
};

/// The file of trajectories.
pub(super) const TRAJECTORIES_FILE: &str = "trajectories.jsonl";
/// The folders of the pictures: one below `images` for each walk, or the tar files in `shards`.
const IMAGES_FOLDER: &str = "images";
const SHARDS_FOLDER: &str = "shards";

/// The folder of an export, with its journals of finished and failed walks.
pub(super) struct TrajectoryStore {
    folder: PathBuf,
    trajectories: Journal,
    errors: Journal,
}

/// The result of one unit: walks that are finished, and walks that failed.
pub(super) struct TrajectoryBatch {
    taken: Vec<ActionTrajectory>,
    failed: Vec<FailedItem>,
}

impl TrajectoryStore {
    /// Opens a folder and continues with its finished walks. Failed walks are tried again.
    pub(super) fn open(folder: &Path) -> Result<Self, CommandError> {
        Ok(Self {
            folder: folder.to_owned(),
            trajectories: Journal::open(&folder.join(TRAJECTORIES_FILE), key_of)?,
            errors: Journal::begin_empty(&folder.join(file::ERRORS), FailedItem::key_of)?,
        })
    }

    /// The ids of the finished walks.
    pub(super) fn finished_ids(&self) -> BTreeSet<String> {
        self.trajectories.keys().map(str::to_owned).collect()
    }

    /// Writes the lines of the walks of a unit.
    pub(super) fn keep_batch(&mut self, batch: &TrajectoryBatch) -> Result<(), CommandError> {
        batch.taken.iter().try_for_each(|taken| self.trajectories.append(&trajectory_line(taken)))?;
        batch.failed.iter().try_for_each(|failed| self.errors.append(failed))
    }

    /// Puts the lines into the order of the walks.
    pub(super) fn sort_and_sync(&mut self, walks: &[ExportedWalk<'_>]) -> Result<(), CommandError> {
        let places: BTreeMap<&str, usize> =
            walks.iter().enumerate().map(|(place, walk)| (walk.path.id.as_str(), place)).collect();
        self.trajectories.arrange_by(|id| places.get(id).copied())?;
        self.trajectories.sync()
    }

    pub(super) fn trajectories_file(&self) -> PathBuf {
        self.folder.join(TRAJECTORIES_FILE)
    }

    /// How many walks cannot be taken.
    pub(super) fn failed_count(&self) -> usize {
        self.errors.len()
    }
}

fn key_of(line: &Value) -> Option<String> {
    Some(line.get("trajectory_id")?.as_str()?.to_owned())
}

/// Takes walks and makes their pictures.
pub(super) struct TrajectoryMaker<'a> {
    pub(super) folder: &'a Path,
    pub(super) scenes: &'a WalkingScenes,
    pub(super) steps: &'a StepExportSettings,
    /// Walks that an earlier command has taken.
    pub(super) done: BTreeSet<String>,
}

impl TrajectoryMaker<'_> {
    /// Makes one unit, a shard or a single walk, unless all of its walks are finished.
    pub(super) fn make_unit(
        &self,
        walks: &[ExportedWalk<'_>],
        unit: &[usize],
    ) -> Result<TrajectoryBatch, CommandError> {
        let is_done = |number: &usize| walks.get(*number).is_some_and(|walk| self.done.contains(&walk.path.id));
        let mut batch = TrajectoryBatch { taken: Vec::new(), failed: Vec::new() };
        if unit.iter().all(is_done) {
            return Ok(batch);
        }
        let mut trajectories = Vec::new();
        for number in unit {
            let Some(walk) = walks.get(*number) else { continue };
            match trajectory_from_walk(walk, self.scenes, self.steps, self.picture_place(*number, walk))? {
                Ok(trajectory) => trajectories.push((*number, trajectory)),
                Err(reason) => batch.failed.push(reason),
            }
        }
        // A shard is written anew only if a walk can be taken that could not before.
        if trajectories.iter().all(|(number, _)| is_done(number)) {
            return Ok(batch);
        }
        let mut ready = Vec::with_capacity(trajectories.len());
        for (number, trajectory) in trajectories {
            interrupt::check_interrupt()?;
            match self.take_pictures(&trajectory) {
                Ok(pictures) => ready.push((number, trajectory, pictures)),
                Err(error) => batch.failed.push(failed_item(&trajectory, error)?),
            }
        }
        batch.taken = match self.steps.shard {
            Some(walks_per_shard) => self.write_shard(ready, walks_per_shard)?,
            None => {
                ready.into_iter().map(|(_, walk, shown)| self.write_folder(walk, &shown)).collect::<Result<_, _>>()?
            }
        };
        Ok(batch)
    }

    fn picture_place(&self, number: usize, walk: &ExportedWalk<'_>) -> PictureLocation {
        match self.steps.shard {
            None => PictureLocation::Folder(format!("{IMAGES_FOLDER}/{}", walk.path.id)),
            Some(walks_per_shard) => {
                PictureLocation::Sample { shard: shard_file(number, walks_per_shard), key: format!("{number:06}") }
            }
        }
    }

    /// Takes the pictures that the agent sees before its actions.
    fn take_pictures(&self, trajectory: &ActionTrajectory) -> Result<Vec<Vec<u8>>, CommandError> {
        (0..trajectory.actions.len()).map(|number| take_picture(self.scenes, self.steps, trajectory, number)).collect()
    }

    fn write_folder(
        &self,
        mut trajectory: ActionTrajectory,
        pictures: &[Vec<u8>],
    ) -> Result<ActionTrajectory, CommandError> {
        let PictureLocation::Folder(images) = &trajectory.pictures else { return Ok(trajectory) };
        let whole = self.folder.join(images);
        let unfinished = self.folder.join(IMAGES_FOLDER).join(format!(".{}.part", trajectory.id));
        for old in [&unfinished, &whole] {
            if old.exists() {
                fs::remove_dir_all(old).map_err(CommandError::io(old, "remove what an earlier command left in"))?;
            }
        }
        if let Err(error) = write_pictures(&unfinished, pictures) {
            // The first failure is the one to report. What stays is removed by the next command.
            let _ = fs::remove_dir_all(&unfinished);
            return Err(error);
        }
        fs::rename(&unfinished, &whole).map_err(CommandError::io(&whole, "name"))?;
        trajectory.sha256 = PictureDigest::from_pictures(pictures);
        Ok(trajectory)
    }

    fn write_shard(
        &self,
        walks: Vec<(usize, ActionTrajectory, Vec<Vec<u8>>)>,
        walks_per_shard: usize,
    ) -> Result<Vec<ActionTrajectory>, CommandError> {
        let Some((first, ..)) = walks.first() else { return Ok(Vec::new()) };
        let file = self.folder.join(shard_file(*first, walks_per_shard));
        let folder = self.folder.join(SHARDS_FOLDER);
        fs::create_dir_all(&folder).map_err(CommandError::io(&folder, "make the folder"))?;
        let mut shard = ShardWriter::begin(&file).map_err(CommandError::io(&file, "write"))?;
        let mut taken = Vec::with_capacity(walks.len());
        for (number, mut trajectory, pictures) in walks {
            trajectory.sha256 = PictureDigest::from_pictures(&pictures);
            shard
                .add_walk(&format!("{number:06}"), &trajectory, &pictures)
                .map_err(CommandError::io(&file, "write"))?;
            taken.push(trajectory);
        }
        shard.finish().map_err(CommandError::io(&file, "write"))?;
        Ok(taken)
    }
}

/// Writes the pictures of a walk into a new folder.
fn write_pictures(folder: &Path, pictures: &[Vec<u8>]) -> Result<(), CommandError> {
    fs::create_dir_all(folder).map_err(CommandError::io(folder, "make the folder"))?;
    for (number, picture) in pictures.iter().enumerate() {
        let file = folder.join(picture_name(number));
        fs::write(&file, picture).map_err(CommandError::io(&file, "write"))?;
    }
    Ok(())
}

/// The walk as a failed item. Errors that do not concern this walk alone are passed on.
fn failed_item(trajectory: &ActionTrajectory, error: CommandError) -> Result<FailedItem, CommandError> {
    match error {
        CommandError::Platform(error) if error.failure_kind() != FailureKind::Lost => {
            let (item, failure) = (trajectory.id.clone(), error.failure_kind());
            Ok(FailedItem { item, failure, reason: error.to_string() })
        }
        other => Err(other),
    }
}

/// Takes the picture that the agent sees before an action, as JPEG.
pub(super) fn take_picture(
    scenes: &WalkingScenes,
    steps: &StepExportSettings,
    trajectory: &ActionTrajectory,
    number: usize,
) -> Result<Vec<u8>, CommandError> {
    let stance = (trajectory.positions[number], trajectory.headings[number]);
    let image = scenes.take_picture(&trajectory.scene, stance, steps.eye_m, steps.fov_deg.to_radians())?;
    encode_jpeg(&image, steps.jpeg_quality).map_err(|error| {
        CommandError::usage(format!("a picture cannot be written as JPEG: {error}"), "report this as a bug")
    })
}

/// The path of the shard that has a walk, below the folder of the export.
fn shard_file(number: usize, walks_per_shard: usize) -> String {
    format!("{SHARDS_FOLDER}/{:06}.tar", number / walks_per_shard)
}
