//! A recording that is a folder of pictures, with poses in a file of the same folder or without any.

use crate::{
    describe::{self, DESCRIPTION_HINT, RecordingDescription},
    file_kind::RecordedFileKind,
    names::{
        PICTURE_FOLDERS, has_ending, is_picture_name, plain_files, scene_id_for_path, sorted_entries, unknown_scene,
    },
    photographs::NoPhotographs,
    poses::{self, PicturePlace, PoseSource},
    reel::{PictureReel, Recording, RecordingSource, TakePicture},
};
use std::{
    collections::BTreeSet,
    path::{Component, Path, PathBuf},
};
use wayword_core::{PlatformError, SceneId};
use wayword_world::{files, picture_end::is_cut_off};

/// Words in the names of pictures that datasets have in addition to photographs.
const NO_PHOTOGRAPHS: [&str; 6] = ["depth", "disparity", "mask", "normal", "segment", "semantic"];
/// Endings of pictures that cannot be read.
const UNREAD_ENDINGS: [&str; 8] = ["heic", "heif", "webp", "avif", "gif", "tif", "tiff", "bmp"];
/// The list of pictures with their times that the RGB-D datasets of TUM have.
const TUM_LIST_FILE: &str = "rgb.txt";
/// The times of the pictures of a sequence of KITTI, seconds, one on each line.
const KITTI_TIMES_FILE: &str = "times.txt";
/// Largest list and largest picture file that are read, bytes; larger ones are errors.
const MAX_LIST_BYTES: u64 = 64 << 20;
const MAX_PICTURE_BYTES: u64 = 64 << 20;
/// Kinds of files that are read as pictures, whatever the endings of their names.
pub(crate) const PICTURE_KINDS: [&str; 2] = ["a PNG picture", "a JPEG picture"];
const CUT_OFF_HINT: &str = "copy it again, or take it away";
/// Most pictures of a folder that are looked into once one of them is cut off, and most that are named.
const MAX_EXAMINED_PICTURES: usize = 2000;
const MAX_NAMED_PICTURES: usize = 5;
const PICTURE_HINT: &str = "remove the picture, or replace it with an intact one";

/// A folder of pictures.
pub(crate) struct PictureFolder {
    scene: SceneId,
    root: PathBuf,
    /// The folder in which the pictures are.
    pictures: PathBuf,
    /// The names of the picture files, sorted.
    names: Vec<String>,
}

impl PictureFolder {
    /// The recording in a folder; `None` where it holds no pictures.
    ///
    /// # Errors
    /// When the folder cannot be read.
    pub(crate) fn open(root: &Path) -> Result<Option<Self>, PlatformError> {
        let places = std::iter::once(root.to_owned()).chain(PICTURE_FOLDERS.map(|name| root.join(name)));
        for pictures in places.filter(|place| place.is_dir()) {
            let mut names = sorted_entries(&pictures)?;
            names.retain(|name| is_picture_name(name));
            let names = keep_photographs(names);
            if !names.is_empty() {
                return Ok(Some(Self { scene: scene_id_for_path(root)?, root: root.to_owned(), pictures, names }));
            }
        }
        Ok(None)
    }

    /// What the pictures are, if they are no photographs; judged by a few of them.
    pub(crate) fn no_photographs(&self) -> Option<NoPhotographs> {
        NoPhotographs::in_folder(&self.pictures, &self.names)
    }

    fn find_poses(&self, described: &RecordingDescription) -> Result<Option<PoseSource>, PlatformError> {
        let place = PicturePlace { root: &self.root, pictures: &self.pictures, names: &self.names };
        place.find_poses(described)
    }

    /// The first file in the pictures' folder for which `is_wanted` is true, and the number of such files.
    pub(crate) fn find_beside_pictures(
        &self,
        is_wanted: fn(&str) -> bool,
    ) -> Result<Option<(PathBuf, usize)>, PlatformError> {
        let mut names = sorted_entries(&self.pictures)?.into_iter().filter(|name| is_wanted(name));
        Ok(names.next().map(|first| (self.pictures.join(first), 1 + names.count())))
    }

