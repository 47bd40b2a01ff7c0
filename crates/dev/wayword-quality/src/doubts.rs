//! Counts the words of people's texts that the follower would doubt. The bounds of doubts are chosen by this measurement: only few words
//! of true texts may be doubted, and many of the turns that were flipped on purpose should be.

use crate::{
    corrupt_people::flip_one_turn,
    share::{ClusteredShare, aligned_table, share_cell},
};
use clap::Args;
use rayon::prelude::*;
use std::{collections::BTreeSet, path::PathBuf};
use wayword_core::{DoubtGrade, doubt::spans_overlap, seeded_rng};
use wayword_fit::fit_follower::texts::{FollowerScene, WalkedText, read_texts};
use wayword_follower::{
    FeatureWeights, Guide,
    doubt::{DoubtBounds, DoubtSite, DoubtSource, find_sites},
    route::KnownWalk,
};
use wayword_language::{reading::read_instruction, rewording::TokenisedText};
use wayword_run::{error::CommandError, output::CommandOutput};

/// The table shows, for each of these shares, the gain that this share of the words exceeds.
const EXCEEDING_SHARES: [f64; 5] = [0.005, 0.01, 0.02, 0.05, 0.1];

/// The flags of `doubts`.
#[derive(Debug, Args)]
pub struct DoubtsArgs {
    /// File with people's texts, as R2R_train.json.
    file: PathBuf,
    /// Folder of Matterport3D's and REVERIE's data.
    #[arg(long)]
    data: PathBuf,
    /// Use at most this many texts, spread over the file.
    #[arg(long)]
    limit: Option<usize>,
    /// Seed of the turns that are flipped, and of the intervals.
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

/// The doubtful sites of a text as it is, and the grade of a turn that was flipped in it.
struct TextDoubtSites {
    /// The number of its scene.
    scene: usize,
    /// The words that the follower could doubt, each with the gains of their alternatives.
    sites: Vec<DoubtSite>,
    /// The grade of the words of a turn that was flipped: `None` without a turn in the text, `Some(None)` without a doubt.
    flipped: Option<Option<DoubtGrade>>,
}

/// Prints how many words of people's texts the follower would doubt, by kind of change, and how often it doubts a flipped turn.
///
/// # Errors
/// When the data or the texts cannot be read.
pub fn measure_doubts(flags: &DoubtsArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let (scenes, files) = read_texts(&flags.data, std::slice::from_ref(&flags.file))?;
    let all: Vec<WalkedText> = files.into_iter().flatten().collect();
    let every = flags.limit.map_or(1, |limit| all.len().div_ceil(limit.max(1))).max(1);
    let picked: Vec<usize> = (0..all.len()).step_by(every).collect();
    let judged: Vec<TextDoubtSites> =
        picked.par_iter().map(|at| find_doubt_sites(&scenes, &all[*at], *at, flags.seed)).collect();
    output.print_result(&(), report_lines(&judged, flags.seed).join("\n"));
    Ok(())
}

/// The sites of a text, and the grade of a turn that is flipped in it. `at`: the number of the text, for the seed.
fn find_doubt_sites(scenes: &[FollowerScene], text: &WalkedText, at: usize, seed: u64) -> TextDoubtSites {
    let sites_in = |spelt: &TokenisedText<'_>, guide: &Guide| {
        let building = &scenes[text.scene].building;
        let known = KnownWalk { building, walk: &text.walk, heading_rad: text.heading_rad };
        find_sites(spelt, guide, known, FeatureWeights::fitted())
    };
    let turned = flip_one_turn(&text.words, &mut seeded_rng(seed, &["doubts", "turn", &at.to_string()]));
    let flipped = turned.map(|turned| {
        let place = text.words.bytes().zip(turned.bytes()).position(|(a, b)| a != b).unwrap_or_default();
        let reading = read_instruction(&turned, &BTreeSet::new());
        let sites = sites_in(&TokenisedText::from_reading(&turned, &reading), &Guide::from_reading(&reading));
        let here = sites.iter().filter(|site| spans_overlap(site.span, [place, place + 1]));
        here.filter_map(|site| DoubtBounds::default().grade_gain(site.source, site.best_gain())).max()
    });
    let sites = sites_in(&TokenisedText::from_text(&text.words), &text.guide);
    TextDoubtSites { scene: text.scene, sites, flipped }
}

fn report_lines(judged: &[TextDoubtSites], seed: u64) -> Vec<String> {
    let mut rows = vec![table_head()];
    rows.extend(DoubtSource::ALL.into_iter().map(|source| source_row(judged, source)));
    let share = |counts: &dyn Fn(&TextDoubtSites) -> Option<bool>| {
        let cases = judged.iter().filter_map(|text| Some((text.scene, counts(text)?)));
        share_cell(ClusteredShare::from_cases(cases, seed).as_ref())
    };
    let mut lines =
        vec![aligned_table(&rows), format!("{} texts; intervals of 95 %, clustered by building", judged.len())];
    for grade in DoubtGrade::ALL {
        let original = share(&|text| Some(text.sites.iter().any(|site| has_grade(site, grade))));
        let flipped = share(&|text| Some(text.flipped? >= Some(grade)));
        let name = grade.name();
        lines.push(format!(
            "{name} or worse: {original} of the texts by a change, {flipped} of turns that were flipped"
        ));
    }
    lines
}

/// Whether the default bounds give the words of a site this grade or a worse one.
fn has_grade(site: &DoubtSite, grade: DoubtGrade) -> bool {
    DoubtBounds::default().grade_gain(site.source, site.best_gain()) >= Some(grade)
}

fn table_head() -> Vec<String> {
    let shares = EXCEEDING_SHARES.map(|share| format!("{} %", 100.0 * share));
    let names = ["change of", "words"].map(str::to_owned).into_iter().chain(shares);
    names.chain(DoubtGrade::ALL.map(|grade| format!("{} or worse", grade.name()))).collect()
}

/// A row of the table: the gains that [`EXCEEDING_SHARES`] of the words exceed, and the shares of words that the bounds call doubtful.
fn source_row(judged: &[TextDoubtSites], source: DoubtSource) -> Vec<String> {
    let of_source = || judged.iter().flat_map(|text| &text.sites).filter(move |site| site.source == source);
    let mut gains: Vec<f64> = of_source().map(DoubtSite::best_gain).collect();
    gains.sort_by(|a, b| b.total_cmp(a));
    let at = |share: f64| gains.get((share * gains.len() as f64) as usize).map(|gain| format!("{gain:.2}"));
    let doubted = |grade: DoubtGrade| {
        let count = of_source().filter(|site| has_grade(site, grade)).count();
        format!("{:.1} %", 100.0 * count as f64 / gains.len().max(1) as f64)
    };
    let named = [source.name().to_owned(), gains.len().to_string()].into_iter();
    let shares = EXCEEDING_SHARES.map(|share| at(share).unwrap_or_else(|| "-".into()));
    named.chain(shares).chain(DoubtGrade::ALL.map(doubted)).collect()
}
