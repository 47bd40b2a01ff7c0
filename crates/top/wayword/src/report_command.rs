//! `wayword report`: writes the HTML pages of a run or a comparison.

use clap::Args;
use std::path::PathBuf;
#[cfg(feature = "experiments")]
use wayword_experiments::compare;
use wayword_formats::OutputPlace;
use wayword_report::pages::{self, ReportOptions};
use wayword_run::{
    check::{CheckedAgain, check_run_again, find_changed_texts},
    error::{CommandError, Exit},
    output::CommandOutput,
    run_folder::{expect_run, file, files_of_run, is_comparison},
    written_files::{find_output_place, refuse_over_input},
};

/// `wayword report`.
#[derive(Debug, Args)]
#[command(
    after_long_help = "Examples:\n  wayword report --run runs/val_seen\n  wayword report --run runs/val_seen --items 20 --single-file --out page.html"
)]
pub struct ReportArgs {
    /// Run folder, or the folder of a comparison.
    #[arg(long, value_name = "DIR")]
    pub run: PathBuf,
    /// Show at most this many items, those with the most suspicious texts first. For a comparison: this many walks, with
    /// successes and failures of each agent and set. [default: 1000; for a comparison 100]
    #[arg(long, value_name = "N")]
    pub items: Option<usize>,
    /// HTML file to write. With more than 25 items it is the list, and the items are on numbered pages in the same folder. Pictures
    /// lie in a folder beside it, report-files for report.html. [default: report.html in the run folder]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Write one file that contains its pictures, up to 64 MiB of them, instead of pages with a folder of pictures beside them.
    #[arg(long)]
    pub single_file: bool,
    /// Show the verdicts of the run, and do not check its texts again. Without it, each text is checked as by `wayword check --run`,
    /// because somebody may have changed it; texts that fail come first.
    #[arg(long)]
    pub no_check: bool,
}

/// Items of a run that are shown, unless `--items` gives another number.
const MAX_REPORT_ITEMS: usize = 1000;
/// Walks of a comparison that are shown, unless `--items` gives another number.
#[cfg(feature = "experiments")]
const MAX_REPORT_WALKS: usize = 100;

/// Runs `wayword report`: finds out whether the folder holds a run or a comparison, and writes its pages.
pub(crate) fn run_report(args: &ReportArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    expect_run(&args.run)?;
    let out = args.out.clone().unwrap_or_else(|| args.run.join(file::REPORT));
    refuse_over_input("--out", &out, files_of_run(&args.run))?;
    let place = find_output_place(&out)?;
    let output = &output.beside_data(&place);
    if is_comparison(&args.run) {
        #[cfg(not(feature = "experiments"))]
        return Err(CommandError::not_built("the folder holds a comparison, which this build cannot show"));
        #[cfg(feature = "experiments")]
        {
            let written = compare::write_page_from_folder(&args.run, &out, args.items.unwrap_or(MAX_REPORT_WALKS))?;
            output.print_result(&written, &written);
            return Ok(Exit::Done);
        }
    }
    let checked = if args.no_check { find_changed_texts(&args.run) } else { check_run_again(&args.run, output) };
    let (again, trouble) = match checked {
        Ok(again) => (again, None),
        Err(CommandError::Interrupted) => return Err(CommandError::Interrupted),
        Err(error) => (CheckedAgain::default(), Some(error)),
    };
    let most_items = args.items.unwrap_or(MAX_REPORT_ITEMS);
    // A pipe or a device has no folder beside it for pictures.
    let is_single_file = args.single_file || !matches!(place, OutputPlace::File(_));
    let options = ReportOptions { most_items, is_single_file, again };
    let written = pages::write_report_as(&args.run, &out, &options)?;
    // Where the run itself is broken, the report has failed with the same error by now.
    if let Some(error) = trouble {
        output.say(format_args!(
            "the texts were not checked again, so the report shows the verdicts of the run: {error}"
        ));
    }
    if written.items + written.left_out == 0 {
        output.say("the run has no item yet, so the page shows none; see errors.jsonl for items that failed");
    }
    output.print_result(&written, &written);
    Ok(Exit::Done)
}
