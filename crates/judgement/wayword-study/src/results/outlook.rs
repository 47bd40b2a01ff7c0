//! What a planned study asks for, and what it can find.

use super::{
    inert,
    sheets::kind_name,
    words::{count, number},
};
use crate::{Item, Kind, Mode, Plan, Settings};
use serde::Serialize;
use std::{collections::BTreeSet, fmt};
use wayword_metrics::{Detectable, detectable};

/// What a planned study asks for, and what it can find: what `study plan` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outlook {
    /// What people do.
    pub mode: Mode,
    /// How many items each condition has; an item of two texts counts for both.
    pub conditions: Vec<Planned>,
    /// All items, without those of practice.
    pub items: usize,
    /// The routes of these items.
    pub routes: usize,
    /// How many answers each item shall have.
    pub per_item: usize,
    /// All answers.
    pub answers: usize,
    /// How many items a person gets.
    pub per_participant: usize,
    /// How many participants are needed, if all of them finish.
    pub participants: usize,
    /// How long it takes each, minutes.
    pub minutes: u32,
    /// The power that the detectable differences are for.
    pub power: f64,
    /// The significance of the two-sided test that they are for.
    pub significance: f64,
    /// The share around which they lie.
    pub base_share: f64,
    /// The smallest differences that the study detects, by how much persons and routes differ.
    pub detectable: Vec<Found>,
}

/// How many items a condition has.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Planned {
    /// The condition.
    pub condition: String,
    /// What it is.
    pub kind: Kind,
    /// Its items.
    pub items: usize,
}

/// The smallest difference that a study detects where persons and routes differ so much.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Found {
    /// How much they differ: `none`, `middle` or `large`.
    pub effects: &'static str,
    /// The standard deviation of persons, and of routes, on the logit scale.
    pub sd: f64,
    /// The difference between the shares of two conditions; where texts are compared, how far from an even split. None where no
    /// difference has that power.
    pub difference: Option<f64>,
    /// Answers in each of two conditions; where texts are compared, comparisons of two conditions.
    pub answers: Option<f64>,
    /// By how much the variance exceeds that of independent answers.
    pub design_effect: Option<f64>,
}

/// How much persons and routes differ, with the standard deviation on the logit scale.
const EFFECTS: [(&str, f64); 3] = [("none", 0.0), ("middle", 0.75), ("large", 1.5)];
const POWER: f64 = 0.8;
const SIGNIFICANCE: f64 = 0.05;
/// Where a difference is hardest to detect.
const BASE: f64 = 0.5;

