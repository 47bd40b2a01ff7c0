//! Chooses the camera of a dataset.

use super::info::Info;
use std::path::Path;
use wayword_core::PlatformError;
use wayword_world::files;

const CHOOSE: &str = "write camera = \"NAME\" into a recording.toml in the dataset's folder";
const NONE: &str = "give a dataset with a feature of dtype video or image";

/// A camera.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Camera {
    /// The name of its feature.
    pub(super) key: String,
    pub(super) kept: Kept,
}

/// The place where a camera's pictures are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kept {
    /// As picture files within the rows.
    Rows,
    /// As videos outside the tables.
    Video,
}

/// The camera that the user named, else the only one.
///
/// # Errors
/// When there is no camera, the named one does not exist, or there are several and none is named.
pub(super) fn choose(root: &Path, info: &Info, named: Option<&str>) -> Result<Camera, PlatformError> {
    let keys: Vec<&String> =
        info.features.iter().filter(|(_, feature)| feature.is_camera()).map(|(key, _)| key).collect();
    let listed = || keys.iter().map(|key| key.as_str()).collect::<Vec<_>>().join(", ");
    let wrong = |reason: String, hint| files::wrong(&Info::file(root), reason, hint);
    let key = match (named, keys.as_slice()) {
        (_, []) => return Err(wrong("has no camera".to_owned(), NONE)),
        (Some(named), _) => {
            let found = keys.iter().find(|key| key.as_str() == named);
            *found.ok_or_else(|| wrong(format!("has no camera {named:?}; its cameras: {}", listed()), CHOOSE))?
        }
        (None, [only]) => *only,
        (None, _) => return Err(wrong(format!("has several cameras: {}", listed()), CHOOSE)),
    };
    let kept = if info.features[key].dtype == "video" { Kept::Video } else { Kept::Rows };
    Ok(Camera { key: key.clone(), kept })
}
