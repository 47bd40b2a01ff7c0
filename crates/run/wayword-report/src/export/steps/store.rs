//! A folder of steps: its walks, and the pictures of each camera. The pictures of a walk are written first and its line in the camera's
//! `pictures.jsonl` last, so every walk with a line is complete. Cameras can be added later.

use super::{
    drawing::{DrawnWalk, draw_walk},
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
    ActionTrajectory, CameraIntrinsics, CameraWalk, PictureDigest, PictureKind, PictureLocation, PictureSet,
    ShardWriter, camera_walk_line, read_camera_walks, read_trajectories, trajectory_line,
};
use wayword_run::{
    error::CommandError,
    interrupt,
    run_folder::{FailedItem, Journal, file},
    written_files::write_file,
};

/// The file of trajectories.
pub(super) const TRAJECTORIES_FILE: &str = "trajectories.jsonl";
/// The folder with a folder for each camera.
const CAMERAS_FOLDER: &str = "cameras";
/// The files of a camera: its intrinsics, and a line for each walk.
const CAMERA_FILE: &str = "camera.json";
const PICTURES_FILE: &str = "pictures.jsonl";
/// The folder of a camera's shards.
const SHARDS_FOLDER: &str = "shards";

/// The folder of a camera, below that of the steps.
pub(super) fn camera_folder(camera: &CameraIntrinsics) -> String {
    format!("{CAMERAS_FOLDER}/{}", camera.name())
}

/// The file with a camera's line for each walk.
pub(super) fn pictures_file(folder: &Path, camera: &CameraIntrinsics) -> PathBuf {
    folder.join(camera_folder(camera)).join(PICTURES_FILE)
}

/// The cameras that a folder of steps has.
pub(super) fn read_cameras(folder: &Path) -> Result<Vec<CameraIntrinsics>, CommandError> {
    let place = folder.join(CAMERAS_FOLDER);
    let entries = fs::read_dir(&place).map_err(CommandError::io(&place, "look into"))?;
    let mut files = entries
        .map(|entry| Ok(entry.map_err(CommandError::io(&place, "look into"))?.path().join(CAMERA_FILE)))
        .collect::<Result<Vec<_>, CommandError>>()?;
    files.sort();
    files.iter().filter(|file| file.is_file()).map(|file| read_camera(file)).collect()
}

fn read_camera(file: &Path) -> Result<CameraIntrinsics, CommandError> {
    let text = fs::read(file).map_err(CommandError::io(file, "read"))?;
    serde_json::from_slice(&text).map_err(|error| {
        let problem = format!("{}: it does not describe a camera: {error}", file.display());
        CommandError::usage(problem, "give a folder that `wayword export --format steps` wrote")
    })
}

/// The journals of a folder of steps.
pub(super) struct TrajectoryStore {
    trajectories: Journal,
    /// The finished walks of each camera.
    pictures: Vec<Journal>,
    errors: Journal,
}

/// The result of one unit: walks and their pictures that are new, and walks that failed.
#[derive(Default)]
pub(super) struct TrajectoryBatch {
    taken: Vec<ActionTrajectory>,
    /// Each with the index of its camera.
    pictured: Vec<(usize, CameraWalk)>,
    failed: Vec<FailedItem>,
}

impl TrajectoryStore {
    /// Opens a folder and continues with its finished walks. Failed walks are tried again.
    pub(super) fn open(folder: &Path, cameras: &[CameraIntrinsics]) -> Result<Self, CommandError> {
        let open_camera = |camera: &CameraIntrinsics| {
            let place = folder.join(camera_folder(camera));
            fs::create_dir_all(&place).map_err(CommandError::io(&place, "make the folder"))?;
            let text = serde_json::to_string_pretty(camera).unwrap_or_default() + "\n";
            write_file(&place.join(CAMERA_FILE), text)?;
            Journal::open(&pictures_file(folder, camera), key_of)
        };
        Ok(Self {
            trajectories: Journal::open(&folder.join(TRAJECTORIES_FILE), key_of)?,
            pictures: cameras.iter().map(open_camera).collect::<Result<_, _>>()?,
            errors: Journal::begin_empty(&folder.join(file::ERRORS), FailedItem::key_of)?,
        })
    }

