//! Opens a path as a recording, of the kind that its contents have.

#[cfg(any(feature = "lerobot", feature = "mcap", feature = "video"))]
use crate::describe::RecordingDescription;
use crate::{
    file_kind::{self, RecordedFileKind, UnreadRecordings},
    folder::{PICTURE_KINDS, PictureFolder, is_unread_picture},
    names::{PICTURE_FOLDERS, has_ending, is_video_name, scene_id_for_path, sorted_entries, unknown_scene},
    photographs::NoPhotographs,
    reel::{Recording, RecordingSource},
    shelf::RecordingShelf,
    training_walks,
};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};
use wayword_core::{PlatformError, SceneId};
use wayword_world::files;

const RECORDING_HINT: &str =
    "give a folder of pictures (PNG, JPEG), a folder of recordings, a LeRobot dataset, or a .mp4 or .mcap file";

/// The folder in which EuRoC's and TUM-VI's sequences have their sensors.
const EUROC_FOLDER: &str = "mav0";

/// Opens a path: one recording, or a folder with several. `hear` gets a line for each file that is skipped.
pub(crate) fn open_source(path: &Path, hear: &dyn Fn(&str)) -> Result<Box<dyn RecordingSource>, PlatformError> {
    if let Some(found) = open_one(path)? {
        if let RecordingEntry::Pictures(folder) = &found {
            hear_of_no_photographs(path, folder.no_photographs(), hear);
        }
        return Ok(found.into_source());
    }
    if !path.is_dir() {
        return Err(no_recording(path));
    }
    // EuRoC and TUM-VI keep the folders of their cameras one folder deeper.
    let sensors = path.join(EUROC_FOLDER);
    if sensors.is_dir() {
        return open_source(&sensors, hear);
    }
    let (mut sources, mut no_photographs) = (Vec::new(), Vec::new());
    let (mut unknown_entries, mut broken) = (Vec::new(), Vec::new());
    // macOS leaves "._x.mp4" next to "x.mp4" on foreign disks, and file managers leave hidden folders of thumbnails.
    for entry in sorted_entries(path)?.into_iter().filter(|name| !name.starts_with('.')) {
        match open_one(&path.join(&entry)) {
            Ok(Some(RecordingEntry::Pictures(folder))) => match folder.no_photographs() {
                Some(what) => no_photographs.push((entry, what, folder)),
                None => sources.push(Box::new(folder) as Box<dyn RecordingSource>),
            },
            Ok(Some(RecordingEntry::Other(source))) => sources.push(source),
            Ok(None) => match lone_recording(&path.join(&entry)) {
                Ok(Some(source)) => sources.push(source),
                Ok(None) => unknown_entries.push(entry),
                Err(error) => broken.push((entry, error)),
            },
            Err(error) => broken.push((entry, error)),
        }
    }
    // Depth maps and masks belong to the photographs or the video beside them. Alone, they are what the user wants.
    let is_alone = sources.is_empty() && broken.is_empty();
    for (entry, what, folder) in no_photographs {
        if is_alone {
            hear_of_no_photographs(&path.join(&entry), Some(what), hear);
            sources.push(Box::new(folder));
        } else {
            hear(&format!("{entry} is skipped: it holds {}, and photographs or a video lie beside it", what.words()));
        }
    }
    if sources.is_empty() {
        if let Some((_, error)) = broken.into_iter().next() {
            return Err(error);
        }
        return Err(match file_kind::find_unread(path, &PICTURE_FOLDERS)? {
            Some(UnreadRecordings { what, hint }) => {
                files::file_error(path, format!("holds no recording that can be read: {what}"), hint)
            }
            None => files::file_error(path, "holds no pictures and no recordings", RECORDING_HINT),
        });
    }
    for entry in unknown_entries {
        let file = path.join(&entry);
        if file.is_dir() && recording_files(&file)?.len() > 1 {
            hear(&format!("{entry} is skipped: it holds several recordings itself; give --data {}", file.display()));
        } else if let Some(UnreadRecordings { what, hint }) = file_kind::find_unread(&file, &PICTURE_FOLDERS)? {
            let why = if file.is_dir() { what } else { format!("it is {what}") };
            hear(&format!("{entry} is skipped: {why}, which cannot be read as it is; {hint}"));
        }
    }
    for (entry, error) in broken {
        let path = path.join(&entry);
        match scene_id_for_path(&path) {
            Ok(scene) => sources.push(Box::new(UnopenedRecording { scene, path })),
            // Without a valid name, no setting can choose it.
            Err(_) => hear(&format!("{entry} is skipped: {error}")),
        }
    }
    let mut scenes = BTreeSet::new();
    if let Some(twice) = sources.iter().flat_map(|source| source.scenes()).find(|scene| !scenes.insert(scene.clone())) {
        let reason = format!("holds two recordings with the name {twice}");
        return Err(files::file_error(path, reason, "give one of them another name, or name the file itself"));
    }
    Ok(Box::new(RecordingShelf { sources }))
}

