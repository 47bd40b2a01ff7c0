//! How far critics go with success: figures of texts against people's, and whether agents arrived by those texts.

use rand::Rng;
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet, btree_map::Entry},
    path::{Path, PathBuf},
};
use wayword::{error::Error, output::Output, run::read_lines};
use wayword_core::rng;
use wayword_metrics::{
    captions::{Row, Text, Vocabulary, collapsed, ptb, scores},
    kendall_tau_b, spearman,
};
use wayword_robustness::sets::Followed;

/// The flags.
#[derive(Debug, clap::Args)]
pub(super) struct Flags {
    /// A folder that `wayword compare` made.
    compared: PathBuf,
    /// People's texts of the same items, in any format.
    #[arg(long, value_name = "FILE")]
    references: PathBuf,
    /// Number of resamples of whole scenes.
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    resamples: u32,
    /// Seed of the resamples.
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

/// What is read of a walk.
#[derive(Debug, Deserialize)]
struct Walked {
    set: String,
    item: String,
    text_index: usize,
    text: String,
}

/// A text with its critics and with what came of it.
#[derive(Debug, Clone)]
struct Judged<'a> {
    agent: &'a str,
    scene: &'a str,
    critics: [f64; 3],
    success: f64,
}

const CRITICS: [&str; 3] = ["BLEU-4", "ROUGE-L", "CIDEr-D"];

/// How far a critic goes with the success of an agent, each with the ends of its 95 % interval.
#[derive(Debug, Serialize)]
struct Found {
    agent: String,
    critic: &'static str,
    texts: usize,
    tau_b: Option<[f64; 3]>,
    spearman: Option<[f64; 3]>,
}

pub(super) fn show(flags: &Flags, output: &Output) -> Result<(), Error> {
    let followed: Vec<Followed> = read_lines(&flags.compared.join("followed.jsonl"))?;
    let walked: Vec<Walked> = read_lines(&flags.compared.join("walks.jsonl"))?;
    if followed.is_empty() {
        let problem = format!("{}: no agent walked by a text there", flags.compared.display());
        return Err(Error::usage(problem, "give a folder that `wayword compare` has finished"));
    }
    let critics = critics(&walked, &people(&flags.references)?);
    let judged = followed.iter().filter_map(|one| {
        let critics = *critics.get(&(one.set.as_str(), one.item.as_str(), one.text_index))?;
        Some(Judged { agent: &one.agent, scene: &one.scene, critics, success: one.success })
    });
    let judged: Vec<Judged<'_>> = judged.collect();
    if judged.is_empty() {
        let problem = format!("{}: it has no text of an item that was walked", flags.references.display());
        return Err(Error::usage(problem, "give the file of the episodes that were compared"));
    }
    let agents: BTreeSet<&str> = judged.iter().map(|one| one.agent).collect();
    let found: Vec<Found> = agents.into_iter().flat_map(|agent| of_agent(&judged, agent, flags)).collect();
    output.data(&found, lines(&found).join("\n"));
    Ok(())
}

/// What people said of each item.
fn people(file: &Path) -> Result<BTreeMap<String, Vec<String>>, Error> {
    let episodes = wayword_formats::read(file)?;
    Ok(episodes.into_iter().map(|episode| (episode.id, episode.instructions)).collect())
}

/// The figures of each text against people's other texts of its item, by set, item and place in the set.
fn critics<'a>(
    walked: &'a [Walked],
    people: &BTreeMap<String, Vec<String>>,
) -> BTreeMap<(&'a str, &'a str, usize), [f64; 3]> {
    let mut vocabulary = Vocabulary::default();
    let mut text = |said: &str| vocabulary.text(&ptb(&collapsed(said)));
    let mut texts: BTreeMap<(&str, &str, usize), (Text, Vec<Text>)> = BTreeMap::new();
    for one in walked {
        let key = (one.set.as_str(), one.item.as_str(), one.text_index);
        // A person's text is not held against itself.
        let others = people.get(&one.item).into_iter().flatten().filter(|said| **said != one.text);
        // Every agent walks by it; it is scored once.
        if let Entry::Vacant(vacant) = texts.entry(key) {
            let others = others.map(|said| text(said)).collect();
            vacant.insert((text(&one.text), others));
        }
    }
    texts.retain(|_, (_, others)| !others.is_empty());
    let rows: Vec<Row<'_>> =
        texts.values().map(|(text, others)| Row { text, references: others.iter().collect() }).collect();
    let figures = scores(&rows).into_iter().map(|score| [score.counts.bleu()[3], score.rouge_l, score.cider_d]);
    texts.keys().copied().zip(figures).collect()
}

