//! Runs with a model that writes: pictures that it is shown, several texts for each path, and views asked about at the same
//! time.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::models as stage;

use crate::common::{Building, EPISODES, run};
use image::{Rgb, RgbImage};
use serde_json::Value;
use stage::{KEY, KEY_ENV, Stage, cast};
use std::{
    collections::BTreeSet,
    fs,
    sync::{Arc, Mutex},
    time::Duration,
};
use wayword_testkit::provider::{
    ModelScript, PictureGallery, ProviderBehaviour, ProviderDialect, ScriptRequest,
    scripts::{FlawedEye, ScriptedCast},
};

/// A careful cast, and the number of pictures of each request to write.
fn watched() -> (ProviderBehaviour, Arc<Mutex<Vec<usize>>>) {
    let shown = Arc::new(Mutex::new(Vec::new()));
    let (noted, cast) =
        (Arc::clone(&shown), ScriptedCast::new(FlawedEye::new(PictureGallery::default(), 1, 0.0), 1, 0.0));
    let words = move |heard: &ScriptRequest| {
        if heard.prompt().contains("Write one instruction in this style") {
            noted.lock().unwrap().push(heard.pictures.len());
        }
        cast.reply(heard)
    };
    let eye = ScriptedCast::new(FlawedEye::new(PictureGallery::default(), 1, 0.0), 1, 0.0);
    (ProviderBehaviour::for_model("words", words).and_model("eye", eye), shown)
}

#[test]
fn a_writer_that_sees_is_shown_the_frames_of_its_path() {
    let (behaviour, shown) = watched();
    let stage = Stage::new(behaviour);
    let ran = stage.generate("run", &["--paths", "2", "--write-sees", "--json"]);
    assert_eq!((ran.code, ran.json()["errors"].as_u64()), (Some(0), Some(0)), "{ran:?}");
    let frames: Vec<usize> = stage.building.records("run").iter().map(|record| record.path.frames.len()).collect();
    let shown = shown.lock().unwrap();
    assert!(!shown.is_empty() && shown.iter().all(|pictures| frames.contains(pictures)), "{shown:?} of {frames:?}");
}

#[test]
fn write_sees_refuses_writers_without_sight_before_the_first_call() {
    let stage = Stage::new(cast());
    let base = ["generate", "--paths", "1", "--out", "run", "--write-sees"];
    for (args, told) in [
        (&[][..], "rules writes, and cannot be shown pictures"),
        (&["--llm", "completions/words", "--base-url", "http://127.0.0.1:9/v1"][..], "takes none"),
    ] {
        let args: Vec<&str> = base.iter().chain(args).copied().collect();
        assert!(stage.building.wayword(&args).refused().contains(told), "{args:?}");
        assert!(!stage.building.path("run").exists());
    }
    assert_eq!(stage.provider.request_count(), 0);
}

/// A stand-in for Ollama, which reports for each model whether it sees.
#[test]
fn a_model_of_ollama_that_does_not_see_is_refused_before_the_first_call() {
    let blind = ["words".to_owned()].into();
    let stage = Stage::new(ProviderBehaviour { blind, ..watched().0 });
    let base = stage.provider.base_url(ProviderDialect::Ollama);
    let generate = |models: &[&str]| {
        let args = ["generate", "--platform", "matterport", "--data", "data", "--paths", "1", "--hops", "3..7"];
        let rest = ["--style", "r2r", "--ledger", "ledger.db", "--out", "run", "--base-url", &base];
        stage.building.wayword(&[&args[..], &rest, models].concat())
    };
    for models in [
        &["--see", "ollama/words"][..],
        &["--see", "ollama/eye", "--write", "ollama/words", "--write-sees"],
        &["--llm", "ollama/words", "--write-sees"],
    ] {
        let ran = generate(models);
        let told = ran.refused();
        assert!(told.contains("ollama/words cannot be shown pictures") && told.contains("vision"), "{told}");
        assert!(!stage.building.path("run").exists());
    }
    assert_eq!(stage.provider.request_count(), 0);
    let sees = generate(&["--see", "ollama/eye", "--llm", "ollama/words"]);
    assert!(matches!(sees.code, Some(0 | 3)) && stage.provider.request_count() > 0, "{sees:?}");
}

