//! The figures of each way of asking, and the table that shows them.

use super::{PerceptionMeasurement, ScoredCaption};
use serde::Serialize;
use std::fmt;
use wayword_run::{count::count_phrase, settings::Perception};
use wayword_synthesis::perception::CaptionScore;

/// The figures of one way of asking.
#[derive(Debug, Serialize)]
pub struct PerceptionRow {
    /// How it was asked.
    pub perception: Perception,
    /// Views that were captioned.
    pub captions: usize,
    /// Views that the model did not caption.
    pub failed: usize,
    /// Different objects that captions named, summed over captions.
    pub named: usize,
    /// Share of the named objects that a label agrees with.
    pub precision: f64,
    /// Share of the named objects that no label confirms.
    pub hallucination_rate: f64,
    /// Share of the different labels of a view that its caption names.
    pub recall: f64,
    /// Share of captions that name a hallucinated object.
    pub captions_with_hallucinations: f64,
    /// Answered questions per view, with the opening question.
    pub questions_per_view: f64,
    /// Calls to models per view, with those that the ledger answered.
    pub calls_per_view: f64,
    /// The figures after a detector corrected the captions, if one was named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with_detector: Option<DetectorCorrectedFigures>,
}

/// The figures of captions that a detector corrected.
#[derive(Debug, Serialize)]
pub struct DetectorCorrectedFigures {
    /// Hallucinated objects that the detector struck out.
    pub struck_out: usize,
    /// Objects that a label confirms, but that the detector struck out all the same.
    pub lost: usize,
    /// Share of the objects still named that a label agrees with.
    pub precision: f64,
    /// Share of them that no label confirms.
    pub hallucination_rate: f64,
    /// Share of the different labels of a view that its caption names.
    pub recall: f64,
}

impl DetectorCorrectedFigures {
    pub(super) fn from_scores<'a>(before: impl Iterator<Item = &'a CaptionScore>, after: &[CaptionScore]) -> Self {
        let (mut named_before, mut wrong_before) = (0, 0);
        for score in before {
            named_before += score.named;
            wrong_before += score.hallucinated.len();
        }
        let sum = |count: fn(&CaptionScore) -> usize| after.iter().map(count).sum::<usize>();
        let (named, wrong) = (sum(|score| score.named), sum(|score| score.hallucinated.len()));
        Self {
            struck_out: wrong_before.saturating_sub(wrong),
            lost: (named_before - wrong_before).saturating_sub(named - wrong),
            precision: count_share(named - wrong, named),
            hallucination_rate: count_share(wrong, named),
            recall: count_share(sum(|score| score.found), sum(|score| score.labelled)),
        }
    }
}

impl PerceptionRow {
    pub(super) fn from_captions(perception: Perception, captions: &[Option<ScoredCaption>], calls: u64) -> Self {
        let captioned: Vec<&ScoredCaption> = captions.iter().flatten().collect();
        let sum = |count: fn(&ScoredCaption) -> usize| captioned.iter().map(|scored| count(scored)).sum::<usize>();
        let named = sum(|scored| scored.score.named);
        let hallucinated = sum(|scored| scored.score.hallucinated.len());
        let with_hallucinations = sum(|scored| usize::from(!scored.score.hallucinated.is_empty()));
        Self {
            perception,
            captions: captioned.len(),
            failed: captions.len() - captioned.len(),
            named,
            precision: count_share(named - hallucinated, named),
            hallucination_rate: count_share(hallucinated, named),
            recall: count_share(sum(|scored| scored.score.found), sum(|scored| scored.score.labelled)),
            captions_with_hallucinations: count_share(with_hallucinations, captioned.len()),
            questions_per_view: count_share(sum(|scored| scored.caption.transcript.len()), captioned.len()),
            calls_per_view: calls as f64 / captions.len().max(1) as f64,
            with_detector: None,
        }
    }
}

/// A part as a share of a whole; 0 if the whole is 0.
fn count_share(part: usize, whole: usize) -> f64 {
    if whole == 0 { 0.0 } else { part as f64 / whole as f64 }
}

/// Prints the measurement as a table with explanations.
pub(super) struct PerceptionTable<'a>(pub(super) &'a PerceptionMeasurement);

