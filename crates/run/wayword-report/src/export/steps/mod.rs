//! Writes trajectories for training policies: the walks of a run as single actions (forward, left, right, stop), with what each camera
//! sees before each. The command can be repeated after an interruption: it keeps the walks that are done. Layouts of other programs
//! are packed from such a folder.

mod drawing;
mod instruction_parts;
mod replay;
mod settings;
mod store;
mod walks;

#[cfg(feature = "parquet")]
pub(super) use drawing::encode_png16;
pub use replay::{TrajectoryReplay, replay_export};

use super::{items, splits, tell_terms};
use crate::{
    export::{
        args::{ExportArgs, ExportFormat},
        steps_args::AskedSteps,
    },
    walking::WalkingScenes,
};
use serde::Serialize;
use settings::StepExportSettings;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};
use store::{TRAJECTORIES_FILE, TrajectoryMaker, TrajectoryStore, pictures_file};
use walks::{ExportedWalk, walks_from_records};
use wayword_formats::{
    DatasetFormat,
    jsonl::InstructionRecord,
    trajectories::{
        ActionTrajectory, CameraIntrinsics, CameraWalk, PixelGoal, read_camera_walks, read_trajectories,
        write_trajectories,
    },
    vlnce_actions::{self, EpisodeActions},
};
use wayword_habitat::walk::AgentGait;
use wayword_run::{
    count::count_phrase,
    error::{CommandError, Exit},
    in_order::{core_count, in_order},
    interrupt,
    output::CommandOutput,
    run_folder::{FolderLock, file, keep_config, lock_folder, read_config, read_run_settings},
};

/// The gait of RxR-CE's task: length of a step, metres, and angle of a turn, degrees.
const RXR_GAIT: [f64; 2] = [0.25, 30.0];
/// The folder in a run with the steps of its walks.
const STEPS_FOLDER: &str = "steps";
/// The camera of VLN-CE's agents: height in metres and pitch in degrees.
pub(super) const USUAL_CAMERA: [f64; 2] = [1.25, 0.0];

/// Result of an export of trajectories.
#[derive(Debug, Serialize)]
struct WrittenTrajectories {
    folder: PathBuf,
    walks: usize,
    instructions: usize,
    /// The cameras; each has taken a picture before each action.
    cameras: Vec<String>,
    pictures: usize,
    /// Parts of texts without length on the walk, which were joined with a neighbour.
    joined_parts: usize,
    /// Walks that cannot be taken; `errors.jsonl` has the reasons.
    failed: usize,
    /// The largest distance between the last place of an agent and the end of its walk, metres.
    farthest_off_m: f64,
}

/// What a layout needs of the steps that it is packed from.
pub(super) struct LayoutNeeds {
    /// The cameras, if the user names none: heights in metres, and pitches in degrees.
    pub(super) cameras: &'static [[f64; 2]],
    /// Length of a step, metres, and angle of a turn, degrees, if the layout's words fix them.
    pub(super) gait: Option<[f64; 2]>,
    /// Whether pictures become videos with H.264, which have even sides.
    pub(super) has_video: bool,
}

/// A folder of steps that holds everything a command needs.
pub(super) struct StepsFolder {
    pub(super) folder: PathBuf,
    pub(super) trajectories: Vec<ActionTrajectory>,
    pub(super) cameras: Vec<CameraIntrinsics>,
    /// Walks that cannot be taken.
    pub(super) failed: usize,
    /// Keeps other commands away while this one uses the folder.
    _held: FolderLock,
}

impl StepsFolder {
    /// What a camera has seen, by the names of the walks.
    pub(super) fn walks_of_camera(
        &self,
        camera: &CameraIntrinsics,
    ) -> Result<BTreeMap<String, CameraWalk>, CommandError> {
        let file = pictures_file(&self.folder, camera);
        let counts: BTreeMap<&str, usize> =
            self.trajectories.iter().map(|trajectory| (trajectory.id.as_str(), trajectory.actions.len())).collect();
        let mut seen = BTreeMap::new();
        for walk in read_camera_walks(&file)? {
            let count = counts.get(walk.trajectory_id.as_str());
            let is_shown = |goal: &PixelGoal| goal.pixel[0] < camera.width_px && goal.pixel[1] < camera.height_px;
            if count.is_some_and(|count| *count != walk.world_from_camera.len())
                || !walk.pixel_goals.iter().flatten().all(is_shown)
            {
                let problem =
                    format!("{}: walk {} does not fit its actions and pictures", file.display(), walk.trajectory_id);
                return Err(CommandError::usage(
                    problem,
                    "remove this file, and the same command draws its walks again",
                ));
            }
            seen.insert(walk.trajectory_id.clone(), walk);
        }
        Ok(seen)
    }
}

