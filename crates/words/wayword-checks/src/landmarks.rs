//! Checks that each landmark of a text is shown by a frame of the path, on the side and in the colour that the text
//! gives it.

use super::{CheckSubject, findings_or_pass, new_finding, sides};
use crate::{
    evidence::{Evidence, EvidenceSource, SeenThing},
    memory::{frames_at_doors, is_door},
};
use std::collections::BTreeMap;
use wayword_core::{CheckFinding, CheckKind, ObjectDistinction, PathTarget, Verdict};
use wayword_language::{
    lexicon::{ThingClass, find_thing, names_agree, same_colour, same_room},
    reading::{EventContent, PlaceLink, PlaceMention, TextReading},
};

/// How a finding begins that could not decide whether a thing is there. A model that sees may be asked.
pub const UNDECIDED_PRESENCE: &str = "the program cannot check whether there is";

/// The findings about the places of a text, and the frames that show them.
pub(super) struct LandmarkFindings {
    pub(super) findings: Vec<CheckFinding>,
    /// For each event of the reading, the frames that show it.
    pub(super) shown: Vec<ShownFrames>,
}

/// The frames that show a place; both lists are empty for an event that is no place.
#[derive(Debug, Clone, Default)]
pub(super) struct ShownFrames {
    /// The frames that show it.
    pub(super) frames: Vec<usize>,
    /// The frames that may show it, because their objects or rooms are not known, or a witness was unsure.
    pub(super) unknown: Vec<usize>,
}

/// Checks each place of a text. The object of a task (`object`) is left to the check of the task. If `made_up` is
/// true, a place that no witness names counts as invented by the writer, and is wrong.
pub(super) fn check_landmarks(
    reading: &TextReading,
    subject: CheckSubject<'_>,
    object: Option<usize>,
    made_up: bool,
) -> LandmarkFindings {
    let evidence = subject.evidence;
    let (mut findings, mut all_shown) = (Vec::new(), Vec::new());
    let seen = SightingIndex::from_evidence(evidence);
    let target = subject.target.filter(|_| evidence.source.leaves_out());
    let facts: Vec<&ObjectDistinction> = target.into_iter().flat_map(PathTarget::known_facts).collect();
    for (at, event) in reading.events.iter().enumerate() {
        let EventContent::Place(place) = &event.what else {
            all_shown.push(ShownFrames::default());
            continue;
        };
        let is_object = object == Some(at);
        let shown = if is_object { at_the_end(place, evidence) } else { seen.frames_showing(place) };
        let is_given = is_object || (shown.frames.is_empty() && names_neighbour(place, &facts));
        let wrong = if is_given { None } else { wrong_presence(place, &shown, evidence, made_up) };
        let off_colour = wrong_colour(place, &shown, evidence).filter(|_| !(is_object && has_colour(place, &facts)));
        findings.extend(
            wrong
                .into_iter()
                .chain(off_colour)
                .map(|(verdict, reason)| new_finding(CheckKind::Landmarks, verdict, reason, Some(event.span))),
        );
        all_shown.push(shown);
    }
    if evidence.source == EvidenceSource::Nothing && findings.is_empty() {
        findings.push(new_finding(
            CheckKind::Landmarks,
            Verdict::Unverified,
            "the program does not know what can be seen along the path",
            None,
        ));
    }
    LandmarkFindings { findings: findings_or_pass(CheckKind::Landmarks, findings), shown: all_shown }
}

/// Whether the world itself has told that a place is beside the target. Witnesses may have missed it.
fn names_neighbour(place: &PlaceMention, facts: &[&ObjectDistinction]) -> bool {
    facts.iter().flat_map(|fact| fact.named_things()).any(|name| names_agree(name, &place.name))
}

/// Whether the world itself has told the colour that a text gives the target.
fn has_colour(place: &PlaceMention, facts: &[&ObjectDistinction]) -> bool {
    let claimed = place.colour.as_deref().unwrap_or_default();
    let is_it = |fact: &&ObjectDistinction| matches!(fact, ObjectDistinction::Colour { colour } if same_colour(colour, claimed));
    facts.iter().any(is_it)
}

