//! Computes the figures of a robustness run from the texts of its arms.
//!
//! A change with a dose gets R, which sets its effect against that of asking again and that of another path. A change with a
//! known effect, such as a mirrored world, gets the share of texts that show exactly this effect.

use super::{
    arm::Arm,
    base::Base,
    record::{Line, Told},
};
use std::collections::BTreeMap;
use wayword_metrics::{Estimate, clustered_interval};
use wayword_report::pages::robustness::results::{Curve, Example, Expectation, Figure, OfChange, OfStyle};
use wayword_robustness::{
    Agreement, Change, Facts, Whole,
    metamorphic::{self, Gone, Outcome, Written},
    ratio::{Drawing, OfPath, falls_at, robustness, slope},
};

/// A change matters if its R is below this.
const LEAST: f64 = 0.8;
/// Most pairs of texts, before and after, that are shown of each change.
const EXAMPLES: usize = 5;
/// Most pairs of texts that are shown because they do not keep an expectation.
const BROKEN: usize = 10;

/// All lines of `texts.jsonl`, by arm and path.
pub(super) type Lines = BTreeMap<String, BTreeMap<String, Line>>;

/// The figures of one style.
pub(super) fn of_style(base: &Base, style: &str, changes: &[Change], lines: &Lines, drawing: Drawing) -> OfStyle {
    let texts = Texts { base, style, lines };
    let (exact, measured): (Vec<&Change>, Vec<&Change>) =
        changes.iter().partition(|change| matches!(change, Change::Whole(_)));
    let measured: Vec<(&Change, OfChange)> =
        measured.into_iter().map(|change| (change, texts.change(change, drawing))).collect();
    OfStyle {
        style: style.to_owned(),
        curves: curves(&measured),
        changes: measured.into_iter().map(|(_, found)| found).collect(),
        expectations: exact.into_iter().map(|change| texts.expectation(change)).collect(),
    }
}

/// The texts of one style.
struct Texts<'a> {
    base: &'a Base,
    style: &'a str,
    lines: &'a Lines,
}

impl<'a> Texts<'a> {
    /// The text of a path in an arm, with the line that contains it.
    fn told(&self, arm: &str, path: &str) -> Option<(&'a Line, &'a Told)> {
        let line = self.lines.get(arm)?.get(path)?;
        Some((line, line.told(self.style)?))
    }

    /// The statements of a path's text in an arm, located by the frames of the run's path.
    fn facts(&self, arm: &str, path: &str) -> Option<Facts> {
        let (line, told) = self.told(arm, path)?;
        let place = |frame: usize| line.base_frame_of.get(frame).copied().unwrap_or(frame);
        Some(Facts::of(told.text.as_ref()?, &told.mentions, place))
    }

    fn change(&self, change: &Change, drawing: Drawing) -> OfChange {
        let id = change.id();
        let mut found = OfChange {
            change: change.to_string(),
            paths: 0,
            lost: 0,
            figures: Vec::new(),
            success: None,
            examples: Vec::new(),
        };
        let (mut paths, mut success) = (Vec::new(), Vec::new());
        for path in &self.base.paths {
            let Some(before) = self.facts("unchanged", &path.id) else { continue };
            let Some(after) = self.facts(&id, &path.id) else {
                found.lost += usize::from(self.told(&id, &path.id).is_some());
                continue;
            };
            found.paths += 1;
            let agreement = |arm: &str| self.facts(arm, &path.id).map(|facts| Agreement::of(&before, &facts));
            let scene = path.scene.as_str().to_owned();
            if let Some((again, other)) = agreement("again").zip(agreement("other-path")) {
                paths.push(OfPath { scene: scene.clone(), changed: Agreement::of(&before, &after), again, other });
            }
            let arrived = |arm: &str| self.told(arm, &path.id).and_then(|(_, told)| told.arrived);
            if let Some((then, now)) = arrived("unchanged").zip(arrived(&id)) {
                success.push((scene, now - then));
            }
            if found.examples.len() < EXAMPLES {
                found.examples.extend(self.example(&id, &path.id, String::new()));
            }
        }
        found.figures = robustness(&paths, drawing).into_iter().map(Figure::from).collect();
        found.success = clustered_interval(&success, drawing.resamples, drawing.level, drawing.seed);
        found
    }

