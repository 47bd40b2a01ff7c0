//! Whole runs with models in process. The models are tiny and random: their words have no meaning, but they run the same code as
//! real models.

#![cfg(feature = "local")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Building, Ran, run};
use std::path::Path;

/// The path of a fixture of `wayword-local`, as a part of a model's name.
fn fixture(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/wayword-local/fixtures");
    folder.join(name).canonicalize().unwrap().display().to_string()
}

/// Two BLIP models: one that answers, and one that describes.
fn eye() -> String {
    format!("hf/{}+{}", fixture("blip_vqa"), fixture("blip_caption"))
}

fn building() -> Building {
    let building = Building::new();
    wayword_testkit::write_distinct_skyboxes(&building.data()).unwrap();
    building
}

/// `wayword generate` over two paths, offline, with a model in process that sees.
fn generate(building: &Building, see: &str, out: &str, args: &[&str]) -> Ran {
    let all =
        ["generate", "--platform", "matterport", "--data", "data", "--paths", "2", "--style", "r2r", "--hops", "3..7"];
    let more = ["--evidence", "captions", "--ledger", "ledger.db", "--json", "--see", see, "--out", out];
    run(building.command(&[&all[..], &more, args].concat()).env("WAYWORD_OFFLINE", "1"))
}

#[test]
fn blip_sees_in_process_and_each_question_is_answered_once() {
    let building = building();
    let eye = eye();
    let first = generate(&building, &eye, "first", &[]);
    let summary = first.json();
    assert_eq!(summary["errors"], 0, "{first:?}");
    assert!(summary["spent"]["answered"].as_u64().unwrap() > 10, "{summary}");
    let walk = &building.lines("first/walks.jsonl")[0]["observations"][0]["looks"][0]["caption"];
    assert!(walk["transcript"].as_array().unwrap().len() > 2, "{walk}");
    assert_eq!(walk["by"]["answerer"].as_str().or(walk["answerer"].as_str()).unwrap_or(&eye), eye);

    let second = generate(&building, &eye, "second", &[]).json();
    assert_eq!((&second["spent"]["requests"], &second["spent"]["answered"]), (&0.into(), &0.into()), "{second}");
    // Another precision may change the answers, so these are other calls.
    let half = generate(&building, &eye, "half", &["--precision", "bf16"]).json();
    assert!(half["spent"]["answered"].as_u64().unwrap() > 10, "{half}");
}

#[test]
fn unusable_local_models_are_refused_before_the_first_call() {
    let building = building();
    let eye = eye();
    let tight = generate(&building, &eye, "tight", &["--memory-gib", "0.1"]);
    assert!(tight.refused().contains("GiB are left"), "{tight:?}");
    assert!(!building.path("tight").exists());
    let cuda = generate(&building, &eye, "cuda", &["--device", "cuda"]);
    assert!(cuda.refused().contains("--features cuda"), "{cuda:?}");
    for (at, (name, told)) in [
        ("hf/blip".to_owned(), "no organisation"),
        (format!("hf/{}", fixture("bert")), "neither see nor write texts"),
        (format!("hf/{0}+{0}", fixture("blip_vqa")), "one that describes"),
        ("hf/org/name".to_owned(), "config.json"),
    ]
    .into_iter()
    .enumerate()
    {
        let ran = generate(&building, &name, &format!("none{at}"), &[]);
        assert!(ran.refused().contains(told), "{name}: {ran:?}");
    }
}

#[test]
fn doctor_explains_how_to_use_a_model_that_only_describes() {
    let building = building();
    let describes = format!("hf/{}", fixture("blip_caption"));
    assert_eq!(generate(&building, &describes, "single", &["--perception", "single"]).json()["errors"], 0);
    let asked = generate(&building, &describes, "dialogue", &[]);
    assert_eq!(asked.json()["errors"], 2, "{asked:?}");
    let errors = building.lines("dialogue/errors.jsonl");
    assert!(errors[0]["reason"].as_str().unwrap().contains("--perception single"), "{errors:?}");
}

#[test]
fn a_gguf_file_is_refused_with_the_servers_that_run_it() {
    let building = building();
    for (name, server, model) in [
        (
            "hf/org/name:x-q4.gguf",
            "ollama run hf.co/org/name:x-q4.gguf",
            "name the model ollama/hf.co/org/name:x-q4.gguf",
        ),
        ("hf/org/name:x-q4.gguf", "llama-server -hf org/name -hff x-q4.gguf", "name the model llamacpp/x-q4"),
        ("hf//models/x.gguf", "llama-server -m /models/x.gguf", "name the model llamacpp/x"),
    ] {
        let ran = generate(&building, "labels", "talks", &["--write", name]);
        let told = ran.refused();
        assert!(told.contains(name) && told.contains(server) && told.contains(model), "{told}");
    }
}
