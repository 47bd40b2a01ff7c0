//! Whole runs with models, against a provider that plays them.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::models as stage;

use crate::common::run;
use serde_json::Value;
use stage::{KEY, Stage, cast, holds_no_key};
use std::fs;
use wayword_testkit::provider::{
    FaultSchedule, PictureGallery, ProviderBehaviour, ServiceFault,
    scripts::{FlawedEye, ScriptedCast},
};

#[test]
fn models_play_every_role_and_provenance_names_them() {
    let stage = Stage::new(cast());
    let ran = stage.generate("run", &["--paths", "6", "--record", "calls.jsonl", "--perception", "dialogue", "--json"]);
    let summary = ran.json();
    assert_eq!((ran.code, summary["errors"].as_u64()), (Some(0), Some(0)), "{ran:?}");
    // Without labels nobody follows the texts, so their routes are unverified.
    assert_eq!((&summary["passed"], &summary["unverified"]), (&0.into(), &6.into()), "{ran:?}");
    assert!(summary["spent"]["answered"].as_u64().unwrap() > 60);
    for record in stage.building.records("run") {
        let provenance = &record.instruction.provenance;
        assert_eq!((&*provenance.asker, &*provenance.answerer), ("server/words", "server/eye"));
        assert_eq!((&*provenance.summariser, &*provenance.checked_against), ("server/words", "captions"));
        assert!(provenance.prompts_hash.is_some());
        let finished = provenance.finished_for.as_deref();
        assert!(provenance.writer == "server/words" || finished == Some("server/words"), "{provenance:?}");
    }
    let walks = stage.building.lines("run/walks.jsonl");
    let transcript = walks[0]["observations"][0]["looks"][0]["caption"]["transcript"].as_array().unwrap();
    assert!(transcript.len() > 2, "{transcript:?}");

    // The whole run again, with only the recorded answers.
    drop(stage.provider);
    let args =
        ["generate", "--platform", "matterport", "--data", "data", "--paths", "6", "--style", "r2r", "--hops", "3..7"];
    let mut args: Vec<String> = args.iter().map(|arg| (*arg).to_owned()).collect();
    let config: toml::Table = fs::read_to_string(stage.building.path("run/config.toml")).unwrap().parse().unwrap();
    let base = config["roles"]["base_url"].as_str().unwrap();
    let rest = [
        "--perception",
        "dialogue",
        "--evidence",
        "captions",
        "--llm",
        "server/words",
        "--see",
        "server/eye",
        "--base-url",
        base,
        "--out",
        "again",
    ];
    args.extend(rest.iter().chain(&["--replay", "calls.jsonl", "--json"]).map(|arg| (*arg).to_owned()));
    let again =
        run(stage.building.command(&args.iter().map(String::as_str).collect::<Vec<_>>()).env_remove(stage::KEY_ENV));
    assert_eq!(again.code, Some(0), "{again:?}");
    assert_eq!(again.json()["spent"]["requests"], 0);
    for file in ["walks.jsonl", "instructions.jsonl"] {
        let read = |run: &str| fs::read(stage.building.path(run).join(file)).unwrap();
        assert!(read("run") == read("again"), "{file} differs");
    }
}

#[test]
fn ledger_answers_repeated_calls() {
    let stage = Stage::new(cast());
    assert_eq!(stage.generate("first", &["--paths", "6"]).code, Some(0));
    let asked = stage.provider.request_count();
    let second = stage.generate("second", &["--paths", "6"]);
    assert_eq!(second.code, Some(0), "{second:?}");
    assert_eq!(stage.provider.request_count(), asked, "{}", second.out);
    // Neither the ledger's log nor its lock file is left behind.
    let names = fs::read_dir(stage.building.path("")).unwrap().map(|entry| entry.unwrap().file_name());
    let beside: Vec<_> = names.filter(|name| name.to_string_lossy().starts_with("ledger.db")).collect();
    assert_eq!(beside, ["ledger.db"]);
    // More paths through the same building pass places with views that were described before.
    stage.generate("third", &["--paths", "40"]);
    let log = stage.provider.log();
    assert_eq!(log.answered_again(), 0);
    assert!(log.answered < 7 * asked, "{} after {asked}", log.answered);
}

