//! Calls per instruction, against those of the paper's way: every frame of every path, all rounds, nothing kept.

use crate::stage::{Stage, World};
use wayword::{error::Error, output::Output};
use wayword_synthesis::dialogue::QUESTIONS;

pub(super) fn measure(world: &World, paths: usize, output: &Output) -> Result<(), Error> {
    let stage = Stage::new(world, 0.15)?;
    let made = stage.make(&stage.job(paths)?)?.0.into_iter().collect::<Result<Vec<_>, _>>()?;
    let frames: usize = made.iter().map(|made| made.walk.path.frames.len()).sum();
    let exchanges: usize = made
        .iter()
        .flat_map(|made| &made.walk.observations)
        .flat_map(|seen| &seen.looks)
        .map(|look| look.caption.transcript.len())
        .sum();
    let log = stage.provider.log();
    // An opening, as many questions and answers as there are, and a summary for each frame; a text for each path.
    let per_frame = 2 * QUESTIONS + 2;
    let papers = frames * per_frame + made.len();
    let per = |calls: usize| calls as f64 / made.len().max(1) as f64;
    let lines = [
        format!(
            "{} paths, {frames} frames, {:.1} exchanges per dialogue",
            made.len(),
            exchanges as f64 / frames.max(1) as f64
        ),
        format!("the paper's way: {papers} calls, {:.1} per instruction", per(papers)),
        format!("here: {} calls, {:.1} per instruction", log.answered, per(log.answered as usize)),
    ];
    output.data(&(), lines.join("\n"));
    Ok(())
}