    fn expectation(&self, change: &Change) -> Expectation {
        let id = change.id();
        let mut found = Expectation {
            change: change.to_string(),
            expected: expected(change).to_owned(),
            told: 0,
            holds: 0,
            examples: Vec::new(),
        };
        for path in &self.base.paths {
            let Some(outcome) = self.outcome(change, &path.id) else { continue };
            found.told += usize::from(outcome != Outcome::NotTold);
            match outcome {
                Outcome::Holds => found.holds += 1,
                Outcome::NotTold => {}
                Outcome::Differs(why) if found.examples.len() < BROKEN => {
                    found.examples.extend(self.example(&id, &path.id, why));
                }
                Outcome::Differs(_) => {}
            }
        }
        found
    }

    /// Whether the texts of a path before and after a change keep its expectation; `None` if one of them is missing.
    fn outcome(&self, change: &Change, path: &str) -> Option<Outcome> {
        let Change::Whole(whole) = change else { return None };
        let arm = if *whole == Whole::Reverse { Arm::Forward } else { Arm::Unchanged };
        let (line, before) = self.told(&arm.id(), path)?;
        let (_, after) = self.told(&change.id(), path)?;
        let text = before.text.as_ref()?;
        let Some(changed) = &after.text else {
            return Some(Outcome::Differs("every text failed its checks after the change".to_owned()));
        };
        let last_frame = line.path.frames.len().saturating_sub(1);
        let base = Written { text, mentions: &before.mentions, last_frame };
        let changed = Written { text: changed, mentions: &after.mentions, last_frame };
        let edit = after.edit.as_ref();
        let gone = || edit.map(|edit| Gone { name: &edit.name, seen_from: &edit.seen_from });
        Some(match whole {
            Whole::Mirror => metamorphic::mirror(base, changed),
            Whole::Turn => metamorphic::turn(base, changed),
            Whole::Remove => metamorphic::remove(base, changed, gone()?),
            Whole::Add => metamorphic::add(base, changed, gone()?),
            Whole::Material => {
                let [old, new] = edit?.colours.as_ref()?;
                metamorphic::material(base, changed, old, new)
            }
            Whole::Reverse => metamorphic::reverse(base, changed),
        })
    }

    fn example(&self, arm: &str, path: &str, note: String) -> Option<Example> {
        let reference = if arm == "reverse" { "forward" } else { "unchanged" };
        let text = |arm: &str| Some(self.told(arm, path)?.1.text.clone().unwrap_or_default());
        Some(Example { path: path.to_owned(), before: text(reference)?, after: text(arm)?, note })
    }
}

/// The expectation of a change, in words.
fn expected(change: &Change) -> &'static str {
    match change {
        Change::Whole(Whole::Mirror) => "the text is equal but left and right",
        Change::Whole(Whole::Turn) => "the text is equal, byte for byte",
        Change::Whole(Whole::Remove) => "its name is gone, and clauses of frames that did not see it are unchanged",
        Change::Whole(Whole::Add) => "only clauses of frames that see it change",
        Change::Whole(Whole::Material) => "only the word for its colour changes",
        _ => "as many turns, each to the other side, rooms and climbs in reverse order",
    }
}

/// A curve of R over the dose for each change with several doses.
fn curves(measured: &[(&Change, OfChange)]) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    for (change, found) in measured {
        let Some(dose) = change.dose() else { continue };
        let r = found.figures.last().and_then(|mean| mean.r);
        match curves.iter_mut().find(|curve| curve.change == change.name()) {
            Some(curve) => curve.points.push((dose, r)),
            None => curves.push(Curve {
                change: change.name().to_owned(),
                unchanged: change.unchanged(),
                points: vec![(dose, r)],
                slope: None,
                falls_at: Vec::new(),
            }),
        }
    }
    curves.retain(|curve| curve.points.len() > 1);
    for curve in &mut curves {
        let known: Vec<(f64, f64)> =
            curve.points.iter().filter_map(|(dose, r)| r.map(|r: Estimate| (*dose, r.mean))).collect();
        curve.slope = slope(&known);
        curve.falls_at = falls_at(&known, curve.unchanged, LEAST);
    }
    curves
}