#[test]
fn a_storm_is_weathered_and_every_item_ends() {
    let mut faults =
        FaultSchedule::storm(0.3).with_fault(ServiceFault::Filtered, 0.002).with_fault(ServiceFault::CutOff, 0.02);
    faults.trickle = std::time::Duration::from_secs(2);
    let behaviour = ProviderBehaviour { faults, ..cast() };
    let stage = Stage::new(ProviderBehaviour { key: Some(KEY.into()), ..behaviour });
    let args = ["--paths", "12", "--concurrency", "16", "--timeout-s", "1", "--perception", "dialogue", "--json"];
    let ran = stage.generate("run", &args);
    let summary = ran.json();
    let ended = ["passed", "unverified", "rejected", "errors"].map(|fate| summary[fate].as_u64().unwrap());
    assert_eq!(ended.iter().sum::<u64>(), 12, "{ran:?}");
    assert!(stage.provider.log().faults_committed() > 50);
    for error in stage.building.lines("run/errors.jsonl") {
        assert!(!error["reason"].as_str().unwrap().is_empty());
    }
    holds_no_key(&stage.building.path(""));
    assert!(!ran.out.contains(KEY) && !ran.err.contains(KEY));
    let again = stage.generate("run", &args);
    assert!(again.json()["errors"].as_u64() <= summary["errors"].as_u64(), "{again:?}");
}

#[test]
fn one_bad_frame_is_an_error_row_that_the_next_command_retries() {
    let faults = FaultSchedule::default().with_first_faults(&[Some(ServiceFault::Filtered)]);
    let stage = Stage::new(ProviderBehaviour { faults, ..cast() });
    let args = ["--paths", "4", "--concurrency", "1", "--json"];
    let first = stage.generate("run", &args);
    assert_eq!((first.code, first.json()["errors"].as_u64()), (Some(3), Some(1)), "{first:?}");
    let errors = stage.building.lines("run/errors.jsonl");
    assert!(errors[0]["reason"].as_str().unwrap().contains("filter"), "{errors:?}");
    let page = stage.building.wayword(&["report", "--run", "run"]);
    assert_eq!(page.code, Some(0), "{page:?}");
    assert!(fs::read_to_string(stage.building.path("run/report.html")).unwrap().contains("filter"));
    let second = stage.generate("run", &args);
    assert_eq!((second.code, second.json()["errors"].as_u64()), (Some(0), Some(0)), "{second:?}");
    assert_eq!(second.json()["unverified"], 4);
}

#[test]
fn a_refused_key_and_an_empty_account_stop_the_run_and_lose_nothing() {
    for is_quota in [false, true] {
        let mut faults = FaultSchedule::default();
        let after = if is_quota { &mut faults.quota_after } else { &mut faults.key_refused_after };
        *after = Some(40);
        let stage = Stage::new(ProviderBehaviour { faults, key: Some(KEY.into()), ..cast() });
        let ran = stage.generate("run", &["--paths", "12", "--concurrency", "2", "--json"]);
        assert_eq!(ran.code, Some(5), "{ran:?}");
        let requests = stage.provider.request_count();
        assert!(requests < 50, "{requests}: it goes on asking");
        assert!(ran.json()["stopped"].as_str().unwrap().contains("hint: "), "{ran:?}");
        let again = stage.generate("run", &["--paths", "12", "--concurrency", "2", "--json"]);
        assert_eq!(again.code, Some(5));
        assert_eq!(stage.provider.log().answered_again(), 0, "{again:?}");
        holds_no_key(&stage.building.path(""));
    }
    let stage = Stage::new(ProviderBehaviour { key: Some(KEY.into()), ..cast() });
    let without = run(stage.generating("run", &["--paths", "2"]).env_remove(stage::KEY_ENV));
    assert!(without.refused().contains(stage::KEY_ENV), "it names the variable: {without:?}");
    assert!(!stage.building.path("run").exists(), "it was known before a folder was made");
    assert_eq!(stage.generate("run", &["--paths", "2"]).code, Some(0));
    let again = run(stage.generating("again", &["--paths", "2"]).env_remove(stage::KEY_ENV));
    assert_eq!(again.code, Some(0), "what the ledger has needs no key: {again:?}");
    let more = run(stage.generating("again", &["--paths", "4"]).env_remove(stage::KEY_ENV));
    assert!(more.code != Some(0), "{more:?}");
}

