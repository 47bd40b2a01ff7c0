//! Power analysis: how often a planned study finds a difference, by simulated studies that are analysed as a real one is.

use super::{
    ConfidenceInterval, StudyAnswer, answer_share,
    logit_normal::{centre_logit, expit},
    quantile::normal_quantile,
    share_difference,
};
use rand::Rng;
use serde::{Deserialize, Serialize};
use wayword_core::seeded_rng;

/// An answer that a planned study gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlannedAnswer {
    /// The number of the person.
    pub person: usize,
    /// The number of the item. Two conditions share items.
    pub item: usize,
    /// Whether it is about the second condition, and not the first.
    pub is_second: bool,
}

/// What a planned study tests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PlannedTest {
    /// Whether the shares of two conditions differ.
    Difference,
    /// Whether one share differs from a half. All answers are about the first condition.
    EvenSplit,
}

/// A planned study, and what is assumed about persons and items.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerPlan<'a> {
    /// The answers that it gets.
    pub answers: &'a [PlannedAnswer],
    /// What it tests.
    pub test: PlannedTest,
    /// The mean of the two conditions' shares over all persons and items.
    pub base_share: f64,
    /// How persons differ in what a condition does to them: the standard deviation on the logit scale, drawn anew for each condition. What a
    /// person does to both conditions alike cancels from their difference, and is left out.
    pub person_sd: f64,
    /// How items differ in the same sense.
    pub item_sd: f64,
    /// Confidence level of the interval that has to leave out no difference.
    pub level: f64,
    /// How many studies are simulated.
    pub studies: usize,
    /// Seed of the studies. Equal seeds draw the same persons, items and luck for every difference.
    pub seed: u64,
}

/// The share of simulated studies that find a difference.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SimulatedPower {
    /// The share.
    pub power: f64,
    /// Its standard error, because the number of simulated studies is limited.
    pub se: f64,
}

/// Largest standard deviation of logits that is accepted. Beyond it a person gives nearly always the same answer.
const MAX_LOGIT_SD: f64 = 10.0;
/// How often the search for a difference corrects its guess.
const MAX_SEARCH_STEPS: usize = 6;
/// The search ends when the power is this near to the wanted one.
const POWER_TOLERANCE: f64 = 0.01;

impl ConfidenceInterval {
    /// Whether a value lies outside the interval.
    #[must_use]
    pub fn leaves_out(&self, value: f64) -> bool {
        self.low > value || self.high < value
    }
}

impl PowerPlan<'_> {
    /// How often the planned study finds a difference of this size: between two shares, or between one share and a half. `None` for
    /// impossible plans, and where a share would lie outside 0 to 1.
    #[must_use]
    pub fn simulate_power(&self, difference: f64) -> Option<SimulatedPower> {
        let shares = self.true_shares(difference)?;
        let found = StudySimulation::new(self, shares).count_found();
        let power = found as f64 / self.studies as f64;
        Some(SimulatedPower { power, se: (power * (1.0 - power) / self.studies as f64).sqrt() })
    }

    /// The smallest difference that the planned study finds with this power. `None` for impossible plans, and where no difference has that
    /// power.
    #[must_use]
    pub fn detectable_difference(&self, power: f64) -> Option<f64> {
        let largest = LARGEST_SHARE_OF_RANGE * self.largest_difference()?;
        let first_guess = 3.0 / (self.answers.len() as f64).sqrt();
        search_for_power(power, largest, first_guess.min(largest), 1.0, |difference| self.simulate_power(difference))
    }

    /// The shares of both conditions for a difference.
    fn true_shares(&self, difference: f64) -> Option<[f64; 2]> {
        let is_possible = self.largest_difference().is_some_and(|largest| difference >= 0.0 && difference < largest);
        let (above, below) = match self.test {
            PlannedTest::Difference => (difference / 2.0, difference / 2.0),
            PlannedTest::EvenSplit => (difference, 0.0),
        };
        is_possible.then_some([self.base_share + above, self.base_share - below])
    }

    /// The difference at which a share would be 0 or 1; `None` for impossible plans.
    fn largest_difference(&self) -> Option<f64> {
        let is_inside = |share: f64| share > 0.0 && share < 1.0;
        let is_sd = |sd: f64| (0.0..=MAX_LOGIT_SD).contains(&sd);
        let is_possible = is_inside(self.base_share)
            && is_inside(self.level)
            && is_sd(self.person_sd)
            && is_sd(self.item_sd)
            && self.studies > 0
            && !self.answers.is_empty();
        let room = self.base_share.min(1.0 - self.base_share);
        is_possible.then_some(match self.test {
            PlannedTest::Difference => 2.0 * room,
            PlannedTest::EvenSplit => 1.0 - self.base_share,
        })
    }
}

