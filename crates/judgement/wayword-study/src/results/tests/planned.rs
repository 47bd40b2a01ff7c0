use super::super::{PlanQuestion, StudyOutlook, compute_results, planned_answers::plan_answers};
use super::fixtures::{START_MS, add_item, add_person, add_route, add_slot, empty, small};
use crate::{ConditionKind, PairChoice, ParticipantAnswer, ParticipantStatus, StudyData, StudyTask};
use wayword_metrics::PlannedAnswer;

fn of(data: &StudyData, question: &PlanQuestion) -> StudyOutlook {
    StudyOutlook::new(&data.plan, &data.settings, &data.items, question)
}

/// A study of two conditions with a text of each for every route, or one comparison of both.
fn two_conditions(mode: StudyTask, routes: usize, per_item: u32, per_participant: u32) -> StudyData {
    let mut data = empty(mode, &[("ours", ConditionKind::Run), ("theirs", ConditionKind::Run)]);
    let texts: &[&[usize]] = if mode == StudyTask::Pair { &[&[0, 1]] } else { &[&[0], &[1]] };
    for _ in 0..routes {
        let route = add_route(&mut data);
        for conditions in texts {
            add_item(&mut data, route, conditions);
        }
    }
    (data.plan.per_item, data.plan.per_participant) = (per_item, per_participant);
    data
}

/// 30 people with one item each in each of two groups detect about 35 points.
#[test]
fn an_impossible_question_names_the_flag_that_was_given_and_its_unit() {
    let ask = |base: f64, effect: f64| {
        let question = PlanQuestion { effect: effect / 100.0, base_share: base / 100.0, ..PlanQuestion::default() };
        question.check().map(|()| question.unit_question()).map_err(|error| error.to_string())
    };
    for (base, effect, said) in [
        (0.5, 20.0, "--base 0.5 with an effect of 20 points gives a share of -9.5 %"),
        (0.5, 20.0, "--base is in per cent, as in --base 50; did you mean 50?"),
        (95.0, 20.0, "--base 95 with an effect of 20 points gives a share of 105 %"),
        (95.0, 20.0, "give an --effect below 10, or a --base nearer to 50"),
        (50.0, 200.0, "--effect 200: no two shares differ by that"),
        (50.0, 0.0, "--effect 0:"),
        (100.0, 20.0, "--base 100: this is no share between 0 and 100 %"),
        (f64::NAN, 20.0, "--base NaN"),
    ] {
        let told = ask(base, effect).unwrap_err();
        assert!(told.contains(said), "{base} {effect}: {told}");
    }
    assert_eq!(ask(50.0, 0.2).unwrap().unwrap(), "--effect 0.2 is 0.2 of a point; did you mean --effect 20?");
    assert_eq!(ask(0.5, 0.1).unwrap().unwrap(), "--effect 0.1 is 0.1 of a point; did you mean --effect 10?");
    assert_eq!(ask(50.0, 20.0).unwrap(), None);
}

#[test]
fn thirty_people_in_each_group_detect_about_35_points() {
    let outlook = of(&two_conditions(StudyTask::Rate, 30, 1, 1), &PlanQuestion::default());
    assert_eq!([outlook.items, outlook.routes, outlook.answers, outlook.participants], [60, 30, 60, 60]);
    let alike = &outlook.assumptions[0];
    assert!((alike.difference.unwrap() - 0.36).abs() < 0.03, "{alike:?}");
    insta::assert_snapshot!(outlook);
}

#[test]
fn what_differs_more_needs_more_participants_and_a_larger_difference() {
    for (mode, routes, per_item, each) in
        [(StudyTask::Follow, 60, 5, 10), (StudyTask::Rate, 40, 3, 6), (StudyTask::Pair, 60, 5, 10)]
    {
        let outlook = of(
            &two_conditions(mode, routes, per_item, each),
            &PlanQuestion { effect: 0.15, ..PlanQuestion::default() },
        );
        for both in outlook.assumptions.windows(2) {
            let [less, more] = both else { continue };
            assert!(more.difference > less.difference, "{mode:?} {outlook}");
            assert!(more.power.unwrap().power <= less.power.unwrap().power + 0.02, "{mode:?} {outlook}");
            assert!(more.participants.unwrap_or(usize::MAX) > less.participants.unwrap(), "{mode:?} {outlook}");
        }
    }
}

