use super::*;
use crate::{
    checked_texts::{text_item, write_items},
    key::WordChange,
    test_data::TestBuildingFolder,
};
use clap::Parser;
use wayword_core::{CheckKind, SceneId, ViewpointId};
use wayword_testkit::{SCAN, viewpoint_id};

#[derive(Parser)]
struct Line {
    #[command(flatten)]
    flags: CorruptionFindingArgs,
}

const NOW: &str = "Walk on. Go down the stairs. Turn left, stop and wait.";
const WAS: &str = "Walk on. Go up the stairs. Turn left, stop and wait.";

fn corruption(item: &str) -> TextCorruption {
    let changes = vec![WordChange { span: [12, 16], was: "up".into(), now: "down".into() }];
    let [item, of, path, kind] = [item, "7", "house/7", "climb-flipped"].map(str::to_owned);
    TextCorruption { item, of, instruction: 0, path, kind, changes }
}

/// From the lower hallway up to the upper one.
fn climb(text: &str) -> Episode {
    let mut climb = text_item(0, &Episode::new("", "", SceneId::new(SCAN).unwrap()), text);
    climb.viewpoints = [1, 6, 7, 8].map(|at| ViewpointId::new(viewpoint_id(at)).unwrap()).to_vec();
    climb.start_heading = Some(wayword_core::Heading::NORTH);
    climb
}

fn in_file(episodes: &[Episode], key: &CorruptionKey, then: impl Fn(&Path, &TestBuildingFolder)) {
    let building = TestBuildingFolder::new();
    let file = building.data_folder().join("texts.json");
    write_items(&file, episodes).unwrap();
    key.write(&CorruptionKey::path_for_texts(&file)).unwrap();
    then(&file, &building);
}

#[test]
fn pairs_restores_the_original_text_by_the_key() {
    let key = CorruptionKey::new(0, vec![corruption("0")]);
    in_file(&[climb(NOW)], &key, |file, _| {
        let pairs = read_pairs(file, &key).unwrap();
        assert_eq!((pairs[0].now.as_str(), pairs[0].was.as_str()), (NOW, WAS));
        let near = |text: &'static str, near: &[[usize; 2]]| text[near[0][0]..near[0][1]].to_owned();
        assert_eq!(near(NOW, &pairs[0].near_now), "Walk on. Go down the stairs. Turn left,");
        assert_eq!(near(WAS, &pairs[0].near_was), "Walk on. Go up the stairs. Turn left,");
    });
}

#[test]
fn a_key_of_another_file_is_refused_by_its_item() {
    for (text, item, problem) in [
        (NOW, "1", "item 1: the key names it, but it is not there"),
        (WAS, "0", "item 0: its text does not have the words of the key"),
    ] {
        let key = CorruptionKey::new(0, vec![corruption(item)]);
        in_file(&[climb(text)], &key, |file, _| {
            let refusal = read_pairs(file, &key).map(|_| ()).unwrap_err().to_string();
            assert!(refusal.contains(problem), "{refusal}");
        });
    }
    let key = CorruptionKey::new(0, vec![corruption("0")]);
    let mut two = climb(NOW);
    two.instructions.push("Stop.".into());
    in_file(&[two], &key, |file, _| assert!(read_pairs(file, &key).is_err()));
}