impl fmt::Display for PerceptionTable<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let PerceptionMeasurement { platform, views, roles, labels_answered, rows, shown, .. } = self.0;
        writeln!(f, "{} of {platform}; {roles}", count_phrase(*views, "view"))?;
        if *labels_answered {
            writeln!(
                f,
                "The ground-truth labels answered here, and no model: the figures show what the dialogue loses, not \
                 how well a model sees."
            )?;
        }
        writeln!(f)?;
        writeln!(f, "asked      objects  precision  recall  hallucinated  with one  questions  calls")?;
        for row in rows {
            writeln!(
                f,
                "{:<10} {:>7}  {:>8.1}%  {:>5.1}%  {:>11.1}%  {:>7.1}%  {:>9.1}  {:>5.1}",
                perception_name(row.perception),
                row.named,
                100.0 * row.precision,
                100.0 * row.recall,
                100.0 * row.hallucination_rate,
                100.0 * row.captions_with_hallucinations,
                row.questions_per_view,
                row.calls_per_view
            )?;
            if let Some(with) = &row.with_detector {
                writeln!(
                    f,
                    "  with the detector {:>8.1}%  {:>5.1}%  {:>11.1}%  {} hallucinated struck out, {} others lost",
                    100.0 * with.precision,
                    100.0 * with.recall,
                    100.0 * with.hallucination_rate,
                    with.struck_out,
                    with.lost
                )?;
            }
            if row.failed > 0 {
                let views = count_phrase(row.failed, "view");
                writeln!(f, "           no caption for {views}; the reasons are printed above")?;
            }
        }
        writeln!(f)?;
        writeln!(
            f,
            "hallucinated: share of the named objects that no label of the view confirms. Labels can leave things out, \
             so some"
        )?;
        write!(
            f,
            "of them may be there. with one: share of captions that name such an object. questions, calls: per view."
        )?;
        if let Some(verdict) = which_pays(rows) {
            write!(f, "\n\n{verdict}")?;
        }
        if let Some(detector) = &self.0.detector {
            write!(f, "\n\n{detector}")?;
        }
        for one in shown {
            write!(
                f,
                "\n\n{} at {} degrees, {}:\n  {}",
                one.scene,
                one.heading_deg,
                perception_name(one.perception),
                one.caption
            )?;
            if !one.hallucinated.is_empty() {
                write!(f, "\n  hallucinated: {}", one.hallucinated.join(", "))?;
            }
        }
        Ok(())
    }
}

/// The F1 score: the harmonic mean of precision and recall.
fn f1_score(row: &PerceptionRow) -> f64 {
    share_of(2.0 * row.precision * row.recall, row.precision + row.recall)
}

fn share_of(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

/// F1 scores that differ by less count as equal.
const EQUAL_F1_MARGIN: f64 = 0.01;

/// Recommends a way of asking: among those about as good as the best, the one with the fewest calls.
fn which_pays(rows: &[PerceptionRow]) -> Option<String> {
    let best = rows.iter().map(f1_score).fold(0.0, f64::max);
    let good = rows.iter().filter(|row| best > 0.0 && f1_score(row) > best - EQUAL_F1_MARGIN);
    let row = good.min_by(|a, b| a.calls_per_view.total_cmp(&b.calls_per_view)).filter(|_| rows.len() > 1)?;
    let next = rows.iter().filter(|other| other.perception != row.perception);
    let next = next.max_by(|a, b| f1_score(a).total_cmp(&f1_score(b)))?;
    Some(format!(
        "{} pays: F1 of objects {:.1} % with {:.1} calls a view; the next best, {}, has {:.1} % with {:.1}.",
        perception_name(row.perception),
        100.0 * f1_score(row),
        row.calls_per_view,
        perception_name(next.perception),
        100.0 * f1_score(next),
        next.calls_per_view
    ))
}

fn perception_name(perception: Perception) -> &'static str {
    match perception {
        Perception::Dialogue => "dialogue",
        Perception::Fixed => "fixed",
        Perception::Single => "single",
        Perception::Structured => "structured",
        Perception::FollowUp => "follow-up",
    }
}
