//! Predicts what a planned study needs (answers, participants, minutes) and how small a difference it can detect.

use super::{
    escape,
    number_format::{count_with_noun, format_number},
    sheets::kind_name,
};
use crate::{ConditionKind, StudyDesign, StudyItem, StudySettings, StudyTask};
use serde::Serialize;
use std::{collections::BTreeSet, fmt};
use wayword_metrics::{DetectableShareDifference, detectable_difference};

/// The needs of a planned study, and the smallest differences that it detects. `study plan` prints this.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StudyOutlook {
    /// The task of the participants.
    pub mode: StudyTask,
    /// How many items each condition has; an item of two texts counts for both.
    pub conditions: Vec<PlannedCondition>,
    /// All items, without those of practice.
    pub items: usize,
    /// The routes of these items.
    pub routes: usize,
    /// Planned answers of each item.
    pub per_item: usize,
    /// All answers.
    pub answers: usize,
    /// How many items a person gets.
    pub per_participant: usize,
    /// How many participants are needed, if all of them finish.
    pub participants: usize,
    /// How long one participant needs, minutes.
    pub minutes: u32,
    /// The statistical power for which the detectable differences are computed.
    pub power: f64,
    /// The significance level of the two-sided test for which the detectable differences are computed.
    pub significance: f64,
    /// The share around which the two conditions are assumed to lie.
    pub base_share: f64,
    /// The smallest detectable differences, each under another assumption of how much persons and routes differ.
    pub detectable: Vec<DetectableDifference>,
}

/// How many items a condition has.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PlannedCondition {
    /// The condition.
    pub condition: String,
    /// Where its texts come from.
    pub kind: ConditionKind,
    /// The number of its items.
    pub items: usize,
}

/// The smallest difference that a study detects, under one assumption of how much persons and routes differ.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DetectableDifference {
    /// How much persons and routes differ: `none`, `middle` or `large`.
    pub effects: &'static str,
    /// The standard deviation of persons, and of routes, on the logit scale.
    pub sd: f64,
    /// The difference between the shares of two conditions; where texts are compared, the distance from an even split. `None` if no
    /// difference is detected with that power.
    pub difference: Option<f64>,
    /// Answers in each of two conditions; where texts are compared, comparisons of two conditions.
    pub answers: Option<f64>,
    /// The factor by which the variance exceeds that of independent answers.
    pub design_effect: Option<f64>,
}

/// Three assumptions of how much persons and routes differ: a name, and the standard deviation on the logit scale.
const LOGIT_SPREADS: [(&str, f64); 3] = [("none", 0.0), ("middle", 0.75), ("large", 1.5)];
/// The share of studies that find a difference of the detectable size.
const TEST_POWER: f64 = 0.8;
/// The significance level of the two-sided test.
const TEST_SIGNIFICANCE: f64 = 0.05;
/// The assumed share. Around a half, a difference is hardest to detect.
const BASE_SHARE: f64 = 0.5;

impl StudyOutlook {
    /// Computes the outlook from the plan and the items.
    #[must_use]
    pub fn new(plan: &StudyDesign, settings: &StudySettings, items: &[StudyItem]) -> Self {
        let items: Vec<&StudyItem> = items.iter().filter(|item| !item.is_practice).collect();
        let has = |item: &StudyItem, name: &str| item.texts.iter().any(|text| text.condition == name);
        let conditions = plan.conditions.iter().map(|condition| PlannedCondition {
            condition: condition.name.clone(),
            kind: condition.kind,
            items: items.iter().filter(|item| has(item, &condition.name)).count(),
        });
        let per_item = plan.per_item as usize;
        let per_participant = (plan.per_participant as usize).min(items.len());
        let answers = items.len() * per_item;
        // A participant gets each item at most once, so there must be as many participants as answers of one item.
        let participants = answers.div_ceil(per_participant.max(1)).max(if items.is_empty() { 0 } else { per_item });
        let mut outlook = Self {
            mode: plan.mode,
            conditions: conditions.collect(),
            items: items.len(),
            routes: items.iter().map(|item| item.route).collect::<BTreeSet<_>>().len(),
            per_item,
            answers,
            per_participant,
            participants,
            minutes: settings.minutes,
            power: TEST_POWER,
            significance: TEST_SIGNIFICANCE,
            base_share: BASE_SHARE,
            detectable: Vec::new(),
        };
        outlook.detectable =
            LOGIT_SPREADS.iter().map(|(effects, sd)| outlook.detectable_difference(effects, *sd, &items)).collect();
        outlook
    }