impl Outlook {
    /// What a study asks for, from its items.
    #[must_use]
    pub fn new(plan: &Plan, settings: &Settings, items: &[Item]) -> Self {
        let items: Vec<&Item> = items.iter().filter(|item| !item.is_practice).collect();
        let has = |item: &Item, name: &str| item.texts.iter().any(|told| told.condition == name);
        let conditions = plan.conditions.iter().map(|condition| Planned {
            condition: condition.name.clone(),
            kind: condition.kind,
            items: items.iter().filter(|item| has(item, &condition.name)).count(),
        });
        let per_item = plan.per_item as usize;
        let per_participant = (plan.per_participant as usize).min(items.len());
        let answers = items.len() * per_item;
        // Nobody gets an item twice.
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
            power: POWER,
            significance: SIGNIFICANCE,
            base_share: BASE,
            detectable: Vec::new(),
        };
        outlook.detectable = EFFECTS.iter().map(|(effects, sd)| outlook.found(effects, *sd, &items)).collect();
        outlook
    }

    fn found(&self, effects: &'static str, sd: f64, items: &[&Item]) -> Found {
        let plan = if self.mode == Mode::Pair { self.of_pairs(sd) } else { self.of_two(sd, items) };
        let found: Option<Detectable> = plan.and_then(|plan| detectable(&plan, POWER, SIGNIFICANCE));
        // One share against a half has half the variance of a difference between two.
        let of_one = if self.mode == Mode::Pair { std::f64::consts::FRAC_1_SQRT_2 } else { 1.0 };
        Found {
            effects,
            sd,
            difference: found.map(|found| of_one * found.difference),
            answers: found.map(|found| found.answers_per_condition),
            design_effect: found.map(|found| found.design_effect),
        }
    }

    /// Two of the conditions, with their share of the answers.
    fn of_two(&self, sd: f64, items: &[&Item]) -> Option<wayword_metrics::Plan> {
        let [first, second] = self.conditions.get(..2)? else { return None };
        let routes = |name: &str| -> BTreeSet<u32> {
            let of = |item: &&&Item| item.texts.iter().any(|told| told.condition == name);
            items.iter().filter(of).map(|item| item.route).collect()
        };
        let (first, second) = (routes(&first.condition), routes(&second.condition));
        let shared = first.intersection(&second).count();
        let all = first.union(&second).count();
        let each = 2.0 * self.per_participant as f64 / self.conditions.len() as f64;
        Some(wayword_metrics::Plan {
            persons: (self.participants as f64 * each.min(1.0)).round() as usize,
            items: all,
            answers_per_person: (each.round() as usize).max(1),
            base_share: BASE,
            person_sd: sd,
            item_sd: sd,
            persons_see_both: each >= 2.0,
            items_in_both: 2 * shared > all,
        })
    }

    /// The comparisons of two of the conditions: as one share, it has the variance of half a difference.
    fn of_pairs(&self, sd: f64) -> Option<wayword_metrics::Plan> {
        let conditions = self.conditions.len();
        let pairs = (conditions * conditions.saturating_sub(1) / 2).max(1);
        let each = self.per_participant as f64 / pairs as f64;
        (conditions > 1).then(|| wayword_metrics::Plan {
            persons: 2 * (self.participants as f64 * each.min(1.0)).round() as usize,
            items: 2 * self.routes,
            answers_per_person: (each.round() as usize).max(1),
            base_share: BASE,
            person_sd: sd,
            item_sd: sd,
            persons_see_both: false,
            items_in_both: false,
        })
    }
}

impl fmt::Display for Outlook {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "mode          {}", self.mode.name())?;
        writeln!(f, "items         {} on {} routes", self.items, self.routes)?;
        for planned in &self.conditions {
            let kind =
                if planned.kind == Kind::Run { String::new() } else { format!(" ({})", kind_name(planned.kind)) };
            writeln!(f, "  {:<11} {}{kind}", planned.items, inert::name(&planned.condition))?;
        }
        writeln!(f, "answers       {}: {} of each item", self.answers, self.per_item)?;
        writeln!(
            f,
            "participants  {}, if all finish: {} each",
            self.participants,
            count(self.per_participant, "item", "items")
        )?;
        writeln!(f, "minutes each  {}", self.minutes)?;
        let what = match self.mode {
            Mode::Pair => "share of two compared conditions, in points from an even split",
            Mode::Follow | Mode::Rate => "difference between the shares of two conditions near 50 %, in points",
        };
        writeln!(f, "\nThe smallest {what},\nthat 4 of 5 such studies find (two-sided test at 5 %):")?;
        for found in &self.detectable {
            let points = found.difference.map_or_else(|| "none".to_owned(), |share| number(100.0 * share, 0));
            let words = match found.effects {
                "none" => "if persons and routes are all alike",
                "middle" => "if they differ (standard deviation 0.75 on the logit scale)",
                _ => "if they differ much (1.5)",
            };
            writeln!(f, "  {points:<5} {words}")?;
        }
        if self.mode != Mode::Pair {
            writeln!(
                f,
                "What a person or a route does to both conditions alike cancels; where it does not, the study finds less."
            )?;
        }
        if self.conditions.iter().all(|planned| planned.kind == Kind::Run) && self.mode != Mode::Pair {
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
