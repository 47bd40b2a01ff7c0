//! Makes the pictures of walks and stores them: in a folder for each walk, or several walks in one tar file (shard). The pictures are
//! written first and the walk's line in `trajectories.jsonl` last, so every walk with a line is complete.

use super::{
    settings::Steps,
    walks::{Walk, trajectory},
};
use crate::walking::Scenes;
use serde_json::Value;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};
use wayword_core::Failure;
use wayword_formats::trajectories::{Digest, Place, Shard, Trajectory, line, picture_name};
use wayword_run::{
    error::Error,
    interrupt,
    pictures::jpeg,
    run_folder::{FailedItem, Journal, file},
};

/// The file of trajectories.
pub(super) const TRAJECTORIES: &str = "trajectories.jsonl";
/// The folders of the pictures: one below `images` for each walk, or the tar files in `shards`.
const IMAGES: &str = "images";
const SHARDS: &str = "shards";

/// The folder of an export, with its journals of finished and failed walks.
pub(super) struct Store {
    folder: PathBuf,
    trajectories: Journal,
    errors: Journal,
}

/// The result of one unit: walks that are finished, and walks that failed.
pub(super) struct Made {
    taken: Vec<Trajectory>,
    failed: Vec<FailedItem>,
}

impl Store {
    /// Opens a folder and continues with its finished walks. Failed walks are tried again.
    pub(super) fn open(folder: &Path) -> Result<Self, Error> {
        Ok(Self {
            folder: folder.to_owned(),
            trajectories: Journal::open(&folder.join(TRAJECTORIES), key_of)?,
            errors: Journal::begin(&folder.join(file::ERRORS), FailedItem::key_of)?,
        })
    }

    /// The ids of the finished walks.
    pub(super) fn done(&self) -> BTreeSet<String> {
        self.trajectories.keys().map(str::to_owned).collect()
    }

    pub(super) fn keep(&mut self, made: &Made) -> Result<(), Error> {
        made.taken.iter().try_for_each(|taken| self.trajectories.append(&line(taken)))?;
        made.failed.iter().try_for_each(|failed| self.errors.append(failed))
    }

    /// Puts the lines into the order of the walks.
    pub(super) fn finish(&mut self, walks: &[Walk<'_>]) -> Result<(), Error> {
        let places: BTreeMap<&str, usize> =
            walks.iter().enumerate().map(|(place, walk)| (walk.path.id.as_str(), place)).collect();
        self.trajectories.arrange(|id| places.get(id).copied())?;
        self.trajectories.sync()
    }

    pub(super) fn file(&self) -> PathBuf {
        self.folder.join(TRAJECTORIES)
    }

    /// How many walks cannot be taken.
    pub(super) fn failed(&self) -> usize {
        self.errors.len()
    }
}

fn key_of(line: &Value) -> Option<String> {
    Some(line.get("trajectory_id")?.as_str()?.to_owned())
}

/// Takes walks and makes their pictures.
pub(super) struct Maker<'a> {
    pub(super) folder: &'a Path,
    pub(super) scenes: &'a Scenes,
    pub(super) steps: &'a Steps,
    /// Walks that an earlier command has taken.
    pub(super) done: BTreeSet<String>,
}