/// A port at which no program listens.
fn closed_port() -> String {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    format!("http://{}/v1", listener.local_addr().unwrap())
}

#[test]
fn model_problems_are_reported_before_the_platform_is_opened() {
    let building = crate::common::Building::new();
    let closed = closed_port();
    let lab = format!("[roles]\nllm = 'lab/words'\n[providers.lab]\ndialect = 'openai'\nbase_url = '{closed}'\n");
    building.write("lab.toml", lab);
    let base = closed.as_str();
    for (args, told) in [
        (&["--llm", "server/words", "--base-url", base][..], &[base, "start server"][..]),
        (&["--llm", "vllm/words", "--base-url", base], &[base, "start vllm"]),
        (&["--config", "lab.toml"], &[base, "start lab", "[providers.lab]"]),
        (&["--llm", "server/words", "--base-url", "http://no-such-host.invalid/v1"], &["no-such-host.invalid"]),
        (&["--llm", "openai/gpt-4.1-mini", "--key-env", "WAYWORD_NO_SUCH_KEY"], &["WAYWORD_NO_SUCH_KEY", "export"]),
        (&["--llm", "server/words", "--base-url", base, "--max-usd", "1"], &["--prices"]),
        (&["--hops", "9-3"], &["--hops 9-3", "4..7"]),
        (&["--hops", "9..3"], &["--hops 9..3", "4..7"]),
        (&["--metres", "20..5"], &["--metres 20..5"]),
        (&["--hops", "0"], &["--hops 0"]),
    ] {
        // The platform's data does not exist either, but the program has not opened it yet.
        for command in ["generate", "perceive"] {
            if command == "perceive" && args[0] != "--llm" {
                continue;
            }
            let mut all = vec![command, "--platform", "matterport", "--data", "nowhere", "--ledger", "ledger.db"];
            all.extend(args);
            if command == "generate" {
                all.extend(["--out", "run"]);
            }
            let ran = building.wayword(&all);
            let error = ran.refused();
            assert!(told.iter().all(|part| error.contains(part)) && !error.contains("nowhere"), "{args:?}: {error}");
            assert!(!building.path("run").exists() && !building.path("ledger.db").exists(), "{args:?}");
        }
    }
}

#[test]
fn a_service_that_is_gone_is_not_needed_for_what_the_ledger_has() {
    let Stage { building, provider } = Stage::new(cast());
    let base = provider.base_url(wayword_testkit::provider::ProviderDialect::OpenAi);
    let models = ["--llm", "server/words", "--see", "server/eye", "--base-url", &base, "--ledger", "ledger.db"];
    let generate = |out: &str, paths: &str| {
        let walks = ["--hops", "3..7", "--style", "r2r", "--evidence", "captions", "--paths", paths];
        building.generate(out, &[&models[..], &walks].concat())
    };
    assert_eq!(generate("run", "3").code, Some(0));
    drop(provider);
    let again = generate("again", "3");
    assert_eq!(again.code, Some(0), "{again:?}");
}

#[cfg(feature = "local")]
#[test]
fn missing_local_model_is_reported_before_the_platform_is_opened() {
    let building = crate::common::Building::new();
    let cache = tempfile::tempdir().unwrap();
    for (model, told) in [("hf/./nowhere-at-all", "nowhere-at-all"), ("hf/Org/name", "config.json")] {
        let args = [
            "generate",
            "--platform",
            "matterport",
            "--data",
            "no-world",
            "--see",
            model,
            "--ledger",
            "l.db",
            "--out",
            "run",
        ];
        let mut command = building.command(&args);
        let ran = run(command.env("WAYWORD_OFFLINE", "1").env("HF_HUB_CACHE", cache.path()));
        let error = ran.refused();
        assert!(error.contains(told) && !error.contains("no-world"), "{error}");
        assert!(!building.path("run").exists());
    }
}