    /// Writes the lines of the walks of a unit.
    pub(super) fn keep_batch(&mut self, batch: &TrajectoryBatch) -> Result<(), CommandError> {
        batch.taken.iter().try_for_each(|taken| self.trajectories.append(&trajectory_line(taken)))?;
        for (camera, walk) in &batch.pictured {
            self.pictures[*camera].append(&camera_walk_line(walk))?;
        }
        batch.failed.iter().try_for_each(|failed| self.errors.append(failed))
    }

    /// Puts the lines into the order of the walks.
    pub(super) fn sort_and_sync(&mut self, walks: &[ExportedWalk<'_>]) -> Result<(), CommandError> {
        let places: BTreeMap<&str, usize> =
            walks.iter().enumerate().map(|(place, walk)| (walk.path.id.as_str(), place)).collect();
        for journal in self.pictures.iter_mut().chain([&mut self.trajectories]) {
            journal.arrange_by(|id| places.get(id).copied())?;
            journal.sync()?;
        }
        Ok(())
    }

    /// How many walks cannot be taken.
    pub(super) fn failed_count(&self) -> usize {
        self.errors.len()
    }
}

fn key_of(line: &Value) -> Option<String> {
    Some(line.get("trajectory_id")?.as_str()?.to_owned())
}

/// A walk with its number among all.
type NumberedWalk = (usize, ActionTrajectory);

/// Takes walks and draws what the cameras see along them.
pub(super) struct TrajectoryMaker<'a> {
    folder: &'a Path,
    scenes: &'a WalkingScenes,
    pub(super) steps: &'a StepExportSettings,
    cameras: &'a [CameraIntrinsics],
    /// Walks that an earlier command has taken.
    done: BTreeMap<String, ActionTrajectory>,
    /// The walks that each camera has seen already.
    pictured: Vec<BTreeSet<String>>,
}

