//! Fixtures, the pictures that their numbers were made of, and damaged copies.

use std::{
    f64::consts::FRAC_PI_2,
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};
use wayword_core::{DVec3, Heading, Image, Pose, View};
use wayword_local::LocalError;

pub(crate) fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

/// The same formula as in the scripts.
pub(crate) fn drawn((width, height): (u32, u32)) -> Image {
    let byte = |at: u32| {
        let (x, y, colour) = (at / 3 % width, at / 3 / width, at % 3);
        ((x * x * 7 + y * 13 + colour * 50 + x * y % 31 * 5) % 256) as u8
    };
    Image::new(width, height, (0..width * height * 3).map(byte).collect()).unwrap()
}

pub(crate) fn view(image: Option<Image>) -> View {
    View::new(Pose::looking_level(DVec3::ZERO, Heading::NORTH), FRAC_PI_2, image.map(Arc::new), None)
}

/// A copy of a fixture.
pub(crate) fn copy(name: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(fixture(name)).unwrap() {
        let entry = entry.unwrap();
        fs::copy(entry.path(), folder.path().join(entry.file_name())).unwrap();
    }
    folder
}

/// Changes a file.
pub(crate) fn change(folder: &Path, file: &str, change: impl FnOnce(Vec<u8>) -> Vec<u8>) {
    let path = folder.join(file);
    fs::write(&path, change(fs::read(&path).unwrap())).unwrap();
}

/// Changes a value of a JSON file.
pub(crate) fn set(folder: &Path, file: &str, place: &str, value: serde_json::Value) {
    change(folder, file, |bytes| {
        let mut json: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
        *json.pointer_mut(place).unwrap() = value;
        json.to_string().into_bytes()
    });
}

/// The error of loading a folder.
#[track_caller]
pub(crate) fn refused<T>(loaded: Result<T, LocalError>) -> String {
    loaded.err().expect("it is refused").to_string()
}

/// Files that are cut off anywhere, or missing, are named.
#[track_caller]
pub(crate) fn damaged_files_are_named<T>(name: &str, load: impl Fn(&Path) -> Result<T, LocalError>) {
    for file in ["model.safetensors", "config.json", "preprocessor_config.json", "tokenizer.json"] {
        let folder = copy(name);
        let path = folder.path().join(file);
        let whole = fs::read(&path).unwrap();
        for length in [0, 7, whole.len() / 2, whole.len() - 2] {
            fs::write(&path, &whole[..length]).unwrap();
            let error = refused(load(folder.path()));
            assert!(error.contains(file), "{error}");
        }
        fs::remove_file(&path).unwrap();
        let error = refused(load(folder.path()));
        assert!(error.contains(file) && error.contains("missing"), "{error}");
    }
}
