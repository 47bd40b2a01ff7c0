//! Layouts that training code reads, packed from a folder of steps: no picture is drawn twice, and pictures are linked where the disk
//! allows it.

#[cfg(feature = "parquet")]
mod internnav;
#[cfg(all(feature = "parquet", feature = "video"))]
mod lerobot;
mod navid;
mod navila;
mod streamvln;

use super::{
    card, read_records, splits,
    steps::{self, LayoutNeeds, StepsFolder},
    tell_terms,
    unfinished_folder::UnfinishedFolder,
};
use crate::export::args::{ExportArgs, ExportFormat};
use serde::Serialize;
use serde_json::json;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};
use wayword_core::Verdict;
use wayword_formats::{
    jsonl::InstructionRecord,
    training::motion_jpeg::motion_jpeg_video,
    trajectories::{
        ActionTrajectory, CameraIntrinsics, CameraWalk, PictureKind, PictureLocation, TrajectoryInstruction,
        read_pictures,
    },
};
use wayword_run::{
    count::count_phrase,
    error::{CommandError, Exit},
    interrupt,
    output::CommandOutput,
    written_files::write_file,
};

/// The gait of VLN-CE's agents: length of a step, metres, and angle of a turn, degrees.
const STEP_M: f64 = 0.25;
const VLNCE_TURN_DEG: f64 = 15.0;
/// The files beside the folders of the splits.
const CARD_FILE: &str = "README.md";
const CHECKS_FILE: &str = "checks.jsonl";

/// A walk of a split, with its texts of the chosen style and what the cameras see.
struct PackedWalk<'a> {
    trajectory: &'a ActionTrajectory,
    texts: Vec<&'a TrajectoryInstruction>,
    /// In the order of the pack's cameras.
    seen: Vec<&'a CameraWalk>,
}

/// The walks of a split, and where they are packed.
struct LayoutPack<'a> {
    steps: &'a Path,
    cameras: &'a [CameraIntrinsics],
    walks: Vec<PackedWalk<'a>>,
    /// The folder of the split.
    folder: PathBuf,
}

/// What a layout got.
#[derive(Debug, Default)]
struct PackedCounts {
    /// Entries that a loader makes samples of: walks, or decisions of a walk by a text.
    entries: usize,
    /// Walks that the layout cannot hold.
    left_out: usize,
}

/// Result of an export of a layout.
#[derive(Debug, Serialize)]
struct WrittenLayout {
    folder: PathBuf,
    /// The folder of steps that it was packed from.
    steps: PathBuf,
    walks: usize,
    instructions: usize,
    entries: usize,
    left_out: usize,
    /// Parts of texts without length on the walk, which were joined with a neighbour.
    joined_parts: usize,
    /// Instructions by split.
    splits: BTreeMap<String, usize>,
    /// Walks that cannot be taken; `errors.jsonl` of the steps has the reasons.
    failed: usize,
}

impl ExportFormat {
    /// What a layout needs of its steps.
    fn layout_needs(self) -> LayoutNeeds {
        LayoutNeeds {
            cameras: match self {
                Self::Internnav => &[steps::USUAL_CAMERA, [1.25, -30.0]],
                _ => &[steps::USUAL_CAMERA],
            },
            gait: match self {
                Self::Uninavid => Some([STEP_M, wayword_formats::training::navid::NAVID_TURN_DEG]),
                Self::Streamvln | Self::Navila | Self::Internnav => Some([STEP_M, VLNCE_TURN_DEG]),
                _ => None,
            },
            has_video: self == Self::Lerobot,
        }
    }
}