#[test]
fn a_changed_answer_stops_the_run_and_is_dropped_by_name() {
    let stage = Stage::new(cast());
    assert_eq!(stage.generate("run", &["--paths", "2"]).code, Some(0));
    let ledger = stage.building.path("ledger.db");
    // Changes one byte of an answer in the file itself.
    let shown = stage.building.wayword(&["ledger", "show", "--limit", "200", "--ledger", "ledger.db", "--json"]).json();
    let texts = shown["rows"].as_array().unwrap().iter().map(|row| row["answer"]["text"].as_str().unwrap());
    let text = texts.max_by_key(|text| text.len()).unwrap().as_bytes();
    let mut bytes = fs::read(&ledger).unwrap();
    let at = bytes.windows(text.len()).enumerate().filter(|(_, found)| *found == text).map(|(at, _)| at);
    at.collect::<Vec<_>>().into_iter().for_each(|at| bytes[at] = b'X');
    fs::write(&ledger, bytes).unwrap();
    let asked = stage.provider.request_count();
    let stopped = stage.generate("again", &["--paths", "2", "--json"]);
    let reason = stopped.json()["stopped"].as_str().unwrap().to_owned();
    assert_eq!(stopped.code, Some(5), "{stopped:?}");
    assert!(reason.contains("ledger.db") && reason.contains("ledger prune --changed"), "{reason}");
    assert_eq!(stage.provider.request_count(), asked, "nothing was asked anew without a word");
    let dropped = stage.building.wayword(&["ledger", "prune", "--changed", "--ledger", "ledger.db", "--json"]);
    assert!(dropped.json()["rows"].as_u64().unwrap() > 0, "{dropped:?}");
    let whole = stage.generate("again", &["--paths", "2"]);
    assert_eq!(whole.code, Some(0), "{whole:?}");
    assert!(stage.provider.request_count() > asked);
    let read = |run: &str| fs::read(stage.building.path(run).join("instructions.jsonl")).unwrap();
    assert!(read("run") == read("again"), "the answers are what they were");
}

const PRICES: &str = "[\"server/words\"]\nusd_per_million_in = 10.0\nusd_per_million_out = 20.0\nas_of = \"2026-11-01\"\n\
                      [\"server/eye\"]\nusd_per_million_in = 10.0\nusd_per_million_out = 20.0\nas_of = \"2026-11-01\"\n";

#[test]
fn money_and_calls_are_bounded_over_all_commands_of_a_run() {
    let stage = Stage::new(cast());
    stage.building.write("prices.toml", PRICES);
    let bounded = |bound: &[&str]| {
        let mut args = vec!["--paths", "30", "--concurrency", "4", "--prices", "prices.toml", "--json"];
        args.extend(bound);
        stage.generate("run", &args)
    };
    let spent = |ran: &crate::common::Ran| ran.json()["spent"]["usd"].as_f64().unwrap();
    let first = bounded(&["--max-usd", "0.3"]);
    assert_eq!(first.code, Some(5), "{first:?}");
    assert!(spent(&first) <= 0.3 && spent(&first) > 0.2, "{first:?}");
    let second = bounded(&["--max-usd", "0.3"]);
    assert!(second.code == Some(5) && spent(&first) + spent(&second) <= 0.3, "{second:?}");
    let asked = stage.provider.request_count();
    let third = bounded(&["--max-calls", &(asked + 10).to_string()]);
    assert!(third.code == Some(5) && stage.provider.request_count() <= asked + 10, "{third:?}");
    let last = bounded(&[]);
    assert_eq!(last.json()["stopped"], Value::Null, "{last:?}");
    let refused = stage.generate("other", &["--paths", "1", "--max-usd", "1"]);
    assert_eq!(refused.code, Some(1), "a model without a price: {refused:?}");
    assert!(refused.err.contains("--prices"), "{refused:?}");
    assert!(!stage.building.path("other").exists(), "what is refused leaves no folder behind");
    let cost = stage.building.wayword(&["ledger", "cost", "--by", "run", "--ledger", "ledger.db", "--json"]);
    assert!(cost.json()["lines"][0]["usd"].as_f64().unwrap() > 0.3);
}

