//! `wayword view`: draws panoramas, maps and paths of a platform's scenes.

pub mod args;
mod file_kind;
mod film;
mod map;
pub mod panorama;
pub mod path;
pub mod picture;
pub mod unfinished;
mod walk;

use crate::view::args::{View, ViewCommand};
use serde::Serialize;
use std::{fmt, path::PathBuf};
use wayword_core::{Island, Platform, SceneId};
use wayword_run::{
    count::count,
    error::{Error, Exit},
    output::Output,
    platforms,
    settings::AskedPlatform,
};

/// Result of a view: the written files and their size.
#[derive(Debug, Serialize)]
struct Written {
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
    islands: Vec<Island>,
}

impl fmt::Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for file in &self.files {
            writeln!(f, "{}", file.display())?;
        }
        let frames = if self.frames == 1 { String::new() } else { format!(", {}", count(self.frames, "frame")) };
        write!(f, "{}: {} x {} pixels{frames}", self.scene, self.width, self.height)?;
        for island in &self.islands {
            write!(f, "\n{island}{}", if island.is_walked { ", used for random paths" } else { "" })?;
        }
        Ok(())
    }
}

pub fn run(args: &View, output: &Output) -> Result<Exit, Error> {
    let written = match &args.command {
        ViewCommand::Panorama(args) => panorama::write(args, output)?,
        ViewCommand::Path(args) => path::write(args, output)?,
        ViewCommand::Map(args) => map::write(args, output)?,
    };
    output.data(&written, &written);
    Ok(Exit::Done)
}

pub fn open(asked: &AskedPlatform) -> Result<Box<dyn Platform>, Error> {
    platforms::open_at(asked.name(), asked.into())
}

/// The scene with this name, or the platform's first if there is no name.
fn scene(platform: &dyn Platform, name: Option<&str>) -> Result<SceneId, Error> {
    match name {
        Some(name) => SceneId::new(name)
            .map_err(|error| Error::usage(format!("--scan {name}: {error}"), "give the name of a scene")),
        None => platform
            .scenes()?
            .into_iter()
            .next()
            .ok_or_else(|| Error::usage("the platform offers no scene", "check --data")),
    }
}
