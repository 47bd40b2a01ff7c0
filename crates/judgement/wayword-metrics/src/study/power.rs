//! Power analysis: the smallest difference between two conditions that a planned study can detect.

use super::{logit_normal, mean_share, quantile};
use serde::{Deserialize, Serialize};

/// A planned study of two conditions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PowerPlan {
    /// All persons, those of both conditions together.
    pub persons: usize,
    /// Items, those of both conditions together where no item is in both.
    pub items: usize,
    /// How many answers each person gives, over both conditions.
    pub answers_per_person: usize,
    /// The mean of the two conditions' shares.
    pub base_share: f64,
    /// The standard deviation of persons on the logit scale.
    pub person_sd: f64,
    /// The standard deviation of items on the logit scale.
    pub item_sd: f64,
    /// Whether each person sees both conditions, with half of the answers each.
    pub persons_see_both: bool,
    /// Whether each item is in both conditions.
    pub items_in_both: bool,
}

/// The smallest difference between two shares that a plan detects.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DetectableShareDifference {
    /// The difference.
    pub difference: f64,
    /// Answers in each condition.
    pub answers_per_condition: f64,
    /// The factor by which the variance exceeds that of independent answers; below 1 where effects of persons and items cancel.
    pub design_effect: f64,
}

/// The smallest difference that a plan detects with this power in a two-sided test at this significance.
///
/// For independent answers, n in each condition, it solves (Fleiss, Levin and Paik 2003, 4.14, without continuity)
///
/// ```text
/// d = (z_significance √(2 m (1 - m)) + z_power √(p (1 - p) + q (1 - q))) / √n,   p, q = m ± d / 2
/// ```
///
/// for two shares with the mean m. Otherwise n is divided by the design effect (Kish 1965)
/// `1 + (a - 1) person + (b - 1) item`, where a and b are the answers of one person and to one item within a condition, and
/// `person` and `item` the correlations of two answers of one person and to one item at that mean. If persons (or items) take part
/// in both conditions, their effects cancel from the difference, and `a - 1` (or `b - 1`) becomes -1. `None` where no difference
/// has that power, and for impossible plans.
#[must_use]
pub fn detectable_difference(plan: &PowerPlan, power: f64, significance: f64) -> Option<DetectableShareDifference> {
    let answers_per_condition = (plan.persons * plan.answers_per_person) as f64 / 2.0;
    let is_inside = |share: f64| share > 0.0 && share < 1.0;
    let is_sd = |sd: f64| (0.0..=MAX_LOGIT_SD).contains(&sd);
    let is_possible = [plan.base_share, power, significance].into_iter().all(is_inside)
        && is_sd(plan.person_sd)
        && is_sd(plan.item_sd)
        && plan.items > 0
        && answers_per_condition > 0.0;
    let design_effect = is_possible.then(|| design_effect(plan, answers_per_condition))?;
    let z = [quantile::normal_quantile(1.0 - significance / 2.0), quantile::normal_quantile(power)];
    let difference = smallest_difference(plan.base_share, answers_per_condition / design_effect, z)?;
    Some(DetectableShareDifference { difference, answers_per_condition, design_effect })
}

/// Largest standard deviation of logits that is accepted. Beyond it a person gives nearly always the same answer.
const MAX_LOGIT_SD: f64 = 10.0;

/// The factor by which the variance exceeds that of independent answers, for `answers` in each condition.
fn design_effect(plan: &PowerPlan, answers: f64) -> f64 {
    let conditions = |in_both: bool| if in_both { 1.0 } else { 2.0 };
    let per_person = answers * conditions(plan.persons_see_both) / plan.persons as f64;
    let per_item = answers * conditions(plan.items_in_both) / plan.items as f64;
    let [person, item] = answer_correlations(plan);
    let effect = |in_both: bool, of_one: f64| if in_both { -1.0 } else { (of_one - 1.0).max(0.0) };
    1.0 + effect(plan.persons_see_both, per_person) * person + effect(plan.items_in_both, per_item) * item
}

/// The correlations of two answers of one person, and of two answers to one item.
///
/// Two answers of one person share the person's part of the logit and differ in the rest. Their covariance is the variance, over
/// the shared part, of the expected share given that part. Divided by p (1 - p) it is their correlation.
fn answer_correlations(plan: &PowerPlan) -> [f64; 2] {
    let total_sd = plan.person_sd.hypot(plan.item_sd);
    let centre = logit_normal::centre_logit(plan.base_share, total_sd);
    let total = plan.base_share * (1.0 - plan.base_share);
    let correlation = |shared_sd: f64, rest_sd: f64| {
        let square = logit_normal::mean_over_normal(centre, shared_sd, |at| mean_share(at, rest_sd).powi(2));
        (square - plan.base_share * plan.base_share) / total
    };
    [correlation(plan.person_sd, plan.item_sd), correlation(plan.item_sd, plan.person_sd)]
}