impl<'a> TrajectoryMaker<'a> {
    /// Prepares to continue a folder.
    ///
    /// # Errors
    /// When the folder has walks that the run does not have, or its file cannot be read.
    pub(super) fn continue_folder(
        folder: &'a Path,
        scenes: &'a WalkingScenes,
        steps: &'a StepExportSettings,
        cameras: &'a [CameraIntrinsics],
        (store, walks): (&TrajectoryStore, &[ExportedWalk<'_>]),
    ) -> Result<Self, CommandError> {
        let hashes: BTreeMap<&str, String> =
            walks.iter().map(|walk| (walk.path.id.as_str(), walk.path_sha256())).collect();
        let mut done = BTreeMap::new();
        for trajectory in read_trajectories(&folder.join(TRAJECTORIES_FILE))? {
            if hashes.get(trajectory.id.as_str()) != Some(&trajectory.path_sha256) {
                let problem =
                    format!("{} holds walk {}, which is not of these runs' texts", folder.display(), trajectory.id);
                return Err(CommandError::usage(problem, "give a new folder"));
            }
            done.insert(trajectory.id.clone(), trajectory);
        }
        let numbers: BTreeMap<&str, usize> =
            walks.iter().enumerate().map(|(number, walk)| (walk.path.id.as_str(), number)).collect();
        let mut pictured = Vec::with_capacity(cameras.len());
        for (camera, journal) in cameras.iter().zip(&store.pictures) {
            let mut complete = BTreeSet::new();
            if !journal.is_empty() {
                for walk in read_camera_walks(&pictures_file(folder, camera))? {
                    refuse_moved_sample(folder, &walk, &numbers)?;
                    if has_pictures(folder, &walk) {
                        complete.insert(walk.trajectory_id);
                    }
                }
            }
            pictured.push(complete);
        }
        Ok(Self { folder, scenes, steps, cameras, done, pictured })
    }

    /// Makes one unit, a shard or a single walk, as far as it is not finished.
    pub(super) fn make_unit(
        &self,
        walks: &[ExportedWalk<'_>],
        unit: &[usize],
    ) -> Result<TrajectoryBatch, CommandError> {
        let mut batch = TrajectoryBatch::default();
        let mut taken: Vec<NumberedWalk> = Vec::new();
        for (number, walk) in unit.iter().filter_map(|number| Some((*number, walks.get(*number)?))) {
            let trajectory = match self.done.get(&walk.path.id) {
                Some(done) => Ok(done.clone()),
                None => trajectory_from_walk(walk, self.scenes, self.steps)?,
            };
            match trajectory {
                Ok(trajectory) => taken.push((number, trajectory)),
                Err(reason) => batch.failed.push(reason),
            }
        }
        for index in 0..self.cameras.len() {
            // A shard is written anew only if a walk can be taken that could not before.
            if !taken.iter().all(|(_, trajectory)| self.pictured[index].contains(&trajectory.id)) {
                taken = self.picture_walks(index, taken, &mut batch)?;
            }
        }
        let new = taken.into_iter().map(|(_, trajectory)| trajectory);
        batch.taken = new.filter(|trajectory| !self.done.contains_key(&trajectory.id)).collect();
        Ok(batch)
    }

    /// Draws and writes what a camera sees along the walks of a unit. Returns the walks that it can see; the others fail.
    fn picture_walks(
        &self,
        index: usize,
        taken: Vec<NumberedWalk>,
        batch: &mut TrajectoryBatch,
    ) -> Result<Vec<NumberedWalk>, CommandError> {
        let camera = &self.cameras[index];
        let (mut seen, mut drawn) = (Vec::new(), Vec::new());
        for (number, trajectory) in taken {
            interrupt::check_interrupt()?;
            match draw_walk(self.scenes, camera, self.steps.jpeg_quality, &trajectory) {
                Ok(pictures) => {
                    seen.push((number, trajectory));
                    drawn.push(pictures);
                }
                Err(error) => batch.failed.push(failed_item(&trajectory, error)?),
            }
        }
        let walks = seen.iter().zip(drawn);
        let written: Vec<CameraWalk> = match self.steps.shard {
            Some(walks_per_shard) => self.write_shard(camera, walks.collect(), walks_per_shard)?,
            None => walks
                .map(|((_, trajectory), pictures)| self.write_folders(camera, trajectory, pictures))
                .collect::<Result<_, _>>()?,
        };
        batch.pictured.extend(written.into_iter().map(|walk| (index, walk)));
        Ok(seen)
    }

    /// Writes what a camera sees along a walk into a folder for each kind.
    fn write_folders(
        &self,
        camera: &CameraIntrinsics,
        trajectory: &ActionTrajectory,
        drawn: DrawnWalk,
    ) -> Result<CameraWalk, CommandError> {
        let place = |kind: PictureKind| format!("{}/{}/{}", camera_folder(camera), kind.name(), trajectory.id);
        for (kind, pictures) in drawn.kinds() {
            self.write_folder(&place(kind), kind, pictures)?;
        }
        Ok(camera_walk(trajectory, drawn, |kind| PictureLocation::Folder(place(kind))))
    }

    fn write_folder(&self, place: &str, kind: PictureKind, pictures: &[Vec<u8>]) -> Result<(), CommandError> {
        let whole = self.folder.join(place);
        let name = whole.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let unfinished = whole.with_file_name(format!(".{name}.part"));
        for old in [&unfinished, &whole] {
            if old.exists() {
                fs::remove_dir_all(old).map_err(CommandError::io(old, "remove what an earlier command left in"))?;
            }
        }
        if let Err(error) = write_pictures(&unfinished, kind, pictures) {
            // The first failure is the one to report. What stays is removed by the next command.
            let _ = fs::remove_dir_all(&unfinished);
            return Err(error);
        }
        fs::rename(&unfinished, &whole).map_err(CommandError::io(&whole, "name"))
    }

    fn write_shard(
        &self,
        camera: &CameraIntrinsics,
        walks: Vec<(&NumberedWalk, DrawnWalk)>,
        walks_per_shard: usize,
    ) -> Result<Vec<CameraWalk>, CommandError> {
        let Some(((first, _), _)) = walks.first() else { return Ok(Vec::new()) };
        let folder = format!("{}/{SHARDS_FOLDER}", camera_folder(camera));
        let place = self.folder.join(&folder);
        fs::create_dir_all(&place).map_err(CommandError::io(&place, "make the folder"))?;
        let name = format!("{folder}/{:06}.tar", first / walks_per_shard);
        let file = self.folder.join(&name);
        let failed = || CommandError::io(&file, "write");
        let mut shard = ShardWriter::begin(&file).map_err(failed())?;
        let mut written = Vec::with_capacity(walks.len());
        for ((number, trajectory), drawn) in walks {
            let key = sample_key(*number);
            shard.add_walk(&key, trajectory, &drawn.kinds()).map_err(failed())?;
            let place = |_| PictureLocation::Sample { shard: name.clone(), key: key.clone() };
            written.push(camera_walk(trajectory, drawn, place));
        }
        shard.finish().map_err(failed())?;
        Ok(written)
    }
}

/// Refuses a shard with a walk that has another number now: new walks would be written over it.
fn refuse_moved_sample(folder: &Path, walk: &CameraWalk, numbers: &BTreeMap<&str, usize>) -> Result<(), CommandError> {
    let PictureLocation::Sample { key, .. } = &walk.rgb.place else { return Ok(()) };
    if numbers.get(walk.trajectory_id.as_str()).is_some_and(|number| sample_key(*number) == *key) {
        return Ok(());
    }
    let problem = format!("{}: the run has got other walks, and shards are written once", folder.display());
    Err(CommandError::usage(problem, "give a new folder, or export without --shard"))
}

fn sample_key(number: usize) -> String {
    format!("{number:06}")
}

/// Whether the files of a walk's pictures are there. What is in them is compared with its hash when they are read.
fn has_pictures(folder: &Path, walk: &CameraWalk) -> bool {
    [PictureKind::Rgb, PictureKind::Depth].into_iter().all(|kind| match &walk.pictures(kind).place {
        PictureLocation::Folder(place) => {
            let count = fs::read_dir(folder.join(place)).map_or(0, Iterator::count);
            count == walk.world_from_camera.len()
        }
        PictureLocation::Sample { shard, .. } => folder.join(shard).is_file(),
    })
}

/// The line of a camera about a walk, once its pictures are written.
fn camera_walk(
    trajectory: &ActionTrajectory,
    drawn: DrawnWalk,
    place: impl Fn(PictureKind) -> PictureLocation,
) -> CameraWalk {
    let [rgb, depth] = drawn
        .kinds()
        .map(|(kind, pictures)| PictureSet { place: place(kind), sha256: PictureDigest::from_pictures(pictures) });
    CameraWalk {
        trajectory_id: trajectory.id.clone(),
        world_from_camera: drawn.world_from_camera,
        rgb,
        depth,
        pixel_goals: drawn.pixel_goals,
    }
}

/// Writes the pictures of a walk into a new folder.
fn write_pictures(folder: &Path, kind: PictureKind, pictures: &[Vec<u8>]) -> Result<(), CommandError> {
    fs::create_dir_all(folder).map_err(CommandError::io(folder, "make the folder"))?;
    for (number, picture) in pictures.iter().enumerate() {
        let file = folder.join(kind.file_name(number));
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