/// The path climbs, so the changed text is wrong at its change and the text before it is right.
#[test]
fn the_program_is_run_over_both_texts() {
    let now = "Walk down the stairs. Stop in the hallway.";
    let changes = vec![WordChange { span: [5, 9], was: "up".into(), now: "down".into() }];
    let key = CorruptionKey::new(0, vec![TextCorruption { changes, ..corruption("0") }]);
    in_file(&[climb(now)], &key, |file, building| {
        let words = ["found".into(), file.to_owned(), "--platform".into(), "matterport".into(), "--data".into()];
        let flags = Line::try_parse_from(words.into_iter().chain([building.data_folder()])).unwrap().flags;
        let pairs = read_pairs(file, &key).unwrap();
        let texts = PairTexts::from_pairs(&pairs);
        let CheckedTexts { findings, .. } =
            check_in_memory(&texts.all, flags.judging.check, &CommandOutput::new(true, true)).unwrap();
        let outcome = PairFindings { pair: &pairs[0], now: &findings[0], was: &findings[texts.old[0]] };
        let rows = kind_rows(&[outcome], 0);
        let counts =
            |row: &CorruptionRow| [&row.found, &row.before].map(|share| share.as_ref().map(|share| share.count));
        assert_eq!(counts(&rows[0]), [Some(1), Some(0)]);
    });
}

fn finding(verdict: Verdict, span: Option<[usize; 2]>) -> CheckFinding {
    CheckFinding { check: CheckKind::Floors, verdict, reason: String::new(), span }
}

#[test]
fn a_corruption_is_found_only_by_a_fail_in_its_clause_or_a_neighbour() {
    let key = CorruptionKey::new(0, vec![corruption("0"), corruption("0")]);
    in_file(&[climb(NOW)], &key, |file, _| {
        let pairs = read_pairs(file, &key).unwrap();
        let at = |words: &str| NOW.find(words).map(|from| [from, from + words.len()]);
        let found = |verdict, span| {
            let now = [finding(verdict, span)];
            PairFindings { pair: &pairs[0], now: &now, was: &[] }.is_found()
        };
        for words in ["Walk", "Go down", "stairs", "left"] {
            assert!(found(Verdict::Fail, at(words)), "{words}");
            assert!(!found(Verdict::Unverified, at(words)), "{words}");
        }
        for (verdict, words, is_doubted) in
            [(Verdict::Fail, "down", true), (Verdict::Unverified, "Go down", true), (Verdict::Fail, "stairs", false)]
        {
            let now = [finding(verdict, at(words))];
            assert_eq!(PairFindings { pair: &pairs[0], now: &now, was: &[] }.is_doubted(), is_doubted, "{words}");
        }
        assert!(!found(Verdict::Fail, at("stop")) && !found(Verdict::Fail, None));
        let far = [finding(Verdict::Fail, at("wait"))];
        let near = [finding(Verdict::Fail, at("stairs"))];
        let outcomes = [
            PairFindings { pair: &pairs[0], now: &near, was: &far },
            PairFindings { pair: &pairs[1], now: &far, was: &near },
        ];
        let rows = kind_rows(&outcomes, 0);
        let counts = |row: &CorruptionRow| {
            let shares = [&row.found, &row.before, &row.found_anew, &row.fails, &row.fails_before];
            shares.map(|share| share.as_ref().map(|share| share.count))
        };
        assert_eq!(counts(&rows[0]), [Some(1), Some(1), Some(1), Some(2), Some(2)]);
        assert_eq!(rows[0].doubted.map(|share| (share.count, share.of)), Some((0, 2)), "no finding is on \"down\"");
        assert_eq!(rows[0].found_anew.map(|share| share.of), Some(1), "one of two failed there before");
        assert_eq!((rows[0].kind.as_str(), rows[1].kind.as_str()), ("climb-flipped", "all"));
        assert!(rows_table(&rows).contains("50.0 % [50.0, 50.0] (1/2)"), "{}", rows_table(&rows));
        assert_eq!(describe_miss(&outcomes[1]), format!("0 climb-flipped: \"down\" was \"up\"\n    {NOW}"));
    });
}

#[test]
fn a_text_that_was_changed_twice_is_checked_once_before() {
    let key = CorruptionKey::new(0, vec![corruption("0"), corruption("0")]);
    in_file(&[climb(NOW)], &key, |file, _| {
        let pairs = read_pairs(file, &key).unwrap();
        let texts = PairTexts::from_pairs(&pairs);
        assert_eq!((texts.all.len(), texts.old.as_slice()), (3, &[2, 2][..]));
    });
}
