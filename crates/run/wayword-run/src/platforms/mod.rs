//! Opens platforms by their names. `listing` has all of them.

mod listing;
#[cfg(feature = "live")]
mod live;
mod python_worlds;
mod remembering;
mod scene_names;

use crate::{
    error::CommandError,
    output,
    settings::{AskedPlatform, RunSettings, refuse_credentials},
    similar::did_you_mean,
    stores,
};
use std::{path::Path, sync::Arc};
use wayword_core::Platform;
#[cfg(feature = "habitat")]
use wayword_habitat::{HabitatOptions, HabitatPlatform};
use wayword_house::HousePlatform;
use wayword_platforms::{matterport::MatterportPlatform, process};
use wayword_recording::RecordingPlatform;

pub(crate) use listing::platform_names;
pub use listing::{PLATFORMS, PlatformListing};
pub use python_worlds::{register_world, unregister_world};
pub use remembering::RememberingPlatform;
pub use scene_names::suggest_scene;

/// Number of scene surveys that a command keeps in memory.
pub const MAX_KEPT_SURVEYS: usize = 128;

/// Whether random paths of a platform can have hops. Elsewhere they run over open ground, and `--hops` has no effect. A
/// recording with poses has none either, but whether it has poses is known only once it is opened.
pub fn has_hops(settings: &RunSettings) -> bool {
    settings.connectivity.is_some() || matches!(&*settings.platform, "matterport" | "process" | "recording")
}

/// Whether a platform is a separate program that this one connects to by `--at`.
pub(crate) fn is_live(name: &str) -> bool {
    matches!(name, "tdw" | "virtualhome")
}

/// Where the scenes of a platform are, from flags or settings.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PlatformPlace<'a> {
    /// The folder or file of its data.
    pub data: Option<&'a Path>,
    /// The address of a running simulator.
    pub at: Option<&'a str>,
    /// The island of a Habitat navmesh on which paths are drawn.
    pub island: Option<usize>,
    /// The folder of viewpoint graphs along which Habitat's scenes are walked.
    pub connectivity: Option<&'a Path>,
}

impl<'a> From<&'a AskedPlatform> for PlatformPlace<'a> {
    fn from(asked: &'a AskedPlatform) -> Self {
        let AskedPlatform { platform: _, data, at, island, connectivity } = asked;
        Self { data: data.as_deref(), at: at.as_deref(), island: *island, connectivity: connectivity.as_deref() }
    }
}

impl<'a> From<&'a RunSettings> for PlatformPlace<'a> {
    fn from(settings: &'a RunSettings) -> Self {
        let RunSettings { data, at, island, connectivity, .. } = settings;
        Self { data: data.as_deref(), at: at.as_deref(), island: *island, connectivity: connectivity.as_deref() }
    }
}

/// Opens the platform that the settings name, and warns if its data lacks objects.
///
/// # Errors
/// When there is no platform of that name, or its data cannot be opened.
pub fn open_platform(settings: &RunSettings) -> Result<Box<dyn Platform>, CommandError> {
    open_and_warn(&settings.platform, PlatformPlace::from(settings))
}

/// As [`open_at`], and warns if the data has no files with objects.
///
/// # Errors
/// As [`open_at`].
pub fn open_and_warn(name: &str, place: PlatformPlace<'_>) -> Result<Box<dyn Platform>, CommandError> {
    let platform = open_at(name, place)?;
    if name == "matterport"
        && let Some(data) = place.data
        && let Some(lack) = MatterportPlatform::lack_of_objects(&stores::local_data(data)?)
    {
        output::print_foreign_line(&lack);
    }
    Ok(platform)
}

/// The edges that the viewpoint graphs of the settings' data have in one direction alone, in a line for the user; `None` if there are
/// none. The program walks them in both directions.
pub fn one_way_edges(settings: &RunSettings) -> Option<String> {
    if let Some(folder) = &settings.connectivity {
        return wayword_world::connectivity::describe_one_way_edges(&stores::local_data(folder).ok()?);
    }
    let data = settings.data.as_ref().filter(|_| settings.platform == "matterport")?;
    MatterportPlatform::one_way_edges(&stores::local_data(data).ok()?)
}

