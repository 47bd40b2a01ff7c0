//! Finds the user's Matterport3D data below a folder, in the places where the tools of its makers put them.

use super::file_reading;
use std::path::{Path, PathBuf};
use wayword_core::{PlatformError, SceneId, ViewpointId};

/// Number of Matterport3DSimulator's views at a viewpoint.
const VIEWS_PER_VIEWPOINT: usize = 36;
const DATA_FOLDER_HINT: &str = "give --data the folder that holds Matterport3DSimulator's `connectivity` folder";

/// Places of REVERIE's boxes below the data folder, in the order in which they are tried.
const BOX_FOLDERS: [&str; 4] = ["reverie/BBox", "BBox", "matterport/BBox", "REVERIE/BBox"];

/// The folders and files of Matterport3D that exist below the data folder.
#[derive(Debug, Clone)]
pub(crate) struct MatterportLayout {
    connectivity: PathBuf,
    /// Folders with one folder per scan.
    scans: Vec<PathBuf>,
    /// The folder of REVERIE's boxes.
    boxes: Option<PathBuf>,
    /// REVERIE's file of object centres.
    pub(crate) object_positions: Option<PathBuf>,
    /// Folders with files `SCAN/VIEWPOINT/N.jpg`.
    views: Vec<PathBuf>,
}

/// The files of a skybox's faces.
#[derive(Debug, Clone)]
pub(crate) enum SkyboxFiles {
    /// Six faces side by side (Matterport3DSimulator's `downsize_skybox.py`).
    Strip(PathBuf),
    /// One file per face, as in Matterport3D.
    Faces([PathBuf; 6]),
}

impl MatterportLayout {
    /// Searches a folder for the parts of Matterport3D, in the places where its tools put them.
    ///
    /// # Errors
    /// If there are no connectivity graphs; the message names the places that were tried.
    pub(crate) fn find_data(data: &Path) -> Result<Self, PlatformError> {
        let connectivity = first_folder(data, &["matterport/connectivity", "connectivity", "graph"]).ok_or_else(|| {
            let reason = if data.is_dir() {
                "holds no connectivity graphs: it has no folder `matterport/connectivity`, `connectivity` or `graph`"
            } else if data.exists() {
                "is not a folder"
            } else {
                "there is no such folder"
            };
            file_reading::file_error(data, reason, DATA_FOLDER_HINT)
        })?;
        Ok(Self {
            connectivity,
            scans: existing_folders(data, &["matterport/v1/scans", "v1/scans", "matterport/scans", "scans", ""]),
            boxes: first_folder(data, &BOX_FOLDERS),
            object_positions: ["reverie/objpos.json", "objpos.json", "BBox/objpos.json"]
                .iter()
                .map(|place| data.join(place))
                .find(|file| file.is_file()),
            views: existing_folders(
                data,
                &["matterport_36_views", "matterport/matterport_36_views", "matterport/views", "views"],
            ),
        })
    }

    /// The folder of the connectivity files.
    pub(crate) fn connectivity_folder(&self) -> &Path {
        &self.connectivity
    }