    /// Pictures with their times, seconds: from TUM's list, else from their names if all of these are times, else at
    /// `pictures_per_s`.
    fn timed_pictures(&self, pictures_per_s: f64) -> Result<Vec<(f64, PathBuf)>, PlatformError> {
        let list = self.root.join(TUM_LIST_FILE);
        if let Some(text) = files::text_if_there(&list, MAX_LIST_BYTES, DESCRIPTION_HINT)? {
            return read_picture_list(&text, &self.root).map_err(|reason| {
                files::file_error(&list, reason, "expected lines of `time file`, each file with a name of its own")
            });
        }
        let times_in_names: Option<Vec<f64>> = self.names.iter().map(|name| time_in_name(name)).collect();
        let times = match times_in_names {
            Some(times) => times,
            None => self
                .kitti_times()?
                .unwrap_or_else(|| (0..self.names.len()).map(|number| number as f64 / pictures_per_s).collect()),
        };
        Ok(times.into_iter().zip(self.names.iter().map(|name| self.pictures.join(name))).collect())
    }

    /// The times in KITTI's list, one for each picture; `None` if there is no such list.
    fn kitti_times(&self) -> Result<Option<Vec<f64>>, PlatformError> {
        let list = self.root.join(KITTI_TIMES_FILE);
        let text = files::text_if_there(&list, MAX_LIST_BYTES, DESCRIPTION_HINT)?;
        let times: Option<Vec<f64>> =
            text.and_then(|text| text.split_whitespace().map(|word| word.parse().ok()).collect());
        Ok(times.filter(|times| times.len() == self.names.len() && times.iter().all(|time_s| time_s.is_finite())))
    }
}

impl RecordingSource for PictureFolder {
    fn scenes(&self) -> Vec<SceneId> {
        vec![self.scene.clone()]
    }

    fn open(&self, scene: &SceneId) -> Result<Recording, PlatformError> {
        if *scene != self.scene {
            return Err(unknown_scene(scene, &self.scenes()));
        }
        let described = RecordingDescription::read(&self.root.join(describe::FOLDER_FILE))?;
        let mut timed = self.timed_pictures(described.pictures_per_s.unwrap_or(1.0))?;
        timed.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (times_s, files) = timed.into_iter().unzip();
        let reel = FolderReel { times_s, files, remarks: Vec::new() };
        let track = self
            .find_poses(&described)?
            .map(|source| poses::read_source(&source, &described, &reel.times_s, &|number| reel.picture_name(number)));
        Ok(Recording { track: track.transpose()?, reel: Box::new(reel), horizontal_fov_rad: None, described })
    }

    fn files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        if *scene != self.scene {
            return Err(unknown_scene(scene, &self.scenes()));
        }
        let description = self.root.join(describe::FOLDER_FILE);
        let described = RecordingDescription::read(&description)?;
        let pictures = self.timed_pictures(described.pictures_per_s.unwrap_or(1.0))?.into_iter().map(|(_, file)| file);
        let poses = self.find_poses(&described)?.map(|source| source.files()).unwrap_or_default();
        let beside = [description, self.root.join(TUM_LIST_FILE), self.root.join(KITTI_TIMES_FILE)];
        Ok(plain_files(pictures.chain(beside).chain(poses)))
    }
}

/// Pictures that are files.
pub(crate) struct FolderReel {
    pub(crate) times_s: Vec<f64>,
    pub(crate) files: Vec<PathBuf>,
    /// What the user has to be told.
    pub(crate) remarks: Vec<String>,
}