impl Maker<'_> {
    /// Makes one unit, a shard or a single walk, unless all of its walks are finished.
    pub(super) fn make(&self, walks: &[Walk<'_>], unit: &[usize]) -> Result<Made, Error> {
        let is_done = |number: &usize| walks.get(*number).is_some_and(|walk| self.done.contains(&walk.path.id));
        let mut made = Made { taken: Vec::new(), failed: Vec::new() };
        if unit.iter().all(is_done) {
            return Ok(made);
        }
        let mut begun = Vec::new();
        for number in unit {
            let Some(walk) = walks.get(*number) else { continue };
            match trajectory(walk, self.scenes, self.steps, self.place(*number, walk))? {
                Ok(trajectory) => begun.push((*number, trajectory)),
                Err(reason) => made.failed.push(reason),
            }
        }
        // A shard is written anew only if a walk can be taken that could not before.
        if begun.iter().all(|(number, _)| is_done(number)) {
            return Ok(made);
        }
        let mut ready = Vec::with_capacity(begun.len());
        for (number, trajectory) in begun {
            interrupt::check()?;
            match self.pictures(&trajectory) {
                Ok(pictures) => ready.push((number, trajectory, pictures)),
                Err(error) => made.failed.push(failed(&trajectory, error)?),
            }
        }
        made.taken = match self.steps.shard {
            Some(of) => self.write_shard(ready, of)?,
            None => {
                ready.into_iter().map(|(_, walk, shown)| self.write_folder(walk, &shown)).collect::<Result<_, _>>()?
            }
        };
        Ok(made)
    }

    fn place(&self, number: usize, walk: &Walk<'_>) -> Place {
        match self.steps.shard {
            None => Place::Folder(format!("{IMAGES}/{}", walk.path.id)),
            Some(of) => Place::Sample { shard: shard_of(number, of), key: format!("{number:06}") },
        }
    }

    /// Takes the pictures that the agent sees before its actions.
    fn pictures(&self, trajectory: &Trajectory) -> Result<Vec<Vec<u8>>, Error> {
        (0..trajectory.actions.len()).map(|number| picture(self.scenes, self.steps, trajectory, number)).collect()
    }

    fn write_folder(&self, mut trajectory: Trajectory, pictures: &[Vec<u8>]) -> Result<Trajectory, Error> {
        let Place::Folder(images) = &trajectory.pictures else { return Ok(trajectory) };
        let whole = self.folder.join(images);
        let begun = self.folder.join(IMAGES).join(format!(".{}.part", trajectory.id));
        for old in [&begun, &whole] {
            if old.exists() {
                fs::remove_dir_all(old).map_err(Error::io(old, "remove what an earlier command left in"))?;
            }
        }
        fs::create_dir_all(&begun).map_err(Error::io(&begun, "make the folder"))?;
        for (number, picture) in pictures.iter().enumerate() {
            let file = begun.join(picture_name(number));
            fs::write(&file, picture).map_err(Error::io(&file, "write"))?;
        }
        fs::rename(&begun, &whole).map_err(Error::io(&whole, "name"))?;
        trajectory.sha256 = Digest::of(pictures);
        Ok(trajectory)
    }

    fn write_shard(&self, walks: Vec<(usize, Trajectory, Vec<Vec<u8>>)>, of: usize) -> Result<Vec<Trajectory>, Error> {
        let Some((first, ..)) = walks.first() else { return Ok(Vec::new()) };
        let file = self.folder.join(shard_of(*first, of));
        let folder = self.folder.join(SHARDS);
        fs::create_dir_all(&folder).map_err(Error::io(&folder, "make the folder"))?;
        let mut shard = Shard::begin(&file).map_err(Error::io(&file, "write"))?;
        let mut taken = Vec::with_capacity(walks.len());
        for (number, mut trajectory, pictures) in walks {
            trajectory.sha256 = Digest::of(&pictures);
            shard.add(&format!("{number:06}"), &trajectory, &pictures).map_err(Error::io(&file, "write"))?;
            taken.push(trajectory);
        }
        shard.finish().map_err(Error::io(&file, "write"))?;
        Ok(taken)
    }
}

/// The walk as a failed item. Errors that do not concern this walk alone are passed on.
fn failed(trajectory: &Trajectory, error: Error) -> Result<FailedItem, Error> {
    match error {
        Error::Platform(error) if error.failure() != Failure::Lost => {
            let (item, failure) = (trajectory.id.clone(), error.failure());
            Ok(FailedItem { item, failure, reason: error.to_string() })
        }
        other => Err(other),
    }
}

/// Takes the picture that the agent sees before an action, as JPEG.
pub(super) fn picture(
    scenes: &Scenes,
    steps: &Steps,
    trajectory: &Trajectory,
    number: usize,
) -> Result<Vec<u8>, Error> {
    let stance = (trajectory.positions[number], trajectory.headings[number]);
    let image = scenes.picture(&trajectory.scene, stance, steps.eye_m, steps.fov_deg.to_radians())?;
    jpeg(&image, steps.jpeg_quality)
        .map_err(|error| Error::usage(format!("a picture cannot be written as JPEG: {error}"), "report this as a bug"))
}

fn shard_of(number: usize, of: usize) -> String {
    format!("{SHARDS}/{:06}.tar", number / of)
}