fn of_agent(judged: &[Judged<'_>], agent: &str, flags: &Flags) -> Vec<Found> {
    let mut scenes: BTreeMap<&str, Vec<&Judged<'_>>> = BTreeMap::new();
    judged.iter().filter(|one| one.agent == agent).for_each(|one| scenes.entry(one.scene).or_default().push(one));
    let scenes: Vec<Vec<&Judged<'_>>> = scenes.into_values().collect();
    let whole: Vec<usize> = (0..scenes.len()).collect();
    let mut dice = rng(flags.seed, &["critics", agent]);
    let draw = |_| (0..scenes.len()).map(|_| dice.random_range(0..scenes.len())).collect::<Vec<usize>>();
    let drawn: Vec<Vec<usize>> = (0..flags.resamples).map(draw).collect();
    let with_interval = |critic: usize, correlation: fn(&[f64], &[f64]) -> Option<f64>| {
        let of = |drawn: &Vec<usize>| {
            let texts = || drawn.iter().flat_map(|at| &scenes[*at]);
            let figures: Vec<f64> = texts().map(|one| one.critics[critic]).collect();
            correlation(&figures, &texts().map(|one| one.success).collect::<Vec<f64>>())
        };
        let mut values: Vec<f64> = drawn.iter().filter_map(of).collect();
        values.sort_unstable_by(f64::total_cmp);
        let end = |share: f64| values.get(((values.len().saturating_sub(1)) as f64 * share).round() as usize).copied();
        Some([of(&whole)?, end(0.025)?, end(0.975)?])
    };
    let found = |(at, critic): (usize, &&'static str)| Found {
        agent: agent.to_owned(),
        critic,
        texts: scenes.iter().map(Vec::len).sum(),
        tau_b: with_interval(at, kendall_tau_b),
        spearman: with_interval(at, spearman),
    };
    CRITICS.iter().enumerate().map(found).collect()
}

fn lines(found: &[Found]) -> Vec<String> {
    let cell = |of: Option<[f64; 3]>| match of {
        Some([mean, low, high]) => format!("{mean:+.2} [{low:+.2}, {high:+.2}]"),
        None => "- (it never varies)".to_owned(),
    };
    let heading =
        format!("{:<20} {:<8} {:>22} {:>22} {:>6}", "agent", "critic", "Kendall's tau-b", "Spearman", "texts");
    let row = |one: &Found| {
        let (tau_b, spearman) = (cell(one.tau_b), cell(one.spearman));
        format!("{:<20} {:<8} {tau_b:>22} {spearman:>22} {:>6}", one.agent, one.critic, one.texts)
    };
    [heading].into_iter().chain(found.iter().map(row)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flags() -> Flags {
        Flags { compared: PathBuf::new(), references: PathBuf::new(), resamples: 50, seed: 0 }
    }

    #[test]
    fn a_critic_that_goes_with_success_is_told_from_one_that_does_not() {
        let scenes: Vec<String> = (0..8).map(|number| number.to_string()).collect();
        let judged: Vec<Judged<'_>> = (0..80)
            .map(|number| {
                // Every scene has as many texts of each kind.
                let success = f64::from(number / 8 % 2);
                let critics = [success + f64::from(number) / 1e6, f64::from(number / 16 % 2), 0.5];
                Judged { agent: "reader", scene: &scenes[number as usize % 8], critics, success }
            })
            .collect();
        let found = of_agent(&judged, "reader", &flags());
        assert!(found[0].spearman.unwrap()[0] > 0.8 && found[0].tau_b.unwrap()[1] > 0.6, "{found:?}");
        assert!(found[1].spearman.unwrap()[0].abs() < 1e-9);
        assert_eq!(found[2].tau_b.map(|_| ()), None);
    }

    #[test]
    fn a_text_is_held_against_other_peoples_texts_alone() {
        let walk = |set: &str, text: &str| Walked {
            set: set.to_owned(),
            item: "1".to_owned(),
            text_index: 0,
            text: text.to_owned(),
        };
        let walked = [walk("original", "Turn left at the sofa."), walk("ours", "Turn left at the sofa.")];
        let people =
            BTreeMap::from([("1".to_owned(), vec!["Turn left at the sofa.".to_owned(), "Wait here.".to_owned()])]);
        let found = critics(&walked, &people);
        assert!(found[&("original", "1", 0)][1] < 0.5, "{found:?}");
        assert!(critics(&walked, &BTreeMap::new()).is_empty());
    }
}