    /// The scenes that have a connectivity file, sorted.
    pub(crate) fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        let mut scenes = Vec::new();
        for file in files_in(&self.connectivity)? {
            let name = file.file_name().and_then(|name| name.to_str());
            let scan = name.and_then(|name| name.strip_suffix("_connectivity.json"));
            scenes.extend(scan.and_then(|scan| SceneId::new(scan).ok()));
        }
        scenes.sort();
        Ok(scenes)
    }

    /// A warning for a user without REVERIE's boxes and with `.house` files for only some buildings or none: in the rest,
    /// objects are not known. It ends with advice. `None` if objects are known everywhere.
    pub(crate) fn lack_of_objects(&self, data: &Path) -> Option<String> {
        let scenes = self.list_scenes().ok()?;
        let houses = scenes.iter().filter(|scene| self.house_segmentation_file(scene).is_some()).count();
        if self.boxes.is_some() || houses == scenes.len() {
            return None;
        }
        let above = data.canonicalize().ok().and_then(|data| data.parent().map(Path::to_owned));
        let hint = match above.filter(|above| first_folder(above, &BOX_FOLDERS).is_some()) {
            Some(above) => format!("give the folder above it, which has boxes: --data {}", above.display()),
            None => format!(
                "put REVERIE's boxes into {}, or the .house file of each building at {}",
                data.join(BOX_FOLDERS[0]).display(),
                data.join("v1/scans/SCAN/house_segmentations/SCAN.house").display()
            ),
        };
        Some(format!(
            "warning: {}: there are no REVERIE boxes (looked for {}), and {} of {} no .house file either; in those, \
             objects are not known: labels name only rooms, and objects in texts stay unverified\n\
             hint: {hint}",
            data.display(),
            BOX_FOLDERS.join(", "),
            scenes.len() - houses,
            match scenes.len() {
                1 => "1 scene has".to_owned(),
                count => format!("{count} scenes have"),
            }
        ))
    }

    pub(crate) fn connectivity_file(&self, scene: &SceneId) -> PathBuf {
        self.connectivity.join(format!("{scene}_connectivity.json"))
    }

    /// Every existing file of a scene, sorted.
    pub(crate) fn files_of_scene<'a>(
        &self,
        scene: &SceneId,
        viewpoints: impl Iterator<Item = &'a ViewpointId>,
    ) -> Vec<PathBuf> {
        let mut files = vec![self.connectivity_file(scene)];
        files.extend(
            [self.rooms_file(scene), self.house_segmentation_file(scene), self.object_positions.clone()]
                .into_iter()
                .flatten(),
        );
        for viewpoint in viewpoints {
            files.extend(self.boxes_file(scene, viewpoint));
            match self.skybox_files(scene, viewpoint) {
                Some(SkyboxFiles::Strip(strip)) => files.push(strip),
                Some(SkyboxFiles::Faces(faces)) => files.extend(faces),
                None => {}
            }
            if let Some(views) = self.views_folder(scene, viewpoint) {
                files.extend((0..VIEWS_PER_VIEWPOINT).map(|view| views.join(format!("{view}.jpg"))));
            }
        }
        files.retain(|file| file.is_file());
        files.sort();
        files
    }

    /// The file of room letters, if it exists.
    pub(crate) fn rooms_file(&self, scene: &SceneId) -> Option<PathBuf> {
        self.find_in_scan(scene, "house_segmentations/panorama_to_region.txt")
    }

    /// The `.house` file, if it exists.
    pub(crate) fn house_segmentation_file(&self, scene: &SceneId) -> Option<PathBuf> {
        self.find_in_scan(scene, &format!("house_segmentations/{scene}.house"))
    }

    /// The file of REVERIE's boxes of a viewpoint, which need not exist.
    pub(crate) fn boxes_file(&self, scene: &SceneId, viewpoint: &ViewpointId) -> Option<PathBuf> {
        self.boxes.as_ref().map(|folder| folder.join(format!("{scene}_{viewpoint}.json")))
    }

    /// The six faces of a viewpoint's skybox: one file with all of them side by side, or one file each.
    pub(crate) fn skybox_files(&self, scene: &SceneId, viewpoint: &ViewpointId) -> Option<SkyboxFiles> {
        let folder = "matterport_skybox_images";
        if let Some(strip) = self.find_in_scan(scene, &format!("{folder}/{viewpoint}_skybox_small.jpg")) {
            return Some(SkyboxFiles::Strip(strip));
        }
        let first = self.find_in_scan(scene, &format!("{folder}/{viewpoint}_skybox0_sami.jpg"))?;
        let face = |index: usize| first.with_file_name(format!("{viewpoint}_skybox{index}_sami.jpg"));
        Some(SkyboxFiles::Faces(std::array::from_fn(face)))
    }

    /// The folder of a viewpoint's 36 views, `0.jpg` to `35.jpg`.
    pub(crate) fn views_folder(&self, scene: &SceneId, viewpoint: &ViewpointId) -> Option<PathBuf> {
        let folders = self.views.iter().map(|views| views.join(scene.as_str()).join(viewpoint.as_str()));
        folders.into_iter().find(|folder| folder.is_dir())
    }

    /// An existing file in a scan's folder.
    fn find_in_scan(&self, scene: &SceneId, file: &str) -> Option<PathBuf> {
        self.possible_paths(scene, file).find(|file| file.is_file())
    }

    /// The possible paths of a scan's file. Matterport3D's archives unpack to `scans/SCAN/SCAN/...` or
    /// `scans/SCAN/...`.
    fn possible_paths(&self, scene: &SceneId, what: &str) -> impl Iterator<Item = PathBuf> {
        let scan = scene.as_str();
        self.scans.iter().flat_map(move |scans| [scans.join(scan).join(what), scans.join(scan).join(scan).join(what)])
    }
}

/// The entries of a folder, in no particular order.
fn files_in(folder: &Path) -> Result<Vec<PathBuf>, PlatformError> {
    let failed = |error: std::io::Error| PlatformError::for_unread_file(folder, &error, DATA_FOLDER_HINT);
    let entries = std::fs::read_dir(folder).map_err(failed)?;
    entries.map(|entry| Ok(entry.map_err(failed)?.path())).collect()
}

/// Those of `places` below the data folder that are folders.
fn existing_folders(data: &Path, places: &[&str]) -> Vec<PathBuf> {
    places.iter().map(|place| data.join(place)).filter(|folder| folder.is_dir()).collect()
}

fn first_folder(data: &Path, places: &[&str]) -> Option<PathBuf> {
    existing_folders(data, places).into_iter().next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lack_of_objects_names_the_folder_above_with_boxes() {
        let above = tempfile::tempdir().unwrap();
        let data = above.path().join("matterport");
        std::fs::create_dir_all(data.join("connectivity")).unwrap();
        std::fs::write(data.join("connectivity/s_connectivity.json"), "[]").unwrap();
        let lack = |data: &Path| MatterportLayout::find_data(data).unwrap().lack_of_objects(data);
        let told = lack(&data).unwrap();
        assert!(told.contains(&data.display().to_string()) && told.contains("REVERIE's boxes into"), "{told}");
        assert!(told.contains("1 of 1 scene has no .house file"), "{told}");
        std::fs::create_dir_all(above.path().join("reverie/BBox")).unwrap();
        assert!(lack(&data).unwrap().contains("give the folder above it"));
        assert_eq!(lack(above.path()), None);
        let house = data.join("v1/scans/s/house_segmentations");
        std::fs::create_dir_all(&house).unwrap();
        std::fs::write(house.join("s.house"), "").unwrap();
        assert_eq!(lack(&data), None);
    }

    #[test]
    fn find_data_names_the_places_of_missing_data() {
        let empty = tempfile::tempdir().unwrap();
        let error = MatterportLayout::find_data(empty.path()).unwrap_err().to_string();
        assert!(error.contains("`matterport/connectivity`, `connectivity` or `graph`"), "{error}");
        assert!(error.contains("--data"), "{error}");
        let place = empty.path().join("place");
        let nowhere = MatterportLayout::find_data(&place).unwrap_err().to_string();
        assert!(nowhere.contains("place: there is no such folder; "), "{nowhere}");
        std::fs::write(&place, "").unwrap();
        let file = MatterportLayout::find_data(&place).unwrap_err().to_string();
        assert!(file.contains("place: is not a folder; "), "{file}");
    }
}