    fn detectable_difference(&self, effects: &'static str, sd: f64, items: &[&StudyItem]) -> DetectableDifference {
        let plan =
            if self.mode == StudyTask::Pair { self.comparison_plan(sd) } else { self.two_condition_plan(sd, items) };
        let found: Option<DetectableShareDifference> =
            plan.and_then(|plan| detectable_difference(&plan, TEST_POWER, TEST_SIGNIFICANCE));
        // One share against a half has half the variance of a difference between two.
        let share_factor = if self.mode == StudyTask::Pair { std::f64::consts::FRAC_1_SQRT_2 } else { 1.0 };
        DetectableDifference {
            effects,
            sd,
            difference: found.map(|found| share_factor * found.difference),
            answers: found.map(|found| found.answers_per_condition),
            design_effect: found.map(|found| found.design_effect),
        }
    }

    /// The plan of the power calculation for the first two conditions, with their share of the answers.
    fn two_condition_plan(&self, sd: f64, items: &[&StudyItem]) -> Option<wayword_metrics::PowerPlan> {
        let [first, second] = self.conditions.get(..2)? else { return None };
        let routes = |name: &str| -> BTreeSet<u32> {
            let has_condition = |item: &&&StudyItem| item.texts.iter().any(|text| text.condition == name);
            items.iter().filter(has_condition).map(|item| item.route).collect()
        };
        let (first, second) = (routes(&first.condition), routes(&second.condition));
        let shared = first.intersection(&second).count();
        let all = first.union(&second).count();
        // A person's answers to texts of these two conditions.
        let answers_each = 2.0 * self.per_participant as f64 / self.conditions.len() as f64;
        Some(wayword_metrics::PowerPlan {
            persons: (self.participants as f64 * answers_each.min(1.0)).round() as usize,
            items: all,
            answers_per_person: (answers_each.round() as usize).max(1),
            base_share: BASE_SHARE,
            person_sd: sd,
            item_sd: sd,
            persons_see_both: answers_each >= 2.0,
            items_in_both: 2 * shared > all,
        })
    }

    /// The plan of the power calculation for comparisons of two conditions. Its result is one share. The calculation expects two groups,
    /// so it gets the persons and the routes twice.
    fn comparison_plan(&self, sd: f64) -> Option<wayword_metrics::PowerPlan> {
        let conditions = self.conditions.len();
        let pairs = (conditions * conditions.saturating_sub(1) / 2).max(1);
        // A person's comparisons of these two conditions.
        let answers_each = self.per_participant as f64 / pairs as f64;
        (conditions > 1).then(|| wayword_metrics::PowerPlan {
            persons: 2 * (self.participants as f64 * answers_each.min(1.0)).round() as usize,
            items: 2 * self.routes,
            answers_per_person: (answers_each.round() as usize).max(1),
            base_share: BASE_SHARE,
            person_sd: sd,
            item_sd: sd,
            persons_see_both: false,
            items_in_both: false,
        })
    }
}

impl fmt::Display for StudyOutlook {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "mode          {}", self.mode.name())?;
        writeln!(f, "items         {} on {} routes", self.items, self.routes)?;
        for planned in &self.conditions {
            let kind = if planned.kind == ConditionKind::Run {
                String::new()
            } else {
                format!(" ({})", kind_name(planned.kind))
            };
            writeln!(f, "  {:<11} {}{kind}", planned.items, escape::to_table_name(&planned.condition))?;
        }
        writeln!(f, "answers       {}: {} of each item", self.answers, self.per_item)?;
        writeln!(
            f,
            "participants  {}, if all finish: {} each",
            self.participants,
            count_with_noun(self.per_participant, "item", "items")
        )?;
        writeln!(f, "minutes each  {}", self.minutes)?;
        let what = match self.mode {
            StudyTask::Pair => "share of two compared conditions, in points from an even split",
            StudyTask::Follow | StudyTask::Rate => {
                "difference between the shares of two conditions near 50 %, in points"
            }
        };
        writeln!(f, "\nThe smallest {what},\nthat 4 of 5 such studies find (two-sided test at 5 %):")?;
        for detectable in &self.detectable {
            let points =
                detectable.difference.map_or_else(|| "none".to_owned(), |share| format_number(100.0 * share, 0));
            let words = match detectable.effects {
                "none" => "if persons and routes are all alike",
                "middle" => "if they differ (standard deviation 0.75 on the logit scale)",
                _ => "if they differ much (1.5)",
            };
            writeln!(f, "  {points:<5} {words}")?;
        }
        if self.mode != StudyTask::Pair {
            writeln!(
                f,
                "What a person or a route does to both conditions alike cancels; where it does not, the study finds less."
            )?;
        }
        if self.conditions.iter().all(|planned| planned.kind == ConditionKind::Run) && self.mode != StudyTask::Pair {
            writeln!(
                f,
                "\nThere is no control. --include people,other-path shows how well a good and a wrong text do."
            )?;
        }
        if self.per_participant == 1 {
            writeln!(f, "\nEach person gets one item: what persons do and what items do cannot be told apart.")?;
        }
        Ok(())
    }
}