#[test]
fn more_routes_and_more_participants_find_smaller_differences() {
    let data = two_conditions(StudyTask::Follow, 20, 3, 6);
    let spread = PlanQuestion { person_sd: Some(0.5), route_sd: Some(0.5), ..PlanQuestion::default() };
    let difference = |question: &PlanQuestion| of(&data, question).assumptions[0].difference.unwrap();
    let planned = difference(&spread);
    assert!(difference(&PlanQuestion { routes: Some(80), ..spread }) < planned);
    assert!(difference(&PlanQuestion { participants: Some(80), ..spread }) < planned);
    assert!(difference(&PlanQuestion { person_sd: Some(1.5), ..spread }) > planned);
    assert!(difference(&PlanQuestion { route_sd: Some(1.5), ..spread }) > planned);
}

/// Draws an answer of a study as the plan assumes it: each person and each route has an effect on each condition.
struct AssumedAnswers {
    /// The logits of both conditions for a person and a route like the mean ones.
    centres: [f64; 2],
    sd: f64,
}

impl AssumedAnswers {
    /// A normal number by the sum of twelve uniform ones, other than the plan draws them.
    fn effect(&self, words: &[&str]) -> f64 {
        self.sd * (uniforms(words).take(12).sum::<f64>() - 6.0)
    }

    fn is_one(&self, study: usize, planned: &PlannedAnswer) -> bool {
        let (study, person, route) = (study.to_string(), planned.person.to_string(), planned.item.to_string());
        let condition = if planned.is_second { "second" } else { "first" };
        let logit = self.centres[usize::from(planned.is_second)]
            + self.effect(&[&study, "person", &person, condition])
            + self.effect(&[&study, "route", &route, condition]);
        uniforms(&[&study, "luck", &person, &route]).next().unwrap() < 1.0 / (1.0 + (-logit).exp())
    }
}

/// Numbers from 0 to 1 by splitmix64, from a hash of the words.
fn uniforms(words: &[&str]) -> impl Iterator<Item = f64> {
    let mut state = wayword_core::seed::derive_seed(5, words);
    std::iter::repeat_with(move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    })
}

/// The share of studies, drawn from the plan's assumptions, for which `results` prints an interval that leaves out no difference.
fn found_by_results(data: &StudyData, outlook: &StudyOutlook, assumed: &AssumedAnswers, studies: usize) -> f64 {
    let planned = plan_answers(
        &super::super::planned_answers::items_of_study(&data.items, &["ours", "theirs"]),
        outlook.participants,
        outlook.answers,
        3,
    );
    let is_found = |study: &usize| {
        let mut data = data.clone();
        let people: Vec<String> =
            (0..outlook.participants).map(|_| add_person(&mut data, ParticipantStatus::Complete)).collect();
        for one in &planned {
            let is_one = assumed.is_one(*study, one);
            let (item, answer) = if data.plan.mode == StudyTask::Pair {
                (one.item, ParticipantAnswer::Pair { choice: if is_one { PairChoice::A } else { PairChoice::B } })
            } else {
                let rating = if is_one { 5 } else { 2 };
                (2 * one.item + usize::from(one.is_second), ParticipantAnswer::Rate { ratings: [rating; 4] })
            };
            add_slot(&mut data, &people[one.person], item as u32, Some(answer));
            // Sides are of no interest here.
            data.slots.last_mut().unwrap().is_turned = false;
        }
        let version = &compute_results(&data, START_MS).unwrap().versions[0];
        let (interval, none) = match &version.pairs {
            Some(pairs) => (pairs.rows[0].share.as_ref().unwrap().interval, 0.5),
            None => (version.differences[0].figures["accurate_high"].interval, 0.0),
        };
        interval.is_some_and(|interval| interval.leaves_out(none))
    };
    (0..studies).filter(is_found).count() as f64 / studies as f64
}