pub(super) fn write_steps(
    args: &ExportArgs,
    out: &Path,
    records: &[InstructionRecord],
    output: &CommandOutput,
) -> Result<Exit, CommandError> {
    items::refuse_without_poses(ExportFormat::Steps, records)?;
    let splits = splits::splits_of_records(args, records)?;
    let settings = StepExportSettings::from_flags(&args.steps)?;
    let has_shards = settings.shard.is_some();
    let walks = walks_from_records(records, &splits);
    let mut made = make_steps(args, (out, settings), &walks, &[USUAL_CAMERA], output)?;
    write_new_texts(&mut made, &walks, has_shards)?;
    write_episodes(args, out, &walks, &made.trajectories, output)?;
    tell_terms(records, output);
    report_written(&made, output)
}

/// Makes the steps that a layout is packed from, as far as they are not there yet: in the folder of `--steps`, or in that of the run.
/// What the flags leave open is as it is in that folder.
pub(super) fn make_steps_of_run(
    args: &ExportArgs,
    records: &[InstructionRecord],
    needs: &LayoutNeeds,
    output: &CommandOutput,
) -> Result<StepsFolder, CommandError> {
    items::refuse_without_poses(ExportFormat::Steps, records)?;
    let run = args.only_run()?;
    let folder = args.steps.steps.clone().unwrap_or_else(|| match needs.gait {
        Some([_, turn_deg]) if turn_deg != AgentGait::default().turn_deg() => {
            run.join(format!("{STEPS_FOLDER}_{turn_deg}deg"))
        }
        _ => run.join(STEPS_FOLDER),
    });
    let before = match folder.join(file::CONFIG).exists() {
        true => Some(read_config::<StepExportSettings>(&folder)?),
        false => None,
    };
    let mut asked = args.steps.with_defaults_from(before.as_ref());
    if let Some([forward_m, turn_deg]) = needs.gait {
        asked.forward_m = asked.forward_m.or(Some(forward_m));
        asked.turn_deg = asked.turn_deg.or(Some(turn_deg));
    }
    let settings = StepExportSettings::from_flags(&asked)?;
    settings.expect_gait(needs.gait)?;
    if needs.has_video && (settings.width_px % 2 == 1 || settings.height_px % 2 == 1) {
        let problem =
            format!("a video has even sides, and these pictures are {}x{}", settings.width_px, settings.height_px);
        return Err(CommandError::usage(problem, "give another --size-px, and another --steps"));
    }
    let splits = splits::splits_of_records(args, records)?;
    let walks = walks_from_records(records, &splits);
    let mut made = make_steps(args, (&folder, settings), &walks, needs.cameras, output)?;
    // The folder may be a dataset of its own, with texts and splits of its own: they stay as they are there.
    renew_texts(&mut made.trajectories, &walks);
    Ok(made)
}