/// Opens a platform by its name, with the folder or file of its data, or the address of a running one, and the island
/// of its navmesh on which paths are drawn.
///
/// # Errors
/// When there is none of that name in this build, or its data cannot be opened.
pub fn open_named(
    name: &str,
    data: Option<&Path>,
    at: Option<&str>,
    island: Option<usize>,
) -> Result<Box<dyn Platform>, CommandError> {
    open_at(name, PlatformPlace { data, at, island, ..PlatformPlace::default() })
}

/// Opens a platform by its name, with where its scenes are.
///
/// # Errors
/// When there is none of that name in this build, its data cannot be opened, or it does not use a part of `place`.
pub fn open_at(name: &str, place: PlatformPlace<'_>) -> Result<Box<dyn Platform>, CommandError> {
    let PlatformPlace { data, at, island, connectivity } = place;
    at.map_or(Ok(()), |at| refuse_credentials("--at", at))?;
    if let Some((flag, example)) = unused_flag(name, place) {
        let default = if name == "house" { ", the default," } else { "" };
        return Err(CommandError::usage(
            format!("platform {name}{default} takes no {flag}"),
            format!("say with --platform which platform this {flag} is for, as in --platform {example}"),
        ));
    }
    if island.is_some() && connectivity.is_some() {
        return Err(CommandError::usage(
            "--island and --connectivity cannot be combined: a scene with a graph is not walked on a navmesh",
            "give one of them",
        ));
    }
    let data = || data.ok_or_else(|| missing_data_error(name)).and_then(stores::local_data);
    match name {
        "house" => Ok(Box::new(HousePlatform::default())),
        "matterport" => Ok(Box::new(MatterportPlatform::open(&data()?)?)),
        "process" => open_child(&data()?),
        #[cfg(feature = "habitat")]
        "habitat" => {
            let connectivity = connectivity.map(Path::to_owned);
            let options = HabitatOptions { island, connectivity, ..HabitatOptions::default() };
            Ok(Box::new(HabitatPlatform::open(&data()?, options, Arc::new(output::print_foreign_line))?))
        }
        #[cfg(feature = "live")]
        "tdw" => live::open_tdw(place.data, place.at),
        #[cfg(feature = "live")]
        "virtualhome" => live::open_virtualhome(place.at),
        "recording" => Ok(Box::new(RecordingPlatform::open(&data()?, Arc::new(output::print_foreign_line))?)),
        absent if PLATFORMS.iter().any(|platform| platform.name == absent) => {
            Err(CommandError::not_built(format!("this build has no platform {absent}")))
        }
        other => Err(CommandError::usage(
            format!("there is no platform {other:?}{}", did_you_mean(other, platform_names())),
            format!("name one of: {}", platform_names().join(", ")),
        )),
    }
}

/// A platform that is another program, or an object of the program that this one runs in. If this program is killed, a second
/// copy of it ends the other program.
fn open_child(file: &Path) -> Result<Box<dyn Platform>, CommandError> {
    if let Some(options) = python_worlds::find_registered_world(file)? {
        return Ok(Box::new(process::ProcessPlatform::start(options, Arc::new(output::print_foreign_line))?));
    }
    let options =
        process::ProcessOptions { guard: process::this_program(), ..process::ProcessOptions::read_world_file(file)? };
    Ok(Box::new(process::ProcessPlatform::start(options, Arc::new(output::print_foreign_line))?))
}

/// The flag that a platform does not use, and one of the platforms that use it. Otherwise `--data` without `--platform`
/// would silently give a generated house.
fn unused_flag(name: &str, place: PlatformPlace<'_>) -> Option<(&'static str, &'static str)> {
    match (place.data, place.at) {
        (Some(_), _) if matches!(name, "house" | "virtualhome") => Some(("--data", "matterport")),
        (_, Some(_)) if !is_live(name) => Some(("--at", "tdw")),
        _ if place.island.is_some() && name != "habitat" => Some(("--island", "habitat")),
        _ if place.connectivity.is_some() && name != "habitat" => Some(("--connectivity", "habitat")),
        _ => None,
    }
}

/// The error for a platform that was asked for without its data.
pub fn missing_data_error(name: &str) -> CommandError {
    let needs = PLATFORMS.into_iter().find(|platform| platform.name == name).map_or("", |platform| platform.needs);
    CommandError::usage(format!("platform {name} needs --data"), format!("give {needs}"))
}