/// The plan's power is that which `results` finds in studies that are drawn from its assumptions.
#[test]
fn results_find_what_the_plan_says() {
    const STUDIES: usize = 200;
    for (mode, sd, effect) in [
        (StudyTask::Rate, 0.0, 0.25),
        (StudyTask::Rate, 0.5, 0.3),
        (StudyTask::Rate, 1.0, 0.35),
        (StudyTask::Pair, 0.5, 0.2),
    ] {
        let data = two_conditions(mode, 16, 4, 8);
        let question = PlanQuestion { effect, person_sd: Some(sd), route_sd: Some(sd), ..PlanQuestion::default() };
        let outlook = of(&data, &question);
        let said = outlook.assumptions[0].power.unwrap();
        let shares =
            if mode == StudyTask::Pair { [0.5 + effect, 0.5] } else { [0.5 + effect / 2.0, 0.5 - effect / 2.0] };
        let assumed = AssumedAnswers { centres: shares.map(|share| centre(share, sd)), sd };
        let found = found_by_results(&data, &outlook, &assumed, STUDIES);
        let error = (said.se.powi(2) + found * (1.0 - found) / STUDIES as f64).sqrt();
        assert!((found - said.power).abs() < 3.0 * error + 0.01, "{mode:?} {sd}: {found} for {said:?}");
        assert!((0.2..0.97).contains(&said.power), "{mode:?} {sd}: {said:?} tests nothing");
    }
}

/// The logit at which the mean over persons and routes is the share, by trying.
fn centre(share: f64, sd: f64) -> f64 {
    let mean = |logit: f64| {
        let (mut sum, mut weights) = (0.0, 0.0);
        for step in -400..=400 {
            let at = f64::from(step) / 50.0;
            let weight = (-at * at / 2.0).exp();
            sum += weight / (1.0 + (-(logit + std::f64::consts::SQRT_2 * sd * at)).exp());
            weights += weight;
        }
        sum / weights
    };
    let (mut low, mut high) = (-20.0, 20.0);
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if mean(middle) < share { low = middle } else { high = middle }
    }
    low
}

#[test]
fn outlook_of_an_empty_plan_prints_no_invalid_numbers() {
    for conditions in [&[("ours", ConditionKind::Run)][..], &[("ours", ConditionKind::Run), ("b", ConditionKind::Run)]]
    {
        let text = of(&empty(StudyTask::Follow, conditions), &PlanQuestion::default()).to_string();
        assert!(!text.contains("NaN") && text.contains("participants  0"), "{text}");
    }
}

#[test]
fn questions_that_make_no_sense_are_refused_by_their_flag() {
    let good = PlanQuestion::default();
    good.check().unwrap();
    for (wrong, flag) in [
        (PlanQuestion { effect: 0.0, ..good }, "--effect"),
        (PlanQuestion { effect: 0.3, base_share: 0.9, ..good }, "--effect"),
        (PlanQuestion { base_share: 1.0, ..good }, "--base"),
        (PlanQuestion { person_sd: Some(f64::NAN), ..good }, "--person-sd"),
        (PlanQuestion { route_sd: Some(-1.0), ..good }, "--route-sd"),
        (PlanQuestion { routes: Some(0), ..good }, "--routes"),
        (PlanQuestion { participants: Some(1_000_000), ..good }, "--participants"),
    ] {
        assert!(wrong.check().unwrap_err().to_string().contains(flag), "{wrong:?}");
    }
}

#[test]
fn the_small_study_has_its_counts() {
    for mode in [StudyTask::Follow, StudyTask::Rate, StudyTask::Pair] {
        let outlook = of(&small(mode), &PlanQuestion::default());
        assert_eq!(outlook.answers, 36);
        let json = serde_json::to_value(&outlook).unwrap();
        assert_eq!(json["assumptions"].as_array().unwrap().len(), 3);
    }
}
