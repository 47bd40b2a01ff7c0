//! The instructions of an item as the page shows them: text with its mentions, verdict, checks and provenance.

use super::{
    item_record::{AcceptedText, ItemRecord, TextState},
    link_targets::{LinkTargets, frame_anchor},
    palette::{FrameColour, frame_colour},
    provenance_words::{cost_words, describe_ambiguity, describe_provenance, describe_round},
    spans::{TextMarks, TextSegment, cut_segments},
    suspicion::{TextSuspicion, current_findings, describe_doubt, fails_now},
};
use serde::Serialize;
use wayword_core::{
    CheckFinding, Instruction, InstructionPart, MentionKind, TextDoubt, TextMention, Verdict, WrittenDraft,
};
use wayword_language::Language;
use wayword_run::{
    check::{CheckedAgain, SecondCheck},
    run_folder::text_label,
};

/// Most findings of an instruction that are shown.
const MAX_SHOWN_FINDINGS: usize = 100;

/// Most drafts of an instruction that are shown.
const MAX_SHOWN_DRAFTS: usize = 32;

/// Most parts of an instruction that are shown.
const MAX_SHOWN_PARTS: usize = 100;

/// An instruction.
#[derive(Debug, Serialize)]
pub(super) struct TextView {
    /// Its style, with its number if the path has several of that style.
    label: String,
    state: TextState,
    /// The tag of its language, if that is written in other letters than English.
    lang: Option<&'static str>,
    /// Why it was rejected.
    reason: Option<String>,
    /// Empty if no text could be written.
    segments: Vec<SegmentView>,
    parts: Vec<PartView>,
    findings: Vec<FindingView>,
    /// Whether the findings are those of a second check, in which the text fails.
    fails_now: bool,
    /// Whether somebody changed it after the run, and whether it was checked again.
    is_changed: bool,
    is_checked: bool,
    /// The words that the follower doubts.
    doubts: Vec<DoubtView>,
    /// How many of its claims could not be decided.
    unverified: usize,
    /// The possible meanings of the text, if there are several.
    ambiguity: Option<String>,
    provenance: Option<String>,
    /// What it cost.
    cost: Option<String>,
    /// The texts of a model that were not kept.
    drafts: Vec<DraftView>,
    /// What writing again after a follower's walk gained.
    refined: Vec<String>,
}

/// A text that was not kept.
#[derive(Debug, Serialize)]
struct DraftView {
    /// The text, cut at the words that a check found wrong.
    said: Vec<(String, bool)>,
    reasons: Vec<String>,
}

/// Words that the follower doubts.
#[derive(Debug, Serialize)]
struct DoubtView {
    grade: &'static str,
    words: String,
    reason: String,
}

