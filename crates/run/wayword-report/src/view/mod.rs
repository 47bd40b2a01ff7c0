//! `wayword view`: draws panoramas, maps and paths of a platform's scenes.

pub mod args;
mod file_kind;
pub(crate) mod film;
mod map;
pub mod panorama;
pub mod path;
pub mod picture;
mod walk;

use crate::view::args::{ViewArgs, ViewCommand};
use serde::Serialize;
use std::{
    fmt,
    path::{Path, PathBuf},
};
use wayword_core::{GroundIsland, Platform, SceneId};
use wayword_run::{
    count::count_phrase,
    error::{CommandError, Exit},
    output::CommandOutput,
    platforms, run_folder,
    settings::{AskedPlatform, RunSettings},
};

/// Result of a view: the written files and their size.
#[derive(Debug, Serialize)]
struct WrittenView {
    scene: SceneId,
    /// The files; several are in the order of the path.
    files: Vec<PathBuf>,
    /// Pixels, or units of an SVG.
    width: u32,
    height: u32,
    /// How many pictures, in order.
    frames: usize,
    /// The islands of the scene, if a map is drawn and the platform knows them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    islands: Vec<GroundIsland>,
}

impl fmt::Display for WrittenView {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for file in &self.files {
            writeln!(f, "{}", file.display())?;
        }
        let frames = if self.frames == 1 { String::new() } else { format!(", {}", count_phrase(self.frames, "frame")) };
        write!(f, "{}: {} x {} pixels{frames}", self.scene, self.width, self.height)?;
        for island in &self.islands {
            write!(f, "\n{island}{}", if island.is_walked { ", used for random paths" } else { "" })?;
        }
        Ok(())
    }
}

/// Runs `wayword view`: draws a panorama, a path or a map, and prints the written files.
///
/// # Errors
/// When the platform cannot be opened or lacks the scene or the path, or a file cannot be written.
pub fn run_view(args: &ViewArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    let written = match &args.command {
        ViewCommand::Panorama(args) => panorama::write_panorama(args, output)?,
        ViewCommand::Path(args) => path::write_path(args, output)?,
        ViewCommand::Map(args) => map::write_map(args, output)?,
    };
    output.print_result(&written, &written);
    Ok(Exit::Done)
}

/// Opens the platform that the flags ask for.
///
/// # Errors
/// When flags do not fit the platform, or its data cannot be read.
pub fn open_platform(asked: &AskedPlatform) -> Result<Box<dyn Platform>, CommandError> {
    platforms::open_at(asked.name(), asked.into())
}

/// The platform that the flags ask for. With the texts of a run and no flag, it is the platform of that run.
fn platform_of_texts(asked: &AskedPlatform, episodes: Option<&Path>) -> AskedPlatform {
    let run = episodes.and_then(Path::parent).filter(|_| *asked == AskedPlatform::default());
    match run.and_then(|run| run_folder::read_run_settings(run).ok()) {
        Some(RunSettings { platform, data, at, island, connectivity, .. }) => {
            AskedPlatform { platform: Some(platform), data, at, island, connectivity }
        }
        None => asked.clone(),
    }
}

/// The scene with this name, or the platform's first if there is no name.
fn choose_scene(platform: &dyn Platform, name: Option<&str>) -> Result<SceneId, CommandError> {
    match name {
        Some(name) => {
            let scene = SceneId::new(name)
                .map_err(|error| CommandError::usage(format!("--scan {name}: {error}"), "give the name of a scene"))?;
            platform.graph_for_scene(&scene).map_err(|error| platforms::suggest_scene(error.into(), platform))?;
            Ok(scene)
        }
        None => platform
            .list_scenes()?
            .into_iter()
            .next()
            .ok_or_else(|| CommandError::usage("the platform offers no scene", "check --data")),
    }
}
