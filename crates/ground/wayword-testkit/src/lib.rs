//! A small made-up building in the file formats of Matterport3D, REVERIE and R2R, for tests: two storeys with stairs,
//! nine rooms, 14 viewpoints, 42 objects (some share a name), ten paths with instructions. It was invented for the tests
//! and contains no data of a dataset, so it can be published.
//!
//! There are stand-ins for services as well: [`provider`] serves models over HTTP that answer from scripts and fail in every
//! way that real services fail; [`PlayedDetector`] detects things by script; [`PostgresServer`] starts a PostgreSQL server.
//! [`read_http_request`] is for the small servers of tests. [`documents`] extracts the commands that the repository's documents ask their readers to type.
//!
//! # Where things are
//! - `test_house.rs`, `episodes.rs`: the building and its paths; a file each for the formats that they are written in.
//! - `provider/faults.rs`, `fault_response.rs`: the faults of services. If a real service shows a new one, it goes here first.
//! - `provider/dialect/`: the requests and replies of each API.
//! - `provider/scripts/`: scripted models that see, ask, summarise, write and walk, and their mistakes.
//! - `documents/`: which lines of a document are commands.

pub mod documents;
mod episodes;
mod house_file;
mod http_request;
mod played_detector;
mod postgres;
pub mod provider;
pub mod resources;
mod reverie_boxes;
mod skyboxes;
mod test_house;

use serde_json::{Value, json};
use std::{fs, io, path::Path};

pub use http_request::read_http_request;
pub use played_detector::PlayedDetector;
pub use postgres::PostgresServer;
pub use test_house::{SCAN, viewpoint_id};

/// Writes the building below `data`, laid out as a user's Matterport3D and REVERIE folders are:
/// `matterport/connectivity`, `matterport/v1/scans`, `reverie` (boxes, `objpos.json`, `REVERIE_val_seen.json`) and
/// `r2r/R2R_val_seen.json`. It writes the same bytes each time.
///
/// # Errors
/// When a file cannot be written.
pub fn write_building(data: &Path) -> io::Result<()> {
    let connectivity = data.join("matterport/connectivity");
    write_file(&connectivity, &format!("{SCAN}_connectivity.json"), connectivity_file().to_string())?;
    write_file(&connectivity, "scans.txt", format!("{SCAN}\n"))?;
    let segmentations = data.join(format!("matterport/v1/scans/{SCAN}/house_segmentations"));
    write_file(&segmentations, "panorama_to_region.txt", panorama_to_region())?;
    write_file(&segmentations, &format!("{SCAN}.house"), house_file::house_file_text())?;
    let reverie = data.join("reverie");
    for (index, _) in test_house::VIEWPOINTS.iter().enumerate() {
        let file = format!("{SCAN}_{}.json", viewpoint_id(index));
        write_file(&reverie.join("BBox"), &file, reverie_boxes::box_file(index).to_string())?;
    }
    write_file(&reverie, "objpos.json", object_positions().to_string())?;
    write_file(&reverie, "REVERIE_val_seen.json", episodes::reverie_file().to_string())?;
    write_file(&data.join("r2r"), "R2R_val_seen.json", episodes::r2r_file().to_string())
}

/// Adds photographs: a skybox per viewpoint (`VIEWPOINT_skybox_small.jpg`, six faces of 64 pixels) with walls in the
/// colours of [`wall_colour`]. Call it after [`write_building`].
///
/// # Errors
/// When a file cannot be written.
pub fn write_skyboxes(data: &Path) -> io::Result<()> {
    write_shaded_skyboxes(data, |_| 0)
}

/// Adds photographs as [`write_skyboxes`] does, but shaded differently at each viewpoint, for tests that distinguish
/// viewpoints by their pictures.
///
/// # Errors
/// When a file cannot be written.
pub fn write_distinct_skyboxes(data: &Path) -> io::Result<()> {
    write_shaded_skyboxes(data, |index| u8::try_from(4 * (index + 1)).unwrap_or(u8::MAX))
}

/// Writes the skyboxes. `shade_of_viewpoint` gives the shade of each viewpoint, by its index.
fn write_shaded_skyboxes(data: &Path, shade_of_viewpoint: impl Fn(usize) -> u8) -> io::Result<()> {
    let folder = data.join(format!("matterport/v1/scans/{SCAN}/matterport_skybox_images"));
    for (index, _) in test_house::VIEWPOINTS.iter().enumerate() {
        write_file(
            &folder,
            &format!("{}_skybox_small.jpg", viewpoint_id(index)),
            skyboxes::skybox_jpeg(shade_of_viewpoint(index))?,
        )?;
    }
    Ok(())
}

pub use skyboxes::wall_colour;

fn write_file(folder: &Path, name: &str, contents: impl AsRef<[u8]>) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    fs::write(folder.join(name), contents)
}

/// The contents of Matterport3D's `SCAN_connectivity.json`.
fn connectivity_file() -> Value {
    let count = test_house::VIEWPOINTS.len() + 1;
    let mut items: Vec<Value> = test_house::VIEWPOINTS
        .iter()
        .enumerate()
        .map(|(index, viewpoint)| {
            connectivity_item(index, test_house::camera_position(viewpoint).to_array(), true, count)
        })
        .collect();
    // A viewpoint that is not included: every real file has some.
    items.push(connectivity_item(count - 1, [5.0, 4.0, 1.5], false, count));
    Value::Array(items)
}

/// One viewpoint of the connectivity file, which has `count` viewpoints in all.
fn connectivity_item(index: usize, [x, y, z]: [f64; 3], included: bool, count: usize) -> Value {
    let is_joined_to: Vec<bool> = (0..count).map(|other| test_house::are_joined(index, other)).collect();
    json!({
        "image_id": viewpoint_id(index),
        // The skybox's axes: x east, y down, z north.
        "pose": [1.0, 0.0, 0.0, x, 0.0, 0.0, 1.0, y, 0.0, -1.0, 0.0, z, 0.0, 0.0, 0.0, 1.0],
        "included": included,
        "visible": is_joined_to,
        "unobstructed": is_joined_to,
        "height": test_house::CAMERA_HEIGHT_M,
    })
}

/// The contents of Matterport3D's `panorama_to_region.txt`: the room of each viewpoint.
fn panorama_to_region() -> String {
    let line = |(index, viewpoint): (usize, &test_house::TestHouseViewpoint)| {
        format!("{index} {} {} {}\n", viewpoint_id(index), viewpoint.room, test_house::ROOMS[viewpoint.room].letter)
    };
    test_house::VIEWPOINTS.iter().enumerate().map(line).collect()
}

/// The contents of REVERIE's `objpos.json`: the centre of each object.
fn object_positions() -> Value {
    let centres = test_house::OBJECTS
        .iter()
        .enumerate()
        .map(|(id, object)| (id.to_string(), json!(test_house::object_centre(object).to_array())));
    let centres: serde_json::Map<String, Value> = centres.collect();
    json!({ SCAN: centres })
}