/// The actions along each walk in RxR-CE's gait, by the name of its path; `None` if the platform has no ground. A walk that cannot be taken has
/// none, and the user is told.
pub(super) fn walk_actions(
    args: &ExportArgs,
    records: &[InstructionRecord],
    record_splits: &[String],
    output: &CommandOutput,
) -> Result<Option<BTreeMap<String, EpisodeActions>>, CommandError> {
    let run = args.only_run()?;
    let run_settings = read_run_settings(run)?;
    if !matches!(run_settings.platform.as_str(), "house" | "habitat") {
        return Ok(None);
    }
    let turn_deg = args.steps.turn_deg.or(Some(RXR_GAIT[1]));
    let steps = StepExportSettings::from_flags(&AskedSteps { turn_deg, ..args.steps.clone() })?;
    steps.expect_gait(Some(RXR_GAIT))?;
    let scenes = WalkingScenes::open_run(&run_settings, [steps.width_px, steps.height_px])?;
    let walks = walks_from_records(records, record_splits);
    let mut actions = BTreeMap::new();
    let take = |walk: &ExportedWalk<'_>| walks::trajectory_from_walk(walk, &scenes, &steps);
    in_order(&walks, core_count(), take, |walk, taken| {
        match taken? {
            Ok(taken) => {
                actions.insert(taken.id.clone(), EpisodeActions::from_positions(&taken.actions, &taken.positions));
            }
            Err(failed) => output.say(format_args!("{} is left out: {}", walk.path.id, failed.reason)),
        }
        Ok::<bool, CommandError>(true)
    })?;
    Ok(Some(actions))
}

