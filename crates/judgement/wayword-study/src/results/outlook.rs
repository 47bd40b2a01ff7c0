//! Predicts what a planned study needs (answers, participants, minutes), how often it finds a difference, and how many participants a
//! difference needs. `outlook_text.rs` prints it.

use super::{
    CONFIDENCE_LEVEL,
    number_format::format_percent,
    planned_answers::{PlannedItem, count_answers, count_routes, full_items, items_of_study, plan_answers},
};
use crate::{ConditionKind, StudyDesign, StudyError, StudyItem, StudySettings, StudyTask};
use serde::Serialize;
use wayword_metrics::{PlannedAnswer, PlannedTest, PowerPlan, SimulatedPower, search_for_power};

/// What a researcher asks of the plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanQuestion {
    /// The difference that the study shall find, as a share: 0.2 is 20 points.
    pub effect: f64,
    /// The mean of the shares of both conditions.
    pub base_share: f64,
    /// How persons differ in what a condition does to them: the standard deviation on the logit scale. `None` tries three.
    pub person_sd: Option<f64>,
    /// How routes differ in the same sense. `None` tries three.
    pub route_sd: Option<f64>,
    /// Another number of routes than the study has, each with a text of every condition.
    pub routes: Option<usize>,
    /// Another number of participants than the study needs.
    pub participants: Option<usize>,
}

/// The needs of a planned study, and what it finds. `study plan` prints this.
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
    pub per_item: f64,
    /// All answers.
    pub answers: usize,
    /// How many items a person gets.
    pub per_participant: usize,
    /// How many participants are needed, if all of them finish.
    pub participants: usize,
    /// How long one participant needs, minutes.
    pub minutes: u32,
    /// The difference that the study shall find, as a share; where texts are compared, the distance from an even split.
    pub effect: f64,
    /// The statistical power for which differences and participants are searched.
    pub power: f64,
    /// The confidence level of the intervals of `results`, which have to leave out no difference.
    pub level: f64,
    /// The share around which the two conditions are assumed to lie.
    pub base_share: f64,
    /// How many studies were simulated for each figure.
    pub simulated_studies: usize,
    /// What the study finds, each time under another assumption of how much persons and routes differ. Empty for a study of one condition.
    pub assumptions: Vec<PlannedPower>,
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

/// What a planned study finds, under one assumption of how much persons and routes differ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PlannedPower {
    /// The standard deviation of persons on the logit scale.
    pub person_sd: f64,
    /// The standard deviation of routes on the logit scale.
    pub route_sd: f64,
    /// How often the planned study finds the asked difference. `None` where the difference is too large for the shares.
    pub power: Option<SimulatedPower>,
    /// The smallest difference that it finds with the wanted power; `None` if there is none.
    pub difference: Option<f64>,
    /// How many participants the asked difference needs for that power, on the same routes; `None` if sixteen times as many are not enough.
    pub participants: Option<usize>,
}

/// Three assumptions of how much persons and routes differ: alike, differ, differ much.
pub(super) const LOGIT_SPREADS: [f64; 3] = [0.0, 0.5, 1.0];
/// The share of studies that find a difference of the detectable size.
const TEST_POWER: f64 = 0.8;
/// Most studies that are simulated for one figure.
const MAX_SIMULATED_STUDIES: usize = 600;
/// Fewest studies that are simulated for one figure.
const MIN_SIMULATED_STUDIES: usize = 100;
/// How many answers are simulated for one figure, so that a plan takes seconds.
const SIMULATED_ANSWERS: usize = 200_000;
/// How many times the planned participants are tried at most.
const MAX_PARTICIPANT_FACTOR: usize = 16;
/// Largest standard deviation on the logit scale that may be asked for.
const MAX_ASKED_SD: f64 = 5.0;
/// Most routes and most participants that may be asked for.
const MAX_ASKED_COUNT: usize = 10_000;