/// The largest difference that is tried, as a share of that at which a share would be 0 or 1.
const LARGEST_SHARE_OF_RANGE: f64 = 0.98;

/// Searches the value at which the power is the wanted one, from a first guess and up to a largest value. The distance from chance to the
/// power, in standard errors, is taken to grow with the value to the power of `growth`: 1 for a difference, 0.5 for a number of persons.
/// `None` if the largest value has less power.
pub fn search_for_power(
    wanted: f64,
    largest: f64,
    first_guess: f64,
    growth: f64,
    power_at: impl Fn(f64) -> Option<SimulatedPower>,
) -> Option<f64> {
    // A difference has to be 1.96 standard errors away to be found, and as much further as the power demands.
    let threshold = normal_quantile(0.975);
    let wanted_distance = threshold + normal_quantile(wanted);
    let (mut low, mut high) = (0.0, None);
    let mut guess = first_guess;
    for _ in 0..MAX_SEARCH_STEPS {
        let power = power_at(guess)?.power;
        if (power - wanted).abs() <= POWER_TOLERANCE {
            return Some(guess);
        }
        if power >= wanted {
            high = Some(guess);
        } else if guess >= largest {
            return None;
        } else {
            low = guess;
        }
        let distance = (threshold + normal_quantile(power.clamp(0.02, 0.998))).max(0.2);
        let next = (guess * (wanted_distance / distance).powf(1.0 / growth)).min(largest);
        // A guess outside what is known already is replaced by the middle.
        let (bottom, top) = (low, high.unwrap_or(f64::INFINITY));
        guess = if next > bottom && next < top { next } else { f64::midpoint(bottom, top.min(largest)) };
    }
    high.or(Some(guess))
}

/// Draws studies of one plan.
struct StudySimulation<'a> {
    plan: &'a PowerPlan<'a>,
    /// The logits of both conditions, of a person and an item like the mean ones.
    centres: [f64; 2],
    persons: usize,
    items: usize,
}

impl<'a> StudySimulation<'a> {
    fn new(plan: &'a PowerPlan<'a>, shares: [f64; 2]) -> Self {
        let sd = plan.person_sd.hypot(plan.item_sd);
        let count =
            |number: fn(&PlannedAnswer) -> usize| plan.answers.iter().map(number).max().map_or(0, |last| last + 1);
        Self {
            plan,
            centres: shares.map(|share| centre_logit(share, sd)),
            persons: count(|answer| answer.person),
            items: count(|answer| answer.item),
        }
    }

    /// How many studies find the difference.
    fn count_found(&self) -> usize {
        let of_condition = |is_second: bool| -> Vec<StudyAnswer<usize, usize>> {
            let own = self.plan.answers.iter().filter(|answer| answer.is_second == is_second);
            own.map(|answer| StudyAnswer { person: answer.person, item: answer.item, value: 0.0 }).collect()
        };
        let mut answers = [of_condition(false), of_condition(true)];
        let mut rng = seeded_rng(self.plan.seed, &["power"]);
        (0..self.plan.studies)
            .filter(|_| {
                self.draw_answers(&mut answers, &mut rng);
                self.is_found(&answers)
            })
            .count()
    }

    /// Draws the persons, the items and the answers of one study.
    fn draw_answers(&self, answers: &mut [Vec<StudyAnswer<usize, usize>>; 2], rng: &mut impl Rng) {
        for (own, centre) in answers.iter_mut().zip(self.centres) {
            let mut normals = |count: usize, sd: f64| -> Vec<f64> {
                (0..count).map(|_| sd * normal_quantile(rng.random_range(1e-12..1.0))).collect()
            };
            let (persons, items) = (normals(self.persons, self.plan.person_sd), normals(self.items, self.plan.item_sd));
            for answer in own {
                let share = expit(centre + persons[answer.person] + items[answer.item]);
                answer.value = f64::from(u8::from(rng.random::<f64>() < share));
            }
        }
    }