/// The mistake in where the text puts a place: it is nowhere along the path, or on another side.
fn wrong_presence(
    place: &PlaceMention,
    shown: &ShownFrames,
    evidence: &Evidence,
    made_up: bool,
) -> Option<(Verdict, String)> {
    if shown.frames.is_empty() && is_beyond(place, evidence) {
        return None;
    }
    if shown.frames.is_empty() {
        let verdict = verdict_on_absence(place, evidence, made_up);
        return Some(match verdict {
            Verdict::Fail => (verdict, format!("no frame of the path shows {:?}", place.name)),
            _ => (verdict, format!("{UNDECIDED_PRESENCE} {:?}", place.name)),
        });
    }
    if sides::is_side_unknown(place, evidence) {
        let reason = format!("the program cannot check on which side of the walker {:?} is", place.name);
        return Some((Verdict::Unverified, reason));
    }
    let side = sides::wrong_side(place, &shown.frames, evidence)?;
    let reason = format!("{:?} is not on the {} where the path passes it", place.name, sides::side_word(side));
    // Captions miss things, so one may be on the other side too. A writer that used only captions cannot know of it.
    let is_unlisted = |at: &usize| {
        evidence.frames[*at].things.iter().any(|thing| thing.is_unlisted && names_agree(&thing.name, &place.name))
    };
    let leaves_out = evidence.source.leaves_out() || shown.frames.iter().any(is_unlisted);
    let may_be_missed = leaves_out && !made_up;
    Some((if may_be_missed { Verdict::Unverified } else { wrong_unless_elsewhere(shown) }, reason))
}

/// Whether a text mentions a room next to the one at the end, or a thing in it, only to identify that room or a thing
/// there.
pub(crate) fn is_beyond(place: &PlaceMention, evidence: &Evidence) -> bool {
    // Every building has these.
    if matches!(&*place.name, "wall" | "floor" | "ceiling") && place.side.is_none() && place.colour.is_none() {
        return true;
    }
    let only_identifies = matches!(place.link, PlaceLink::Beside | PlaceLink::Within) && place.side.is_none();
    let beyond = &evidence.beyond;
    let is_room = || place.is_room && beyond.rooms.iter().any(|room| same_room(room, &place.name));
    let is_thing = || place.is_thing && beyond.things.iter().any(|thing| names_agree(thing, &place.name));
    only_identifies && (is_room() || is_thing())
}

/// The verdict on a place that is wrong at every frame that shows it. It may still be right at frames with unknown
/// objects.
fn wrong_unless_elsewhere(shown: &ShownFrames) -> Verdict {
    if shown.unknown.is_empty() { Verdict::Fail } else { Verdict::Unverified }
}

/// The mistake in the colour that the text gives a place.
fn wrong_colour(place: &PlaceMention, shown: &ShownFrames, evidence: &Evidence) -> Option<(Verdict, String)> {
    let claimed = place.colour.as_ref()?;
    let things = shown
        .frames
        .iter()
        .flat_map(|at| &evidence.frames[*at].things)
        .filter(|thing| names_agree(&thing.name, &place.name));
    let things: Vec<&SeenThing> = things.collect();
    let is_disputed = || things.iter().any(|thing| thing.disputed_colour.is_some());
    let known: Vec<&String> = things.iter().flat_map(|thing| thing.colour.iter().chain(&thing.more_colours)).collect();
    // "The brown chair" for a dark brown one is no mistake, nor is "cream" for beige.
    let fits = known.iter().any(|colour| same_colour(colour, claimed)) || looks_tell_colour(place, claimed, evidence);
    let unverified = |reason: String| Some((Verdict::Unverified, reason));
    match (known.is_empty(), fits) {
        (_, true) => None,
        (false, false) if is_disputed() => {
            unverified(format!("labels and the witness give {:?} different colours", place.name))
        }
        (true, false) if shown.frames.is_empty() => None,
        (true, false) => {
            Some((Verdict::Unverified, format!("the program cannot check whether {:?} is {claimed}", place.name)))
        }
        (false, false) => {
            Some((wrong_unless_elsewhere(shown), format!("no {:?} along the path is {claimed}", place.name)))
        }
    }
}

/// Whether the looks of some thing have the colour and the name of a place: "with purple flowers", "in an orange pot".
fn looks_tell_colour(place: &PlaceMention, claimed: &str, evidence: &Evidence) -> bool {
    let looks = evidence.frames.iter().flat_map(|frame| &frame.things).filter_map(|thing| thing.detail.as_deref());
    let has_colour = |look: &str| look.split(' ').any(|word| same_colour(word, claimed));
    looks.into_iter().any(|look| has_colour(look) && tells_of(look, &place.name))
}