/// Solves the formula for the difference, by bisection.
fn smallest_difference(mean: f64, answers: f64, [significance, power]: [f64; 2]) -> Option<f64> {
    let variance = |share: f64| (share * (1.0 - share)).max(0.0);
    let is_detected = |difference: f64| {
        let apart = variance(mean + difference / 2.0) + variance(mean - difference / 2.0);
        let needed = significance * (2.0 * variance(mean)).sqrt() + power * apart.sqrt();
        difference * answers.sqrt() >= needed
    };
    // With a larger difference, one of the two shares would be outside 0 to 1.
    let largest = 2.0 * mean.min(1.0 - mean);
    let (mut low, mut high) = (0.0, largest);
    for _ in 0..100 {
        let middle = f64::midpoint(low, high);
        if is_detected(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    is_detected(largest).then_some(high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    const PLAN: PowerPlan = PowerPlan {
        persons: 60,
        items: 60,
        answers_per_person: 1,
        base_share: 0.5,
        person_sd: 0.0,
        item_sd: 0.0,
        persons_see_both: false,
        items_in_both: false,
    };

    fn found(plan: PowerPlan) -> DetectableShareDifference {
        detectable_difference(&plan, 0.8, 0.05).unwrap()
    }

    #[test]
    fn thirty_persons_in_each_group_detect_about_35_points() {
        let found = found(PLAN);
        assert_eq!((found.answers_per_condition, found.design_effect), (30.0, 1.0));
        assert_eq!(format!("{:.3}", found.difference), "0.355");
    }

    /// The size that detects 0.6 against 0.7 by Fleiss's formula is 356 (Fleiss, Levin and Paik 2003).
    #[test]
    fn a_known_size_detects_its_difference() {
        let found = found(PowerPlan { persons: 2 * 356, items: 2 * 356, base_share: 0.65, ..PLAN });
        assert!((found.difference - 0.1).abs() < 1e-4, "{found:?}");
    }

    #[test]
    fn one_person_each_with_one_item_each_is_independent_whatever_they_are_like() {
        let found = found(PowerPlan { person_sd: 1.5, item_sd: 1.0, ..PLAN });
        assert_eq!(found.design_effect, 1.0);
    }

    #[test]
    fn clusters_cost_and_conditions_within_persons_gain() {
        let several = PowerPlan { persons: 30, answers_per_person: 10, person_sd: 1.0, item_sd: 1.0, ..PLAN };
        let within = PowerPlan { persons_see_both: true, items_in_both: true, ..several };
        let free = PowerPlan { person_sd: 0.0, item_sd: 0.0, ..several };
        let [several, within, free] = [several, within, free].map(found);
        assert!(several.design_effect > 2.0, "{several:?}");
        assert!(within.design_effect < 1.0, "{within:?}");
        assert!(within.difference < free.difference && free.difference < several.difference);
    }

    /// The variance of a difference between equal shares, over simulated studies: the plan's persons in order, items in turns.
    fn simulated_variance(plan: PowerPlan) -> f64 {
        const STUDIES: u32 = 2000;
        let mut rng = wayword_core::seeded_rng(1, &["power"]);
        let centre = logit_normal::centre_logit(plan.base_share, plan.person_sd.hypot(plan.item_sd));
        let one = |_| {
            let mut normals = |count, sd: f64| -> Vec<f64> {
                (0..count).map(|_| sd * quantile::normal_quantile(rng.random_range(1e-12..1.0))).collect()
            };
            let (persons, items) = (normals(plan.persons, plan.person_sd), normals(plan.items, plan.item_sd));
            let mut ones = [0.0; 2];
            for n in 0..plan.persons * plan.answers_per_person {
                let (person, at) = (n / plan.answers_per_person, n % plan.answers_per_person);
                let second = usize::from(if plan.persons_see_both { at % 2 == 1 } else { person % 2 == 1 });
                let half = plan.items / 2;
                let before = if plan.persons_see_both { n / 2 } else { person / 2 * plan.answers_per_person + at };
                let turn = 7 * before;
                let item = if plan.items_in_both { turn % plan.items } else { turn % half + second * half };
                let share = logit_normal::expit(centre + persons[person] + items[item]);
                ones[second] += f64::from(u8::from(rng.random::<f64>() < share));
            }
            let answers = (plan.persons * plan.answers_per_person) as f64 / 2.0;
            ((ones[0] - ones[1]) / answers).powi(2)
        };
        (0..STUDIES).map(one).sum::<f64>() / f64::from(STUDIES)
    }

    #[test]
    fn the_design_effect_is_that_of_simulated_studies() {
        let plan = PowerPlan {
            persons: 30,
            items: 60,
            answers_per_person: 10,
            person_sd: 1.0,
            item_sd: 1.0,
            base_share: 0.7,
            ..PLAN
        };
        for (persons_see_both, items_in_both) in [(false, false), (false, true), (true, false)] {
            let plan = PowerPlan { persons_see_both, items_in_both, ..plan };
            let DetectableShareDifference { design_effect, answers_per_condition, .. } = found(plan);
            let independent = 2.0 * plan.base_share * (1.0 - plan.base_share) / answers_per_condition;
            let simulated = simulated_variance(plan) / independent;
            assert!((simulated / design_effect - 1.0).abs() < 0.12, "{plan:?}: {simulated} for {design_effect}");
        }
    }

    #[test]
    fn detectable_is_none_for_impossible_plans() {
        for plan in [
            PowerPlan { persons: 0, ..PLAN },
            PowerPlan { items: 0, ..PLAN },
            PowerPlan { base_share: 1.0, ..PLAN },
            PowerPlan { person_sd: f64::NAN, ..PLAN },
            PowerPlan { persons: 2, ..PLAN },
        ] {
            assert_eq!(detectable_difference(&plan, 0.8, 0.05), None);
        }
    }
}
