//! Correlates critics of texts (automatic scores such as BLEU-4 or the agreement with pictures) with outcomes of the same texts: whether
//! agents or people reached the goal by them, and how people rated them.

mod compared;
mod correlate;
mod figures;
mod study;
#[cfg(test)]
mod tests;

use correlate::{Found, correlate};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use wayword_experiments::{
    by_pictures::{Critic, args::Pictured},
    episodes,
};
use wayword_run::{error::Error, output::Output};

/// The flags of `critics`.
#[derive(Debug, Clone, clap::Args)]
pub struct Flags {
    /// A folder that `wayword compare` made, or one that `wayword study results` wrote.
    folder: PathBuf,
    /// People's texts of the same items or paths, in any format. Without them there are no BLEU-4, ROUGE-L and CIDEr-D.
    #[arg(long, value_name = "FILE")]
    references: Option<PathBuf>,
    /// The pictures that texts are compared with.
    #[command(flatten)]
    pictured: Pictured,
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
struct Told {
    /// The item that it was written for, if known.
    item: Option<String>,
    /// The path that it was given for ([`episodes::path_name`]).
    path: String,
    scene: String,
    text: String,
}

/// The outcomes of texts by one measure, such as the success of one agent.
#[derive(Debug, Clone, PartialEq)]
struct Outcomes {
    /// The agent, or the group of people, that walked or rated.
    who: String,
    /// The measure.
    outcome: String,
    /// Numbers of texts, each with the mean over the answers to it.
    of_texts: Vec<(usize, f64)>,
    /// How many answers.
    answers: usize,
}

/// The texts of a folder, and their outcomes.
#[derive(Debug, Clone, PartialEq)]
struct Material {
    texts: Vec<Told>,
    outcomes: Vec<Outcomes>,
}

/// People's texts, by item and by path.
#[derive(Debug, Default)]
struct People {
    items: BTreeMap<String, Vec<String>>,
    paths: BTreeMap<String, Vec<String>>,
}

impl People {
    fn read(file: &Path) -> Result<Self, Error> {
        let mut people = Self::default();
        for episode in wayword_formats::read(file)? {
            let path = people.paths.entry(episodes::cluster(&episode)).or_default();
            path.extend(episode.instructions.iter().cloned());
            people.items.entry(episode.id).or_default().extend(episode.instructions);
        }
        Ok(people)
    }

    /// Other people's texts about the same item, or else the same path.
    fn others<'a>(&'a self, told: &'a Told) -> impl Iterator<Item = &'a str> {
        let of_item = told.item.as_ref().and_then(|item| self.items.get(item));
        let said = of_item.or_else(|| self.paths.get(&told.path));
        // A person's text is not compared with itself.
        said.into_iter().flatten().map(String::as_str).filter(|said| *said != told.text)
    }
}

pub fn show(flags: &Flags, output: &Output) -> Result<(), Error> {
    let found = found(flags, output)?;
    output.data(&found, correlate::lines(&found).join("\n"));
    Ok(())
}

fn found(flags: &Flags, output: &Output) -> Result<Vec<Found>, Error> {
    let material = material(flags)?;
    let mut critics = vec![figures::words(&material.texts)];
    if let Some(file) = &flags.references {
        critics.extend(figures::by_people(&material.texts, &People::read(file)?));
        if critics.iter().skip(1).all(|critic| critic.figures.iter().all(Option::is_none)) {
            let problem = format!("{}: it has no text of what the texts are about", file.display());
            return Err(Error::usage(problem, "give the file of the episodes that were compared or studied"));
        }
    }
    let file = flags.references.as_deref().unwrap_or(Path::new(""));
    if flags.pictured.clip.is_some() && flags.pictured.pictures.is_none() && flags.references.is_none() {
        return Err(Error::usage(
            "--clip: it is not known where the pictures are",
            "give a run of the same paths with --pictures, or a platform with --platform and the paths with --references",
        ));
    }
    if let Some(critic) = Critic::open(&flags.pictured, &[], file, output)? {
        critics.extend(figures::by_pictures(&material.texts, &critic, output)?);
    }
    let texts = &material.texts;
    let of = |outcomes| critics.iter().map(move |critic| correlate(texts, outcomes, critic, flags));
    Ok(material.outcomes.iter().flat_map(of).collect())
}

fn material(flags: &Flags) -> Result<Material, Error> {
    let folder = &flags.folder;
    let has = |name: &str| folder.join(name).is_file();
    if has(compared::FOLLOWED) {
        compared::read(folder)
    } else if has(study::RESULTS) {
        study::read(folder, flags.finished)
    } else if has("plan.json") && has("items.jsonl") {
        Err(Error::usage(
            format!("{}: this is a study, and not what it gave", folder.display()),
            "write its results with `wayword study results STUDY --out RESULTS`, and give that folder",
        ))
    } else {
        Err(Error::usage(
            format!("{}: there is neither a comparison nor the results of a study in it", folder.display()),
            "give a folder that `wayword compare` has finished, or one that `wayword study results` wrote",
        ))
    }
}