/// The things of the evidence, sorted by name. A path shows a few dozen names over and over, so each place of a text is
/// compared with each name once.
struct SightingIndex<'a> {
    evidence: &'a Evidence,
    /// By the name of a thing, the frames that show one.
    frames_of_things: BTreeMap<&'a str, Vec<usize>>,
    /// What pictures show, what belongs to things, and what they are made of ("of a ship", "with a brass knob", "tile"), with the
    /// frames.
    details: Vec<(&'a str, usize)>,
    /// The frames on both sides of a door or doorway through which the walk leads.
    doors: Vec<usize>,
}

impl<'a> SightingIndex<'a> {
    fn from_evidence(evidence: &'a Evidence) -> Self {
        let mut frames_of_things: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (at, frame) in evidence.frames.iter().enumerate() {
            for thing in &frame.things {
                frames_of_things.entry(&thing.name).or_default().push(at);
            }
        }
        let details = evidence.frames.iter().enumerate().flat_map(|(at, frame)| {
            let looks = |thing: &'a SeenThing| [thing.detail.as_deref(), thing.material.as_deref()];
            frame.things.iter().flat_map(looks).flatten().map(move |look| (look, at))
        });
        Self { evidence, frames_of_things, details: details.collect(), doors: frames_at_doors(evidence) }
    }

    /// The frames that show a place, and those that may show it.
    fn frames_showing(&self, place: &PlaceMention) -> ShownFrames {
        let (mut frames, mut unknown) = (Vec::new(), Vec::new());
        if place.is_room {
            frames.extend(self.evidence.frames_in_room(&place.name));
            unknown.extend(self.evidence.frames_without_room());
        }
        if place.is_thing {
            let agreeing = self.frames_of_things.iter().filter(|(name, _)| names_agree(name, &place.name));
            frames.extend(agreeing.flat_map(|(_, frames)| frames));
            frames.extend(
                self.details.iter().filter(|(detail, _)| tells_of(detail, &place.name)).map(|(_, frame)| frame),
            );
            unknown.extend(self.evidence.frames_without_things());
            unknown.extend(self.evidence.frames_perhaps_with(&place.name));
        }
        if find_thing(&place.name).is_some_and(|thing| thing.class == ThingClass::Stairs) {
            frames.extend(self.evidence.frames_on_stairs());
        }
        if is_door(&place.name) {
            frames.extend(&self.doors);
        }
        frames.sort_unstable();
        frames.dedup();
        unknown.sort_unstable();
        unknown.dedup();
        unknown.retain(|frame| frames.binary_search(frame).is_err());
        ShownFrames { frames, unknown }
    }
}

/// Whether a look of a thing has a name in it. Of a name that the lexicon lacks ("pink tiles"), its last word counts.
fn tells_of(look: &str, name: &str) -> bool {
    let words: Vec<&str> = look.split(' ').collect();
    let has = |name: &str| {
        let length = name.split(' ').count();
        words.windows(length.min(words.len()).max(1)).any(|words| names_agree(&words.join(" "), name))
    };
    has(name) || (find_thing(name).is_none() && name.rsplit_once(' ').is_some_and(|(_, last)| has(last)))
}

/// The last frame, if it shows the place.
fn at_the_end(place: &PlaceMention, evidence: &Evidence) -> ShownFrames {
    let last = evidence.frames.len().saturating_sub(1);
    let is_seen = evidence.final_things().iter().any(|thing| names_agree(&thing.name, &place.name));
    ShownFrames { frames: if is_seen { vec![last] } else { Vec::new() }, unknown: Vec::new() }
}

/// The verdict where no frame shows a place.
fn verdict_on_absence(place: &PlaceMention, evidence: &Evidence, made_up: bool) -> Verdict {
    let denied = || match made_up {
        true => evidence.is_named_nowhere(&place.name),
        false => evidence.denies_thing(&place.name),
    };
    let thing_denied = place.is_thing && denied();
    // A room that the text calls near to something need not be on the path.
    let room_denied = place.is_room && evidence.denies_room(&place.name) && place.link != PlaceLink::Beside;
    // A name that may mean a thing or a room fails only where the thing is denied.
    if thing_denied || (room_denied && !place.is_thing) { Verdict::Fail } else { Verdict::Unverified }
}
