//! `wayword generate` as a user runs it: what the run folder contains, and which input is refused.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Building, EPISODES, files};
use std::{fs, fs::File};
use wayword_core::{Instruction, MentionKind, Verdict};
use wayword_language::text::{sentence_count, word_count};

fn spoken(instruction: &Instruction, kind: MentionKind) -> Vec<&str> {
    let mentions = instruction.mentions.iter().filter(|mention| mention.kind == kind);
    mentions.map(|mention| &instruction.text[mention.span[0]..mention.span[1]]).collect()
}

#[test]
fn episodes_get_an_instruction_in_each_style_that_passes_every_check() {
    let building = Building::new();
    let records = building.run_over_episodes("run");
    assert_eq!(records.len(), 20);
    for record in &records {
        let (instruction, provenance) = (&record.instruction, &record.instruction.provenance);
        assert_eq!(instruction.verdict, Verdict::Pass, "{}", instruction.text);
        assert!(
            instruction.findings.iter().all(|finding| finding.verdict == Verdict::Pass)
                && !instruction.findings.is_empty()
        );
        assert_eq!((provenance.asker.as_str(), provenance.writer.as_str()), ("rules", "rules"));
        assert_eq!((provenance.answerer.as_str(), provenance.checked_against.as_str()), ("labels", "labels"));
        assert!(!instruction.mentions.is_empty(), "{}", instruction.text);
        for mention in &instruction.mentions {
            let words = instruction.text.get(mention.span[0]..mention.span[1]).unwrap();
            assert!(
                mention.frame < record.path.frames.len() && word_count(words) > 0,
                "{words:?} in {}",
                instruction.text
            );
        }
        if instruction.style == "reverie" {
            assert!(
                sentence_count(&instruction.text) == 1 && word_count(&instruction.text) < 20,
                "{}",
                instruction.text
            );
            let target = &record.path.target.as_ref().unwrap().name;
            let named = spoken(instruction, MentionKind::Target);
            assert!(
                named.iter().any(|name| wayword_language::lexicon::names_agree(target, name)),
                "{named:?} for {target} in {}",
                instruction.text
            );
        } else {
            assert!(sentence_count(&instruction.text) >= 2, "{}", instruction.text);
        }
    }
    let found: Vec<String> = files(&building.path("run")).into_keys().map(|path| path.display().to_string()).collect();
    assert_eq!(
        found,
        ["config.toml", "data.json", "errors.jsonl", "instructions.jsonl", "rejected.jsonl", "run.lock", "walks.jsonl"]
    );
    assert_eq!((building.lines("run/walks.jsonl").len(), building.lines("run/rejected.jsonl").len()), (10, 0));
}

#[test]
fn run_folder_has_pictures_if_the_platform_has_them() {
    let building = Building::new();
    wayword_testkit::write_skyboxes(&building.data()).unwrap();
    assert_eq!(building.generate("run", &["--episodes", EPISODES, "--limit", "1"]).code, Some(0));
    let walk = &building.lines("run/walks.jsonl")[0];
    let (frames, id) = (walk["path"]["frames"].as_array().unwrap().len(), walk["path"]["id"].as_str().unwrap());
    assert_eq!(walk["has_pictures"], true);
    for at in 0..frames {
        let picture = fs::read(building.path(&format!("run/frames/{id}_{at}.jpg"))).unwrap();
        assert!(picture.starts_with(&[0xff, 0xd8]), "frame {at} is a JPEG");
    }
}

#[test]
fn with_json_standard_output_is_one_object_and_talk_goes_to_standard_error() {
    let building = Building::new();
    let arguments = ["--episodes", EPISODES, "--json"];
    let summary = building.generate("run", &arguments).json();
    assert_eq!(
        (&summary["items"], &summary["passed"], &summary["rejected"]),
        (&10.into(), &20.into(), &0.into()),
        "{summary}"
    );
    let again = building.generate("run", &arguments);
    assert_eq!(again.json(), summary);
    assert!(again.err.contains("10 of 10"), "{again:?}");
    let quiet = building.generate("run", &["--episodes", EPISODES, "--json", "--quiet"]);
    assert_eq!((quiet.json(), quiet.err.as_str()), (summary, ""));
}

#[test]
fn the_same_command_again_changes_no_byte() {
    let building = Building::new();
    building.run_over_episodes("run");
    let before = files(&building.path("run"));
    building.run_over_episodes("run");
    assert!(files(&building.path("run")) == before);
    building.run_over_episodes("other");
    assert!(files(&building.path("other")) == before, "two runs of one command differ");
}