/// Says that pictures are no photographs. They are used all the same, because the user named them, and a drawing may look like a mask.
fn hear_of_no_photographs(path: &Path, found: Option<NoPhotographs>, hear: &dyn Fn(&str)) {
    if let Some(what) = found {
        let (path, what) = (path.display(), what.words());
        hear(&format!(
            "warning: {path} holds {what}, in which a model sees little; if there are colour pictures, give their folder"
        ));
    }
}

/// The recording in a folder that holds one video or MCAP file: a robot writes a folder for each of its walks. The folder names it, because
/// the files in several such folders are often called alike.
fn lone_recording(folder: &Path) -> Result<Option<Box<dyn RecordingSource>>, PlatformError> {
    if !folder.is_dir() {
        return Ok(None);
    }
    let names = recording_files(folder)?;
    let [name] = names.as_slice() else { return Ok(None) };
    let Some(RecordingEntry::Other(inner)) = open_one(&folder.join(name))? else { return Ok(None) };
    Ok(Some(Box::new(FolderRecording { scene: scene_id_for_path(folder)?, inner })))
}

/// The names of the video and MCAP files in a folder.
fn recording_files(folder: &Path) -> Result<Vec<String>, PlatformError> {
    let is_shown = |name: &String| !name.starts_with('.') && is_recording_file(name);
    Ok(sorted_entries(folder)?.into_iter().filter(is_shown).collect())
}

/// The only recording of a folder, under the name of the folder.
struct FolderRecording {
    scene: SceneId,
    inner: Box<dyn RecordingSource>,
}

impl FolderRecording {
    /// The recording's own name.
    fn own_name(&self, scene: &SceneId) -> Result<SceneId, PlatformError> {
        let own = self.inner.scenes().into_iter().next().filter(|_| *scene == self.scene);
        own.ok_or_else(|| unknown_scene(scene, &self.scenes()))
    }
}

impl RecordingSource for FolderRecording {
    fn scenes(&self) -> Vec<SceneId> {
        vec![self.scene.clone()]
    }

    fn open(&self, scene: &SceneId) -> Result<Recording, PlatformError> {
        self.inner.open(&self.own_name(scene)?)
    }

    fn files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        self.inner.files(&self.own_name(scene)?)
    }
}

/// The error for a path that is no recording and no folder.
fn no_recording(path: &Path) -> PlatformError {
    match RecordedFileKind::from_file(path) {
        Some(kind) if PICTURE_KINDS.contains(&kind.name) => files::file_error(
            path,
            "is one picture, and a recording is a folder of them",
            "give its folder: --data DIR",
        ),
        Some(kind) => {
            files::file_error(path, format!("is not a recording that can be read: it is {}", kind.name), kind.hint)
        }
        None if path.exists() => files::file_error(path, "is not a recording of a known kind", RECORDING_HINT),
        None => files::file_error(path, "there is no such file or folder", RECORDING_HINT),
    }
}