/// An adjective ("soft" in "a soft, blotchy pattern") must not become the object of a task, in any way of asking. Rules that
/// finish for a model then have no object, and the text is rejected.
#[test]
fn rules_never_finish_with_an_adjective_as_the_object() {
    let finished = |perception: &str, answer: &'static str| {
        let stage = Stage::new(
            ProviderBehaviour::for_model("words", |_: &ScriptRequest| {
                "I'm sorry, but I can't help with that.".to_owned()
            })
            .and_model("eye", move |_: &ScriptRequest| answer.to_owned()),
        );
        let args = ["--paths", "2", "--hops", "3..7", "--style", "reverie", "--target", "free", "--repairs", "1"];
        let rest = ["--evidence", "captions", "--finish", "rules", "--perception", perception, "--out", "run"];
        let ran = run(&mut stage.command("generate", &[&args[..], &rest].concat()));
        let texts: Vec<String> =
            stage.building.records("run").into_iter().map(|record| record.instruction.text).collect();
        (ran.code, texts, stage.building.lines("run/rejected.jsonl").len())
    };
    for (perception, soft, sofa) in [
        (
            "structured",
            r#"{"room": "bedroom", "things": [{"name": "soft"}, {"name": "blotchy"}]}"#,
            r#"{"room": "bedroom", "things": [{"name": "soft"}, {"name": "sofa"}]}"#,
        ),
        ("single", "It is a bedroom. It is soft, with a soft, blotchy pattern.", "It is a bedroom with a soft sofa."),
    ] {
        assert_eq!(finished(perception, soft), (Some(3), Vec::new(), 2), "{perception}");
        let (_, texts, _) = finished(perception, sofa);
        assert!(texts.len() == 2 && texts.iter().all(|text| text.contains("sofa")), "{perception}: {texts:?}");
    }
}

