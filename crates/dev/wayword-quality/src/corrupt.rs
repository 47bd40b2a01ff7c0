//! Corrupts instructions that passed the checks, so that it can be counted how many corruptions the checks catch.
//!
//! The first kinds change the instruction's mentions: words that the checks recognised when the instruction was made. They cannot
//! show which words the checks fail to recognise. The other kinds use only the path and its labels (`by_path`).

mod by_path;

use rand::{Rng, seq::IndexedRandom};
use std::collections::BTreeSet;
use wayword_checks::Evidence;
use wayword_core::{InstructionStyle, MentionKind};
use wayword_formats::jsonl::InstructionRecord;
use wayword_language::lexicon::names_agree;

/// A way to corrupt an instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum InstructionCorruption {
    /// A left turn becomes a right turn, or the other way round.
    TurnFlipped,
    /// A landmark replaced by one that no frame shows.
    LandmarkAbsent,
    /// Two places swapped, where all frames that show the first come before all frames that show the second.
    OrderSwapped,
    /// Words of a reference text copied in.
    ReferenceCopied,
    /// The task's object replaced by one of another viewpoint that the last one does not show.
    TaskElsewhere,
    /// Stairs on a path without any.
    StairsAdded,
    /// A storey on which the path does not end.
    FloorWrong,
    /// A room replaced by one in which no frame is.
    RoomWrong,
    /// A thing on the other side.
    SideWrong,
    /// A task on an object that no frame shows, in a style that asks for no task.
    TaskUnasked,
}

impl InstructionCorruption {
    /// All kinds.
    pub(super) const ALL: [Self; 10] = [
        Self::TurnFlipped,
        Self::LandmarkAbsent,
        Self::OrderSwapped,
        Self::ReferenceCopied,
        Self::TaskElsewhere,
        Self::StairsAdded,
        Self::FloorWrong,
        Self::RoomWrong,
        Self::SideWrong,
        Self::TaskUnasked,
    ];

    /// Its name in the table.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::TurnFlipped => "turn flipped",
            Self::LandmarkAbsent => "landmark replaced by an absent one",
            Self::OrderSwapped => "two places swapped in order",
            Self::ReferenceCopied => "a reference's words copied",
            Self::TaskElsewhere => "the task's object from elsewhere",
            Self::StairsAdded => "stairs on a path without any",
            Self::FloorWrong => "a storey where the path does not end",
            Self::RoomWrong => "a room where the path does not lead",
            Self::SideWrong => "a thing on the other side",
            Self::TaskUnasked => "an added task on an absent object",
        }
    }
}

/// Objects of homes that replace landmarks. The list was written for this measurement and doesn't use the checks' lexicon.
const ABSENT_OBJECTS: [&str; 24] = [
    "piano",
    "treadmill",
    "fireplace",
    "refrigerator",
    "washing machine",
    "pool table",
    "bathtub",
    "chandelier",
    "dishwasher",
    "grandfather clock",
    "aquarium",
    "bookcase",
    "wardrobe",
    "printer",
    "bicycle",
    "harp",
    "couch",
    "stove",
    "toilet",
    "television",
    "crib",
    "jukebox",
    "telescope",
    "rocking chair",
];

/// A corrupted text, or `None` if this kind of corruption is not possible. `others`: the names of the things along all
/// paths of the scene.
pub(super) fn corrupt_instruction(
    kind: InstructionCorruption,
    record: &InstructionRecord,
    evidence: &Evidence,
    others: &BTreeSet<String>,
    style: &InstructionStyle,
    rng: &mut impl Rng,
) -> Option<String> {
    let text = &record.instruction.text;
    let spans = |wanted: &[MentionKind]| -> Vec<[usize; 2]> {
        record
            .instruction
            .mentions
            .iter()
            .filter(|mention| wanted.contains(&mention.kind))
            .map(|mention| mention.span)
            .collect()
    };
    let replace = |span: [usize; 2], by: &str| format!("{}{by}{}", &text[..span[0]], &text[span[1]..]);
    match kind {
        InstructionCorruption::TurnFlipped => {
            let turns: Vec<[usize; 2]> = spans(&[MentionKind::Turn])
                .into_iter()
                .filter(|span| matches!(&text[span[0]..span[1]], "left" | "right"))
                .collect();
            let span = *turns.choose(rng)?;
            Some(replace(span, if &text[span[0]..span[1]] == "left" { "right" } else { "left" }))
        }
        InstructionCorruption::LandmarkAbsent => {
            let span = *spans(&[MentionKind::Landmark, MentionKind::Target]).choose(rng)?;
            let absent: Vec<&str> =
                ABSENT_OBJECTS.into_iter().filter(|name| evidence.frames_with_thing(name).is_empty()).collect();
            Some(replace(span, absent.choose(rng)?))
        }
        InstructionCorruption::OrderSwapped => swap_places(record, evidence, rng),
        InstructionCorruption::ReferenceCopied => {
            let reference = style.references.choose(rng)?.trim_end_matches('.');
            let words: Vec<&str> = reference.split(' ').collect();
            let length = rng.random_range(10..=12).min(words.len());
            let start = rng.random_range(0..=words.len() - length);
            let run = words[start..start + length].join(" ").replace(". ", " ");
            Some(format!("{run}, {text}"))
        }
        InstructionCorruption::TaskElsewhere => {
            let span = *spans(&[MentionKind::Target]).first()?;
            let elsewhere: Vec<&String> = others
                .iter()
                .filter(|name| !evidence.final_things().iter().any(|thing| names_agree(&thing.name, name)))
                .collect();
            Some(replace(span, elsewhere.choose(rng)?))
        }
        InstructionCorruption::StairsAdded => by_path::add_stairs(text, &record.path, style, rng),
        InstructionCorruption::FloorWrong => by_path::add_wrong_floor(text, &record.path, style, rng),
        InstructionCorruption::RoomWrong => by_path::replace_room(text, evidence, style, rng),
        InstructionCorruption::SideWrong => by_path::put_on_wrong_side(text, evidence, style, rng),
        InstructionCorruption::TaskUnasked => by_path::unasked_task(text, evidence, style, rng),
    }
}

/// Swaps two places if every frame that shows the first comes before every frame that shows the second.
fn swap_places(record: &InstructionRecord, evidence: &Evidence, rng: &mut impl Rng) -> Option<String> {
    let text = &record.instruction.text;
    let places: Vec<_> = record
        .instruction
        .mentions
        .iter()
        .filter(|mention| matches!(mention.kind, MentionKind::Landmark | MentionKind::Room | MentionKind::Target))
        .collect();
    let frames = |span: [usize; 2]| {
        let name = &text[span[0]..span[1]];
        let mut frames = evidence.frames_with_thing(name);
        frames.extend(evidence.frames_in_room(name));
        frames
    };
    let mut pairs = Vec::new();
    for (at, first) in places.iter().enumerate() {
        for second in &places[at + 1..] {
            let (a, b) = (frames(first.span), frames(second.span));
            if a.iter().max().zip(b.iter().min()).is_some_and(|(last_a, first_b)| last_a < first_b) {
                pairs.push((first.span, second.span));
            }
        }
    }
    let (a, b) = *pairs.choose(rng)?;
    Some(format!("{}{}{}{}{}", &text[..a[0]], &text[b[0]..b[1]], &text[a[1]..b[0]], &text[a[0]..a[1]], &text[b[1]..]))
}