/// The recording at a path.
///
/// # Errors
/// When there is none, or it cannot be opened.
fn open_recording(path: &Path) -> Result<Box<dyn RecordingSource>, PlatformError> {
    open_one(path)?.map(RecordingEntry::into_source).ok_or_else(|| no_recording(path))
}

/// A recording that could not be opened when its folder was listed. A run that uses it opens it again, and reports the error
/// then; runs that use other recordings of the folder go on.
struct UnopenedRecording {
    scene: SceneId,
    path: PathBuf,
}

impl RecordingSource for UnopenedRecording {
    fn scenes(&self) -> Vec<SceneId> {
        vec![self.scene.clone()]
    }

    fn open(&self, scene: &SceneId) -> Result<Recording, PlatformError> {
        open_recording(&self.path)?.open(scene)
    }

    fn files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        open_recording(&self.path)?.files(scene)
    }
}

/// A recording at a path.
enum RecordingEntry {
    Pictures(PictureFolder),
    Other(Box<dyn RecordingSource>),
}

impl RecordingEntry {
    fn into_source(self) -> Box<dyn RecordingSource> {
        match self {
            Self::Pictures(folder) => Box::new(folder),
            Self::Other(source) => source,
        }
    }
}

/// The recording at a path; `None` where there is none.
fn open_one(path: &Path) -> Result<Option<RecordingEntry>, PlatformError> {
    let other = |source| Some(RecordingEntry::Other(source));
    if path.is_dir() {
        if path.join("meta").join("info.json").is_file() {
            return open_lerobot(path, None).map(other);
        }
        if let Some(walks) = training_walks::open_annotated(path)? {
            return Ok(other(Box::new(walks)));
        }
        if let Some(bag) = open_bag(path)? {
            return Ok(other(bag));
        }
        let Some(folder) = PictureFolder::open(path)? else { return Ok(None) };
        // A picture may be among videos by chance, so the program does not guess which of them the user wants.
        if let Some((file, _)) = folder.find_beside_pictures(is_recording_file)? {
            let file = file.file_name().unwrap_or_default().display();
            let reason = format!("holds pictures and also recordings, such as {file}");
            return Err(files::file_error(path, reason, "give the recording's own path, or move the pictures away"));
        }
        // The picture files that cannot be read may be part of the same recording, so its path would have gaps.
        if let Some((file, count)) = folder.find_beside_pictures(is_unread_picture)? {
            let kind = RecordedFileKind::from_file(&file).map_or("a picture that cannot be read", |kind| kind.name);
            let more = if count > 1 { format!(" (and {} more)", count - 1) } else { String::new() };
            let reason =
                format!("holds pictures, but {} is {kind}{more}", file.file_name().unwrap_or_default().display());
            let hint = RecordedFileKind::from_file(&file).map_or("move it away", |kind| kind.hint);
            return Err(files::file_error(path, reason, hint));
        }
        return Ok(Some(RecordingEntry::Pictures(folder)));
    }
    if !path.is_file() {
        return Ok(None);
    }
    match file_ending(path).as_str() {
        "mp4" | "m4v" | "mov" => open_video(path).map(other),
        "mcap" => open_mcap(path).map(other),
        _ => Ok(None),
    }
}

