//! Chooses the camera of a dataset.

use super::info::DatasetInfo;
use std::path::Path;
use wayword_core::PlatformError;
use wayword_world::files;

const CHOOSE_CAMERA_HINT: &str = "write camera = \"NAME\" into a recording.toml in the dataset's folder";
const NO_CAMERA_HINT: &str = "give a dataset with a feature of dtype video or image";

/// A camera of a dataset.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct DatasetCamera {
    /// The name of its feature.
    pub(super) key: String,
    /// Where its pictures are.
    pub(super) storage: PictureStorage,
}

/// The place where a camera's pictures are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PictureStorage {
    /// As picture files within the rows.
    Rows,
    /// As videos outside the tables.
    Video,
}

/// The camera that the user named, else the only one.
///
/// # Errors
/// When there is no camera, the named one does not exist, or there are several and none is named.
pub(super) fn choose_camera(
    root: &Path,
    info: &DatasetInfo,
    named: Option<&str>,
) -> Result<DatasetCamera, PlatformError> {
    let keys: Vec<&String> =
        info.features.iter().filter(|(_, feature)| feature.is_camera()).map(|(key, _)| key).collect();
    let listed = || keys.iter().map(|key| key.as_str()).collect::<Vec<_>>().join(", ");
    let wrong = |reason: String, hint| files::file_error(&DatasetInfo::info_file(root), reason, hint);
    let key = match (named, keys.as_slice()) {
        (_, []) => return Err(wrong("has no camera".to_owned(), NO_CAMERA_HINT)),
        (Some(named), _) => {
            let found = keys.iter().find(|key| key.as_str() == named);
            *found.ok_or_else(|| {
                wrong(format!("has no camera {named:?}; its cameras: {}", listed()), CHOOSE_CAMERA_HINT)
            })?
        }
        (None, [only]) => *only,
        (None, _) => return Err(wrong(format!("has several cameras: {}", listed()), CHOOSE_CAMERA_HINT)),
    };
    let is_video = info.features.get(key).is_some_and(|feature| feature.dtype == "video");
    let storage = if is_video { PictureStorage::Video } else { PictureStorage::Rows };
    Ok(DatasetCamera { key: key.clone(), storage })
}
