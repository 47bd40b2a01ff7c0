//! Computes the figures of a robustness run from the texts of its arms.
//!
//! A change with a dose gets R, which sets its effect against that of asking again and that of another path. A change with a
//! known effect, such as a mirrored world, gets the share of texts that show exactly this effect.

use super::{
    arm::RobustnessArm,
    base::BaseRun,
    record::{ArmPathRecord, ArmText},
};
use std::collections::BTreeMap;
use wayword_metrics::{MeanEstimate, clustered_interval};
use wayword_report::pages::robustness::results::{
    ChangeResults, DoseCurve, ExpectationResult, RobustnessFigure, StyleResults, TextPairExample,
};
use wayword_robustness::{
    Change, TextAgreement, TextFacts, WholeChange,
    metamorphic::{self, AnnotatedText, ChangedThing, ExpectationOutcome},
    ratio::{BootstrapOptions, PathAgreements, dose_slope, falling_doses, robustness_ratios},
};

/// A change matters if its R (1: no more than asking again, 0: as much as another path) is below this.
const MIN_HARMLESS_R: f64 = 0.8;
/// Most pairs of texts, before and after, that are shown of each change.
const MAX_CHANGE_EXAMPLES: usize = 5;
/// Most pairs of texts that are shown because they do not keep an expectation.
const MAX_BROKEN_EXAMPLES: usize = 10;

/// All lines of `texts.jsonl`, by arm and path.
pub(super) type RecordsByArm = BTreeMap<String, BTreeMap<String, ArmPathRecord>>;

/// The figures of one style.
pub(super) fn figures_for_style(
    base: &BaseRun,
    style: &str,
    changes: &[Change],
    lines: &RecordsByArm,
    drawing: BootstrapOptions,
) -> StyleResults {
    let texts = StyleTexts { base, style, lines };
    let (exact, measured): (Vec<&Change>, Vec<&Change>) =
        changes.iter().partition(|change| matches!(change, Change::Whole(_)));
    let measured: Vec<(&Change, ChangeResults)> =
        measured.into_iter().map(|change| (change, texts.change_figures(change, drawing))).collect();
    StyleResults {
        style: style.to_owned(),
        curves: dose_curves(&measured),
        changes: measured.into_iter().map(|(_, results)| results).collect(),
        expectations: exact.into_iter().map(|change| texts.expectation_figures(change)).collect(),
    }
}

/// The texts of one style.
struct StyleTexts<'a> {
    base: &'a BaseRun,
    style: &'a str,
    lines: &'a RecordsByArm,
}

impl<'a> StyleTexts<'a> {
    /// The text of a path in an arm, with the line that contains it.
    fn text_in_arm(&self, arm: &str, path: &str) -> Option<(&'a ArmPathRecord, &'a ArmText)> {
        let line = self.lines.get(arm)?.get(path)?;
        Some((line, line.text_in_style(self.style)?))
    }

    /// The statements of a path's text in an arm, located by the frames of the run's path.
    fn facts_in_arm(&self, arm: &str, path: &str) -> Option<TextFacts> {
        let (line, arm_text) = self.text_in_arm(arm, path)?;
        let base_frame = |frame: usize| line.base_frame_of.get(frame).copied().unwrap_or(frame);
        Some(TextFacts::from_mentions(arm_text.text.as_ref()?, &arm_text.mentions, base_frame))
    }

    fn change_figures(&self, change: &Change, drawing: BootstrapOptions) -> ChangeResults {
        let id = change.id();
        let mut results = ChangeResults {
            change: change.to_string(),
            paths: 0,
            lost: 0,
            figures: Vec::new(),
            success: None,
            examples: Vec::new(),
        };
        let (mut paths, mut success) = (Vec::new(), Vec::new());
        for path in &self.base.paths {
            let Some(before) = self.facts_in_arm("unchanged", &path.id) else { continue };
            let Some(after) = self.facts_in_arm(&id, &path.id) else {
                results.lost += usize::from(self.text_in_arm(&id, &path.id).is_some());
                continue;
            };
            results.paths += 1;
            let agreement =
                |arm: &str| self.facts_in_arm(arm, &path.id).map(|facts| TextAgreement::from_facts(&before, &facts));
            let scene = path.scene.as_str().to_owned();
            if let Some((again, other)) = agreement("again").zip(agreement("other-path")) {
                paths.push(PathAgreements {
                    scene: scene.clone(),
                    changed: TextAgreement::from_facts(&before, &after),
                    again,
                    other,
                });
            }
            let arrived = |arm: &str| self.text_in_arm(arm, &path.id).and_then(|(_, arm_text)| arm_text.arrived);
            if let Some((then, now)) = arrived("unchanged").zip(arrived(&id)) {
                success.push((scene, now - then));
            }
            if results.examples.len() < MAX_CHANGE_EXAMPLES {
                results.examples.extend(self.text_example(&id, &path.id, String::new()));
            }
        }
        results.figures = robustness_ratios(&paths, drawing).into_iter().map(RobustnessFigure::from).collect();
        results.success = clustered_interval(&success, drawing.resamples, drawing.level, drawing.seed);
        results
    }