#[test]
fn a_folder_with_a_run_of_other_settings_is_refused_and_left_alone() {
    let building = Building::new();
    building.run_over_episodes("run");
    let before = files(&building.path("run"));
    let ran = building.generate(
        "run",
        &["--episodes", EPISODES, "--style", "reverie", "--style", "r2r", "--seed", "5", "--repairs", "2"],
    );
    let error = ran.refused();
    assert!(
        error.contains("other settings: repairs (8 before, 2 now), seed (0 before, 5 now)\nhint")
            && error.contains("--out"),
        "{error}"
    );
    assert!(files(&building.path("run")) == before);
}

#[test]
fn second_process_in_the_same_folder_gets_exit_code_busy() {
    let building = Building::new();
    building.run_over_episodes("run");
    let held = File::options().write(true).open(building.path("run/run.lock")).unwrap();
    held.lock().unwrap();
    let before = files(&building.path("run"));
    let ran = building.generate("run", &["--episodes", EPISODES, "--style", "reverie", "--style", "r2r"]);
    assert_eq!((ran.code, ran.out.as_str()), (Some(4), ""), "{ran:?}");
    assert!(ran.err.starts_with("error: ") && ran.err.contains("another wayword process is writing"), "{ran:?}");
    assert!(files(&building.path("run")) == before);
    drop(held);
    building.run_over_episodes("run");
}

#[test]
fn random_paths_keep_to_hops_metres_and_scene() {
    let building = Building::new();
    let ran = building.generate(
        "run",
        &["--paths", "30", "--hops", "3..4", "--metres", "6..12", "--scan", wayword_testkit::SCAN, "--seed", "4"],
    );
    assert!(matches!(ran.code, Some(0 | 3)), "{ran:?}");
    let walks = building.lines("run/walks.jsonl");
    assert_eq!(walks.len(), 30);
    let mut lengths = std::collections::BTreeSet::new();
    for walk in walks {
        let path: wayword_core::Path = serde_json::from_value(walk["path"].clone()).unwrap();
        assert!(
            (3..=4).contains(&path.moves().len()) && (6.0..=12.0).contains(&path.length_m().unwrap()),
            "{} hops, {} m",
            path.moves().len(),
            path.length_m().unwrap()
        );
        lengths.insert((path.length_m().unwrap() * 100.0) as u64);
    }
    assert!(lengths.len() > 5, "the paths are random: {lengths:?}");
    let seeds = |out: &str, seed: &str| {
        building.generate(out, &["--paths", "3", "--hops", "3..4", "--seed", seed]);
        building.records(out).into_iter().map(|record| record.instruction.text).collect::<Vec<_>>()
    };
    assert_ne!(seeds("one", "1"), seeds("two", "2"));
}

#[test]
fn random_paths_that_no_scene_has_are_refused_before_a_folder_is_made() {
    let building = Building::new();
    let ran = building.generate("run", &["--paths", "2", "--hops", "40..50"]);
    assert!(ran.refused().contains("40 to 50 hops") && ran.err.contains("widen --hops or --metres"), "{ran:?}");
    assert!(!building.path("run").exists());
    let house = ["generate", "--paths", "9", "--metres", "500..600", "--out", "run"];
    let ran = building.wayword(&house);
    assert!(ran.refused().contains("none of the 20 scenes has a path with 500 to 600 metres"), "{ran:?}");
    assert!(ran.err.contains("hint: widen --metres, or"), "{ran:?}");
}