impl FolderReel {
    /// The error for a picture that cannot be decoded. Where it is cut off, others of the folder may be too, and are named.
    fn picture_error(&self, file: &Path, bytes: &[u8], reason: String) -> PlatformError {
        if !is_cut_off(bytes) {
            return files::file_error(file, reason, PICTURE_HINT);
        }
        let read = |other: &Path| files::bytes_if_there(other, MAX_PICTURE_BYTES, PICTURE_HINT).ok().flatten();
        let others = self.files.iter().take(MAX_EXAMINED_PICTURES).filter(|other| other.as_path() != file);
        let cut = others.filter(|other| read(other).is_some_and(|bytes| is_cut_off(&bytes)));
        let cut: Vec<String> =
            cut.filter_map(|other| Some(other.file_name()?.to_string_lossy().into_owned())).collect();
        let named = cut.iter().take(MAX_NAMED_PICTURES).map(String::as_str).collect::<Vec<_>>().join(", ");
        let more = match (cut.len(), cut.len().saturating_sub(MAX_NAMED_PICTURES)) {
            (0, _) => String::new(),
            (_, 0) => format!(", like {named}"),
            (_, more) => format!(", like {named} and {more} more"),
        };
        files::file_error(file, format!("{reason}{more}"), CUT_OFF_HINT)
    }
}

impl PictureReel for FolderReel {
    fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    fn picture_name(&self, number: usize) -> String {
        let name = self.files.get(number).and_then(|file| file.file_name());
        name.map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
    }

    fn remarks(&self) -> &[String] {
        &self.remarks
    }

    fn hand_out_pictures(&self, wanted: &[usize], take: &mut TakePicture<'_>) -> Result<(), PlatformError> {
        for number in wanted {
            let Some(file) = self.files.get(*number) else { continue };
            let wrong = |reason: String| files::file_error(file, reason, PICTURE_HINT);
            let bytes = files::bytes_if_there(file, MAX_PICTURE_BYTES, PICTURE_HINT)?;
            let bytes = bytes.ok_or_else(|| wrong("there is no such file".to_owned()))?;
            let picture = files::decode_picture(&bytes);
            // The error for a file of another kind names that kind.
            let refuse =
                |reason: String| unfit_picture(file).unwrap_or_else(|| self.picture_error(file, &bytes, reason));
            take(*number, picture.map_err(refuse)?)?;
        }
        Ok(())
    }

    fn glance_at(&self, wanted: &[usize]) -> Result<(), PlatformError> {
        let unfit = wanted.iter().filter_map(|number| self.files.get(*number)).find_map(|file| unfit_picture(file));
        unfit.map_or(Ok(()), Err)
    }
}

/// The error for a file that is neither PNG nor JPEG by its first bytes; `None` if it may be one.
fn unfit_picture(file: &Path) -> Option<PlatformError> {
    let kind = RecordedFileKind::from_file(file).filter(|kind| !PICTURE_KINDS.contains(&kind.name))?;
    Some(files::file_error(file, format!("is {}, neither PNG nor JPEG", kind.name), kind.hint))
}

/// Reads lines of `time file`; the files must lie below the folder.
fn read_picture_list(text: &str, root: &Path) -> Result<Vec<(f64, PathBuf)>, String> {
    let lines = text.lines().enumerate().filter(|(_, line)| {
        let line = line.trim();
        !line.is_empty() && !line.starts_with('#')
    });
    let mut names = BTreeSet::new();
    let read = lines.map(|(at, line)| {
        let (time, file) =
            line.trim().split_once([' ', '\t']).ok_or_else(|| format!("line {}: has only one word", at + 1))?;
        let time_s: f64 =
            time.parse().ok().filter(|time_s: &f64| time_s.is_finite()).ok_or_else(|| {
                format!("line {}: {:?} is not a time", at + 1, time.chars().take(40).collect::<String>())
            })?;
        let file = Path::new(file.trim());
        if !file.components().all(|part| matches!(part, Component::Normal(_))) {
            return Err(format!("line {}: the file is not inside the folder", at + 1));
        }
        // Pose files and frames refer to a picture by its name alone.
        if !names.insert(file.file_name()) {
            return Err(format!("line {}: an earlier line has a file with the same name", at + 1));
        }
        Ok((time_s, root.join(file)))
    });
    read.collect()
}

