//! Turns the paths of a run into recordings: for each path a folder with the pictures along it and their poses.

use crate::robustness::base::Base;
use image::RgbImage;
use serde_json::{Value, json};
use std::{fs, path::Path as FilePath};
use wayword_core::{Gaze, Path, Platform};
use wayword_run::{
    error::Error,
    in_order::{cores, in_order},
    interrupt,
};

/// Horizontal field of view of the camera, degrees.
const FOV_DEG: f64 = 90.0;

/// The name of a path's recording.
pub(super) fn name(path: &Path) -> String {
    path.id.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect()
}

/// Films all paths that have no recording yet.
///
/// # Errors
/// When a view has no picture, or a file cannot be written.
pub(super) fn make(base: &Base, world: &dyn Platform, folder: &FilePath) -> Result<(), Error> {
    let left: Vec<&Path> = base.paths.iter().filter(|path| !folder.join(name(path)).is_dir()).collect();
    let filming = |path: &&Path| {
        interrupt::check()?;
        film(path, world, folder)
    };
    in_order(&left, cores(), filming, |_, made| made.map(|()| true))
}

fn film(path: &Path, world: &dyn Platform, folder: &FilePath) -> Result<(), Error> {
    let name = name(path);
    // A film that was half made when the program was stopped is made again.
    let unfinished = folder.join(format!(".{name}"));
    let _ = fs::remove_dir_all(&unfinished);
    fs::create_dir_all(&unfinished).map_err(Error::io(&unfinished, "make the folder"))?;
    let mut poses: Vec<Value> = Vec::new();
    for (at, frame) in path.frames.iter().enumerate() {
        let gaze = Gaze { heading: frame.pose.heading, horizontal_fov_rad: FOV_DEG.to_radians() };
        let view = world.look(&path.scene, frame, gaze)?;
        let picture = view
            .image
            .as_ref()
            .and_then(|image| RgbImage::from_raw(image.width_px(), image.height_px(), image.rgb().to_vec()));
        let picture = picture.ok_or_else(|| {
            Error::usage(
                format!("path {}, frame {at}: the platform has no picture", path.id),
                "leave out platform=recording",
            )
        })?;
        let file = format!("{at:04}.png");
        let saved = unfinished.join(&file);
        picture
            .save(&saved)
            .map_err(|error| Error::usage(format!("{}: {error}", saved.display()), "make room on the disk"))?;
        let heading_deg = frame.pose.heading.rad().to_degrees();
        poses.push(json!({ "image": file, "position": frame.pose.position.to_array(), "heading_deg": heading_deg }));
    }
    let write = |file: &str, text: String| {
        let file = unfinished.join(file);
        fs::write(&file, text).map_err(Error::io(&file, "write"))
    };
    write("poses.json", Value::from(poses).to_string())?;
    write("recording.toml", format!("horizontal_fov_deg = {FOV_DEG}\nworld = \"z-up\"\norientation = \"robot\"\n"))?;
    let whole = folder.join(name);
    fs::rename(&unfinished, &whole).map_err(Error::io(&whole, "name the folder"))
}
