//! Correlates critics of texts (automatic scores such as BLEU-4 or the agreement with pictures) with outcomes of the same texts: whether
//! agents or people reached the goal by them, and how people rated them.

mod comparison;
mod correlate;
mod figures;
mod study;
#[cfg(test)]
mod tests;

use correlate::{CriticCorrelation, correlate_critic};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use wayword_experiments::{
    by_pictures::{PictureCritic, args::PictureCriticArgs},
    episodes,
};
use wayword_run::{error::CommandError, output::CommandOutput};

/// The flags of `critics`.
#[derive(Debug, Clone, clap::Args)]
pub struct CriticsArgs {
    /// A folder that `wayword compare` made, or one that `wayword study results` wrote.
    folder: PathBuf,
    /// People's texts of the same items or paths, in any format. Without them there are no BLEU-4, ROUGE-L and CIDEr-D.
    #[arg(long, value_name = "FILE")]
    references: Option<PathBuf>,
    /// The pictures that texts are compared with.
    #[command(flatten)]
    pictured: PictureCriticArgs,
    /// Of a study, take only the answers of those who finished and passed the attention checks.
    #[arg(long)]
    finished: bool,
    /// Number of resamples of whole scenes.
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    resamples: u32,
    /// Seed of the resamples.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Print the figures as JSON.
    #[arg(long)]
    pub json: bool,
}

/// A text that an agent or a person walked by or rated.
#[derive(Debug, Clone, PartialEq)]
struct OutcomeText {
    /// The item that it was written for, if known.
    item: Option<String>,
    /// The path that it was given for ([`episodes::path_name`]).
    path: String,
    scene: String,
    /// Its words.
    text: String,
}

/// The outcomes of texts by one measure, such as the success of one agent.
#[derive(Debug, Clone, PartialEq)]
struct TextOutcomes {
    /// The agent, or the group of people, that walked or rated.
    who: String,
    /// The name of the measure, such as "success".
    outcome: String,
    /// Indices of texts in [`CriticMaterial::texts`], each with the mean over the answers to the text.
    text_means: Vec<(usize, f64)>,
    /// How many answers the texts have together.
    answers: usize,
}

/// The texts of a folder, and their outcomes.
#[derive(Debug, Clone, PartialEq)]
struct CriticMaterial {
    texts: Vec<OutcomeText>,
    outcomes: Vec<TextOutcomes>,
}

/// People's texts, by item and by path.
#[derive(Debug, Default)]
struct PeopleTexts {
    items: BTreeMap<String, Vec<String>>,
    paths: BTreeMap<String, Vec<String>>,
}

impl PeopleTexts {
    fn read_episodes(file: &Path) -> Result<Self, CommandError> {
        let mut people = Self::default();
        for episode in wayword_formats::read_any_format(file)? {
            let path = people.paths.entry(episodes::episode_path_name(&episode)).or_default();
            path.extend(episode.instructions.iter().cloned());
            people.items.entry(episode.id).or_default().extend(episode.instructions);
        }
        Ok(people)
    }

    /// Other people's texts about the same item, or else the same path.
    fn others_about<'a>(&'a self, text: &'a OutcomeText) -> impl Iterator<Item = &'a str> {
        let of_item = text.item.as_ref().and_then(|item| self.items.get(item));
        let texts = of_item.or_else(|| self.paths.get(&text.path));
        // A person's text is not compared with itself.
        texts.into_iter().flatten().map(String::as_str).filter(|other| *other != text.text)
    }
}

/// Correlates critics with the success of agents or people, and prints the table.
///
/// # Errors
/// When the folder is no comparison or study with results, or the references, the pictures or the model cannot be read.
pub fn show_correlations(flags: &CriticsArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let found = find_correlations(flags, output)?;
    output.print_result(&found, correlate::table_lines(&found).join("\n"));
    Ok(())
}

fn find_correlations(flags: &CriticsArgs, output: &CommandOutput) -> Result<Vec<CriticCorrelation>, CommandError> {
    let material = read_material(flags)?;
    let mut critics = vec![figures::word_counts(&material.texts)];
    if let Some(file) = &flags.references {
        critics.extend(figures::score_by_people(&material.texts, &PeopleTexts::read_episodes(file)?));
        if critics.iter().skip(1).all(|critic| critic.figures.iter().all(Option::is_none)) {
            let problem = format!("{}: it has no text of what the texts are about", file.display());
            return Err(CommandError::usage(problem, "give the file of the episodes that were compared or studied"));
        }
    }
    let file = flags.references.as_deref().unwrap_or(Path::new(""));
    if flags.pictured.clip.is_some() && flags.pictured.pictures.is_none() && flags.references.is_none() {
        return Err(CommandError::usage(
            "--clip: it is not known where the pictures are",
            "give a run of the same paths with --pictures, or a platform with --platform and the paths with --references",
        ));
    }
    if let Some(critic) = PictureCritic::open(&flags.pictured, &[], file, output)? {
        critics.extend(figures::score_by_pictures(&material.texts, &critic, output)?);
    }
    let texts = &material.texts;
    let correlations = |outcomes| critics.iter().map(move |critic| correlate_critic(texts, outcomes, critic, flags));
    Ok(material.outcomes.iter().flat_map(correlations).collect())
}

fn read_material(flags: &CriticsArgs) -> Result<CriticMaterial, CommandError> {
    let folder = &flags.folder;
    let has = |name: &str| folder.join(name).is_file();
    if has(comparison::FOLLOWED_FILE) {
        comparison::read_comparison(folder)
    } else if has(study::RESULTS_FILE) {
        study::read_results(folder, flags.finished)
    } else if has("plan.json") && has("items.jsonl") {
        Err(CommandError::usage(
            format!("{}: this is a study, and not what it gave", folder.display()),
            "write its results with `wayword study results STUDY --out RESULTS`, and give that folder",
        ))
    } else {
        Err(CommandError::usage(
            format!("{}: there is neither a comparison nor the results of a study in it", folder.display()),
            "give a folder that `wayword compare` has finished, or one that `wayword study results` wrote",
        ))
    }
}
