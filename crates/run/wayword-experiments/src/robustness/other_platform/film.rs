//! Turns the paths of a run into recordings: for each path a folder with the pictures along it and their poses.

use crate::robustness::base::BaseRun;
use image::RgbImage;
use serde_json::{Value, json};
use std::{fs, path::Path as FilePath};
use wayword_core::{Path, Platform, ViewGaze};
use wayword_run::{
    error::CommandError,
    in_order::{core_count, in_order},
    interrupt,
};

/// Horizontal field of view of the camera, degrees.
const FOV_DEG: f64 = 90.0;

/// The name of a path's recording.
pub(super) fn recording_name(path: &Path) -> String {
    path.id.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect()
}

/// Films all paths that have no recording yet.
///
/// # Errors
/// When a view has no picture, or a file cannot be written.
pub(super) fn film_paths(base: &BaseRun, world: &dyn Platform, folder: &FilePath) -> Result<(), CommandError> {
    let unfilmed: Vec<&Path> = base.paths.iter().filter(|path| !folder.join(recording_name(path)).is_dir()).collect();
    let filming = |path: &&Path| {
        interrupt::check_interrupt()?;
        film_path(path, world, folder)
    };
    in_order(&unfilmed, core_count(), filming, |_, made| made.map(|()| true))
}

fn film_path(path: &Path, world: &dyn Platform, folder: &FilePath) -> Result<(), CommandError> {
    let name = recording_name(path);
    // A film that was half made when the program was stopped is made again.
    let unfinished = folder.join(format!(".{name}"));
    let _ = fs::remove_dir_all(&unfinished);
    fs::create_dir_all(&unfinished).map_err(CommandError::io(&unfinished, "make the folder"))?;
    let mut poses: Vec<Value> = Vec::new();
    for (at, frame) in path.frames.iter().enumerate() {
        let gaze = ViewGaze { heading: frame.pose.heading, horizontal_fov_rad: FOV_DEG.to_radians() };
        let view = world.look_from(&path.scene, frame, gaze)?;
        let picture = view
            .image
            .as_ref()
            .and_then(|image| RgbImage::from_raw(image.width_px(), image.height_px(), image.rgb_bytes().to_vec()));
        let picture = picture.ok_or_else(|| {
            CommandError::usage(
                format!("path {}, frame {at}: the platform has no picture", path.id),
                "leave out platform=recording",
            )
        })?;
        let file = format!("{at:04}.png");
        let saved = unfinished.join(&file);
        picture
            .save(&saved)
            .map_err(|error| CommandError::usage(format!("{}: {error}", saved.display()), "make room on the disk"))?;
        let heading_deg = frame.pose.heading.rad().to_degrees();
        poses.push(json!({ "image": file, "position": frame.pose.position.to_array(), "heading_deg": heading_deg }));
    }
    let write = |file: &str, text: String| {
        let file = unfinished.join(file);
        fs::write(&file, text).map_err(CommandError::io(&file, "write"))
    };
    write("poses.json", Value::from(poses).to_string())?;
    write("recording.toml", format!("horizontal_fov_deg = {FOV_DEG}\nworld = \"z-up\"\norientation = \"robot\"\n"))?;
    let whole = folder.join(name);
    fs::rename(&unfinished, &whole).map_err(CommandError::io(&whole, "name the folder"))
}
