//! Measures generated texts, each figure next to that of people's texts. To be independent, it shares no code with the writer or the
//! checks, except the names in the lexicon, and the English words for texts in other languages.

mod clauses;
mod copies;
pub mod houses;
mod listener;
mod names;
mod rooms;
mod row;
mod surface;

use crate::share::aligned_table;
use clap::Args;
use copies::TrainingTexts;
use row::TextFigureRow;
use serde_json::json;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};
use wayword_core::{Platform, SceneId, ViewpointSurvey};
use wayword_formats::Episode;
use wayword_language::languages::ReadableText;
use wayword_run::{
    error::CommandError,
    output::CommandOutput,
    platforms,
    settings::{AskedPlatform, AskedSettings},
};
use wayword_world::survey_scene;

/// The flags of `texts`.
#[derive(Debug, Args)]
pub struct TextFiguresArgs {
    /// Generated texts: a dataset file of any format.
    generated: PathBuf,
    /// People's texts of the same items, for a second column.
    #[arg(long)]
    people: Option<PathBuf>,
    /// Texts that the writer could have copied from. Runs of words and skeletons in common with them are counted.
    #[arg(long)]
    train: Option<PathBuf>,
    /// Platform of the paths, to check by its labels whether a text pins its target down.
    #[arg(long, requires = "data")]
    platform: Option<String>,
    /// Folder of the platform's data.
    #[arg(long, requires = "platform")]
    data: Option<PathBuf>,
    /// Show this many generated texts that do not pin their target down, and why.
    #[arg(long, default_value_t = 0)]
    show: usize,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Prints figures of generated texts next to those of people's texts about the same items.
///
/// # Errors
/// When a file cannot be read, or the platform cannot be opened or lacks a scene.
pub fn measure_texts(flags: &TextFiguresArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let generated = read_in_english(&flags.generated)?;
    let people = flags.people.as_deref().map(|file| read_same_items(file, &generated)).transpose()?;
    let train = flags.train.as_deref().map(read_in_english).transpose()?;
    let train = train.map(|episodes| TrainingTexts::from_texts(&texts_in_turn(&episodes)));
    let platform = flags.platform.clone().map(|name| open_platform(name, flags.data.clone())).transpose()?;
    let mut sides: Vec<(&str, Vec<TextFigureRow>)> = Vec::new();
    for (name, episodes) in [("generated", Some(&generated)), ("people", people.as_ref())] {
        let Some(episodes) = episodes else { continue };
        let mut rows = text_rows(episodes, train.as_ref());
        let surveys =
            platform.as_deref().map_or_else(|| Ok(BTreeMap::new()), |platform| survey_scenes(platform, episodes))?;
        rows.extend(rooms::room_rows(episodes, &surveys));
        if let Some(platform) = &platform {
            let heard = listener::hear_episodes(platform.as_ref(), &surveys, episodes)?;
            rows.extend(listener::listener_rows(&heard));
            let wrong = heard.iter().filter(|heard| name == "generated" && !heard.is_pinned()).take(flags.show);
            wrong.for_each(|heard| output.say(format!("{}: {}: {}", heard.item, heard.describe_fault(), heard.text)));
        }
        sides.push((name, rows));
    }
    let value = sides.iter().map(|(name, rows)| ((*name).to_owned(), json!(rows))).collect::<serde_json::Map<_, _>>();
    output.print_result(&value, side_by_side(&sides));
    Ok(())
}

/// The items of a file. A text in another language that the program reads is in English words, so that all figures count the same.
fn read_in_english(file: &Path) -> Result<Vec<Episode>, CommandError> {
    let mut episodes = wayword_formats::read_any_format(file)?;
    for text in episodes.iter_mut().flat_map(|episode| &mut episode.instructions) {
        let readable = ReadableText::new(text, None);
        if readable.is_glossed() {
            *text = readable.english().to_owned();
        }
    }
    Ok(episodes)
}

fn open_platform(platform: String, data: Option<PathBuf>) -> Result<Box<dyn Platform>, CommandError> {
    let asked = AskedPlatform { platform: Some(platform), data, ..AskedPlatform::default() };
    platforms::open_platform(&AskedSettings::from(asked).resolve()?)
}

/// Surveys of the episodes' scenes, as far as the platform has them.
fn survey_scenes(
    platform: &dyn Platform,
    episodes: &[Episode],
) -> Result<BTreeMap<SceneId, ViewpointSurvey>, CommandError> {
    let available: BTreeSet<SceneId> = platform.list_scenes()?.into_iter().collect();
    let scenes: BTreeSet<&SceneId> = episodes.iter().map(|episode| &episode.scene).collect();
    let survey = |scene: &&SceneId| Ok(((*scene).clone(), survey_scene(platform, scene)?));
    scenes.iter().filter(|scene| available.contains(**scene)).map(survey).collect()
}

/// The items of people's file that are among the generated ones; all items of the file where none is.
fn read_same_items(file: &Path, generated: &[Episode]) -> Result<Vec<Episode>, CommandError> {
    let ids: BTreeSet<&str> = generated.iter().map(|episode| episode.id.as_str()).collect();
    let (same, others): (Vec<Episode>, Vec<Episode>) =
        read_in_english(file)?.into_iter().partition(|episode| ids.contains(episode.id.as_str()));
    Ok(if same.is_empty() { others } else { same })
}

/// The figures that need only the texts.
fn text_rows(episodes: &[Episode], train: Option<&TrainingTexts>) -> Vec<TextFigureRow> {
    let texts = texts_in_turn(episodes);
    let mut rows = surface::surface_rows(&texts);
    rows.extend(copies::copy_rows(&texts, train));
    rows
}

/// The first text of each item, then the second ones, and so on.
fn texts_in_turn(episodes: &[Episode]) -> Vec<&str> {
    let most = episodes.iter().map(|episode| episode.instructions.len()).max().unwrap_or(0);
    let nth = |at: usize| episodes.iter().filter_map(move |episode| episode.instructions.get(at));
    (0..most).flat_map(nth).map(String::as_str).collect()
}

/// A table with a column for each side, and a line for each row of the first side.
fn side_by_side(sides: &[(&str, Vec<TextFigureRow>)]) -> String {
    let head = std::iter::once(String::new()).chain(sides.iter().map(|(name, _)| (*name).to_owned()));
    let names = sides.first().map_or(&[][..], |(_, rows)| rows);
    let line = |row: &TextFigureRow| {
        let cell = |rows: &[TextFigureRow]| {
            rows.iter().find(|other| other.name == row.name).map_or("-".to_owned(), |row| row.value.table_cell())
        };
        std::iter::once(row.name.clone()).chain(sides.iter().map(|(_, rows)| cell(rows))).collect()
    };
    aligned_table(&std::iter::once(head.collect()).chain(names.iter().map(line)).collect::<Vec<_>>())
}
