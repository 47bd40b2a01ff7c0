//! `wayword export --format duet`: the files that agents' loaders ask for.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::Building;

fn export(building: &Building, run: &str, style: &str, more: &[&str]) -> crate::common::Ran {
    let arguments = ["export", "--run", run, "--style", style, "--format", "duet", "--out", "anno", "--json"];
    building.wayword(&[&arguments[..], more].concat())
}

#[cfg(not(feature = "local"))]
#[test]
fn build_without_tokenizers_refuses_duet_files() {
    let building = Building::new();
    building.run_over_episodes("run");
    let ran = export(&building, "run", "r2r", &["--tokenizer", "words.json"]);
    let error = ran.refused();
    assert!(error.contains("no tokenizers") && error.contains("--features full"), "{error}");
}

#[cfg(feature = "local")]
mod built {
    use super::*;
    use serde_json::{Value, json};
    use std::{collections::BTreeSet, fs};

    /// A tokenizer of letters: each word is its letters.
    fn tokenizer(building: &Building, begin: &str, end: &str) -> String {
        let letters = || ('a'..='z').map(String::from);
        let words = [begin, "[UNK]", end].into_iter().map(str::to_owned);
        let words = words.chain(letters()).chain(letters().map(|letter| format!("##{letter}")));
        let vocabulary: Value = words.enumerate().map(|(id, word)| (word, json!(id))).collect();
        let file = json!({
            "version": "1.0", "truncation": null, "padding": null, "added_tokens": [],
            "normalizer": {"type": "BertNormalizer", "clean_text": true, "handle_chinese_chars": true,
                "strip_accents": null, "lowercase": true},
            "pre_tokenizer": {"type": "BertPreTokenizer"}, "post_processor": null, "decoder": null,
            "model": {"type": "WordPiece", "unk_token": "[UNK]", "continuing_subword_prefix": "##",
                "max_input_chars_per_word": 100, "vocab": vocabulary},
        });
        let name = format!("{}.json", end.trim_matches(['<', '>', '/', '[', ']']));
        building.write(&name, file.to_string());
        name
    }

    fn read(building: &Building, file: &str) -> Vec<Value> {
        serde_json::from_slice(&fs::read(building.path(file)).unwrap()).unwrap()
    }

    /// The ids that [`tokenizer`] has for a text.
    fn ids(text: &str) -> Vec<u64> {
        let mut ids = vec![0];
        let mut is_within = false;
        for c in text.to_lowercase().chars() {
            if c.is_ascii_lowercase() {
                ids.push(3 + u64::from(c as u32 - 'a' as u32) + if is_within { 26 } else { 0 });
            } else if !c.is_whitespace() {
                ids.push(1);
            }
            is_within = c.is_ascii_lowercase();
        }
        ids.push(2);
        ids
    }

    #[test]
    fn items_are_those_of_the_format_with_the_ids_of_their_tokens() {
        let building = Building::new();
        building.run_over_episodes("run");
        let bert = tokenizer(&building, "[CLS]", "[SEP]");
        for (style, name) in [("r2r", "R2R_val_seen_enc.json"), ("reverie", "REVERIE_val_seen_enc.json")] {
            let ran = export(&building, "run", style, &["--tokenizer", &bert]);
            assert_eq!(ran.code, Some(0), "{ran:?}");
            assert_eq!((&ran.json()["splits"]["val_seen"], &ran.json()["instructions"]), (&json!(10), &json!(10)));
            let plain = ["export", "--run", "run", "--style", style, "--format", style, "--out", "plain.json"];
            assert_eq!(building.wayword(&plain).code, Some(0));
            let mut items = read(&building, &format!("anno/{name}"));
            for item in &mut items {
                let encodings = item.as_object_mut().unwrap().shift_remove("instr_encodings").unwrap();
                let texts = item["instructions"].as_array().unwrap();
                let expected: Vec<Vec<u64>> = texts.iter().map(|text| ids(text.as_str().unwrap())).collect();
                assert_eq!(encodings, json!(expected));
            }
            assert_eq!(items, read(&building, "plain.json"), "{style}");
        }
    }

    #[test]
    fn pretraining_has_a_line_for_each_text_and_the_views_of_all_neighbours() {
        let building = Building::new();
        let records = building.run_over_episodes("run");
        let bert = tokenizer(&building, "[CLS]", "[SEP]");
        for (style, name) in [("r2r", "R2R_val_seen_enc.jsonl"), ("reverie", "REVERIE_val_seen_enc.jsonl")] {
            let export =
                ["export", "--run", "run", "--style", style, "--format", "duet-pretrain", "--tokenizer", &bert];
            let ran = building.wayword(&[&export[..], &["--out", "pre", "--json"]].concat());
            assert_eq!(ran.code, Some(0), "{ran:?}");
            let lines = building.lines(&format!("pre/{name}"));
            let texts: BTreeSet<Vec<u64>> = records
                .iter()
                .filter(|record| record.instruction.style == style)
                .map(|record| ids(&record.instruction.text))
                .collect();
            let views: Value =
                serde_json::from_slice(&fs::read(building.path("pre/scanvp_candview_relangles.json")).unwrap())
                    .unwrap();
            for line in &lines {
                let encoded: Vec<u64> = serde_json::from_value(line["instr_encoding"].clone()).unwrap();
                assert!(texts.contains(&encoded), "{line}");
                let path: Vec<&str> = line["path"].as_array().unwrap().iter().map(|at| at.as_str().unwrap()).collect();
                for hop in path.windows(2) {
                    let here = format!("{}_{}", line["scan"].as_str().unwrap(), hop[0]);
                    assert!((0.0..36.0).contains(&views[&here][hop[1]][0].as_f64().unwrap()), "{here}");
                }
                let name_parts = line["instr_id"].as_str().unwrap().split('_').count();
                let is_about_object = style == "reverie";
                assert_eq!(
                    (name_parts == 3, line.get("pos_vps").is_some()),
                    (is_about_object, is_about_object),
                    "{line}"
                );
            }
            assert_eq!(lines.len() as u64, ran.json()["instructions"].as_u64().unwrap());
        }
    }

