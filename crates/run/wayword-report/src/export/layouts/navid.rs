//! The layouts of Uni-NaVid (`uninavid.json`) and NaVid (`navid.json`), which share their videos: one for each decision, with all views
//! up to it.

use super::{LayoutPack, PackedCounts, write_motion_jpeg};
use std::fs;
use wayword_formats::{
    training::{
        ActionRun,
        navid::{NavidPolicy, navid_decisions, navid_sample, write_navid_file},
    },
    trajectories::PictureKind,
};
use wayword_run::{error::CommandError, interrupt, output::CommandOutput};

/// Pictures each second. The loaders take one picture a second, so none is left out.
const VIDEO_FPS: u32 = 1;
/// The folder of the videos.
const VIDEOS_FOLDER: &str = "nav_videos";

pub(super) fn pack_navid(pack: &LayoutPack<'_>, output: &CommandOutput) -> Result<PackedCounts, CommandError> {
    let videos = pack.folder.join(VIDEOS_FOLDER);
    fs::create_dir_all(&videos).map_err(CommandError::io(&videos, "make the folder"))?;
    let bar = output.progress_bar(pack.walks.len(), "walks");
    for walk in &pack.walks {
        interrupt::check_interrupt()?;
        let pictures = pack.read_pictures(walk, 0, PictureKind::Rgb)?;
        for run in navid_decisions(&walk.trajectory.actions) {
            let place = pack.folder.join(video_name(&walk.trajectory.id, run.first));
            write_motion_jpeg(&place, &pictures[..=run.first], &pack.cameras[0], VIDEO_FPS)?;
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    let mut entries = 0;
    for (policy, file) in [(NavidPolicy::UniNaVid, "uninavid.json"), (NavidPolicy::NaVid, "navid.json")] {
        let samples = pack.walks.iter().flat_map(|walk| {
            let (id, actions) = (&walk.trajectory.id, &walk.trajectory.actions);
            walk.texts.iter().enumerate().flat_map(move |(number, text)| {
                let name = format!("VLN_{id}-{number}");
                let sample = move |run: ActionRun| {
                    navid_sample(policy, (&name, video_name(id, run.first)), &text.text, actions, run)
                };
                navid_decisions(actions).into_iter().map(sample)
            })
        });
        write_navid_file(&pack.folder.join(file), samples.inspect(|_| entries += 1))?;
    }
    Ok(PackedCounts { entries, left_out: 0 })
}

/// The video of the views up to a decision.
fn video_name(walk: &str, step: usize) -> String {
    format!("{VIDEOS_FOLDER}/{walk}_{step}.avi")
}