#[cfg(unix)]
#[test]
fn an_interrupt_finishes_what_is_in_flight_and_the_same_command_goes_on() {
    let latency = std::time::Duration::from_millis(20);
    let stage = Stage::new(ProviderBehaviour { latency, ..cast() });
    let args = ["--paths", "40", "--concurrency", "8", "--json"];
    let child = stage
        .generating("run", &args)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    while stage.provider.request_count() < 60 {
        std::thread::yield_now();
    }
    std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let output = child.wait_with_output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(6), "{told}");
    assert!(told.contains("finishing the items in progress"), "{told}");
    let log = stage.provider.log();
    assert_eq!(log.received, log.answered, "nothing was broken off");
    let whole = stage.generate("run", &args);
    assert_eq!(whole.json()["stopped"], Value::Null, "{whole:?}");
    assert_eq!(stage.provider.log().answered_again(), 0);
    stage.generate("other", &args);
    for file in ["walks.jsonl", "instructions.jsonl", "rejected.jsonl"] {
        let read = |run: &str| fs::read(stage.building.path(run).join(file)).unwrap();
        assert!(read("run") == read("other"), "{file} differs");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_a_run_that_the_ledger_answers() {
    let stage = Stage::new(cast());
    assert_eq!(stage.generate("run", &["--paths", "16"]).code, Some(0));
    let args = ["--paths", "16", "--concurrency", "1", "--json"];
    let asked = stage.provider.request_count();
    let child = stage
        .generating("again", &args)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let walks = stage.building.path("again/walks.jsonl");
    while fs::metadata(&walks).map_or(0, |file| file.len()) == 0 {
        std::thread::yield_now();
    }
    std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(6));
    let whole = stage.generate("again", &args);
    assert_eq!((whole.code, stage.provider.request_count()), (Some(0), asked), "{whole:?}");
    for file in ["walks.jsonl", "instructions.jsonl"] {
        let read = |run: &str| fs::read(stage.building.path(run).join(file)).unwrap();
        assert!(read("run") == read("again"), "{file} differs");
    }
}

#[test]
fn summary_counts_the_texts_that_rules_finished() {
    let careless = ScriptedCast::new(FlawedEye::new(PictureGallery::default(), 1, 0.15), 1, 1.0);
    let stage = Stage::new(ProviderBehaviour::for_model("words", careless.clone()).and_model("eye", careless));
    let ran = stage.generate("run", &["--paths", "4", "--repairs", "0"]);
    let finished = stage.building.records("run").into_iter();
    let finished = finished.filter(|record| record.instruction.provenance.finished_for.is_some()).count();
    assert!(finished > 0 && ran.out.contains(&format!("{finished} instructions written by rules")), "{ran:?}");
}

#[test]
fn refused_model_settings_leave_no_folder_and_no_plan() {
    let stage = Stage::new(cast());
    fs::create_dir(stage.building.path("own")).unwrap();
    stage.building.write("own/questions.j2", "Ask.");
    for (args, told) in [
        (["--replay", "nowhere.jsonl"], "nowhere.jsonl"),
        (["--prompts", "own"], "questions"),
        (["--llm", "nobody/words"], "nobody"),
    ] {
        let base = ["generate", "--llm", "ollama/words", "--paths", "1"];
        let mut run = base.iter().chain(&args).copied().collect::<Vec<_>>();
        if args[0] == "--llm" {
            run.drain(1..3);
        }
        run.extend(["--out", "run"]);
        assert!(stage.building.wayword(&run).refused().contains(told), "{args:?}");
        assert!(!stage.building.path("run").exists(), "{args:?}");
        run.push("--dry-run");
        assert!(stage.building.wayword(&run).refused().contains(told), "{args:?}");
    }
}