/// Exports the texts of a run in a layout.
pub(super) fn export_layout(
    args: &ExportArgs,
    (format, out): (ExportFormat, &Path),
    output: &CommandOutput,
) -> Result<Exit, CommandError> {
    // The steps are those of all styles, so that layouts of several styles share them.
    let records = &read_records(args, None)?;
    // Before anything is drawn, so that a folder in use is refused at once.
    let folder = UnfinishedFolder::begin(out)?;
    let made = steps::make_steps_of_run(args, records, &format.layout_needs(), output)?;
    let seen = made.cameras.iter().map(|camera| made.walks_of_camera(camera)).collect::<Result<Vec<_>, _>>()?;
    let walks_by_split = choose_walks(&made, &seen, args.style.as_deref());
    let walks = || walks_by_split.values().flatten();
    let packed: BTreeSet<&str> = walks().map(|walk| walk.trajectory.id.as_str()).collect();
    let mut written = WrittenLayout {
        folder: out.to_owned(),
        steps: made.folder.clone(),
        walks: packed.len(),
        instructions: walks().map(|walk| walk.texts.len()).sum(),
        entries: 0,
        left_out: 0,
        joined_parts: walks().flat_map(|walk| &walk.texts).map(|text| text.joined_parts).sum(),
        splits: BTreeMap::new(),
        failed: made.failed,
    };
    write_card(args, (format, out), (&folder, records, &packed))?;
    let mut names = BTreeSet::from([CARD_FILE, CHECKS_FILE].map(str::to_owned));
    for (split, walks) in walks_by_split {
        interrupt::check_interrupt()?;
        written.splits.insert(split.to_owned(), walks.iter().map(|walk| walk.texts.len()).sum());
        let place = folder.place().join(split);
        fs::create_dir_all(&place).map_err(CommandError::io(&place, "make the folder"))?;
        let pack = LayoutPack { steps: &made.folder, cameras: &made.cameras, walks, folder: place };
        let counts = pack.pack_layout(format, output)?;
        written.entries += counts.entries;
        written.left_out += counts.left_out;
        names.insert(split.to_owned());
    }
    folder.finish(names.iter().map(String::as_str))?;
    tell_terms(records, output);
    Ok(report_written(format, &written, output))
}

/// The walks of each split with their texts of a style. A walk that a camera could not see is left out.
fn choose_walks<'a>(
    made: &'a StepsFolder,
    seen: &'a [BTreeMap<String, CameraWalk>],
    style: Option<&str>,
) -> BTreeMap<&'a str, Vec<PackedWalk<'a>>> {
    let mut walks_by_split: BTreeMap<&str, Vec<PackedWalk<'_>>> = BTreeMap::new();
    for trajectory in &made.trajectories {
        let has_style = |text: &&TrajectoryInstruction| style.is_none_or(|style| text.style == style);
        let texts: Vec<_> = trajectory.instructions.iter().filter(has_style).collect();
        let seen: Option<Vec<_>> = seen.iter().map(|walks| walks.get(&trajectory.id)).collect();
        if let Some(seen) = seen.filter(|_| !texts.is_empty()) {
            walks_by_split.entry(&trajectory.split).or_default().push(PackedWalk { trajectory, texts, seen });
        }
    }
    walks_by_split
}

/// Writes the dataset card, and what the checks left open of each text, about the texts that are packed.
fn write_card(
    args: &ExportArgs,
    (format, out): (ExportFormat, &Path),
    (folder, records, packed): (&UnfinishedFolder, &[InstructionRecord], &BTreeSet<&str>),
) -> Result<(), CommandError> {
    let is_packed = |record: &&InstructionRecord| {
        packed.contains(record.path.id.as_str())
            && args.style.as_deref().is_none_or(|style| record.instruction.style == style)
    };
    let records: Vec<InstructionRecord> = records.iter().filter(is_packed).cloned().collect();
    let record_splits = splits::splits_of_records(args, &records)?;
    let card = card::card_text(args, out, &records, &record_splits, Some(format))?;
    write_file(&folder.place().join(CARD_FILE), card)?;
    write_file(&folder.place().join(CHECKS_FILE), check_lines(&records))
}

/// For each text its verdict, and what the checks left unverified.
fn check_lines(records: &[InstructionRecord]) -> String {
    let line = |record: &InstructionRecord| {
        let with = |verdict: Verdict| -> Vec<_> {
            let findings = record.instruction.findings.iter().filter(|finding| finding.verdict == verdict);
            findings.map(|finding| json!({"check": finding.check.name(), "reason": finding.reason})).collect()
        };
        let told = json!({
            "trajectory_id": record.path.id,
            "style": record.instruction.style,
            "text": record.instruction.text,
            "verdict": record.instruction.verdict,
            "unverified": with(Verdict::Unverified),
            "failed": with(Verdict::Fail),
        });
        format!("{told}\n")
    };
    records.iter().map(line).collect()
}

fn report_written(format: ExportFormat, written: &WrittenLayout, output: &CommandOutput) -> Exit {
    let mut more = String::new();
    if written.left_out > 0 {
        more += &format!("; {} left out, which the layout cannot hold", count_phrase(written.left_out, "walk"));
    }
    if written.joined_parts > 0 {
        more += &format!("; {} without length joined", count_phrase(written.joined_parts, "part"));
    }
    if written.failed > 0 {
        more += &format!(
            "; {} cannot be taken, and errors.jsonl of the steps says why",
            count_phrase(written.failed, "walk")
        );
    }
    output.print_result(
        written,
        format_args!(
            "{} with {} in layout {format} in {}, packed from {}{more}",
            count_phrase(written.walks, "walk"),
            count_phrase(written.instructions, "instruction"),
            written.folder.display(),
            written.steps.display()
        ),
    );
    if written.failed > 0 { Exit::WithLoss } else { Exit::Done }
}