    #[test]
    fn texts_for_one_path_are_one_item_with_as_many_encodings() {
        let building = Building::new();
        let mut records = building.run_over_episodes("run");
        records.retain(|record| record.instruction.style == "reverie");
        let first = records[0].clone();
        records[1].path = first.path;
        records[1].extra = first.extra;
        records[1].instruction.mentions.clear();
        wayword_formats::jsonl::write_records(&building.path("run/instructions.jsonl"), &records).unwrap();
        let bert = tokenizer(&building, "[CLS]", "[SEP]");
        for (dataset, name) in [("r2r", "R2R_mine_enc.json"), ("reverie", "REVERIE_mine_enc.json")] {
            let ran =
                export(&building, "run", "reverie", &["--tokenizer", &bert, "--dataset", dataset, "--split", "mine"]);
            assert_eq!(ran.code, Some(0), "{ran:?}");
            let items = read(&building, &format!("anno/{name}"));
            assert_eq!(items.len(), 9);
            let texts = items[0]["instructions"].as_array().unwrap();
            let expected: Vec<Vec<u64>> = texts.iter().map(|text| ids(text.as_str().unwrap())).collect();
            assert_eq!((texts.len(), &items[0]["instr_encodings"]), (2, &json!(expected)), "{dataset}");
        }
    }

    #[test]
    fn rxr_s_lines_have_numbers_even_for_paths_with_names() {
        let building = Building::new();
        assert!(building.generate("random", &["--paths", "3", "--hops", "3..7", "--style", "r2r"]).code.is_some());
        let xlm = tokenizer(&building, "<s>", "</s>");
        let ran = export(&building, "random", "r2r", &["--tokenizer", &xlm, "--dataset", "rxr"]);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let lines = building.lines("anno/rxr_train_guide_enc_xlmr.jsonl");
        assert!(lines.iter().all(|line| line["path_id"].is_u64() && line["instruction_id"].is_u64()));
        let numbers: BTreeSet<String> =
            lines.iter().map(|line| format!("{}_{}", line["path_id"], line["instruction_id"])).collect();
        assert_eq!(numbers.len(), lines.len());
        for line in &lines {
            assert_eq!(line["instr_encoding"], json!(ids(line["instruction"].as_str().unwrap())));
            assert_eq!(line["split"], "train");
        }
        let bert = tokenizer(&building, "[CLS]", "[SEP]");
        let ran = export(&building, "random", "r2r", &["--tokenizer", &bert, "--dataset", "rxr"]);
        let error = ran.refused();
        assert!(error.contains("XLM-RoBERTa") && error.contains("hf/FacebookAI/xlm-roberta-base"), "{error}");
        let ran = export(&building, "random", "r2r", &["--tokenizer", &xlm]);
        assert!(building.path("anno/R2R_train_enc_xlmr.json").is_file(), "{ran:?}");
    }

    #[test]
    fn paths_without_viewpoints_are_refused_before_anything_is_written() {
        let building = Building::new();
        let run = ["generate", "--paths", "1", "--metres", "5..9", "--style", "r2r", "--out", "houses"];
        assert_eq!(building.wayword(&run).code, Some(0));
        let bert = tokenizer(&building, "[CLS]", "[SEP]");
        let ran = export(&building, "houses", "r2r", &["--tokenizer", &bert]);
        assert!(ran.refused().contains("names no viewpoints"), "{ran:?}");
        assert!(!building.path("anno").exists());
    }

    #[test]
    fn missing_tokenizer_is_reported_with_the_command_that_fetches_it() {
        let building = Building::new();
        building.run_over_episodes("run");
        let model = "hf/google-bert/bert-base-uncased";
        let arguments = ["export", "--run", "run", "--style", "r2r", "--format", "duet", "--out", "anno"];
        let mut command = building.command(&[&arguments[..], &["--tokenizer", model]].concat());
        let cache = building.path("hub");
        let ran = crate::common::run(command.env("WAYWORD_OFFLINE", "1").env("HF_HUB_CACHE", &cache));
        assert!(ran.refused().contains(&format!("wayword models fetch --tokenizer {model}")), "{ran:?}");
        assert!(!building.path("anno").exists());
        // In the layout of the hub's cache it is found.
        let bert = tokenizer(&building, "[CLS]", "[SEP]");
        let folder = cache.join("models--google-bert--bert-base-uncased/snapshots/main");
        fs::create_dir_all(&folder).unwrap();
        fs::copy(building.path(&bert), folder.join("tokenizer.json")).unwrap();
        let mut command = building.command(&[&arguments[..], &["--tokenizer", model]].concat());
        let ran = crate::common::run(command.env("WAYWORD_OFFLINE", "1").env("HF_HUB_CACHE", &cache));
        assert_eq!(ran.code, Some(0), "{ran:?}");
        assert!(export(&building, "run", "r2r", &["--tokenizer", "none.json"]).refused().contains("none.json"));
    }
}
