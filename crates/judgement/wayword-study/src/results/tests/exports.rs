use super::{
    figures::of,
    fixtures::{add_slot, small},
    reader::{column, read},
};
use crate::{ParticipantAnswer, SlotState, StudyTask};
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

fn files(data: &crate::StudyData) -> BTreeMap<&'static str, String> {
    of(data).render_files().unwrap().into_iter().collect()
}

#[test]
fn markdown_of_a_small_study() {
    insta::assert_snapshot!(files(&small(StudyTask::Rate))["results.md"]);
}

#[test]
fn markdown_of_a_small_study_of_pairs() {
    insta::assert_snapshot!(files(&small(StudyTask::Pair))["results.md"]);
}

#[test]
fn every_column_of_every_file_is_in_the_codebook() {
    for mode in [StudyTask::Follow, StudyTask::Rate, StudyTask::Pair] {
        let files = files(&small(mode));
        let book = read(&files["codebook.csv"]);
        let told: BTreeSet<(String, String)> = book[1..].iter().map(|row| (row[0].clone(), row[1].clone())).collect();
        assert!(book.iter().all(|row| row.len() == 5 && !row[2].is_empty() && !row[4].is_empty()));
        for (name, text) in files.iter().filter(|(name, _)| name.ends_with(".csv") && **name != "codebook.csv") {
            let rows = read(text);
            assert!(rows.iter().all(|row| row.len() == rows[0].len()), "{name}");
            for head in &rows[0] {
                assert!(told.contains(&((*name).to_owned(), head.clone())), "{name} {head}");
                assert!(files["results.md"].contains(&head.replace('_', "\\_")), "{name} {head}");
            }
        }
        assert_eq!(files.contains_key("moves.csv"), mode == StudyTask::Follow);
    }
}

/// `wayword-measure critics` reads these.
#[test]
fn files_have_the_columns_that_critics_are_correlated_with() {
    let of_walks = ["success", "spl", "ndtw", "easy", "confident", "demanding"];
    let of_ratings = ["similar", "accurate", "ghosts", "reachable"];
    for (mode, name, measures) in
        [(StudyTask::Follow, "follow", &of_walks[..]), (StudyTask::Rate, "rate", &of_ratings[..])]
    {
        let files = files(&small(mode));
        let about: serde_json::Value = serde_json::from_str(&files["results.json"]).unwrap();
        assert_eq!((&about["format"], &about["mode"]), (&"wayword-study-results/1".into(), &name.into()));
        let scales = about["scales"].as_array().unwrap().iter().map(|scale| scale["name"].as_str().unwrap());
        assert!(measures.ends_with(&scales.collect::<Vec<_>>()));
        let (items, answers) = (read(&files["items.csv"]), read(&files["answers.csv"]));
        for name in ["item", "route", "scene", "kind", "text"] {
            column(&items, name);
        }
        for name in ["item", "in_everybody", "in_finished"].iter().chain(measures) {
            column(&answers, name);
        }
    }
}

#[test]
fn files_hold_no_id_of_the_database_no_clock_and_no_order_of_consent() {
    for mode in [StudyTask::Follow, StudyTask::Rate, StudyTask::Pair] {
        let data = small(mode);
        let files = files(&data);
        for (name, text) in &files {
            assert!(data.participants.iter().all(|person| !text.contains(&person.id)), "{name}");
            assert!(!text.contains("17800"), "{name} has a clock");
        }
        let rows = read(&files["submissions.csv"]);
        let order: Vec<usize> = column(&rows, "seconds").iter().map(|seconds| seconds.len()).collect();
        assert_eq!(order.len(), data.participants.len());
        let statuses = column(&rows, "status");
        let consent: Vec<String> = data
            .participants
            .iter()
            .map(|person| serde_json::to_value(person.status).unwrap().as_str().unwrap().to_owned())
            .collect();
        assert_ne!(statuses, consent, "names follow the order of consent");
    }
}

#[test]
fn the_json_has_all_figures_and_reads_back() {
    let data = small(StudyTask::Follow);
    let json: serde_json::Value = serde_json::from_str(&files(&data)["results.json"]).unwrap();
    assert_eq!(json["format"], "wayword-study-results/1");
    assert_eq!(json["versions"][0]["rows"].as_array().unwrap().len(), 3);
    assert_eq!(json["scales"].as_array().unwrap().len(), 3);
    let figure = &json["versions"][0]["rows"][0]["figures"]["success"];
    assert!(figure["value"].is_number() && figure["method"].is_string(), "{figure}");
}

#[test]
fn the_same_answers_give_the_same_files() {
    let data = small(StudyTask::Pair);
    let mut other = data.clone();
    other.slots.reverse();
    assert_eq!(files(&data), files(&other));
}

#[test]
fn write_files_returns_the_files_of_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let written = of(&small(StudyTask::Rate)).write_files(&folder.path().join("out")).unwrap();
    let mut there: Vec<_> =
        std::fs::read_dir(folder.path().join("out")).unwrap().map(|file| file.unwrap().path()).collect();
    let mut told = written.clone();
    there.sort();
    told.sort();
    assert_eq!(there, told);
    assert_eq!(written[0].file_name().unwrap(), "index.html");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// For any texts and any number of answers, the files read back, and their counts are those of the data.
    #[test]
    fn exports_read_back_and_agree_with_the_data(texts in prop::collection::vec(any::<String>(), 1..8), more in 0usize..12) {
        let mut data = small(StudyTask::Rate);
        for number in 0..more {
            let person = data.participants[number % 4].id.clone();
            add_slot(&mut data, &person, (number % 12) as u32, Some(ParticipantAnswer::Rate { ratings: [(1 + number % 5) as u8; 4] }));
        }
        for (at, slot) in data.slots.iter_mut().enumerate() {
            slot.own_text = Some(texts[at % texts.len()].clone());
        }
        let results = of(&data);
        let files: BTreeMap<&str, String> = results.render_files().unwrap().into_iter().collect();
        let rows = read(&files["answers.csv"]);
        let answered = data.slots.iter().filter(|slot| slot.state == SlotState::Answered).count();
        prop_assert_eq!(rows.len() - 1, answered);
        let counted = column(&rows, "in_everybody").iter().filter(|cell| *cell == "1").count();
        prop_assert_eq!(counted, results.versions[0].answers);
        let finished = column(&rows, "in_finished").iter().filter(|cell| *cell == "1").count();
        prop_assert_eq!(finished, results.versions[1].answers);
        let levels: u32 = column(&rows, "accurate").iter().map(|cell| cell.parse::<u32>().unwrap()).sum();
        let accurate = |slot: &crate::ItemSlot| match slot.answer {
            Some(ParticipantAnswer::Rate { ratings }) => u32::from(ratings[1]),
            _ => 0,
        };
        let given: u32 = data.slots.iter().map(accurate).sum();
        prop_assert_eq!(levels, given);
        for own in column(&rows, "own_text") {
            let text = own.strip_prefix('\'').unwrap_or(&own);
            prop_assert!(texts.iter().any(|one| super::super::escape::strip_active_characters(one) == text), "{:?}", own);
        }
        let submissions = read(&files["submissions.csv"]);
        let done: usize = column(&submissions, "answered").iter().map(|cell| cell.parse::<usize>().unwrap()).sum();
        prop_assert_eq!(done, answered);
    }
}