/// Takes walks in single actions, and draws what the cameras see, as far as the folder does not have it.
fn make_steps(
    args: &ExportArgs,
    (folder, steps): (&Path, StepExportSettings),
    walks: &[ExportedWalk<'_>],
    usual_cameras: &[[f64; 2]],
    output: &CommandOutput,
) -> Result<StepsFolder, CommandError> {
    let run = args.only_run()?;
    let cameras = steps.cameras(&args.steps.camera, usual_cameras)?;
    let scenes = WalkingScenes::open_run(&read_run_settings(run)?, [steps.width_px, steps.height_px])?;
    fs::create_dir_all(folder).map_err(CommandError::io(folder, "make the folder"))?;
    let held = lock_folder(folder)?;
    keep_config(folder, &steps)?;
    let mut store = TrajectoryStore::open(folder, &cameras)?;
    let maker = TrajectoryMaker::continue_folder(folder, &scenes, &steps, &cameras, (&store, walks))?;
    take_walks(walks, &maker, &mut store, output)?;
    store.sort_and_sync(walks)?;
    // Reads the file back, so that what is reported and packed is what is there.
    let trajectories = read_trajectories(&folder.join(TRAJECTORIES_FILE))?;
    Ok(StepsFolder { folder: folder.to_owned(), trajectories, cameras, failed: store.failed_count(), _held: held })
}

/// Gives trajectories the texts and splits of this command. Returns whether any had others.
fn renew_texts(trajectories: &mut [ActionTrajectory], walks: &[ExportedWalk<'_>]) -> bool {
    let by_id: BTreeMap<&str, &ExportedWalk<'_>> = walks.iter().map(|walk| (walk.path.id.as_str(), walk)).collect();
    let mut is_changed = false;
    for trajectory in trajectories {
        let Some(walk) = by_id.get(trajectory.id.as_str()) else { continue };
        let instructions = walk.instructions(&trajectory.frame_steps);
        if trajectory.instructions != instructions || trajectory.split != walk.split {
            (trajectory.instructions, trajectory.split) = (instructions, walk.split.to_owned());
            is_changed = true;
        }
    }
    is_changed
}

/// Writes the texts and splits of this command into its folder, if an earlier command left others.
fn write_new_texts(made: &mut StepsFolder, walks: &[ExportedWalk<'_>], has_shards: bool) -> Result<(), CommandError> {
    let by_id: BTreeMap<&str, &str> = walks.iter().map(|walk| (walk.path.id.as_str(), walk.split)).collect();
    let moved = made.trajectories.iter().find_map(|trajectory| {
        let split = by_id.get(trajectory.id.as_str())?;
        (*split != trajectory.split).then_some((trajectory, split))
    });
    if let Some((trajectory, split)) = moved {
        let problem = format!(
            "{} has walk {} in split {}, and now it would be in {split}",
            made.folder.display(),
            trajectory.id,
            trajectory.split
        );
        return Err(CommandError::usage(problem, "give a new folder, because the old split has files in this one"));
    }
    if !renew_texts(&mut made.trajectories, walks) {
        return Ok(());
    }
    if has_shards {
        let problem = format!("{}: its shards hold other texts", made.folder.display());
        return Err(CommandError::usage(problem, "give a new folder"));
    }
    Ok(write_trajectories(&made.folder.join(TRAJECTORIES_FILE), &made.trajectories)?)
}

/// Takes all walks that are not done yet, several at the same time.
fn take_walks(
    walks: &[ExportedWalk<'_>],
    maker: &TrajectoryMaker<'_>,
    store: &mut TrajectoryStore,
    output: &CommandOutput,
) -> Result<(), CommandError> {
    // A unit is written as a whole: the walks of one shard, or a single walk.
    let numbers: Vec<usize> = (0..walks.len()).collect();
    let units: Vec<&[usize]> = numbers.chunks(maker.steps.shard.unwrap_or(1)).collect();
    let bar = output.progress_bar(walks.len(), "walks");
    let _interrupt_guard = interrupt::finish_items_first(None);
    let make = |unit: &&[usize]| {
        interrupt::check_interrupt()?;
        maker.make_unit(walks, unit)
    };
    let kept = in_order(&units, core_count(), make, |unit, batch| {
        store.keep_batch(&batch?)?;
        bar.inc(unit.len() as u64);
        Ok::<bool, CommandError>(true)
    });
    bar.finish_and_clear();
    kept
}

/// Adds VLN-CE's files to the folder: the episodes of each split, and their actions.
fn write_episodes(
    args: &ExportArgs,
    out: &Path,
    walks: &[ExportedWalk<'_>],
    taken: &[ActionTrajectory],
    output: &CommandOutput,
) -> Result<(), CommandError> {
    let by_id: BTreeMap<&str, &ActionTrajectory> = taken.iter().map(|taken| (taken.id.as_str(), taken)).collect();
    let splits: BTreeSet<&str> = taken.iter().map(|taken| taken.split.as_str()).collect();
    for split in splits {
        let (mut records, mut names, mut actions) = (Vec::new(), Vec::new(), BTreeMap::new());
        let of_split = walks.iter().filter(|walk| walk.split == split);
        for (walk, taken) in of_split.filter_map(|walk| Some((walk, by_id.get(walk.path.id.as_str())?))) {
            for (name, record) in &walk.texts {
                records.push((*record).clone());
                names.push(name.clone());
                actions.insert(name.clone(), EpisodeActions::from_positions(&taken.actions, &taken.positions));
            }
        }
        let mut episodes = items::episodes_from_records(DatasetFormat::Vlnce, &args.run, &records, output);
        for (episode, name) in episodes.iter_mut().zip(names) {
            episode.id = name;
        }
        items::write_items(DatasetFormat::Vlnce, &out.join(format!("{split}.json.gz")), &records, episodes)?;
        vlnce_actions::write_actions(&out.join(format!("{split}_gt.json.gz")), &actions)?;
    }
    Ok(())
}

fn report_written(made: &StepsFolder, output: &CommandOutput) -> Result<Exit, CommandError> {
    let trajectories = &made.trajectories;
    let instructions = || trajectories.iter().flat_map(|trajectory| &trajectory.instructions);
    let written = WrittenTrajectories {
        folder: made.folder.clone(),
        walks: trajectories.len(),
        instructions: instructions().count(),
        cameras: made.cameras.iter().map(CameraIntrinsics::name).collect(),
        pictures: made.cameras.len() * trajectories.iter().map(|trajectory| trajectory.actions.len()).sum::<usize>(),
        joined_parts: instructions().map(|instruction| instruction.joined_parts).sum(),
        failed: made.failed,
        farthest_off_m: trajectories.iter().map(|trajectory| trajectory.off_m).fold(0.0, f64::max),
    };
    let failures = match made.failed {
        0 => String::new(),
        failed => format!("; {} cannot be taken, and errors.jsonl says why", count_phrase(failed, "walk")),
    };
    output.print_result(
        &written,
        format_args!(
            "{} with {} and {} in {}, each ends within {:.2} m of its walk's end{failures}",
            count_phrase(written.walks, "walk"),
            count_phrase(written.instructions, "instruction"),
            count_phrase(written.pictures, "picture"),
            made.folder.display(),
            written.farthest_off_m
        ),
    );
    Ok(if made.failed > 0 { Exit::WithLoss } else { Exit::Done })
}