    fn expectation_figures(&self, change: &Change) -> ExpectationResult {
        let id = change.id();
        let mut results = ExpectationResult {
            change: change.to_string(),
            expected: expected_outcome(change).to_owned(),
            told: 0,
            holds: 0,
            examples: Vec::new(),
        };
        for path in &self.base.paths {
            let Some(outcome) = self.expectation_outcome(change, &path.id) else { continue };
            results.told += usize::from(outcome != ExpectationOutcome::NotTold);
            match outcome {
                ExpectationOutcome::Holds => results.holds += 1,
                ExpectationOutcome::NotTold => {}
                ExpectationOutcome::Differs(why) if results.examples.len() < MAX_BROKEN_EXAMPLES => {
                    results.examples.extend(self.text_example(&id, &path.id, why));
                }
                ExpectationOutcome::Differs(_) => {}
            }
        }
        results
    }

    /// Whether the texts of a path before and after a change keep its expectation; `None` if one of them is missing.
    fn expectation_outcome(&self, change: &Change, path: &str) -> Option<ExpectationOutcome> {
        let Change::Whole(whole) = change else { return None };
        let arm = if *whole == WholeChange::Reverse { RobustnessArm::Forward } else { RobustnessArm::Unchanged };
        let (line, before) = self.text_in_arm(&arm.id(), path)?;
        let (_, after) = self.text_in_arm(&change.id(), path)?;
        let text = before.text.as_ref()?;
        let Some(changed) = &after.text else {
            return Some(ExpectationOutcome::Differs("every text failed its checks after the change".to_owned()));
        };
        let last_frame = line.path.frames.len().saturating_sub(1);
        let base = AnnotatedText { text, mentions: &before.mentions, last_frame };
        let changed = AnnotatedText { text: changed, mentions: &after.mentions, last_frame };
        let edit = after.edit.as_ref();
        let changed_thing = || edit.map(|edit| ChangedThing { name: &edit.name, seen_from: &edit.seen_from });
        Some(match whole {
            WholeChange::Mirror => metamorphic::check_mirrored_world(base, changed),
            WholeChange::Turn => metamorphic::check_turned_world(base, changed),
            WholeChange::Remove => metamorphic::check_removed_thing(base, changed, changed_thing()?),
            WholeChange::Add => metamorphic::check_added_thing(base, changed, changed_thing()?),
            WholeChange::Material => {
                let [old, new] = edit?.colours.as_ref()?;
                metamorphic::check_changed_material(base, changed, old, new)
            }
            WholeChange::Reverse => metamorphic::check_reversed_path(base, changed),
        })
    }

    fn text_example(&self, arm: &str, path: &str, note: String) -> Option<TextPairExample> {
        let reference = if arm == "reverse" { "forward" } else { "unchanged" };
        let text = |arm: &str| Some(self.text_in_arm(arm, path)?.1.text.clone().unwrap_or_default());
        Some(TextPairExample { path: path.to_owned(), before: text(reference)?, after: text(arm)?, note })
    }
}

/// The expectation of a change, in words.
fn expected_outcome(change: &Change) -> &'static str {
    match change {
        Change::Whole(WholeChange::Mirror) => "the text is equal but left and right",
        Change::Whole(WholeChange::Turn) => "the text is equal, byte for byte",
        Change::Whole(WholeChange::Remove) => {
            "its name is gone, and clauses of frames that did not see it are unchanged"
        }
        Change::Whole(WholeChange::Add) => "only clauses of frames that see it change",
        Change::Whole(WholeChange::Material) => "only the word for its colour changes",
        _ => "as many turns, each to the other side, rooms and climbs in reverse order",
    }
}

/// A curve of R over the dose for each change with several doses.
fn dose_curves(measured: &[(&Change, ChangeResults)]) -> Vec<DoseCurve> {
    let mut curves: Vec<DoseCurve> = Vec::new();
    for (change, results) in measured {
        let Some(dose) = change.dose_value() else { continue };
        let r = results.figures.last().and_then(|mean| mean.r);
        match curves.iter_mut().find(|curve| curve.change == change.name()) {
            Some(curve) => curve.points.push((dose, r)),
            None => curves.push(DoseCurve {
                change: change.name().to_owned(),
                unchanged: change.unchanged_dose(),
                points: vec![(dose, r)],
                slope: None,
                falls_at: Vec::new(),
            }),
        }
    }
    curves.retain(|curve| curve.points.len() > 1);
    for curve in &mut curves {
        let known: Vec<(f64, f64)> =
            curve.points.iter().filter_map(|(dose, r)| r.map(|r: MeanEstimate| (*dose, r.mean))).collect();
        curve.slope = dose_slope(&known);
        curve.falls_at = falling_doses(&known, curve.unchanged, MIN_HARMLESS_R);
    }
    curves
}