#[test]
fn each_path_gets_as_many_different_texts_as_asked_for() {
    let building = Building::new();
    let args = ["--episodes", EPISODES, "--style", "r2r", "--style", "reverie", "--per-path", "3", "--limit", "4"];
    let ran = building.generate("run", &args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let records = building.records("run");
    assert_eq!(records.len(), 4 * 2 * 3);
    for three in records.chunks(3) {
        let texts: BTreeSet<&str> = three.iter().map(|record| record.instruction.text.as_str()).collect();
        assert_eq!((texts.len(), three[0].path.id.clone()), (3, three[2].path.id.clone()), "{texts:?}");
        assert_eq!(three[0].instruction.style, three[2].instruction.style);
    }
    let before = fs::read(building.path("run/instructions.jsonl")).unwrap();
    assert_eq!(building.generate("run", &args).code, Some(0));
    assert!(before == fs::read(building.path("run/instructions.jsonl")).unwrap(), "the same command changes bytes");
    // The first text of a path is the same as in a run with one text per path.
    let alone = building.generate("alone", &["--episodes", EPISODES, "--style", "r2r", "--limit", "4"]);
    assert_eq!(alone.code, Some(0));
    for record in building.records("alone") {
        let text = &record.instruction.text;
        assert!(records.iter().any(|other| other.instruction.text == *text), "{text}");
    }
    for (style, format) in [("r2r", "r2r"), ("reverie", "reverie")] {
        let args = ["export", "--run", "run", "--format", format, "--style", style, "--out", "out.json"];
        assert_eq!(building.wayword(&args).code, Some(0), "{format}");
        let episodes = wayword_formats::read_any_format(&building.path("out.json")).unwrap();
        let texts: usize = episodes.iter().map(|episode| episode.instructions.len()).sum();
        assert!(texts == 12 && episodes.len() <= 4, "{format}: {texts} texts of {} items", episodes.len());
    }
    assert!(building.generate("more", &["--per-path", "10"]).refused().contains("--per-path 10 is not from 1 to 9"));
    assert_eq!(building.wayword(&["report", "--run", "run"]).code, Some(0));
}

#[test]
fn writer_prompt_has_the_earlier_texts_of_a_path() {
    let (behaviour, shown) = watched();
    let stage = Stage::new(behaviour);
    let ran = stage.generate("run", &["--paths", "2", "--per-path", "2", "--json"]);
    assert_eq!((ran.code, ran.json()["errors"].as_u64()), (Some(0), Some(0)), "{ran:?}");
    let texts: Vec<String> = stage.building.records("run").into_iter().map(|record| record.instruction.text).collect();
    assert_eq!(texts.iter().collect::<BTreeSet<_>>().len(), 4, "{texts:?}");
    assert!(shown.lock().unwrap().len() >= 4);
}

/// Twelve views and more: of eight at a time, most of the waiting is saved.
#[test]
fn the_views_of_one_path_are_asked_about_at_the_same_time() {
    const LATENCY: Duration = Duration::from_millis(300);
    let asked = |concurrency: &str| {
        let stage = Stage::new(ProviderBehaviour { latency: LATENCY, ..watched().0 });
        let args = ["--paths", "1", "--frames", "panoramic", "--perception", "single", "--concurrency", concurrency];
        let ran = stage.generate("run", &args);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        stage
    };
    let (one, eight) = (asked("1"), asked("8"));
    let calls = eight.provider.request_count();
    assert!(calls >= 12 && eight.provider.log().most_at_once > 4, "{calls} calls");
    assert!(eight.provider.log().most_at_once <= 8);
    let rounds = [&one, &eight].map(|stage| stage.provider.log().rounds);
    assert_eq!(rounds[0], calls);
    assert!(rounds[1] * 2 < rounds[0], "{rounds:?} rounds with one and with eight at a time");
    for file in ["walks.jsonl", "instructions.jsonl"] {
        let read = |stage: &Stage| fs::read(stage.building.path("run").join(file)).unwrap();
        assert!(read(&one) == read(&eight), "{file} depends on the order of the answers");
    }
}

#[test]
fn a_plan_counts_the_texts_and_pictures_of_a_run() {
    let stage = Stage::new(cast());
    let planned = |more: &[&str]| {
        let args = ["--style", "r2r", "--hops", "3..7", "--paths", "4", "--dry-run", "--json"];
        let args: Vec<&str> = args.iter().chain(more).copied().collect();
        let plan = run(&mut stage.command("generate", &args)).json();
        let models = plan["models"].as_array().unwrap().clone();
        let words = models.iter().find(|model| model["model"] == "server/words").unwrap().clone();
        (words["calls"].as_u64().unwrap(), words["tokens_in"].as_u64().unwrap())
    };
    let once = |more: &[&str]| planned(&[&["--repairs", "0", "--refine", "0"], more].concat());
    let (one, three) = (once(&[]), once(&["--per-path", "3"]));
    assert_eq!(three.0, one.0 + 2 * 4);
    // Of four texts, usually two are written again.
    assert_eq!(planned(&[]).0, one.0 + 2);
    assert!(once(&["--write-sees"]).1 > one.1 + 4 * 4 * 262);
}

/// Twelve views and one text with eight requests at a time: two rounds of views and one of writing. Questions about open points
/// take two more.
#[test]
fn a_path_of_twelve_views_takes_three_rounds_of_calls_and_five_with_questions() {
    for (perception, most) in [("single", 3), ("structured", 3), ("follow-up", 5)] {
        let eye = FlawedEye { misshapen_share: 0.0, ..FlawedEye::new(PictureGallery::default(), 1, 0.15) };
        let behaviour = ProviderBehaviour { latency: Duration::from_millis(500), ..watched().0 };
        let stage = Stage::new(behaviour.and_model("eye", ScriptedCast::new(eye, 1, 0.0)));
        let args = ["--paths", "1", "--hops", "2", "--metres", "0..100", "--frames", "panoramic", "--concurrency", "8"];
        let rest = ["--perception", perception, "--style", "r2r", "--repairs", "0", "--out", "run"];
        let ran = run(&mut stage.command("generate", &[&args[..], &rest].concat()));
        assert!(matches!(ran.code, Some(0 | 3)), "{ran:?}");
        let looks: Vec<Value> = stage.building.lines("run/walks.jsonl")[0]["observations"]
            .as_array()
            .unwrap()
            .iter()
            .flat_map(|observation| observation["looks"].as_array().unwrap().clone())
            .collect();
        let asked: usize = looks.iter().map(|look| look["caption"]["transcript"].as_array().unwrap().len()).sum();
        assert_eq!(looks.len(), 12);
        assert_eq!(perception == "follow-up", asked > 12, "{asked} questions");
        // Panoramas of answers in words are condensed by a model; that comes on top.
        let further = stage.provider.log().answered - asked as u64 - 1;
        assert!(further == 0 || perception == "single", "{perception}: {further} further calls");
        let rounds = stage.provider.log().rounds;
        // The first call of a model goes ahead alone, so that a fault of the service costs one call.
        assert!(rounds <= 1 + most + further, "{perception}: {rounds} rounds, {asked} questions");
    }
}

/// Without a terminal a long run prints a line about its calls now and then.
#[test]
fn run_without_a_terminal_prints_lines_about_its_calls() {
    let stage = Stage::new(ProviderBehaviour { latency: Duration::from_millis(400), ..watched().0 });
    let args = ["--paths", "1", "--frames", "panoramic", "--perception", "single", "--concurrency", "1"];
    let ran = stage.generate("run", &args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    // Where the machine is busy, there is a line before the first call.
    let told = |line: &&str| line.contains(" calls") && line.ends_with(" left");
    let line = ran.err.lines().find(told).unwrap_or_else(|| panic!("{ran:?}"));
    assert!(line.starts_with("items: 0 of 1, ") && line.contains(" of about ") && line.ends_with(" left"), "{line}");
    // It is known from the start how many calls there will be.
    let numbers: Vec<u64> = line.split(|c: char| !c.is_ascii_digit()).filter_map(|word| word.parse().ok()).collect();
    let asked = stage.provider.request_count();
    assert!(numbers[3].abs_diff(asked) <= asked / 5 + 1, "{line}, and {asked} were asked");
    let quiet = stage.generate("again", &[&args[..], &["--quiet"]].concat());
    assert!(!quiet.err.contains(" calls"), "{quiet:?}");
}

/// The tokens that a plan estimates are within 30 % of those that the run uses, in each way of asking.
#[test]
fn a_plan_is_within_a_third_of_what_the_run_uses() {
    let mut wrong = Vec::new();
    for args in [
        &[][..],
        &["--perception", "structured", "--frames", "panoramic"],
        &["--perception", "follow-up"],
        &["--perception", "dialogue"],
        &["--perception", "single"],
        &["--perception", "fixed", "--frames", "panoramic"],
        &["--perception", "single", "--write-sees", "--per-path", "2"],
    ] {
        let stage = Stage::new(watched().0);
        let asked = ["--paths", "8", "--picture-px", "512", "--json"];
        let plan = [&asked[..], args, &["--dry-run"]].concat();
        let planned = stage.generate("plan", &plan).json();
        let sum = |field: &str| {
            let models = planned["models"].as_array().unwrap().iter();
            models.map(|model| model[field].as_u64().unwrap()).sum::<u64>() as f64
        };
        let ran = stage.generate("run", &[&asked[..], args].concat());
        let spent = ran.json()["spent"].clone();
        let used = |field: &str| spent[field].as_f64().unwrap();
        let shares = [
            ("calls", sum("calls") / used("answered")),
            ("tokens", (sum("tokens_in") + sum("tokens_out")) / (used("tokens_in") + used("tokens_out"))),
        ];
        wrong.extend(
            shares
                .iter()
                .filter(|(_, share)| !(0.7..=1.3).contains(share))
                .map(|(of, share)| format!("{args:?}: {of} {share:.2}")),
        );
    }
    assert!(wrong.is_empty(), "planned / used: {wrong:?}");
}

/// Four pictures are fewer hops than usual, and three metres fewer than usual.
#[test]
fn a_few_pictures_of_a_recording_are_one_path() {
    for poses in [true, false] {
        let stage = Stage::new(cast());
        let folder = stage.building.path("walk");
        fs::create_dir(&folder).unwrap();
        let mut csv = String::from("image,x,y,z,heading_deg\n");
        for at in 0..4_u32 {
            let pixel = |x: u32, y: u32| {
                Rgb([if ((x + 13 * at) / 16).is_multiple_of(2) { 210 } else { 30 }, (y / 2) as u8, 40 * at as u8])
            };
            RgbImage::from_fn(320, 240, pixel).save(folder.join(format!("{at}.png"))).unwrap();
            csv += &format!("{at}.png,0,{at},1.5,0\n");
        }
        if poses {
            fs::write(folder.join("poses.csv"), csv).unwrap();
        }
        let models = stage.models();
        let mut args = vec!["generate", "--platform", "recording", "--data", "walk", "--out", "run", "--style", "r2r"];
        args.extend(models.iter().map(String::as_str));
        let ran = run(stage.building.command(&args).env(KEY_ENV, KEY));
        assert!(matches!(ran.code, Some(0 | 3)), "{ran:?}");
        let walks = stage.building.lines("run/walks.jsonl");
        assert_eq!((walks.len(), walks[0]["path"]["frames"].as_array().unwrap().len()), (1, 4), "{ran:?}");
    }
}