#[test]
fn a_plan_takes_what_runs_at_home_for_free() {
    let stage = Stage::new(cast());
    let lab = "[roles]\nllm = 'lab/words'\n[providers.lab]\ndialect = 'ollama'\nbase_url = 'http://127.0.0.1:9'\nlocal = true\n";
    stage.building.write("lab.toml", lab);
    let plan = stage.building.wayword(&["generate", "--config", "lab.toml", "--paths", "1", "--dry-run", "--json"]);
    assert_eq!(plan.json()["models"][0]["usd"], 0.0, "{plan:?}");
}

#[test]
fn a_dry_run_asks_nothing_and_counts_what_a_run_would_ask() {
    let stage = Stage::new(cast());
    stage.building.write("prices.toml", PRICES);
    let args = ["--style", "r2r", "--hops", "3..7", "--paths", "6", "--prices", "prices.toml", "--dry-run", "--json"];
    let plan = run(&mut stage.command("generate", &args)).json();
    assert_eq!(stage.provider.request_count(), 0);
    let models = plan["models"].as_array().unwrap();
    assert!(models.iter().all(|model| model["usd"].as_f64().unwrap() > 0.0), "{plan}");
    let planned: u64 = models.iter().map(|model| model["calls"].as_u64().unwrap()).sum();
    stage.generate("run", &["--paths", "6"]);
    let asked = stage.provider.request_count();
    // Repairs add to the planned calls, and dialogues that end early save some.
    assert!(planned >= asked * 9 / 10 && planned < 3 * asked, "{planned} planned, {asked} asked");
}

#[test]
fn doctor_reports_working_models_and_hints_for_the_others() {
    let stage = Stage::new(ProviderBehaviour { key: Some(KEY.into()), ..cast() });
    let healthy = run(&mut stage.command("doctor", &[]));
    assert!(healthy.out.contains("server/words") && healthy.out.contains("has a picture and labels"), "{healthy:?}");
    let keyless = run(stage.command("doctor", &["--json"]).env_remove(stage::KEY_ENV));
    assert_eq!(keyless.code, Some(1), "{keyless:?}");
    let findings = keyless.json();
    let problem =
        findings["findings"].as_array().unwrap().iter().find(|finding| finding["state"] == "problem").unwrap();
    assert!(problem["hint"].as_str().unwrap().contains(stage::KEY_ENV), "{findings}");
    let base = stage.provider.base_url(wayword_testkit::provider::ProviderDialect::Ollama);
    let settings = format!(
        "[roles]\nllm = \"lab/words\"\n[providers.lab]\ndialect = \"ollama\"\nbase_url = \"{base}\"\nkey_env = \"{}\"\n",
        stage::KEY_ENV
    );
    stage.building.write("lab.toml", settings);
    let args = ["doctor", "--config", "lab.toml", "--ledger", "ledger.db"];
    let own = run(stage.building.command(&args).env(stage::KEY_ENV, KEY));
    assert!(own.out.contains("lab/words answers"), "{own:?}");
    stage.building.write("gone.toml", "platform = 'matterport'\ndata = 'data'\nepisodes = 'gone.json'\n");
    let gone = stage.building.wayword(&["doctor", "--config", "gone.toml"]);
    assert!(gone.code == Some(1) && gone.out.contains("gone.json"), "{gone:?}");
    drop(stage.provider);
    let offline = stage.building.wayword(&["doctor"]);
    assert_eq!(offline.code, Some(0), "{offline:?}");
}