#[test]
fn flags_without_effect_are_named() {
    let building = Building::new();
    let args = ["generate", "--paths", "1", "--hops", "1..2", "--max-usd", "2", "--style", "r2r", "--out", "run"];
    let ran = building.wayword(&args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(
        ran.err.contains("--hops has no effect") && ran.err.contains("settings have no effect: --max-usd"),
        "{ran:?}"
    );
}

#[test]
fn flags_win_over_the_config_file_and_the_file_over_defaults() {
    let building = Building::new();
    building.write(
        "run.toml",
        "platform = \"matterport\"\ndata = \"data\"\npaths = 3\nseed = 1\nstyle = [\"r2r\"]\nhops = \"2..3\"\n",
    );
    let ran = building.wayword(&["generate", "--config", "run.toml", "--seed", "9", "--out", "run"]);
    assert!(matches!(ran.code, Some(0 | 3)), "{ran:?}");
    let config: toml::Table = toml::from_str(&fs::read_to_string(building.path("run/config.toml")).unwrap()).unwrap();
    assert_eq!(
        (config["seed"].as_integer(), config["paths"].as_integer(), config["repairs"].as_integer()),
        (Some(9), Some(3), Some(8))
    );
    assert!(
        building
            .records("run")
            .iter()
            .all(|record| record.instruction.style == "r2r" && (3..=4).contains(&record.path.frames.len()))
    );
    // The flag `--episodes` wins over the file's number of paths.
    let ran = building.wayword(&["generate", "--config", "run.toml", "--episodes", EPISODES, "--out", "episodes"]);
    assert_eq!((ran.code, building.records("episodes").len()), (Some(0), 10), "{ran:?}");
}

#[test]
fn a_misspelt_key_of_the_config_file_is_refused_by_name() {
    let building = Building::new();
    building.write("run.toml", "platfrom = \"house\"\n");
    let ran = building.wayword(&["generate", "--config", "run.toml", "--out", "run"]);
    let error = ran.refused();
    assert!(error.contains("run.toml") && error.contains("platfrom"), "{error}");
    assert!(!building.path("run").exists());
}

#[test]
fn panoramic_frames_are_four_looks_condensed_to_under_twenty_words() {
    let building = Building::new();
    assert_eq!(building.generate("run", &["--episodes", EPISODES, "--frames", "panoramic"]).code, Some(0));
    for walk in building.lines("run/walks.jsonl") {
        for observation in walk["observations"].as_array().unwrap() {
            let headings: Vec<f64> = observation["looks"]
                .as_array()
                .unwrap()
                .iter()
                .map(|look| look["gaze"]["heading"].as_f64().unwrap())
                .collect();
            assert_eq!(headings.len(), 4);
            assert!(
                headings.windows(2).all(|pair| (pair[1] - pair[0] - std::f64::consts::FRAC_PI_2).abs() < 1e-9),
                "{headings:?}"
            );
            assert!(word_count(observation["summary"].as_str().unwrap()) < 20, "{}", observation["summary"]);
        }
    }
    assert_eq!(building.generate("central", &["--episodes", EPISODES, "--frames", "central"]).code, Some(0));
    let first = &building.lines("central/walks.jsonl")[0]["observations"][0];
    assert_eq!(first["looks"].as_array().unwrap().len(), 1);
}

#[test]
fn fixed_perception_asks_the_same_of_every_view() {
    let building = Building::new();
    let asked = |out: &str, perception: &str| -> std::collections::BTreeSet<Vec<String>> {
        assert!(matches!(
            building.generate(out, &["--episodes", EPISODES, "--perception", perception]).code,
            Some(0 | 3)
        ));
        let walks = building.lines(&format!("{out}/walks.jsonl"));
        let questions = |look: &serde_json::Value| -> Vec<String> {
            look["caption"]["transcript"]
                .as_array()
                .unwrap()
                .iter()
                .map(|exchange| exchange["question"].as_str().unwrap().to_owned())
                .collect()
        };
        walks
            .iter()
            .flat_map(|walk| {
                walk["observations"].as_array().unwrap().iter().flat_map(|seen| seen["looks"].as_array().unwrap())
            })
            .map(questions)
            .collect()
    };
    assert_eq!(asked("fixed", "fixed").len(), 1);
    assert!(asked("dialogue", "dialogue").len() > 1);
    assert!(building.records("fixed").iter().all(|record| record.instruction.provenance.asker == "fixed queries"));
    assert!(building.generate("few", &["--episodes", EPISODES, "--questions", "1"]).code.is_some());
    let walks = building.lines("few/walks.jsonl");
    assert!(
        walks
            .iter()
            .all(|walk| walk["observations"][0]["looks"][0]["caption"]["transcript"].as_array().unwrap().len() <= 2),
        "the opening and one question"
    );
}

#[test]
fn a_free_target_is_the_writers_and_is_exported_without_an_object() {
    let building = Building::new();
    let ran = building.generate("run", &["--episodes", EPISODES, "--style", "reverie", "--target", "free"]);
    assert!(matches!(ran.code, Some(0 | 3)), "{ran:?}");
    let records = building.records("run");
    assert!(records.len() >= 8, "{} of 10", records.len());
    assert!(records.iter().all(|record| record.path.target.is_none()
        && record.instruction.mentions.iter().any(|mention| mention.kind == MentionKind::Target)));
    assert_eq!(
        building
            .wayword(&["export", "--run", "run", "--style", "reverie", "--format", "reverie", "--out", "free.json"])
            .code,
        Some(0)
    );
    let items: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(building.path("free.json")).unwrap()).unwrap();
    assert_eq!(items.as_array().unwrap().len(), records.len());
    assert!(items.as_array().unwrap().iter().all(|item| item.get("objId").is_none()));
}