impl LayoutPack<'_> {
    fn pack_layout(&self, format: ExportFormat, output: &CommandOutput) -> Result<PackedCounts, CommandError> {
        match format {
            ExportFormat::Streamvln => streamvln::pack_streamvln(self),
            ExportFormat::Navila => navila::pack_navila(self),
            ExportFormat::Uninavid => navid::pack_navid(self, output),
            #[cfg(feature = "parquet")]
            ExportFormat::Internnav => internnav::pack_internnav(self, output),
            #[cfg(feature = "parquet")]
            ExportFormat::InternnavN1 => internnav::pack_vln_n1(self, output),
            #[cfg(all(feature = "parquet", feature = "video"))]
            ExportFormat::Lerobot => lerobot::pack_lerobot(self, output),
            _ => Err(CommandError::not_built(format!("--format {format}: this build writes no tables and no videos"))),
        }
    }

    /// Puts the pictures of a walk by a camera, which were read, into the split's folder, under the names that `name` gives them. All lie
    /// in one folder.
    fn place_pictures(
        &self,
        walk: &PackedWalk<'_>,
        (camera, kind): (usize, PictureKind),
        pictures: &[Vec<u8>],
        name: impl Fn(usize) -> PathBuf,
    ) -> Result<(), CommandError> {
        let places: Vec<PathBuf> = (0..pictures.len()).map(|number| self.folder.join(name(number))).collect();
        match &walk.seen[camera].pictures(kind).place {
            PictureLocation::Folder(folder) => {
                make_shared_folder(&places)?;
                let folder = self.steps.join(folder);
                let mut named = places.iter().enumerate();
                named.try_for_each(|(number, place)| link_or_copy(&folder.join(kind.file_name(number)), place))
            }
            PictureLocation::Sample { .. } => write_files(&places, pictures),
        }
    }

    /// The pictures of a walk by a camera, compared with their hash.
    fn read_pictures(
        &self,
        walk: &PackedWalk<'_>,
        camera: usize,
        kind: PictureKind,
    ) -> Result<Vec<Vec<u8>>, CommandError> {
        let set = walk.seen[camera].pictures(kind);
        Ok(read_pictures(self.steps, set, kind, walk.trajectory.actions.len())?)
    }
}

/// Gives a file a second name, or copies it where the disk has no such names.
fn link_or_copy(from: &Path, to: &Path) -> Result<(), CommandError> {
    if fs::hard_link(from, to).is_err() {
        fs::copy(from, to).map_err(CommandError::io(to, "write"))?;
    }
    Ok(())
}

/// Makes the folder that files share.
fn make_shared_folder(places: &[PathBuf]) -> Result<(), CommandError> {
    match places.first().and_then(|place| place.parent()) {
        Some(folder) => fs::create_dir_all(folder).map_err(CommandError::io(folder, "make the folder")),
        None => Ok(()),
    }
}

/// Writes files into the folder that they share.
fn write_files(places: &[PathBuf], contents: &[Vec<u8>]) -> Result<(), CommandError> {
    make_shared_folder(places)?;
    places
        .iter()
        .zip(contents)
        .try_for_each(|(place, bytes)| fs::write(place, bytes).map_err(CommandError::io(place, "write")))
}

/// Writes a video of JPEG pictures as they are.
fn write_motion_jpeg(
    place: &Path,
    pictures: &[Vec<u8>],
    camera: &CameraIntrinsics,
    fps: u32,
) -> Result<(), CommandError> {
    let video = motion_jpeg_video(pictures, [camera.width_px, camera.height_px], fps);
    fs::write(place, video.map_err(CommandError::io(place, "write"))?).map_err(CommandError::io(place, "write"))
}

/// Walks by their scene, in the order of the scenes.
#[cfg(feature = "parquet")]
fn walks_by_scene<'p, 'a>(pack: &'p LayoutPack<'a>) -> BTreeMap<&'p str, Vec<&'p PackedWalk<'a>>> {
    let mut scenes: BTreeMap<&str, Vec<&PackedWalk<'_>>> = BTreeMap::new();
    for walk in &pack.walks {
        scenes.entry(walk.trajectory.scene.as_str()).or_default().push(walk);
    }
    scenes
}
