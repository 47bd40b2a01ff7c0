//! The instructions of an item as the page shows them: text with its mentions, verdict, checks and provenance.

use super::{
    palette::{Colour, colour},
    places::{Places, frame_anchor},
    records::ItemRecord,
    spans::segments,
};
use serde::Serialize;
use wayword_core::{Chosen, ChosenBy, Finding, Instruction, Mention, MentionKind, Provenance, Verdict};

/// Most findings of an instruction that are shown.
const MOST_FINDINGS: usize = 100;

/// An instruction.
#[derive(Debug, Serialize)]
pub(super) struct TextView {
    style: String,
    state: TextState,
    /// Why it was rejected.
    reason: Option<String>,
    /// Empty if no text could be written.
    parts: Vec<PartView>,
    findings: Vec<FindingView>,
    /// The possible meanings of the text, if there are several.
    ambiguity: Option<String>,
    provenance: Option<String>,
}

/// The state of an instruction, the worst first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum TextState {
    /// It failed a check, and is not part of the dataset.
    Rejected,
    /// Something could not be checked.
    Unverified,
    /// It passed every check.
    Passed,
}

/// A segment of an instruction's text.
#[derive(Debug, Serialize)]
struct PartView {
    text: String,
    is_flawed: bool,
    link: Option<LinkView>,
    /// Whether the mention of `link` ends here.
    is_last: bool,
    /// Other mentions that end here.
    others: Vec<LinkView>,
}

/// A mention as a link to its frame.
#[derive(Debug, Serialize)]
struct LinkView {
    kind: &'static str,
    /// Of the frame, from 0.
    number: usize,
    /// The frame's; `None` if the page does not show the frame.
    anchor: Option<String>,
    colour: Colour,
    /// Name of the icon for a turn.
    turn: Option<&'static str>,
    hint: String,
}

/// A check's outcome.
#[derive(Debug, Serialize)]
struct FindingView {
    check: &'static str,
    verdict: Verdict,
    reason: String,
    words: Option<String>,
}

/// The state of an accepted instruction.
pub(super) fn state(verdict: Verdict) -> TextState {
    match verdict {
        Verdict::Pass => TextState::Passed,
        Verdict::Unverified => TextState::Unverified,
        Verdict::Fail => TextState::Rejected,
    }
}

/// An item's instructions, accepted and rejected.
pub(super) fn texts(record: &ItemRecord, places: Places<'_>) -> Vec<TextView> {
    let accepted = record.accepted.iter().map(|instruction| TextView {
        style: instruction.style.clone(),
        state: state(instruction.verdict),
        reason: None,
        parts: parts(instruction, places),
        findings: findings(instruction),
        ambiguity: ambiguity(instruction),
        provenance: Some(provenance(&instruction.provenance)),
    });
    let rejected = record.rejected.iter().map(|rejected| TextView {
        style: rejected.style.clone(),
        state: TextState::Rejected,
        reason: Some(rejected.reason.clone()),
        parts: rejected.last.as_ref().map(|last| parts(last, places)).unwrap_or_default(),
        findings: rejected.last.as_ref().map(findings).unwrap_or_default(),
        ambiguity: rejected.last.as_ref().and_then(ambiguity),
        provenance: rejected.last.as_ref().map(|last| provenance(&last.provenance)),
    });
    let mut texts: Vec<TextView> = accepted.chain(rejected).collect();
    texts.sort_by(|a, b| a.style.cmp(&b.style));
    texts
}

fn parts(instruction: &Instruction, places: Places<'_>) -> Vec<PartView> {
    let Instruction { text, mentions, findings, .. } = instruction;
    let view = |mention: &Mention| link(mention, text, places);
    let part = |segment: super::spans::Segment<'_>| PartView {
        text: segment.text.to_owned(),
        is_flawed: segment.is_flawed,
        link: segment.mention.map(view),
        is_last: segment.mention.is_some_and(|mention| segment.ends.contains(&mention)),
        others: segment
            .ends
            .iter()
            .filter(|mention| Some(**mention) != segment.mention)
            .map(|mention| view(mention))
            .collect(),
    };
    segments(text, mentions, findings, places.frames).into_iter().map(part).collect()
}

fn link(mention: &Mention, text: &str, places: Places<'_>) -> LinkView {
    let (kind, number) = (kind(mention.kind), mention.frame);
    let words = text.get(mention.span[0]..mention.span[1]).unwrap_or_default();
    LinkView {
        kind,
        number,
        anchor: (mention.frame < places.shown).then(|| frame_anchor(places.item, mention.frame)),
        colour: colour(mention.frame, places.shown),
        turn: (mention.kind == MentionKind::Turn).then(|| told_turn(words)),
        hint: format!("{kind}, frame {number}"),
    }
}

fn kind(kind: MentionKind) -> &'static str {
    match kind {
        MentionKind::Landmark => "landmark",
        MentionKind::Room => "room",
        MentionKind::Turn => "turn",
        MentionKind::Floor => "floor",
        MentionKind::Target => "target",
    }
}

/// The icon for the turn that the words describe. It may differ from the path's own turn, which the frame shows.
fn told_turn(words: &str) -> &'static str {
    let words = words.to_lowercase();
    let tells = |word: &str| words.contains(word);
    match () {
        () if tells("left") => "left",
        () if tells("right") => "right",
        () if tells("around") || tells("back") || tells("u-turn") => "around",
        () => "straight",
    }
}

fn findings(instruction: &Instruction) -> Vec<FindingView> {
    let view = |finding: &Finding| FindingView {
        check: finding.check.name(),
        verdict: finding.verdict,
        reason: finding.reason.clone(),
        words: finding.span.and_then(|span| instruction.text.get(span[0]..span[1])).map(str::to_owned),
    };
    instruction.findings.iter().take(MOST_FINDINGS).map(view).collect()
}

/// The possible meanings of an instruction, if there are several, and the thing by which its own end differs from the others.
fn ambiguity(instruction: &Instruction) -> Option<String> {
    let ambiguity = instruction.ambiguity.as_ref()?;
    let told = ambiguity.told()?;
    Some(match &ambiguity.told_apart_by {
        Some(by) => format!("{told}; only at its own end there is: {by}"),
        None => told,
    })
}

fn provenance(provenance: &Provenance) -> String {
    let Provenance { wayword, asker, answerer, summariser, writer, checked_against, seed, style_hash, .. } = provenance;
    let repairs = match provenance.repairs {
        0 => "at the first attempt".to_owned(),
        1 => "after 1 repair".to_owned(),
        more => format!("after {more} repairs"),
    };
    let after = provenance.finished_for.as_ref().map_or_else(String::new, |first| format!(" after {first} had failed"));
    let chosen = provenance.chosen.as_ref().map_or_else(String::new, chosen);
    let prompts = provenance.prompts_hash.as_ref().map_or_else(String::new, |hash| format!(", prompts {hash}"));
    format!(
        "Wayword {wayword}: {asker} asked, {answerer} answered, {summariser} summarised, {writer} wrote{after}, {repairs}{chosen}; \
         checked against {checked_against}; seed {seed}, style {style_hash}{prompts}"
    )
}

fn chosen(chosen: &Chosen) -> String {
    let by = match chosen.by {
        ChosenBy::Follower => "by the follower",
        ChosenBy::Checks => "by the checks alone",
    };
    format!(", chosen among {} texts ({} passed) {by}", chosen.among, chosen.passed)
}
