//! `wayword calibrate`: learns from a dataset of the user how often people name an object or a room that the labels lack, name
//! by name. The checks then know for which names a missing label means a mistake.

use crate::{
    error::{Error, Exit},
    output::Output,
    own_format,
    people::{Held, Labels, belongs, held, is_known, walks},
    platforms,
    settings::{Asked, AskedPlatform},
};
use clap::Args;
use serde::Serialize;
use std::{collections::BTreeMap, path::PathBuf};
use wayword_checks::open::{Calibration, Case, Observed, Weights};

/// `wayword calibrate`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword calibrate --platform matterport --data DATA --from R2R_train.json --out matterport.toml
  wayword check R2R_val_seen.json --platform matterport --data DATA --calibration matterport.toml")]
pub struct Calibrate {
    /// The platform.
    #[command(flatten)]
    pub platform: AskedPlatform,
    /// File of texts that people wrote: R2R, REVERIE, RxR or Wayword.
    #[arg(long, value_name = "FILE")]
    pub from: PathBuf,
    /// File to write.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
}

pub fn run(args: &Calibrate, output: &Output) -> Result<Exit, Error> {
    let platform = platforms::open(&Asked::from(args.platform.clone()).resolve()?)?;
    let (walks, surveys) = walks(platform.as_ref(), &args.from)?;
    let texts = walks.iter().map(|walk| walk.texts.len()).sum();
    let weights = Weights::shipped();
    let samples = held(&walks.iter().collect::<Vec<_>>(), &Labels::of(surveys.iter()), weights, 0);
    // As if there were as many wrong claims of a kind as true ones: the odds are then the ratio.
    let known: Vec<&Held> = samples.iter().filter(|held| is_known(&held.claim)).collect();
    let count = |case: Case, wrong: bool| {
        known.iter().filter(|held| held.wrong == wrong && belongs(&held.claim, case)).count().max(1) as f64
    };
    let share = |case: Case| (case, count(case, false) / count(case, true));
    let shares: BTreeMap<Case, f64> = Case::ALL.map(share).into();
    let observed = known.iter().filter_map(|held| {
        let missed = held.missed()?;
        let weight = if held.wrong { shares[&missed.case] } else { 1.0 };
        Some(Observed { claim: &held.claim, missed, wrong: held.wrong, weight })
    });
    let observed: Vec<Observed<'_>> = observed.collect();
    let from = args.from.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let calibration = Calibration::fit(platform.name(), &from, texts, &observed);
    std::fs::write(&args.out, written(&calibration)).map_err(Error::io(&args.out, "write"))?;
    let made = Made { names: calibration.names.len(), texts, claims: observed.len() };
    output.data(&made, format!("{} names from {} claims of {texts} texts", made.names, made.claims));
    Ok(Exit::Done)
}

/// The numbers that the command prints.
#[derive(Debug, Serialize)]
struct Made {
    names: usize,
    texts: usize,
    claims: usize,
}

fn written(calibration: &Calibration) -> String {
    let head = "# Made by `wayword calibrate`. It comes from a dataset, whose terms apply: keep it to yourself.\n\n";
    head.to_owned() + &own_format::headed::<Calibration>(&toml::to_string(calibration).unwrap_or_default())
}