/// Whether a file is, by its ending, a photograph of a kind that cannot be read.
pub(crate) fn is_unread_picture(name: &str) -> bool {
    // Datasets keep depth maps as TIFF, and these are not missing photographs.
    !is_no_photograph(name) && has_ending(name, &UNREAD_ENDINGS)
}

/// Whether a picture is a depth map, a mask or the like by its name.
fn is_no_photograph(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    NO_PHOTOGRAPHS.iter().any(|word| name.contains(word))
}

/// The names without depth maps and the like; all names if no photograph is among them.
fn keep_photographs(names: Vec<String>) -> Vec<String> {
    let photographs: Vec<String> = names.iter().filter(|name| !is_no_photograph(name)).cloned().collect();
    if photographs.is_empty() { names } else { photographs }
}

/// The time in a picture's name, seconds: `1305031102.175304.png` is in seconds, `1403636579763555584.png`
/// in nanoseconds. `None` if the name is a running number (`000012.png`).
fn time_in_name(name: &str) -> Option<f64> {
    let stem = Path::new(name).file_stem()?.to_str()?;
    let digits = stem.bytes().all(|byte| byte.is_ascii_digit());
    // KITTI's running numbers have ten digits, as times in seconds have.
    if digits && stem.starts_with('0') {
        return None;
    }
    // ARKitScenes: the number of the scene, and the seconds.
    let (digits, stem) = match stem.split_once('_') {
        // A date before a time of day is no scene.
        Some((date, _)) if date.len() == 8 && (date.starts_with("19") || date.starts_with("20")) => return None,
        Some((scene, time)) if time.contains('.') && scene.bytes().all(|byte| byte.is_ascii_digit()) => (false, time),
        _ => (digits, stem),
    };
    let number: f64 = stem.parse().ok().filter(|number: &f64| number.is_finite() && *number >= 0.0)?;
    let per_s = match (digits, stem.len()) {
        (false, _) => 1.0,
        (true, 10) => 1.0,
        (true, 13) => 1e3,
        (true, 16) => 1e6,
        (true, 19) => 1e9,
        _ => return None,
    };
    Some(number / per_s)
}

#[cfg(test)]
mod layout_tests;
#[cfg(test)]
mod tests {
    use super::*;
    use image::{Rgb, RgbImage};

    #[test]
    fn a_date_before_a_time_of_day_is_no_scene_with_seconds() {
        assert_eq!(time_in_name("20230101_120000.123.jpg"), None);
        assert_eq!(time_in_name("41069021_3298.501.png"), Some(3298.501));
    }

    /// A folder with pictures; the red of each is its number.
    fn folder(names: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (at, name) in names.iter().enumerate() {
            let file = folder.path().join(name);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            RgbImage::from_pixel(4, 3, Rgb([at as u8, 0, 0])).save(file).unwrap();
        }
        folder
    }

    fn open(folder: &Path) -> Recording {
        let source = PictureFolder::open(folder).unwrap().unwrap();
        source.open(&source.scenes()[0]).unwrap()
    }

    #[test]
    fn pictures_come_as_people_count_them() {
        let folder = folder(&["f10.png", "f2.png", "notes/f3.png"]);
        std::fs::write(folder.path().join("notes.txt"), "no picture").unwrap();
        let recording = open(folder.path());
        assert_eq!(recording.reel.times_s(), [0.0, 1.0]);
        assert_eq!([0, 1].map(|at| recording.reel.picture_name(at)), ["f2.png", "f10.png"]);
        let mut reds = Vec::new();
        let take = &mut |at, image: wayword_core::Image| {
            reds.push((at, image.rgb_bytes()[0]));
            Ok(())
        };
        recording.reel.hand_out_pictures(&[0, 1], take).unwrap();
        assert_eq!(reds, [(0, 1), (1, 0)]);
        assert!(recording.track.is_none());
    }