impl PlanQuestion {
    /// Checks the numbers.
    ///
    /// # Errors
    /// The first that makes no sense, by the name of its flag.
    pub fn check(&self) -> Result<(), StudyError> {
        let refuse = |problem: &str, hint: &str| Err(StudyError::refused_request(problem, hint));
        let (base, effect) = (format_percent(self.base_share), format_percent(self.effect));
        if !(self.base_share > 0.0 && self.base_share < 1.0) {
            return refuse(
                &format!("--base {base}: this is no share between 0 and 100 %"),
                "--base is in per cent, above 0 and below 100, as in --base 50",
            );
        }
        if !(self.effect > 0.0 && self.effect < 1.0) {
            return refuse(
                &format!("--effect {effect}: no two shares differ by that"),
                "--effect is in points of per cent, above 0 and below 100, as in --effect 20",
            );
        }
        // The shares of the two conditions lie half of the effect below the base and above it.
        let ends = [self.base_share - self.effect / 2.0, self.base_share + self.effect / 2.0];
        if let Some(end) = ends.into_iter().find(|end| !(*end > 0.0 && *end < 1.0)) {
            let problem =
                format!("--base {base} with an effect of {effect} points gives a share of {} %", format_percent(end));
            let hint = if self.base_share <= 0.01 {
                format!(
                    "--base is in per cent, as in --base 50; did you mean {}?",
                    format_percent(100.0 * self.base_share)
                )
            } else {
                let most = format_percent(2.0 * self.base_share.min(1.0 - self.base_share));
                format!("give an --effect below {most}, or a --base nearer to 50")
            };
            return refuse(&problem, &hint);
        }
        for (flag, sd) in [("--person-sd", self.person_sd), ("--route-sd", self.route_sd)] {
            if sd.is_some_and(|sd| !(0.0..=MAX_ASKED_SD).contains(&sd)) {
                let given = sd.unwrap_or_default();
                return refuse(
                    &format!("{flag} {given}: not possible"),
                    "give a standard deviation on the logit scale, 0 to 5",
                );
            }
        }
        for (flag, count) in [("--routes", self.routes), ("--participants", self.participants)] {
            if count.is_some_and(|count| count == 0 || count > MAX_ASKED_COUNT) {
                let given = count.unwrap_or_default();
                return refuse(&format!("{flag} {given}: not possible"), "give 1 to 10000");
            }
        }
        Ok(())
    }

    /// A question to somebody who gave the effect or the base as a share, and not in per cent; `None` where nothing looks like that.
    #[must_use]
    pub fn unit_question(&self) -> Option<String> {
        let shares = [("--effect", self.effect, "of a point"), ("--base", self.base_share, "per cent")];
        let (flag, share, unit) = shares.into_iter().find(|(_, share, _)| *share <= 0.01)?;
        let (given, meant) = (format_percent(share), format_percent(100.0 * share));
        Some(format!("{flag} {given} is {given} {unit}; did you mean {flag} {meant}?"))
    }

    /// The assumed standard deviations of persons and routes.
    fn spreads(&self) -> Vec<[f64; 2]> {
        match (self.person_sd, self.route_sd) {
            (None, None) => LOGIT_SPREADS.iter().map(|sd| [*sd, *sd]).collect(),
            (Some(person), Some(route)) => vec![[person, route]],
            (Some(person), None) => LOGIT_SPREADS.iter().map(|sd| [person, *sd]).collect(),
            (None, Some(route)) => LOGIT_SPREADS.iter().map(|sd| [*sd, route]).collect(),
        }
    }
}

impl Default for PlanQuestion {
    /// 20 points around a half, where a difference is hardest to find.
    fn default() -> Self {
        Self { effect: 0.2, base_share: 0.5, person_sd: None, route_sd: None, routes: None, participants: None }
    }
}

