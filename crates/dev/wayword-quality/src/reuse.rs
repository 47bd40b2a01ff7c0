//! Compares the calls per instruction with those of the paper's method, which asks about every frame of every path in all rounds and reuses
//! no answer.

use crate::stage::{MeasuredWorldArgs, MeasurementStage};
use wayword_run::{error::CommandError, output::CommandOutput};
use wayword_synthesis::dialogue::DEFAULT_MAX_QUESTIONS;

/// The instructions that were made, and the calls that they took.
#[derive(Debug)]
struct ReuseFigures {
    instructions: usize,
    frames: usize,
    /// Questions with their answers, in all dialogues.
    exchanges: usize,
    /// Calls that the paper's method would take for the same paths.
    papers: usize,
    /// Calls that the provider answered here.
    here: u64,
}

/// Makes instructions for paths of one building, and prints the calls next to those of the paper's method.
///
/// # Errors
/// When the platform cannot be opened, or an item fails.
pub fn measure_reuse(world: &MeasuredWorldArgs, paths: usize, output: &CommandOutput) -> Result<(), CommandError> {
    output.print_result(&(), reuse_figures(&MeasurementStage::new(world, 0.15)?, paths)?.report_lines().join("\n"));
    Ok(())
}

fn reuse_figures(stage: &MeasurementStage, paths: usize) -> Result<ReuseFigures, CommandError> {
    let made = stage.make_items(&stage.writing_job(paths)?)?.0.into_iter().collect::<Result<Vec<_>, _>>()?;
    let frames: usize = made.iter().map(|made| made.walk.path.frames.len()).sum();
    let exchanges: usize = made
        .iter()
        .flat_map(|made| &made.walk.observations)
        .flat_map(|seen| &seen.looks)
        .map(|look| look.caption.transcript.len())
        .sum();
    // For each frame an opening, every question with its answer, and a summary; for each path a text.
    let per_frame = 2 * DEFAULT_MAX_QUESTIONS + 2;
    let papers = frames * per_frame + made.len();
    Ok(ReuseFigures { instructions: made.len(), frames, exchanges, papers, here: stage.provider.log().answered })
}

impl ReuseFigures {
    fn report_lines(&self) -> [String; 3] {
        let Self { instructions, frames, exchanges, papers, here } = self;
        let per = |count: f64, whole: usize| count / whole.max(1) as f64;
        [
            format!(
                "{instructions} paths, {frames} frames, {:.1} exchanges per dialogue",
                per(*exchanges as f64, *frames)
            ),
            format!("the paper's method: {papers} calls, {:.1} per instruction", per(*papers as f64, *instructions)),
            format!("here: {here} calls, {:.1} per instruction", per(*here as f64, *instructions)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_data::TestBuildingFolder;
    use wayword_run::item::run_items;

    #[test]
    fn lines_give_the_calls_per_instruction() {
        let figures = ReuseFigures { instructions: 4, frames: 20, exchanges: 90, papers: 404, here: 62 };
        assert_eq!(
            figures.report_lines(),
            [
                "4 paths, 20 frames, 4.5 exchanges per dialogue",
                "the paper's method: 404 calls, 101.0 per instruction",
                "here: 62 calls, 15.5 per instruction",
            ]
        );
    }

    /// The paper asks nine questions about each frame, which are 20 calls with the opening and the summary. Here the
    /// ledger, which counts on its own, has one row for each call.
    #[test]
    fn calls_here_are_those_in_the_ledger_and_those_of_the_paper_follow_from_the_frames() {
        let building = TestBuildingFolder::new();
        let stage = MeasurementStage::new(&building.matterport_world(), 0.15).unwrap();
        let settings = stage.writing_job(3).unwrap().settings;
        let frames = |item: &wayword_run::item::RunItem| item.find_path(&settings, &stage.world).unwrap().frames.len();
        let frames: usize = run_items(&settings, &stage.world).unwrap().iter().map(frames).sum();
        let figures = reuse_figures(&stage, 3).unwrap();
        assert_eq!((figures.instructions, figures.frames, figures.papers), (3, frames, 20 * frames + 3));
        assert_eq!(figures.here, stage.calls().unwrap().len() as u64);
        assert!(figures.here < figures.papers as u64, "{figures:?}");
    }
}
