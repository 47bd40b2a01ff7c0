//! Replays the walks of an export of steps, and counts those that end elsewhere and pictures that differ.

use std::path::PathBuf;
use wayword_report::export::replay_export;
use wayword_run::{error::CommandError, output::CommandOutput};

/// The flags of `steps`.
#[derive(Debug, clap::Args)]
pub struct StepsArgs {
    /// Folder that `wayword export --format steps` wrote.
    #[arg(long, value_name = "DIR")]
    steps: PathBuf,
    /// The run that was exported.
    #[arg(long, value_name = "DIR")]
    run: PathBuf,
    /// Draw every n-th walk again.
    #[arg(long, default_value_t = 1)]
    every: usize,
}

/// Takes the walks of an export of steps again, and prints how many end elsewhere and how many pictures differ.
///
/// # Errors
/// When the export or its run cannot be read, or a picture cannot be drawn again.
pub fn replay_steps(flags: &StepsArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let replay = replay_export(&flags.steps, &flags.run, flags.every)?;
    output.print_result(
        &replay,
        format_args!(
            "{} walks, {} astray, the farthest ends {:.2} m from its walk's end; {} pictures, {} others than those of their poses; {} pixel \
             goals, {} of them at their place",
            replay.walks,
            replay.astray,
            replay.farthest_off_m,
            replay.pictures,
            replay.others,
            replay.goals,
            replay.goals_near
        ),
    );
    Ok(())
}
