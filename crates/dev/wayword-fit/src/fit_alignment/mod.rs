//! Fits the weights of the alignment to stretches of walks that people gave to the parts of texts, and measures an alignment by them.

mod figures;
pub mod people_parts;

use crate::fit_follower::texts::{FollowerScene, read_scenes};
use clap::Args;
use figures::{AlignedCase, AlignedPair, AlignmentFigures, align_all};
use people_parts::{PeopleAlignedText, read_aligned_texts};
use rand::seq::SliceRandom;
use rayon::prelude::*;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};
use wayword_core::{SceneId, seeded_rng};
use wayword_follower::{
    FeatureWeights,
    alignment::{AlignmentCase, AlignmentLearner, AlignmentSlope, AlignmentWeights, PartReading, PartedText},
    learn::FitPlan,
};
use wayword_run::{error::CommandError, output::CommandOutput, written_files::write_file};

/// The flags of `fit-alignment`.
#[derive(Debug, Args)]
pub struct FitAlignmentArgs {
    /// File with parts and their stretches, as FGR2R_val_seen.json.
    file: PathBuf,
    /// Folder of Matterport3D's data.
    #[arg(long)]
    data: PathBuf,
    /// Seed of the order of texts.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Rounds over all texts.
    #[arg(long, default_value_t = 40)]
    rounds: usize,
    /// Strength of the pull of weights towards 0.
    #[arg(long, default_value_t = 0.08)]
    hold: f64,
    /// Factor of this strength for tables that distinguish finely.
    #[arg(long, default_value_t = 2.0)]
    hold_fine: f64,
    /// Write the weights, fitted on all buildings, into this file.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// The flags of `align`.
#[derive(Debug, Args)]
pub struct MeasureAlignmentArgs {
    /// File with parts and their stretches, as FGR2R_val_seen.json.
    file: PathBuf,
    /// The platform of the walks.
    #[arg(long, default_value = "matterport", value_parser = ["matterport"])]
    platform: String,
    /// Folder of Matterport3D's data.
    #[arg(long)]
    data: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    pub json: bool,
}

/// Fits the weights on every other building of a file and prints how they do on the rest, then fits them on all.
///
/// # Errors
/// When the data or the file cannot be read, or the weights cannot be written.
pub fn fit_alignment_weights(flags: &FitAlignmentArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let texts = read_aligned_texts(&flags.file)?;
    let data = AlignmentData::read(&flags.data, texts)?;
    let cases = data.cases();
    let names: BTreeSet<&SceneId> = data.texts.iter().map(|text| &text.scene).collect();
    let first_half: BTreeSet<&SceneId> = names.iter().copied().step_by(2).collect();
    let is_first = |case: &&AlignedCase<'_>| first_half.contains(&case.text.scene);
    let (first, second): (Vec<&AlignedCase<'_>>, Vec<&AlignedCase<'_>>) = cases.iter().partition(is_first);
    output.say(format!(
        "{} texts of {} buildings, {} texts of the others",
        first.len(),
        first_half.len(),
        second.len()
    ));
    let [by_first, by_second] = [&first, &second].map(|half| fit_both(flags, half));
    let [first, second] = [(&first, &by_second), (&second, &by_first)].map(|(half, weights)| align_all(half, weights));
    output.say(format!("fitted on one half, the other half:\n{}", AlignmentFigures::measure(&second).to_lines()));
    let both: Vec<AlignedPair<'_>> = first.into_iter().chain(second).collect();
    output.say(format!("each half by the other:\n{}", AlignmentFigures::measure(&both).to_lines()));
    if let Some(out) = &flags.out {
        let [words, counts] = fit_both(flags, &cases.iter().collect::<Vec<_>>());
        let name = flags.file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let origin = format!("stretches of {name}, Fine-Grained R2R");
        let FitAlignmentArgs { seed, rounds, hold, hold_fine, .. } = flags;
        let command = format!(
            "wayword-measure fit-alignment {name} --data DATA --seed {seed} --rounds {rounds} --hold {hold} --hold-fine \
             {hold_fine} --out FILE"
        );
        let text = AlignmentWeights::to_json(&words, &counts, &origin, &command);
        write_file(out, text)?;
    }
    Ok(())
}

/// Measures the shipped alignment by people's stretches.
///
/// # Errors
/// When the data or the file cannot be read.
pub fn measure_alignment(flags: &MeasureAlignmentArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let data = AlignmentData::read(&flags.data, read_aligned_texts(&flags.file)?)?;
    let cases = data.cases();
    let weights =
        [PartReading::Words, PartReading::WordCounts].map(|reading| AlignmentWeights::fitted(reading).clone());
    let figures = AlignmentFigures::measure(&align_all(&cases.iter().collect::<Vec<_>>(), &weights));
    output.print_result(&figures, figures.to_lines());
    Ok(())
}

/// Texts with their buildings.
struct AlignmentData {
    scenes: Vec<FollowerScene>,
    texts: Vec<PeopleAlignedText>,
    /// The parts of each text.
    parted: Vec<PartedText>,
}

impl AlignmentData {
    fn read(data: &Path, texts: Vec<PeopleAlignedText>) -> Result<Self, CommandError> {
        let names: BTreeSet<&SceneId> = texts.iter().map(|text| &text.scene).collect();
        let scenes = read_scenes(data, &names)?;
        let parted = texts.par_iter().map(|text| PartedText::from_spans(&text.words, &text.spans)).collect();
        Ok(Self { scenes, texts, parted })
    }

    /// The texts that lie on the viewpoints of their buildings.
    fn cases(&self) -> Vec<AlignedCase<'_>> {
        let cases = self.texts.par_iter().zip(&self.parted).filter_map(|(text, parted)| {
            let scene = self.scenes.iter().find(|scene| scene.name == text.scene)?;
            let walk: Vec<usize> = text.walk.iter().map(|id| scene.viewpoint_number(id)).collect::<Option<_>>()?;
            let follower = FeatureWeights::fitted();
            let case = AlignmentCase::new(parted, &scene.building, &walk, text.heading_rad, follower);
            Some(AlignedCase::new(text, parted, scene, &walk, case))
        });
        cases.collect()
    }
}

fn fit_both(flags: &FitAlignmentArgs, cases: &[&AlignedCase<'_>]) -> [AlignmentWeights; 2] {
    [PartReading::Words, PartReading::WordCounts].map(|reading| fit_reading(flags, cases, reading))
}

fn fit_reading(flags: &FitAlignmentArgs, cases: &[&AlignedCase<'_>], reading: PartReading) -> AlignmentWeights {
    let plan = FitPlan { rounds: flags.rounds, rate: 0.05, batch: 32, hold: flags.hold, hold_fine: flags.hold_fine };
    let mut cases = cases.to_vec();
    cases.shuffle(&mut seeded_rng(flags.seed, &["fit-alignment"]));
    let mut learner = AlignmentLearner::new(plan, reading);
    for round in 0..plan.rounds {
        for batch in cases.chunks(plan.batch) {
            let weights = learner.current_weights();
            let slopes = batch.par_iter().map(|case| {
                let mut slope = AlignmentSlope::default();
                slope.add_text(&case.case, &case.text.stretches, &weights);
                slope
            });
            learner.step_down(round, &slopes.reduce(AlignmentSlope::default, |a, b| a.plus(&b)));
        }
    }
    learner.finish()
}