/// How many studies of so many answers are simulated.
fn count_studies(answers: usize) -> usize {
    (SIMULATED_ANSWERS / answers.max(1)).clamp(MIN_SIMULATED_STUDIES, MAX_SIMULATED_STUDIES)
}

impl StudyOutlook {
    /// Computes the outlook from the plan and the items.
    #[must_use]
    pub fn new(plan: &StudyDesign, settings: &StudySettings, items: &[StudyItem], question: &PlanQuestion) -> Self {
        let names: Vec<&str> = plan.conditions.iter().map(|condition| condition.name.as_str()).collect();
        let planned_items = match question.routes {
            Some(routes) => full_items(routes, names.len(), plan.mode),
            None => items_of_study(items, &names),
        };
        let conditions = plan.conditions.iter().enumerate().map(|(number, condition)| PlannedCondition {
            condition: condition.name.clone(),
            kind: condition.kind,
            items: planned_items.iter().filter(|item| item.is_about(number)).count(),
        });
        let (items, routes) = (planned_items.len(), count_routes(&planned_items));
        let (per_item, per_participant) = (plan.per_item as usize, (plan.per_participant as usize).min(routes));
        let wanted = items * per_item;
        // A participant gets each item at most once, so there must be as many participants as answers of one item.
        let needed = wanted.div_ceil(per_participant.max(1)).max(if items == 0 { 0 } else { per_item });
        let participants = question.participants.unwrap_or(needed);
        let possible = count_answers(&planned_items, participants, per_participant);
        let answers = if question.participants.is_some() { possible } else { wanted.min(possible) };
        let simulated_studies = count_studies(answers);
        let mut outlook = Self {
            mode: plan.mode,
            conditions: conditions.collect(),
            items,
            routes,
            per_item: answers as f64 / items.max(1) as f64,
            answers,
            per_participant,
            participants,
            minutes: settings.minutes,
            effect: question.effect,
            power: TEST_POWER,
            level: CONFIDENCE_LEVEL,
            base_share: question.base_share,
            simulated_studies,
            assumptions: Vec::new(),
        };
        if names.len() > 1 && answers > 0 {
            let seed = plan.seed;
            let planned = plan_answers(&planned_items, participants, answers, seed);
            let power = |[person_sd, route_sd]: [f64; 2]| {
                outlook.planned_power(&planned_items, &planned, person_sd, route_sd, seed)
            };
            outlook.assumptions = question.spreads().into_iter().map(power).collect();
        }
        outlook
    }

    /// What the study finds under one assumption.
    fn planned_power(
        &self,
        items: &[PlannedItem],
        planned: &[PlannedAnswer],
        person_sd: f64,
        route_sd: f64,
        seed: u64,
    ) -> PlannedPower {
        let test = if self.mode == StudyTask::Pair { PlannedTest::EvenSplit } else { PlannedTest::Difference };
        let base_share = if test == PlannedTest::EvenSplit { 0.5 } else { self.base_share };
        let studies = self.simulated_studies;
        let plan = PowerPlan {
            answers: planned,
            test,
            base_share,
            person_sd,
            item_sd: route_sd,
            level: self.level,
            studies,
            seed,
        };
        let power_of = |participants: f64| {
            let participants = participants.round().max(2.0) as usize;
            let answers = count_answers(items, participants, self.per_participant);
            let studies = count_studies(answers).min(studies);
            let answers = plan_answers(items, participants, answers, seed);
            PowerPlan { answers: &answers, studies, ..plan }.simulate_power(self.effect)
        };
        let most = (MAX_PARTICIPANT_FACTOR * self.participants) as f64;
        let needed = search_for_power(TEST_POWER, most, self.participants.max(2) as f64, 0.5, power_of);
        PlannedPower {
            person_sd,
            route_sd,
            power: plan.simulate_power(self.effect),
            difference: plan.detectable_difference(TEST_POWER),
            participants: needed.map(|needed| needed.round().max(2.0) as usize),
        }
    }
}