/// The ending of a file's name, in lower case; empty if it has none.
fn file_ending(path: &Path) -> String {
    path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// Whether a file is, by its ending, a video or an MCAP file, which this program opens as a recording of its own.
fn is_recording_file(name: &str) -> bool {
    is_video_name(name) || has_ending(name, &["mcap"])
}

/// Opens a dataset of LeRobot or InternNav. `camera` wins over that of its recording.toml.
#[cfg(feature = "lerobot")]
pub(crate) fn open_lerobot(path: &Path, camera: Option<&str>) -> Result<Box<dyn RecordingSource>, PlatformError> {
    if let Some(walks) = training_walks::open_internnav(path)? {
        return Ok(Box::new(walks));
    }
    let file = path.join(crate::describe::FOLDER_FILE);
    let mut described = RecordingDescription::read(&file)?.refuse_pose_file_settings(&file)?;
    described.camera = camera.map(str::to_owned).or(described.camera);
    Ok(Box::new(crate::lerobot::LeRobotDataset::open(path, described)?))
}

#[cfg(not(feature = "lerobot"))]
fn open_lerobot(path: &Path, _: Option<&str>) -> Result<Box<dyn RecordingSource>, PlatformError> {
    Err(error_for_missing_feature(path, "LeRobot datasets"))
}

#[cfg(feature = "video")]
fn open_video(path: &Path) -> Result<Box<dyn RecordingSource>, PlatformError> {
    Ok(Box::new(crate::video::FilmFile::open(path, RecordingDescription::read_beside(path)?)?))
}

#[cfg(not(feature = "video"))]
fn open_video(path: &Path) -> Result<Box<dyn RecordingSource>, PlatformError> {
    Err(error_for_missing_feature(path, "MP4 files"))
}

#[cfg(feature = "mcap")]
fn open_mcap(path: &Path) -> Result<Box<dyn RecordingSource>, PlatformError> {
    let [own, of_folder] = RecordingDescription::files_beside(path);
    let described = RecordingDescription::read_beside(path)?;
    let described = described.refuse_pose_file_settings(if own.is_file() { &own } else { &of_folder })?;
    Ok(Box::new(crate::mcap::McapFile::open(path, described)?))
}

/// The recording of a rosbag2 folder. A single file keeps its own name.
#[cfg(feature = "mcap")]
fn open_bag(folder: &Path) -> Result<Option<Box<dyn RecordingSource>>, PlatformError> {
    let Some(files) = crate::mcap::find_bag_files(folder)? else { return Ok(None) };
    if let [file] = files.as_slice() {
        return open_mcap(file).map(Some);
    }
    let file = folder.join(crate::describe::FOLDER_FILE);
    let described = RecordingDescription::read(&file)?.refuse_pose_file_settings(&file)?;
    Ok(Some(Box::new(crate::mcap::McapFile::open_bag(folder, files, described)?)))
}

#[cfg(not(feature = "mcap"))]
fn open_bag(_: &Path) -> Result<Option<Box<dyn RecordingSource>>, PlatformError> {
    Ok(None)
}

#[cfg(not(feature = "mcap"))]
fn open_mcap(path: &Path) -> Result<Box<dyn RecordingSource>, PlatformError> {
    Err(error_for_missing_feature(path, "MCAP files"))
}

/// The error for a recording of a kind that was left out when this program was built.
#[cfg(not(all(feature = "lerobot", feature = "mcap", feature = "video")))]
fn error_for_missing_feature(path: &Path, what: &str) -> PlatformError {
    let hint = "build it with `cargo build --release --features full`";
    files::file_error(path, format!("this build cannot read {what}"), hint)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder of recordings, each with one picture.
    fn shelf(pictures: &[&str]) -> tempfile::TempDir {
        let shelf = tempfile::tempdir().unwrap();
        for picture in pictures {
            let file = shelf.path().join(picture);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, "").unwrap();
        }
        shelf
    }

    #[test]
    fn open_skips_hidden_entries_of_a_folder_of_recordings() {
        let shelf = shelf(&["b/1.png", "a/rgb/1.png", ".small/1.png", "notes/1.txt"]);
        std::fs::write(shelf.path().join("._a.mp4"), "").unwrap();
        let scenes = open_source(shelf.path(), &|_| ()).map(|source| source.scenes()).unwrap();
        assert_eq!(scenes.iter().map(SceneId::as_str).collect::<Vec<_>>(), ["a", "b"]);
    }

    #[cfg(feature = "mcap")]
    #[test]
    fn open_names_a_folder_with_one_file_after_the_folder() {
        let made = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/mcap/poses_zstd.mcap");
        let shelf = shelf(&["run_1/rgb/1.png", "several/a.mcap", "several/b.mcap"]);
        for run in ["run_2", "run_3"] {
            std::fs::create_dir(shelf.path().join(run)).unwrap();
            std::fs::copy(&made, shelf.path().join(run).join("front.mcap")).unwrap();
        }
        let heard = std::cell::RefCell::new(Vec::new());
        let source = open_source(shelf.path(), &|line| heard.borrow_mut().push(line.to_owned())).unwrap();
        let scenes = source.scenes();
        assert_eq!(scenes.iter().map(SceneId::as_str).collect::<Vec<_>>(), ["run_1", "run_2", "run_3"]);
        assert!(heard.borrow()[0].starts_with("several is skipped: it holds several recordings itself"), "{heard:?}");
        assert!(source.open(&scenes[1]).is_ok());
        assert!(source.files(&scenes[1]).unwrap()[0].ends_with("run_2/front.mcap"));
        assert!(source.open(&SceneId::new("front").unwrap()).is_err());
    }

    #[test]
    fn open_refuses_a_folder_with_pictures_and_recordings() {
        let shelf = shelf(&["map.png"]);
        std::fs::write(shelf.path().join("walk.mp4"), "").unwrap();
        let error = open_source(shelf.path(), &|_| ()).err().unwrap().to_string();
        assert!(error.contains("holds pictures and also recordings, such as walk.mp4"), "{error}");
    }

    /// The first bytes of files as other programs write them.
    const WEBM: &[u8] = b"\x1a\x45\xdf\xa3\x9fB\x86\x81\x01B\xf7\x81\x01B\xf2\x81\x04B\xf3\x81\x08B\x82\x84webm";
    const HEIC: &[u8] = b"\0\0\0\x1cftypheic\0\0\0\0mif1heicmiaf";
    const WEBP: &[u8] = b"RIFF\x24\0\0\0WEBPVP8 ";
    const BMP: &[u8] = b"BM\x46\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0";

    fn refused(files: &[(&str, &[u8])], path: &str) -> String {
        let folder = tempfile::tempdir().unwrap();
        for (name, bytes) in files {
            let file = folder.path().join(name);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, bytes).unwrap();
        }
        open_source(&folder.path().join(path), &|_| ()).err().unwrap().to_string()
    }

    #[test]
    fn open_names_unreadable_kinds_and_how_to_convert_them() {
        for (files, path, told) in [
            (
                &[("1.heic", HEIC), ("2.heic", HEIC)][..],
                "",
                &["1.heic is an HEIC picture (and 1 more)", "heif-convert"][..],
            ),
            (&[("rgb/1.webp", WEBP)], "", &["1.webp is a WebP picture", "ffmpeg -i IN -frames:v 1 OUT.png"]),
            (&[("walk.webm", WEBM)], "walk.webm", &["it is a WebM video", "-c:v libx264 -pix_fmt yuv420p"]),
            (&[("walk.webm", WEBM), ("notes.txt", b"no video")], "", &["walk.webm is a WebM video", "libx264"]),
            (
                &[("1.png", b""), ("2.heic", HEIC)],
                "",
                &["holds pictures, but 2.heic is an HEIC picture", "heif-convert"],
            ),
            (
                &[("1.png", b""), ("2.gif", b"GIF89a"), ("3.gif", b"GIF87a")],
                "",
                &["holds pictures, but 2.gif is a GIF picture (and 1 more)", "ffmpeg"],
            ),
            (&[("1.jpg", b""), ("2.TIF", b"II*\0")], "", &["but 2.TIF is a TIFF or raw picture"]),
            (&[("1.bmp", BMP), ("2.bmp", BMP)], "", &["1.bmp is a BMP picture (and 1 more)", "ffmpeg"]),
            (&[("walk.avi", b"RIFF\xdc\x6d\0\0AVI LIST")], "walk.avi", &["it is an AVI video", "libx264"]),
            (&[("walk.bag", b"#ROSBAG V2.0\n")], "walk.bag", &["it is a ROS 1 bag", "rosbags-convert"]),
            (&[("notes.txt", b"no video")], "", &["holds no pictures and no recordings", "PNG, JPEG"]),
            (&[("1.jpg", b"\xff\xd8\xff\xe0")], "1.jpg", &["is one picture", "give its folder: --data DIR"]),
            (&[("1.JPEG", b"\x89PNG\r\n\x1a\n")], "1.JPEG", &["is one picture", "give its folder: --data DIR"]),
        ] {
            let error = refused(files, path);
            assert!(told.iter().all(|words| error.contains(words)), "{error}");
        }
    }

    #[test]
    fn open_reports_the_files_that_it_skips() {
        let shelf = shelf(&["a/1.png"]);
        std::fs::write(shelf.path().join("b.webm"), WEBM).unwrap();
        std::fs::create_dir(shelf.path().join("c")).unwrap();
        std::fs::write(shelf.path().join("c/1.heic"), HEIC).unwrap();
        std::fs::write(shelf.path().join("notes.txt"), "notes").unwrap();
        let heard = std::cell::RefCell::new(Vec::new());
        open_source(shelf.path(), &|line| heard.borrow_mut().push(line.to_owned())).unwrap();
        let heard = heard.into_inner();
        assert_eq!(heard.len(), 2, "{heard:?}");
        assert!(
            heard[0].starts_with("b.webm is skipped: it is a WebM video, which cannot be read as it is; "),
            "{heard:?}"
        );
        assert!(
            heard[1].starts_with("c is skipped: 1.heic is an HEIC picture, which cannot be read as it is; "),
            "{heard:?}"
        );
    }

    #[test]
    fn open_skips_depth_maps_and_masks_beside_photographs_and_tells_it() {
        let shelf = tempfile::tempdir().unwrap();
        let save = |file: &str, picture: image::DynamicImage| {
            let file = shelf.path().join(file);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            picture.save(file).unwrap();
        };
        let depth = image::ImageBuffer::from_fn(8, 8, |x, y| image::Luma([(x * 300 + y) as u16]));
        save("ahead/1.png", image::DynamicImage::ImageLuma16(depth));
        let scenes = |hear: &dyn Fn(&str)| -> Vec<String> {
            let source = open_source(shelf.path(), hear).unwrap();
            source.scenes().iter().map(ToString::to_string).collect()
        };
        assert_eq!(scenes(&|_| ()), ["ahead"], "alone, they are what the user wants");
        save("sure/1.png", image::DynamicImage::new_luma8(8, 8));
        let photograph = image::ImageBuffer::from_fn(8, 8, |x, y| image::Rgb([x as u8 * 9, y as u8, 7]));
        save("walk/1.png", image::DynamicImage::ImageRgb8(photograph));
        let heard = std::cell::RefCell::new(Vec::new());
        assert_eq!(scenes(&|line| heard.borrow_mut().push(line.to_owned())), ["walk"]);
        let heard = heard.into_inner();
        assert!(heard[0].starts_with("ahead is skipped: it holds depth maps"), "{heard:?}");
        assert!(heard[1].starts_with("sure is skipped: it holds masks") && heard.len() == 2, "{heard:?}");
    }

    #[test]
    fn an_unknown_recording_error_lists_the_known_ones() {
        let shelf = shelf(&["b/1.png", "a/1.png"]);
        let source = open_source(shelf.path(), &|_| ()).unwrap();
        let error = source.open(&SceneId::new("c").unwrap()).err().unwrap().to_string();
        assert!(error.contains("--data holds a, b"), "{error}");
    }

    #[cfg(feature = "video")]
    #[test]
    fn open_refuses_two_recordings_with_one_name() {
        let shelf = shelf(&["walk/1.png"]);
        std::fs::write(shelf.path().join("walk.mp4"), "").unwrap();
        let error = open_source(shelf.path(), &|_| ()).err().unwrap().to_string();
        assert!(error.contains("two recordings with the name walk"), "{error}");
    }
}
