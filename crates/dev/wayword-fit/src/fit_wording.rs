//! Counts how people's texts describe a way, for `style/builtin/way.toml` of `wayword-synthesis`, and for the file of another language
//! beside it.

use crate::matterport::open_matterport;
use clap::Args;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
};
use wayword_core::SceneId;
use wayword_language::{
    lexicon::{room_name, same_room},
    reading::{EventContent, TextReading},
};
use wayword_run::{
    error::CommandError,
    output::CommandOutput,
    people::{PeopleText, PeopleWalk, left_out, read_people_walks},
    text_language::ForeignTexts,
};
use wayword_synthesis::style::{LanguageWording, count_shapes, way::WayWording};

/// The flags of `fit-wording`.
#[derive(Debug, Args)]
pub struct FitWordingArgs {
    /// File of people's texts. Its last ten buildings by name are left out.
    texts: PathBuf,
    /// Folder of Matterport3D's and REVERIE's data: what a room is labelled.
    #[arg(long)]
    data: PathBuf,
}

/// With fewer mentions of a labelled room, how people call it is not known.
const MIN_ROOM_MENTIONS: f64 = 40.0;
/// A name of a labelled room is kept if at least this share of its mentions use it.
const MIN_NAME_SHARE: f64 = 0.04;
/// The unnamed room is looked for in so many clauses at the end of a text.
const LAST_CLAUSES: usize = 2;

/// The names of each labelled room, by its usual name, with how many texts use them.
type RoomNames = BTreeMap<String, BTreeMap<String, f64>>;

/// Prints the constructions of the texts with their counts, as TOML. Shapes consist of the words that `way.toml` lists, and where the
/// texts show too few of a kind, those of `way.toml` are printed. `rooms_by_label` has the names that people give to rooms of a label.
/// Of texts in another language all counts are printed, and no `rooms_by_label`.
///
/// # Errors
/// When the texts or the data cannot be read.
pub fn fit_wording(flags: &FitWordingArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let platform = open_matterport(&flags.data)?;
    let (mut walks, _) = read_people_walks(platform.as_ref(), &flags.texts)?;
    let scenes: BTreeSet<SceneId> = walks.iter().map(|walk| walk.path.scene.clone()).collect();
    let apart = left_out(&scenes);
    walks.retain(|walk| !apart.contains(&walk.path.scene));
    let texts: Vec<&PeopleText> = walks.iter().flat_map(|walk| &walk.texts).collect();
    let language = ForeignTexts::find(texts.iter().map(|text| text.words.as_str()));
    if let Some(language) = language.and_then(|found| LanguageWording::of_language(found.language)) {
        let words: Vec<String> = texts.iter().map(|text| text.words.clone()).collect();
        return print_wording(&count_shapes(language, &words), texts.len(), output);
    }
    let mut wording = WayWording::from_texts(texts.iter().map(|text| (text.words.as_str(), &text.reading)));
    wording.rooms_by_label = count_room_names(&walks);
    print_wording(&wording, texts.len(), output)
}

fn print_wording(wording: &WayWording, texts: usize, output: &CommandOutput) -> Result<(), CommandError> {
    let as_toml = toml::to_string(wording).map_err(|error| CommandError::usage(error.to_string(), "report this"))?;
    output.print_result(&(), format!("# {texts} texts\n{as_toml}"));
    Ok(())
}

/// How people call the rooms of each label.
fn count_room_names(walks: &[PeopleWalk]) -> RoomNames {
    let mut names = RoomNames::new();
    for walk in walks {
        let labels: Vec<&str> =
            walk.evidence.frames.iter().flat_map(|frame| &frame.rooms).filter_map(|room| room_name(room)).collect();
        let end = walk.evidence.frames.last().and_then(|frame| frame.rooms.first()).and_then(|room| room_name(room));
        for text in &walk.texts {
            for (label, name) in named_rooms(text, &labels) {
                *names.entry(label.to_owned()).or_default().entry(name).or_default() += 1.0;
            }
            if let Some(end) = end.filter(|_| ends_in_the_room(&text.reading)) {
                *names.entry(end.to_owned()).or_default().entry("room".to_owned()).or_default() += 1.0;
            }
        }
    }
    names.remove("stairs");
    names.retain(|_, names| {
        let total: f64 = names.values().sum();
        names.retain(|_, texts| *texts >= total * MIN_NAME_SHARE);
        total >= MIN_ROOM_MENTIONS
    });
    names
}

/// The rooms that a text names, each with the label on the walk that it means: its own, or else one that people do not keep apart from it.
fn named_rooms<'l>(text: &PeopleText, labels: &[&'l str]) -> BTreeSet<(&'l str, String)> {
    let mut named = BTreeSet::new();
    for event in &text.reading.events {
        let EventContent::Place(place) = &event.what else { continue };
        let Some(said) = text.words.get(event.span[0]..event.span[1]).map(str::to_lowercase) else { continue };
        let is_plain = place.is_room && !place.several && said.chars().all(|c| c.is_ascii_lowercase() || c == ' ');
        let Some(usual) = room_name(&place.name).filter(|_| is_plain) else { continue };
        let own = labels.iter().find(|label| **label == usual);
        if let Some(label) = own.or_else(|| labels.iter().find(|label| same_room(label, usual))) {
            named.insert((*label, said));
        }
    }
    named
}

/// Whether the last clauses of a text speak of "the room" and name none.
fn ends_in_the_room(reading: &TextReading) -> bool {
    let worded = reading.clauses.iter().enumerate().filter(|(_, clause)| clause.span[0] < clause.span[1]);
    let Some((first, clause)) = worded.rev().take(LAST_CLAUSES).last() else { return false };
    let from = clause.span[0];
    let names_a_room = reading
        .events
        .iter()
        .any(|event| matches!(&event.what, EventContent::Place(place) if place.is_room) && event.clause >= first);
    let mut words = reading.tokens().iter().filter(|token| token.span[0] >= from && token.is_word());
    !names_a_room && words.any(|token| token.word == "room")
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_language::reading::read_instruction;

    fn text(words: &str) -> PeopleText {
        PeopleText {
            words: words.into(),
            reading: read_instruction(words, &BTreeSet::new()).into_claims(),
            claims: Vec::new(),
        }
    }

    #[test]
    fn named_rooms_finds_the_label_that_a_name_means() {
        let named = |words: &str, labels: &[&'static str]| named_rooms(&text(words), labels);
        let living = |label| BTreeSet::from([(label, "living room".to_owned())]);
        assert_eq!(named("Stop in the living room.", &["hallway", "family room"]), living("family room"));
        assert_eq!(named("Stop in the living room.", &["family room", "living room"]), living("living room"));
        assert!(named("Stop in the living room.", &["kitchen", "bathroom"]).is_empty());
    }

    #[test]
    fn ends_in_the_room_looks_at_the_last_clauses_alone() {
        let ends = |words: &str| ends_in_the_room(&text(words).reading);
        assert!(ends("Walk down the hallway. Turn left. Enter the room and stop."));
        assert!(!ends("Leave the room. Walk down the hallway. Turn left. Stop."));
        assert!(!ends("Enter the bedroom. Leave the room and stop in the kitchen."));
    }
}
