use super::super::{ConditionStrengths, StudyReport, compute_results};
use super::fixtures::{START_MS, add_item, add_person, add_route, add_slot, empty, of_the_paper, small};
use crate::{ConditionKind, PairChoice, ParticipantAnswer, ParticipantStatus, StudyData, StudyTask};

pub(super) fn of(data: &StudyData) -> StudyReport {
    compute_results(data, START_MS + 3_600_000).unwrap()
}

/// The seed paper's own figures: 43.3, 83.3, 16.7 and 73.3 % of 30 people.
#[test]
fn the_papers_figures_have_the_intervals_that_its_thirty_people_allow() {
    let results = of(&of_the_paper());
    let row = &results.versions[0].rows[0];
    let expected = [
        ("similar_low", 43.3, [27.4, 60.8]),
        ("accurate_high", 83.3, [66.4, 92.7]),
        ("ghosts_any", 16.7, [7.3, 33.6]),
        ("reachable_high", 73.3, [55.6, 85.8]),
    ];
    for (name, share, [low, high]) in expected {
        let figure = &row.figures[name];
        let interval = figure.interval.as_ref().unwrap();
        let found = [figure.value, interval.low, interval.high].map(|value| (1000.0 * value).round() / 10.0);
        assert_eq!(found, [share, low, high], "{name}");
        assert_eq!(figure.method, wayword_metrics::IntervalMethod::Wilson);
        assert_eq!([figure.answers, figure.persons, figure.items], [30, 30, 30]);
    }
    let files = results.render_files().unwrap();
    let markdown = &files.iter().find(|(name, _)| *name == "results.md").unwrap().1;
    for shown in ["83.3 \\[66.4, 92.7\\]", "73.3 \\[55.6, 85.8\\]", "43.3 \\[27.4, 60.8\\]", "16.7 \\[7.3, 33.6\\]"] {
        // Once of this study, once of the paper.
        assert!(markdown.matches(shown).count() >= 2, "{shown}");
    }
}

#[test]
fn a_study_without_answers_can_be_read() {
    for mode in [StudyTask::Follow, StudyTask::Rate, StudyTask::Pair] {
        let mut data = empty(mode, &[("ours", ConditionKind::Run), ("humans", ConditionKind::People)]);
        let both: &[usize] = if mode == StudyTask::Pair { &[0, 1] } else { &[0] };
        let route = add_route(&mut data);
        add_item(&mut data, route, both);
        for (name, text) in of(&data).render_files().unwrap() {
            assert!(!text.contains("NaN") && !text.contains("inf,"), "{mode:?} {name}");
            assert!(
                name.ends_with(".csv")
                    || text.contains("no answers yet")
                    || name == "results.tex"
                    || name == "analysis.R"
                    || name == "results.json",
                "{name}"
            );
        }
    }
}

#[test]
fn answers_of_those_who_were_screened_out_or_practised_are_in_no_figure() {
    let mut data = small(StudyTask::Rate);
    let before = of(&data).versions[0].answers;
    let person = data.participants.iter().find(|one| one.status == ParticipantStatus::ScreenedOut).unwrap().id.clone();
    add_slot(&mut data, &person, 0, Some(ParticipantAnswer::Rate { ratings: [1; 4] }));
    let other = data.participants[0].id.clone();
    add_slot(&mut data, &other, 11, Some(ParticipantAnswer::Rate { ratings: [1; 4] }));
    data.slots.last_mut().unwrap().position = None;
    assert_eq!(of(&data).versions[0].answers, before);
}

#[test]
fn the_second_version_leaves_out_those_who_did_not_finish_or_failed() {
    let results = of(&small(StudyTask::Rate));
    let [everybody, finished] = &results.versions[..] else { panic!("there are no exclusion rules") };
    assert_eq!([everybody.persons, everybody.answers], [7, 36]);
    assert_eq!([finished.persons, finished.answers], [4, 24]);
    let people = &results.people;
    assert_eq!([people.complete, people.quiet, people.live, people.withdrawn], [4, 1, 0, 1]);
    assert_eq!([people.screened_out, people.attention_failed], [1, 1]);
    assert_eq!(people.forgotten, 1);
    assert_eq!(people.by_position[4].given, 6);
    assert_eq!(people.by_position[4].answered, 5);
    assert_eq!(people.attention.by_participant.len(), 1);
    assert!(!people.attention.by_participant[0].is_over, "one of two in a study of more than five minutes");
}

#[test]
fn walks_are_scored_from_the_start_to_the_goal() {
    let mut data = empty(StudyTask::Follow, &[("ours", ConditionKind::Run)]);
    let route = add_route(&mut data);
    let item = add_item(&mut data, route, &[0]);
    // Stops one place short of the goal, or at it.
    for looks in [0, 1] {
        let person = add_person(&mut data, ParticipantStatus::Complete);
        add_slot(
            &mut data,
            &person,
            item,
            Some(ParticipantAnswer::Follow {
                statements: [4, 5, 1],
                looks,
                stopped_ms: START_MS + 100_000,
                window: None,
            }),
        );
    }
    let results = of(&data);
    let figures = &results.versions[0].rows[0].figures;
    assert_eq!(figures["success"].value, 1.0);
    assert_eq!(figures["navigation_error_m"].value, 1.0);
    assert_eq!(figures["length_m"].value, 7.0);
    assert_eq!(figures["presses"].value, 4.0);
    assert_eq!(figures["easy_high"].value, 1.0);
    assert!(results.problems.is_empty());
    data.slots[0].moves.remove(0);
    assert!(of(&data).problems[0].contains("no edge"), "{:?}", of(&data).problems);
}

