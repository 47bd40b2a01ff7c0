//! The instructions of an item as the page shows them: text with its mentions, verdict, checks and provenance.

use super::{
    item_record::{ItemRecord, TextState, state_from_verdict},
    link_targets::{LinkTargets, frame_anchor},
    palette::{FrameColour, frame_colour},
    spans::{TextMarks, TextSegment, cut_segments},
};
use serde::Serialize;
use wayword_core::{
    CheckFinding, ChosenBy, Instruction, InstructionPart, MentionKind, RefinedRound, TextMention, TextProvenance,
    TextSelection, Verdict, WrittenDraft,
};

/// Most findings of an instruction that are shown.
const MAX_SHOWN_FINDINGS: usize = 100;

/// Most drafts of an instruction that are shown.
const MAX_SHOWN_DRAFTS: usize = 32;

/// Most parts of an instruction that are shown.
const MAX_SHOWN_PARTS: usize = 100;

/// How many parts of an item light up with their frames. The style sheet has rules for so many.
pub(super) const MAX_LIT_PARTS: usize = 64;

/// An instruction.
#[derive(Debug, Serialize)]
pub(super) struct TextView {
    style: String,
    state: TextState,
    /// Why it was rejected.
    reason: Option<String>,
    /// Empty if no text could be written.
    segments: Vec<SegmentView>,
    pub(super) parts: Vec<PartView>,
    findings: Vec<FindingView>,
    /// How many of its claims could not be decided.
    unverified: usize,
    /// The possible meanings of the text, if there are several.
    ambiguity: Option<String>,
    provenance: Option<String>,
    /// The texts of a model that were not kept.
    drafts: Vec<DraftView>,
    /// What writing again after a follower's walk gained.
    refined: Vec<String>,
}

/// A text that was not kept.
#[derive(Debug, Serialize)]
struct DraftView {
    text: String,
    reasons: Vec<String>,
}

/// A part of an instruction with its frames.
#[derive(Debug, Serialize)]
pub(super) struct PartView {
    /// Its number among the parts of all texts of the item, by which a style sheet finds its frames; `None` beyond
    /// [`MAX_LIT_PARTS`].
    pub(super) key: Option<usize>,
    words: String,
    pub(super) frames: [usize; 2],
    /// The anchor of its first frame; `None` if the page does not show it.
    anchor: Option<String>,
    percent: Option<u8>,
}

/// A segment of an instruction's text.
#[derive(Debug, Serialize)]
struct SegmentView {
    text: String,
    /// The key of its part.
    part: Option<usize>,
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
    /// The number of the frame, from 0.
    number: usize,
    /// The anchor of the frame; `None` if the page does not show the frame.
    anchor: Option<String>,
    colour: FrameColour,
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

/// An item's instructions, accepted and rejected.
pub(super) fn text_views(record: &ItemRecord, places: LinkTargets<'_>) -> Vec<TextView> {
    let accepted = record.accepted.iter().map(|instruction| TextView {
        style: instruction.style.clone(),
        state: state_from_verdict(instruction.verdict),
        reason: None,
        segments: segment_views(instruction, places),
        parts: part_views(instruction, places),
        findings: finding_views(instruction),
        unverified: count_unverified(instruction),
        ambiguity: describe_ambiguity(instruction),
        provenance: Some(describe_provenance(&instruction.provenance)),
        drafts: draft_views(&instruction.provenance.drafts),
        refined: instruction.provenance.refined.iter().map(describe_round).collect(),
    });
    let rejected = record.rejected.iter().map(|rejected| TextView {
        style: rejected.style.clone(),
        state: TextState::Rejected,
        reason: Some(rejected.reason.clone()),
        segments: rejected.last.as_ref().map(|last| segment_views(last, places)).unwrap_or_default(),
        parts: rejected.last.as_ref().map(|last| part_views(last, places)).unwrap_or_default(),
        findings: rejected.last.as_ref().map(finding_views).unwrap_or_default(),
        unverified: rejected.last.as_ref().map_or(0, count_unverified),
        ambiguity: rejected.last.as_ref().and_then(describe_ambiguity),
        provenance: rejected.last.as_ref().map(|last| describe_provenance(&last.provenance)),
        drafts: draft_views(&rejected.drafts),
        refined: Vec::new(),
    });
    let mut texts: Vec<TextView> = accepted.chain(rejected).collect();
    texts.sort_by(|a, b| a.style.cmp(&b.style));
    number_parts(&mut texts);
    texts
}

/// Gives the parts of all texts of an item their keys.
fn number_parts(texts: &mut [TextView]) {
    let mut first = 0;
    for text in texts {
        let key = |number: usize| Some(first + number).filter(|key| *key < MAX_LIT_PARTS);
        text.parts.iter_mut().enumerate().for_each(|(number, part)| part.key = key(number));
        text.segments.iter_mut().for_each(|segment| segment.part = segment.part.and_then(key));
        first += text.parts.len();
    }
}

fn part_views(instruction: &Instruction, places: LinkTargets<'_>) -> Vec<PartView> {
    let view = |part: &InstructionPart| PartView {
        key: None,
        words: instruction.text.get(part.span[0]..part.span[1]).unwrap_or_default().to_owned(),
        frames: part.frames,
        anchor: (part.frames[0] < places.shown).then(|| frame_anchor(places.item, part.frames[0])),
        percent: part.confidence.map(|share| (100.0 * share.clamp(0.0, 1.0)).round() as u8),
    };
    shown_parts(instruction, places).iter().map(view).collect()
}

/// The parts that the page shows: all if each has frames of the path, else none, so that a segment finds its part by its number.
fn shown_parts<'a>(instruction: &'a Instruction, places: LinkTargets<'_>) -> &'a [InstructionPart] {
    let fits = |part: &InstructionPart| part.frames[0] <= part.frames[1] && part.frames[1] < places.frames;
    let parts = &instruction.parts[..instruction.parts.len().min(MAX_SHOWN_PARTS)];
    if parts.iter().all(fits) { parts } else { &[] }
}

fn count_unverified(instruction: &Instruction) -> usize {
    instruction.findings.iter().filter(|finding| finding.verdict == Verdict::Unverified).count()
}

fn segment_views(instruction: &Instruction, places: LinkTargets<'_>) -> Vec<SegmentView> {
    let Instruction { text, mentions, findings, .. } = instruction;
    let parts = shown_parts(instruction, places);
    let view = |mention: &TextMention| link_view(mention, text, places);
    let segment_view = |segment: TextSegment<'_>| SegmentView {
        text: segment.text.to_owned(),
        part: segment.part,
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
    let marks = TextMarks { mentions, parts, findings };
    cut_segments(text, marks, places.frames).into_iter().map(segment_view).collect()
}

fn link_view(mention: &TextMention, text: &str, places: LinkTargets<'_>) -> LinkView {
    let (kind, number) = (kind_name(mention.kind), mention.frame);
    let words = text.get(mention.span[0]..mention.span[1]).unwrap_or_default();
    LinkView {
        kind,
        number,
        anchor: (mention.frame < places.shown).then(|| frame_anchor(places.item, mention.frame)),
        colour: frame_colour(mention.frame, places.shown),
        turn: (mention.kind == MentionKind::Turn).then(|| turn_sign_from_words(words)),
        hint: format!("{kind}, frame {number}"),
    }
}

fn kind_name(kind: MentionKind) -> &'static str {
    match kind {
        MentionKind::Landmark => "landmark",
        MentionKind::Room => "room",
        MentionKind::Turn => "turn",
        MentionKind::Floor => "floor",
        MentionKind::Target => "target",
    }
}

