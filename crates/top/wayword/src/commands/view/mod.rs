//! `wayword view`.

mod file_kind;
mod film;
mod map;
mod panorama;
mod path;
mod picture;
mod unfinished;
mod walk;

use crate::{
    cli::{View, ViewCommand},
    count::count,
    error::{Error, Exit},
    output::Output,
    settings::World,
    world,
};
use serde::Serialize;
use std::{fmt, path::PathBuf};
use wayword_core::{Island, Platform, SceneId};

/// What was written.
#[derive(Debug, Serialize)]
struct Written {
    scene: SceneId,
    /// The files, in the order of the walk where there are several.
    files: Vec<PathBuf>,
    /// Pixels, or units of an SVG.
    width: u32,
    height: u32,
    /// Pictures, one after the other.
    frames: usize,
    /// The pieces of ground of the scene, where a map is drawn and the world knows them.
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
            write!(f, "\n{island}{}", if island.is_walked { ", which walks keep to" } else { "" })?;
        }
        Ok(())
    }
}

pub(super) fn run(args: &View, output: &Output) -> Result<Exit, Error> {
    let written = match &args.command {
        ViewCommand::Panorama(args) => panorama::write(args, output)?,
        ViewCommand::Path(args) => path::write(args, output)?,
        ViewCommand::Map(args) => map::write(args, output)?,
    };
    output.data(&written, &written);
    Ok(Exit::Done)
}

fn open(world: &World) -> Result<Box<dyn Platform>, Error> {
    world::open_named(world.name(), world.data.as_deref(), world.at.as_deref(), world.island)
}

/// The scene of a name, or the world's first.
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