    #[test]
    fn depth_maps_beside_photographs_are_no_pictures() {
        let both = folder(&["rgb_0.png", "depth_0.png", "rgb_1.png", "depth_1.png"]);
        let recording = open(both.path());
        assert_eq!([0, 1].map(|at| recording.reel.picture_name(at)), ["rgb_0.png", "rgb_1.png"]);
        assert_eq!(open(folder(&["in_depth_1.png"]).path()).reel.times_s().len(), 1);
    }

    #[test]
    fn names_that_are_times_are_times() {
        let stamped = folder(&["rgb/1305031102.175304.png", "rgb/1305031102.211214.png"]);
        let recording = open(stamped.path());
        assert!((recording.reel.times_s()[1] - 1_305_031_102.211_214).abs() < 1e-6);
        assert_eq!(time_in_name("1403636579763555584.png"), Some(1_403_636_579.763_555_6));
        assert_eq!(time_in_name("40753679_6791.477.png"), Some(6791.477));
        assert_eq!(time_in_name("000012.png"), None);
        assert_eq!(time_in_name("0000000012.png"), None);
    }

    #[test]
    fn a_list_of_tum_gives_times_and_files_below_the_folder() {
        let folder = folder(&["rgb/a.png", "rgb/b.png"]);
        std::fs::write(folder.path().join("rgb.txt"), "# time file\n5.5 rgb/b.png\n6.5 rgb/a.png\n").unwrap();
        let recording = open(folder.path());
        assert_eq!(recording.reel.times_s(), [5.5, 6.5]);
        assert_eq!(recording.reel.picture_name(0), "b.png");
        for bad in ["1 ../x.png", "1 /etc/x.png", "x rgb/a.png", "1"] {
            assert!(read_picture_list(bad, Path::new("/tmp")).unwrap_err().contains("line 1"), "{bad}");
        }
        assert!(read_picture_list("1 left/a.png\n2 right/a.png", Path::new("/tmp")).unwrap_err().contains("line 2"));
    }

    #[test]
    fn a_broken_picture_is_named() {
        let folder = folder(&["1.png"]);
        std::fs::write(folder.path().join("2.png"), "no picture").unwrap();
        let error = open(folder.path()).reel.hand_out_pictures(&[1], &mut |_, _| Ok(())).unwrap_err().to_string();
        assert!(error.contains("2.png") && error.contains("is text, neither PNG nor JPEG"), "{error}");
    }

    #[test]
    fn pictures_that_are_cut_off_are_named_together() {
        let folder = tempfile::tempdir().unwrap();
        let picture = image::RgbImage::from_fn(64, 48, |x, y| image::Rgb([(x * 3) as u8, (y * 5) as u8, 9]));
        let mut whole = std::io::Cursor::new(Vec::new());
        picture.write_to(&mut whole, image::ImageFormat::Jpeg).unwrap();
        let whole = whole.into_inner();
        for at in 0..12 {
            let length = if matches!(at, 3 | 5 | 11) { whole.len() / 2 } else { whole.len() };
            std::fs::write(folder.path().join(format!("{at:06}.jpg")), &whole[..length]).unwrap();
        }
        let read = |wanted: &[usize]| open(folder.path()).reel.hand_out_pictures(wanted, &mut |_, _| Ok(()));
        let error = read(&[0, 3]).unwrap_err().to_string();
        assert!(
            error.contains("000003.jpg: is a picture that is cut off, like 000005.jpg, 000011.jpg; copy it"),
            "{error}"
        );
        read(&[0, 1, 2, 4]).unwrap();
        for number in [5, 11] {
            std::fs::write(folder.path().join(format!("{number:06}.jpg")), &whole).unwrap();
        }
        let error = read(&[3]).unwrap_err().to_string();
        assert!(error.ends_with("is a picture that is cut off; copy it again, or take it away"), "{error}");
    }

    #[test]
    fn a_folder_without_pictures_is_no_recording() {
        let folder = tempfile::tempdir().unwrap();
        assert!(PictureFolder::open(folder.path()).unwrap().is_none());
    }
}