#[test]
fn sides_are_turned_back_before_wins_are_counted() {
    let mut data = empty(StudyTask::Pair, &[("ours", ConditionKind::Run), ("humans", ConditionKind::People)]);
    let route = add_route(&mut data);
    let item = add_item(&mut data, route, &[0, 1]);
    for (is_turned, choice) in [
        (false, PairChoice::B),
        (true, PairChoice::A),
        (true, PairChoice::Tie),
        (false, PairChoice::Bad),
        (true, PairChoice::B),
    ] {
        let person = add_person(&mut data, ParticipantStatus::Complete);
        add_slot(&mut data, &person, item, Some(ParticipantAnswer::Pair { choice }));
        data.slots.last_mut().unwrap().is_turned = is_turned;
    }
    let results = of(&data);
    let pairs = results.versions[0].pairs.as_ref().unwrap();
    let row = &pairs.rows[0];
    assert_eq!([row.first_wins, row.second_wins, row.ties, row.both_bad], [1, 2, 1, 1]);
    assert_eq!(row.share.as_ref().unwrap().value, 0.4);
    let figures = &results.versions[0].rows[1].figures;
    assert_eq!(figures["gain"].value, 0.6);
    assert_eq!(figures["both_bad"].value, 0.2);
}

#[test]
fn strengths_that_cannot_be_computed_have_a_reason() {
    let mut data = small(StudyTask::Pair);
    for slot in &mut data.slots {
        if slot.answer.is_some() {
            slot.answer = Some(ParticipantAnswer::Pair { choice: PairChoice::Tie });
        }
    }
    let results = of(&data);
    let ConditionStrengths::Unknown { why, .. } = &results.versions[0].pairs.as_ref().unwrap().strengths else {
        panic!("all are ties")
    };
    let files = results.render_files().unwrap();
    assert!(files[1].1.contains(why.as_str()), "{why}");
}

/// One participant, or one route, gives figures without intervals, as in docs/STUDY.md.
#[test]
fn one_participant_or_one_route_has_no_interval() {
    for mode in [StudyTask::Follow, StudyTask::Rate, StudyTask::Pair] {
        let data = small(mode);
        let person = data.participants[0].id.clone();
        let (mut of_one_person, mut of_one_route) = (data.clone(), data.clone());
        of_one_person.slots.retain(|slot| slot.participant == person);
        of_one_route.slots.retain(|slot| data.items[slot.item as usize].route == 0);
        for data in [of_one_person, of_one_route] {
            let results = of(&data);
            for version in &results.versions {
                let figures = version.rows.iter().flat_map(|row| row.figures.values());
                let first_and_second = |difference: &'_ wayword_metrics::FigureDifference| difference.interval;
                let differences = version.differences.iter().flat_map(|one| one.figures.values().map(first_and_second));
                assert!(figures.map(|figure| figure.interval).chain(differences).all(|interval| interval.is_none()));
                if let Some(pairs) = &version.pairs {
                    assert!(
                        pairs.rows.iter().filter_map(|row| row.share.as_ref()).all(|share| share.interval.is_none())
                    );
                    assert!(matches!(pairs.strengths, ConditionStrengths::Unknown { .. }), "{:?}", pairs.strengths);
                }
            }
            let files = results.render_files().unwrap();
            assert!(!files[1].1.contains(" 1 persons"), "{}", files[1].1);
        }
    }
}

#[test]
fn one_participant_and_one_condition_are_enough_for_files() {
    for mode in [StudyTask::Follow, StudyTask::Rate, StudyTask::Pair] {
        let mut data = small(mode);
        let person = data.participants[0].id.clone();
        data.slots.retain(|slot| slot.participant == person);
        data.participants.truncate(1);
        for (name, text) in of(&data).render_files().unwrap() {
            assert!(!text.contains("NaN"), "{mode:?} {name}");
        }
        if mode != StudyTask::Pair {
            data.plan.conditions.truncate(1);
            let results = of(&data);
            assert!(results.versions[0].differences.is_empty());
            results.render_files().unwrap();
        }
    }
}

#[test]
fn intervals_stay_on_the_scale() {
    for mode in [StudyTask::Follow, StudyTask::Rate] {
        let results = of(&small(mode));
        for version in &results.versions {
            for (row, measure) in
                version.rows.iter().flat_map(|row| results.measures.iter().map(move |measure| (row, measure)))
            {
                let Some(figure) = row.figures.get(measure.name) else { continue };
                let Some(interval) = &figure.interval else { continue };
                assert!(interval.low <= figure.value && figure.value <= interval.high, "{} {figure:?}", measure.name);
                assert!(measure.range[0].is_none_or(|low| low <= interval.low), "{} {figure:?}", measure.name);
                assert!(measure.range[1].is_none_or(|high| high >= interval.high), "{} {figure:?}", measure.name);
            }
        }
    }
}