/// A part of an instruction with its frames.
#[derive(Debug, Serialize)]
struct PartView {
    /// Its number among the parts of all texts of the item, by which the script finds its words.
    key: usize,
    words: String,
    frames: [usize; 2],
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
    /// The frames of its part.
    frames: Option<[usize; 2]>,
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
pub(super) fn text_views(record: &ItemRecord, again: &CheckedAgain, places: LinkTargets<'_>) -> Vec<TextView> {
    let accepted = record.accepted.iter().map(|text| accepted_view(text, again.of_line(text.line), places));
    let rejected = record.rejected.iter().map(|rejected| TextView {
        label: text_label(&rejected.style, rejected.number),
        state: TextState::Rejected,
        lang: rejected.last.as_ref().and_then(|last| Language::tag_of_script(&last.text)),
        reason: Some(rejected.reason.clone()),
        segments: rejected.last.as_ref().map(|last| segment_views(last, places)).unwrap_or_default(),
        parts: rejected.last.as_ref().map(|last| part_views(last, places)).unwrap_or_default(),
        findings: rejected.last.as_ref().map(finding_views).unwrap_or_default(),
        fails_now: false,
        is_changed: false,
        is_checked: false,
        doubts: Vec::new(),
        unverified: 0,
        ambiguity: rejected.last.as_ref().and_then(describe_ambiguity),
        cost: rejected.cost.as_ref().map(cost_words),
        provenance: rejected.last.as_ref().map(|last| describe_provenance(&last.provenance)),
        drafts: draft_views(&rejected.drafts),
        refined: Vec::new(),
    });
    let mut texts: Vec<TextView> = accepted.chain(rejected).collect();
    texts.sort_by(|a, b| a.label.cmp(&b.label));
    number_parts(&mut texts);
    texts
}

fn accepted_view(text: &AcceptedText, second: SecondCheck<'_>, places: LinkTargets<'_>) -> TextView {
    let stored = &text.instruction;
    let judged = (stored.text.as_str(), stored.verdict, &stored.findings[..]);
    let suspicion = TextSuspicion::of_accepted(judged, stored.ambiguity.as_ref(), second);
    let fails_now = fails_now(stored.verdict, second);
    let mut shown = stored.clone();
    if fails_now || second.is_changed {
        // What the run kept about the text may be about other words.
        shown.findings = current_findings(stored.verdict, &stored.findings, second).to_vec();
        shown.parts = second.text.map(|again| again.parts.clone()).unwrap_or_default();
        shown.ambiguity = second.text.and_then(|again| again.ambiguity.clone());
    }
    if second.is_changed {
        shown.mentions.clear();
    }
    let doubts = second.text.and_then(|again| again.doubted.as_ref()).map_or(&[][..], |doubted| &doubted.doubts);
    let doubt_view = |doubt: &TextDoubt| DoubtView {
        grade: doubt.grade.name(),
        words: describe_doubt(&shown.text, doubt),
        reason: doubt.reason.clone(),
    };
    TextView {
        label: text_label(&shown.style, text.number),
        state: suspicion.state,
        lang: Language::tag_of_script(&shown.text),
        reason: None,
        segments: segment_views(&shown, places),
        parts: part_views(&shown, places),
        findings: finding_views(&shown),
        fails_now,
        is_changed: second.is_changed,
        is_checked: second.text.is_some(),
        doubts: doubts.iter().map(doubt_view).collect(),
        unverified: suspicion.unverified,
        ambiguity: describe_ambiguity(&shown),
        cost: text.cost.as_ref().map(cost_words),
        provenance: Some(describe_provenance(&shown.provenance)),
        drafts: draft_views(&shown.provenance.drafts),
        refined: shown.provenance.refined.iter().map(describe_round).collect(),
    }
}

/// Gives the parts of all texts of an item their keys.
fn number_parts(texts: &mut [TextView]) {
    let mut first = 0;
    for text in texts {
        text.parts.iter_mut().enumerate().for_each(|(number, part)| part.key = first + number);
        text.segments.iter_mut().for_each(|segment| segment.part = segment.part.map(|number| first + number));
        first += text.parts.len();
    }
}

fn part_views(instruction: &Instruction, places: LinkTargets<'_>) -> Vec<PartView> {
    let view = |part: &InstructionPart| PartView {
        key: 0,
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

fn segment_views(instruction: &Instruction, places: LinkTargets<'_>) -> Vec<SegmentView> {
    let Instruction { text, mentions, findings, .. } = instruction;
    let parts = shown_parts(instruction, places);
    let view = |mention: &TextMention| link_view(mention, text, places);
    let segment_view = |segment: TextSegment<'_>| SegmentView {
        text: segment.text.to_owned(),
        part: segment.part,
        frames: segment.part.and_then(|number| parts.get(number)).map(|part| part.frames),
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

/// The drafts that the page shows.
fn draft_views(drafts: &[WrittenDraft]) -> Vec<DraftView> {
    let said = |draft: &WrittenDraft| {
        let marks = TextMarks { findings: &draft.findings, ..TextMarks::default() };
        let cut = cut_segments(&draft.text, marks, 0).into_iter();
        cut.map(|part| (part.text.to_owned(), part.is_flawed)).collect()
    };
    let view = |draft: &WrittenDraft| DraftView { said: said(draft), reasons: draft.reasons.clone() };
    drafts.iter().take(MAX_SHOWN_DRAFTS).map(view).collect()
}
