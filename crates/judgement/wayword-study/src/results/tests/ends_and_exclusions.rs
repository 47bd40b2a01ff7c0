use super::figures::of;
use super::fixtures::{add_item, add_person, add_route, add_slot, empty, small};
use super::reader::{column, read};
use crate::{
    ConditionKind, EndAnswer, EndQuestion, EndQuestionKind, ExclusionRules, FilmPicture, ParticipantAnswer,
    ParticipantStatus, StudyData, StudyTask,
};
use std::collections::BTreeMap;

/// Three ratings of one text: answered after 25 s with the whole film, after 2 s, and after 25 s with a fifth of the film.
fn rated() -> StudyData {
    let mut data = empty(StudyTask::Rate, &[("ours", ConditionKind::Run)]);
    let route = add_route(&mut data);
    data.routes[route as usize].film =
        (0..10).map(|at| FilmPicture { file: format!("{at}.jpg"), alt: String::new() }).collect();
    let item = add_item(&mut data, route, &[0]);
    for (seconds, pictures) in [(25, Some(10)), (2, Some(10)), (25, Some(2)), (25, None)] {
        let person = add_person(&mut data, ParticipantStatus::Complete);
        add_slot(&mut data, &person, item, Some(ParticipantAnswer::Rate { ratings: [4; 4] }));
        let slot = data.slots.last_mut().unwrap();
        (slot.pictures_seen, slot.answered_ms) = (pictures, Some(slot.given_ms + seconds * 1000));
    }
    data.settings.exclusions =
        ExclusionRules { min_seconds_per_item: 3.0, min_share_of_film: 0.5, ..ExclusionRules::default() };
    data
}

#[test]
fn answers_that_break_a_rule_are_named_counted_and_left_out_of_one_version() {
    let results = of(&rated());
    let names: Vec<(&str, usize)> = results.versions.iter().map(|version| (version.name, version.answers)).collect();
    assert_eq!(names, [("everybody", 4), ("finished", 4), ("kept", 2)]);
    let counts: Vec<_> =
        results.exclusions.iter().map(|one| (one.rule, one.answers, one.persons, one.unknown)).collect();
    assert_eq!(counts, [("too_fast", 1, 1, 0), ("film_not_watched", 1, 1, 1)]);
    let files: BTreeMap<&str, String> = results.render_files().unwrap().into_iter().collect();
    let rows = read(&files["answers.csv"]);
    let mut excluded = column(&rows, "excluded");
    excluded.sort();
    assert_eq!(excluded, ["", "", "film_not_watched", "too_fast"]);
    assert_eq!(column(&rows, "in_kept").iter().filter(|cell| *cell == "1").count(), 2);
    for file in ["index.html", "results.md", "results.tex"] {
        assert!(files[file].contains("answered in less than 3 seconds"), "{file}");
    }
}

#[test]
fn a_walk_without_a_move_can_be_left_out_and_without_rules_there_are_two_versions() {
    let mut data = small(StudyTask::Follow);
    assert_eq!(of(&data).versions.len(), 2);
    data.settings.exclusions.min_moves_per_walk = 1;
    data.slots[0].moves.clear();
    let results = of(&data);
    assert_eq!(results.exclusions[0].answers, 1);
    assert_eq!(results.versions[1].answers - results.versions[2].answers, 1);
}

#[test]
fn answers_at_the_end_are_counted_and_texts_stand_in_one_file() {
    let mut data = small(StudyTask::Pair);
    let question = |name: &str, kind, answers: &[&str]| EndQuestion {
        name: name.to_owned(),
        text: format!("About {name} <b>?"),
        kind,
        answers: answers.iter().map(|one| (*one).to_owned()).collect(),
        optional: true,
        max_chars: 0,
    };
    data.settings.end = vec![
        question("often", EndQuestionKind::Scale, &["never", "daily"]),
        question("remarks", EndQuestionKind::Text, &[]),
    ];
    let answer =
        |name: &str, answer: &str, number| EndAnswer { name: name.to_owned(), answer: answer.to_owned(), number };
    data.participants[0].end = vec![answer("often", "daily", Some(2)), answer("remarks", "=secret, \"x\"", None)];
    data.participants[1].end = vec![answer("often", "", None), answer("remarks", "", None)];
    let results = of(&data);
    let [often, remarks] = &results.end[..] else { panic!("{:?}", results.end) };
    assert_eq!((often.chosen[1].count, often.answered, often.left_out), (1, 1, 1));
    assert_eq!((remarks.answered, remarks.chosen.len()), (1, 0));
    let files: BTreeMap<&str, String> = results.render_files().unwrap().into_iter().collect();
    let rows = read(&files["end.csv"]);
    assert_eq!(column(&rows, "answer").iter().filter(|cell| *cell == "'=secret, \"x\"").count(), 1);
    for (name, text) in &files {
        assert!(*name == "end.csv" || !text.contains("secret"), "{name}");
    }
    assert!(files["index.html"].contains("About often &lt;b&gt;?"), "{}", files["index.html"]);
    assert!(files["codebook.csv"].contains("end.csv,number"));
}
