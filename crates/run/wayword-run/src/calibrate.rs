//! `wayword calibrate`: learns from a dataset of the user how often people name an object or a room that the labels lack, name
//! by name. The checks then know for which names a missing label means a mistake.

use crate::{
    error::{CommandError, Exit},
    output::CommandOutput,
    own_format,
    people::{ClaimSample, LabelNames, belongs_to_case, is_known, read_people_walks, sample_claims},
    platforms,
    settings::{AskedPlatform, AskedSettings, RolePlayer},
    written_files::{find_output_place, refuse_over_input, write_file},
};
use clap::Args;
use serde::Serialize;
use std::{
    collections::BTreeMap,
    path::{Path as FilePath, PathBuf},
};
use wayword_checks::open::{Calibration, ClaimCase, ClaimObservation, SilenceWeights};
use wayword_formats::{DatasetFormat, detect_format, jsonl};

/// `wayword calibrate`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword calibrate --platform matterport --data DATA --from R2R_train.json --out matterport.toml
  wayword check R2R_val_seen.json --platform matterport --data DATA --calibration matterport.toml")]
pub struct CalibrateArgs {
    /// The platform.
    #[command(flatten)]
    pub platform: AskedPlatform,
    /// File of texts that people wrote: R2R, REVERIE, RxR, VLN-CE or Wayword.
    #[arg(long, value_name = "FILE")]
    pub from: PathBuf,
    /// File to write.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
}

/// Runs `wayword calibrate`: fits names to people's texts about a platform's paths, and writes the file.
///
/// # Errors
/// When the platform cannot be opened, the texts cannot be read, or the file cannot be written.
pub fn run_calibrate(args: &CalibrateArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    let output = &output.beside_data(&find_output_place(&args.out)?);
    refuse_over_input("--out", &args.out, [args.from.clone()])?;
    refuse_own_texts(&args.from)?;
    let platform = platforms::open_platform(&AskedSettings::from(args.platform.clone()).resolve()?)?;
    let (walks, surveys) = read_people_walks(platform.as_ref(), &args.from)?;
    let texts = walks.iter().map(|walk| walk.texts.len()).sum();
    let weights = SilenceWeights::shipped();
    let samples =
        sample_claims(&walks.iter().collect::<Vec<_>>(), &LabelNames::from_surveys(surveys.iter()), weights, 0);
    // Wrong claims are weighted so that those of a kind count as much in all as the true ones of that kind. The odds of
    // a claim are then the ratio of how often true and wrong claims are missed.
    let known: Vec<&ClaimSample> = samples.iter().filter(|sample| is_known(&sample.claim)).collect();
    let count = |case: ClaimCase, wrong: bool| {
        known.iter().filter(|sample| sample.wrong == wrong && belongs_to_case(&sample.claim, case)).count().max(1)
            as f64
    };
    let share = |case: ClaimCase| (case, count(case, false) / count(case, true));
    let shares: BTreeMap<ClaimCase, f64> = ClaimCase::ALL.map(share).into();
    let observed = known.iter().filter_map(|sample| {
        let missed = sample.missed_evidence()?;
        let weight = if sample.wrong { shares[&missed.case] } else { 1.0 };
        Some(ClaimObservation { claim: &sample.claim, missed, wrong: sample.wrong, weight })
    });
    let observed: Vec<ClaimObservation<'_>> = observed.collect();
    let from = args.from.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let calibration = Calibration::fit_names(platform.name(), &from, texts, &observed);
    write_file(&args.out, calibration_text(&calibration))?;
    let summary = CalibrationSummary { names: calibration.names.len(), texts, claims: observed.len() };
    output.print_result(&summary, format!("{} names from {} claims of {texts} texts", summary.names, summary.claims));
    Ok(Exit::Done)
}

/// Refuses texts that rules wrote from labels: labels would be compared with themselves.
fn refuse_own_texts(file: &FilePath) -> Result<(), CommandError> {
    if detect_format(file)? != DatasetFormat::Wayword {
        return Ok(());
    }
    let records = jsonl::read_records(file)?;
    if records.iter().any(|record| record.instruction.provenance.writer == RolePlayer::Rules.as_str()) {
        let problem =
            format!("{}: rules wrote its texts from labels, so they say nothing about people's words", file.display());
        return Err(CommandError::usage(
            problem,
            "give texts that people wrote, such as R2R's or REVERIE's train split",
        ));
    }
    Ok(())
}

/// The numbers that the command prints: of fitted names, of texts, and of claims that the labels lack.
#[derive(Debug, Serialize)]
struct CalibrationSummary {
    names: usize,
    texts: usize,
    claims: usize,
}

fn calibration_text(calibration: &Calibration) -> String {
    let head = "# Made by `wayword calibrate`. It comes from a dataset, whose terms apply: keep it to yourself.\n\n";
    head.to_owned() + &own_format::with_header::<Calibration>(&toml::to_string(calibration).unwrap_or_default())
}