    /// Whether the interval of a study leaves out no difference.
    fn is_found(&self, [first, second]: &[Vec<StudyAnswer<usize, usize>>; 2]) -> bool {
        let (interval, none) = match self.plan.test {
            PlannedTest::Difference => {
                (share_difference(first, second, self.plan.level).and_then(|found| found.interval), 0.0)
            }
            PlannedTest::EvenSplit => (answer_share(first, self.plan.level).and_then(|found| found.interval), 0.5),
        };
        interval.is_some_and(|interval| interval.leaves_out(none))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each of `persons` answers `each` items of `items`, in turns about the one condition and the other.
    fn planned(persons: usize, each: usize, items: usize) -> Vec<PlannedAnswer> {
        let answer = |n: usize| PlannedAnswer {
            person: n / each,
            item: (n / 2 + n / items / 2) % items,
            is_second: if each == 1 { (n / each) % 2 == 1 } else { n % 2 == 1 },
        };
        (0..persons * each).map(answer).collect()
    }

    fn plan(answers: &[PlannedAnswer]) -> PowerPlan<'_> {
        PowerPlan {
            answers,
            test: PlannedTest::Difference,
            base_share: 0.5,
            person_sd: 0.0,
            item_sd: 0.0,
            level: 0.95,
            studies: 1000,
            seed: 1,
        }
    }

    /// 30 persons with one item each, in each of two groups, find 35 points by Fleiss's formula; the interval is a little stricter.
    #[test]
    fn thirty_persons_in_each_group_find_about_35_points() {
        let answers: Vec<PlannedAnswer> =
            (0..60).map(|n| PlannedAnswer { person: n, item: n, is_second: n % 2 == 1 }).collect();
        let found = plan(&answers).detectable_difference(0.8).unwrap();
        assert!((found - 0.36).abs() < 0.025, "{found}");
    }

    #[test]
    fn without_a_difference_one_study_in_twenty_or_fewer_finds_one() {
        let answers = planned(30, 10, 60);
        for sd in [0.0, 0.5, 1.0] {
            let plan = PowerPlan { person_sd: sd, item_sd: sd, ..plan(&answers) };
            let found = plan.simulate_power(0.0).unwrap();
            assert!(found.power < 0.05 + 3.0 * found.se, "{sd}: {found:?}");
        }
    }

    #[test]
    fn what_differs_more_needs_a_larger_difference_and_more_persons_a_smaller_one() {
        let (few, many) = (planned(24, 10, 60), planned(96, 10, 60));
        let mut before = 0.0;
        for sd in [0.0, 0.5, 1.0] {
            let found = |answers: &[PlannedAnswer]| {
                let plan = PowerPlan { person_sd: sd, item_sd: sd, ..plan(answers) };
                plan.detectable_difference(0.8).unwrap()
            };
            let (few, many) = (found(&few), found(&many));
            assert!(many < few && few > before, "{sd}: {few} {many}, before {before}");
            before = few;
        }
    }

    #[test]
    fn the_detectable_difference_has_the_wanted_power() {
        let answers = planned(40, 6, 30);
        for test in [PlannedTest::Difference, PlannedTest::EvenSplit] {
            let plan = PowerPlan { person_sd: 0.5, item_sd: 0.5, test, ..plan(&answers) };
            let difference = plan.detectable_difference(0.8).unwrap();
            // Other studies than those that the search saw.
            let other = PowerPlan { seed: 2, ..plan }.simulate_power(difference).unwrap();
            assert!((other.power - 0.8).abs() < 0.05, "{test:?} {difference}: {other:?}");
        }
    }

    #[test]
    fn impossible_plans_have_no_power() {
        let answers = planned(4, 1, 4);
        let good = plan(&answers);
        for bad in [
            PowerPlan { answers: &[], ..good },
            PowerPlan { base_share: 1.0, ..good },
            PowerPlan { person_sd: f64::NAN, ..good },
            PowerPlan { studies: 0, ..good },
        ] {
            assert_eq!((bad.simulate_power(0.1), bad.detectable_difference(0.8)), (None, None));
        }
        assert_eq!(good.simulate_power(1.0), None);
        let two = planned(2, 1, 2);
        assert_eq!(plan(&two).detectable_difference(0.8), None, "one answer each shows nothing");
    }
}