#[test]
fn perception_is_measured_in_each_way_of_asking() {
    let stage = Stage::new(cast());
    let stopped = run(&mut stage.command("perceive", &["--views", "12", "--max-calls", "3"]));
    assert_eq!(stopped.code, Some(5), "{stopped:?}");
    let measured = run(&mut stage.command("perceive", &["--views", "12", "--json"])).json();
    let rows = measured["rows"].as_array().unwrap();
    let ways: Vec<&str> = rows.iter().map(|row| row["perception"].as_str().unwrap()).collect();
    assert_eq!(ways, ["fixed", "single", "structured", "follow_up", "dialogue"]);
    let calls: Vec<f64> = rows.iter().map(|row| row["calls_per_view"].as_f64().unwrap()).collect();
    assert!(calls[0] == 2.0 && calls[1] == 1.0 && calls[4] > 4.0, "{calls:?}");
    assert!(calls[2] <= 1.3 && calls[3] >= calls[2], "{calls:?}");
    let said = run(&mut stage.command("perceive", &["--views", "12"])).out;
    assert!(said.contains(" pays: F1 of objects"), "{said}");
    let labels =
        stage.building.wayword(&["perceive", "--platform", "matterport", "--data", "data", "--views", "12", "--json"]);
    let rows = labels.json();
    assert_eq!(rows["rows"][4]["hallucination_rate"], 0.0, "ground-truth labels hallucinate nothing: {rows}");
    let episodes = format!("episodes = '{}'\n", crate::common::EPISODES);
    stage.building.write("run.toml", format!("platform = 'matterport'\ndata = 'data'\n{episodes}"));
    let shown = |args: &[&str]| stage.building.wayword(&[&["perceive", "--show", "4", "--views", "4"], args].concat());
    let by_flags = shown(&["--platform", "matterport", "--data", "data", "--episodes", crate::common::EPISODES]);
    assert_eq!(shown(&["--config", "run.toml"]).out, by_flags.out, "the file's episodes are looked along");
}

/// One call a view, two an instruction at most, and a view is talked about once for every run.
#[test]
fn by_default_a_view_costs_one_call() {
    let stage = Stage::new(cast());
    let run = |name: &str, more: &[&str]| {
        let ran = stage.generate(name, &[&["--paths", "6", "--json"], more].concat());
        assert!(ran.code == Some(0), "{ran:?}");
        ran.json()
    };
    let summary = run("run", &[]);
    let provenance = &stage.building.records("run")[0].instruction.provenance;
    assert_eq!(provenance.asker, "one structured request");
    let walks = stage.building.lines("run/walks.jsonl");
    let observations = || walks.iter().flat_map(|walk| walk["observations"].as_array().unwrap());
    let views = observations().map(|seen| seen["looks"].as_array().unwrap().len()).sum::<usize>();
    let calls = summary["spent"]["answered"].as_u64().unwrap() as f64;
    assert!(calls <= 1.3 * views as f64 + 2.0 * 6.0, "{calls} calls for {views} views");
    assert!(observations().any(|seen| seen["looks"][0]["caption"]["is_structured"] == true));
    let again = run("again", &["--repairs", "1"]);
    let new = again["spent"]["answered"].as_u64().unwrap();
    assert!(new <= 4 * 6, "{new} calls, though every view was talked about before");
}

#[test]
fn the_ledger_can_be_shown_exported_and_pruned() {
    let stage = Stage::new(cast());
    let missing = stage.building.wayword(&["ledger", "show", "--ledger", "ledger.db"]);
    assert!(missing.refused().contains("there is no ledger yet"));
    stage.generate("run", &["--paths", "2"]);
    let ledger = |args: &[&str]| {
        let mut all = vec!["ledger", "--ledger", "ledger.db", "--json"];
        all.extend(args);
        stage.building.wayword(&all)
    };
    let shown = ledger(&["show", "--model", "server/eye", "--limit", "3"]);
    assert_eq!(shown.json()["rows"].as_array().unwrap().len(), 3, "{shown:?}");
    let exported = ledger(&["export", "--out", "all.jsonl"]).json()["rows"].as_u64().unwrap();
    assert_eq!(stage.building.lines("all.jsonl").len() as u64, exported);
    assert_eq!(exported, stage.provider.request_count());
    assert_eq!(ledger(&["prune"]).code, Some(1), "it does not empty the ledger by mistake");
    let old = ledger(&["prune", "--older-than-days", "213503982334602"]);
    assert_eq!(old.json()["rows"], 0, "nothing is as old as that: {old:?}");
    let pruned = ledger(&["prune", "--model", "server/eye"]).json()["rows"].as_u64().unwrap();
    assert!(pruned > 0 && pruned < exported);
}