/// The icon for the turn that the words describe. It may differ from the path's own turn, which the frame shows.
fn turn_sign_from_words(words: &str) -> &'static str {
    let words = words.to_lowercase();
    let has = |word: &str| words.contains(word);
    match () {
        () if has("left") => "left",
        () if has("right") => "right",
        () if has("around") || has("back") || has("u-turn") => "around",
        () => "straight",
    }
}

fn finding_views(instruction: &Instruction) -> Vec<FindingView> {
    let view = |finding: &CheckFinding| FindingView {
        check: finding.check.name(),
        verdict: finding.verdict,
        reason: finding.reason.clone(),
        words: finding.span.and_then(|span| instruction.text.get(span[0]..span[1])).map(str::to_owned),
    };
    instruction.findings.iter().take(MAX_SHOWN_FINDINGS).map(view).collect()
}

/// The possible meanings of an instruction, if there are several, and the thing by which its own end differs from the others.
fn describe_ambiguity(instruction: &Instruction) -> Option<String> {
    let ambiguity = instruction.ambiguity.as_ref()?;
    let meanings = ambiguity.to_sentence()?;
    Some(match &ambiguity.told_apart_by {
        Some(by) => format!("{meanings}; only at its own end there is: {by}"),
        None => meanings,
    })
}

/// The drafts that the page shows.
fn draft_views(drafts: &[WrittenDraft]) -> Vec<DraftView> {
    let view = |draft: &WrittenDraft| DraftView { text: draft.text.clone(), reasons: draft.reasons.clone() };
    drafts.iter().take(MAX_SHOWN_DRAFTS).map(view).collect()
}

/// What a round of writing again gained.
fn describe_round(round: &RefinedRound) -> String {
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    let before = percent(round.before);
    match (round.after, round.kept) {
        (Some(after), true) => {
            format!("a follower arrived with {before}, by the text written again with {}", percent(after))
        }
        (Some(after), false) => {
            format!("a follower arrives with {before}; the text written again had {} and was not kept", percent(after))
        }
        (None, _) => format!("a follower arrives with {before}; the text written again failed its checks"),
    }
}

fn describe_provenance(provenance: &TextProvenance) -> String {
    let TextProvenance { wayword, asker, answerer, summariser, writer, checked_against, seed, style_hash, .. } =
        provenance;
    let repairs = match provenance.repairs {
        0 => "at the first attempt".to_owned(),
        1 => "after 1 repair".to_owned(),
        more => format!("after {more} repairs"),
    };
    let after = provenance.finished_for.as_ref().map_or_else(String::new, |first| format!(" after {first} had failed"));
    let chosen = provenance.chosen.as_ref().map_or_else(String::new, describe_choice);
    let prompts = provenance.prompts_hash.as_ref().map_or_else(String::new, |hash| format!(", prompts {hash}"));
    format!(
        "Wayword {wayword}: {asker} asked, {answerer} answered, {summariser} summarised, {writer} wrote{after}, {repairs}{chosen}; \
         checked against {checked_against}; seed {seed}, style {style_hash}{prompts}"
    )
}

fn describe_choice(chosen: &TextSelection) -> String {
    let by = match chosen.by {
        ChosenBy::Follower => "by the follower",
        ChosenBy::Checks => "by the checks alone",
    };
    format!(", chosen among {} texts ({} passed) {by}", chosen.among, chosen.passed)
}