/// A style file's text.
fn style(name: &str, references: &[&str], constraints: &str) -> String {
    let quoted: Vec<String> = references.iter().map(|text| format!("    {text:?},")).collect();
    format!("name = \"{name}\"\nreferences = [\n{}\n]\n{constraints}", quoted.join("\n"))
}

const TERSE: &[&str] = &[
    "Go to the pantry and open the oven",
    "Enter the study, clean the globe",
    "Head to the attic and move the crib",
    "Find the sauna and wash the bucket",
];
const TALKATIVE: &[&str] = &[
    "Turn left at the piano and walk along the corridor past the aquarium. Turn right at the wardrobe and go straight through the nursery. Turn left again beside the harp and keep walking. Stop in front of the rocking horse in the playroom.",
    "Walk out of the chapel and turn right by the organ. Continue beyond the two benches, then turn left into the cloister. Go past the statue and turn right at the fountain. Wait next to the wooden gate at the very end.",
    "Leave the cellar behind you and turn left after the barrels. Go up the steps and turn right near the lantern. Walk all the way through the armoury until you reach the shield. Turn left there and stop close to the anvil.",
];

#[test]
fn a_users_own_references_change_what_is_written() {
    let building = Building::new();
    building.write("terse.toml", style("terse", TERSE, ""));
    building.write("talkative.toml", style("talkative", TALKATIVE, ""));
    let ran = building.generate("run", &["--episodes", EPISODES, "--style", "terse.toml", "--style", "talkative.toml"]);
    assert!(matches!(ran.code, Some(0 | 3)), "{ran:?}");
    let records = building.records("run");
    let of = |name: &str| {
        records.iter().map(|record| &record.instruction).filter(|text| text.style == name).collect::<Vec<_>>()
    };
    let (terse, talkative) = (of("terse"), of("talkative"));
    assert!(terse.len() >= 9 && talkative.len() >= 9, "{} and {} of 10", terse.len(), talkative.len());
    let mean = |texts: &[&Instruction], measure: &dyn Fn(&Instruction) -> usize| {
        texts.iter().map(|text| measure(text)).sum::<usize>() as f64 / texts.len() as f64
    };
    let words = |texts: &[&Instruction]| mean(texts, &|text| word_count(&text.text));
    assert!(words(&terse) < 12.0 && words(&talkative) > 22.0, "{} and {} words", words(&terse), words(&talkative));
    let sentences = |texts: &[&Instruction]| mean(texts, &|text| sentence_count(&text.text));
    assert!(
        sentences(&terse) == 1.0 && sentences(&talkative) > 2.0,
        "{} and {} sentences",
        sentences(&terse),
        sentences(&talkative)
    );
    let turns = |texts: &[&Instruction]| mean(texts, &|text| spoken(text, MentionKind::Turn).len());
    assert!(turns(&terse) == 0.0 && turns(&talkative) > 0.5, "{} and {} turns", turns(&terse), turns(&talkative));
    let tasks = |texts: &[&Instruction]| mean(texts, &|text| spoken(text, MentionKind::Target).len());
    assert!(tasks(&terse) == 1.0 && tasks(&talkative) == 0.0, "{} and {} tasks", tasks(&terse), tasks(&talkative));
    let stops = |texts: &[&Instruction]| texts.iter().filter(|text| text.text.ends_with('.')).count();
    assert_eq!((stops(&terse), stops(&talkative)), (0, talkative.len()));
    assert_ne!(terse[0].provenance.style_hash, talkative[0].provenance.style_hash);
}

#[test]
fn a_style_is_taken_from_a_datasets_own_texts() {
    let building = Building::new();
    let ran = building.generate(
        "run",
        &[
            "--episodes",
            EPISODES,
            "--style",
            "reverie=data/reverie/REVERIE_val_seen.json",
            "--style",
            "walks=data/r2r/R2R_val_seen.json",
        ],
    );
    assert!(matches!(ran.code, Some(0 | 3)), "{ran:?}");
    let records = building.records("run");
    let originals: Vec<String> = wayword_formats::read_any_format(&building.r2r())
        .unwrap()
        .into_iter()
        .flat_map(|episode| episode.instructions)
        .collect();
    for record in &records {
        let text = &record.instruction.text;
        match record.instruction.style.as_str() {
            // The constraints of the built-in style of that name.
            "reverie" => assert!(word_count(text) < 20 && sentence_count(text) == 1, "{text}"),
            "walks" => assert!(!originals.contains(text), "{text}"),
            other => panic!("{other}"),
        }
    }
    let count = |style: &str| records.iter().filter(|record| record.instruction.style == style).count();
    assert!(count("reverie") >= 9 && count("walks") >= 9, "{} and {} of 10", count("reverie"), count("walks"));
}
