//! `wayword generate --spans FOLDER`: the spans of a run, as lines of JSON.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::models as stage;

use crate::common::{Building, EPISODES, run};
use serde_json::Value;
use stage::{KEY, KEY_ENV, Stage, cast, holds_no_key};
use std::{collections::BTreeSet, fs, path::Path};
use wayword_testkit::provider::{FaultSchedule, ProviderBehaviour, ProviderDialect, ServiceFault};

/// The spans of a folder, as the lines of its files. Each has an id of its own, and its parent is among them.
fn spans(folder: &Path) -> Vec<Value> {
    let files = fs::read_dir(folder).unwrap().map(|entry| fs::read_to_string(entry.unwrap().path()).unwrap());
    let lines: Vec<Value> = files
        .flat_map(|text| text.lines().map(|line| serde_json::from_str(line).unwrap()).collect::<Vec<Value>>())
        .collect();
    let ids: BTreeSet<&str> = lines.iter().map(|line| line["id"].as_str().unwrap()).collect();
    assert_eq!(ids.len(), lines.len(), "ids are used once");
    for line in &lines {
        let is_top = line["name"] == "worker";
        assert_eq!(line["parent"].as_str().is_none_or(|parent| !ids.contains(parent)), is_top, "{line}");
        assert!(line["start_unix_s"].as_f64().unwrap() > 1.7e9 && line["duration_s"].as_f64().unwrap() >= 0.0);
    }
    lines
}

fn named<'a>(spans: &'a [Value], name: &str) -> Vec<&'a Value> {
    spans.iter().filter(|span| span["name"] == name).collect()
}

/// The spans with this value of a field.
fn with<'a>(spans: &[&'a Value], field: &str, value: impl Into<Value>) -> Vec<&'a Value> {
    let value = value.into();
    spans.iter().filter(|span| span["fields"][field] == value).copied().collect()
}

/// Names of the parents of spans.
fn parents<'a>(all: &'a [Value], of: &[&Value]) -> BTreeSet<&'a str> {
    let parents = all.iter().filter(|span| of.iter().any(|child| child["parent"] == span["id"]));
    parents.map(|span| span["name"].as_str().unwrap()).collect()
}

#[test]
fn a_run_of_one_machine_leaves_a_line_for_each_item_and_call_and_no_words() {
    let stage = Stage::new(cast());
    let args = ["--paths", "6", "--concurrency", "8", "--perception", "dialogue", "--spans", "spans"];
    let ran = stage.generate("run", &args);
    assert!(matches!(ran.code, Some(0 | 3)), "{ran:?}");
    let all = spans(&stage.building.path("spans"));
    let items = named(&all, "item");
    let id = fs::read_to_string(stage.building.path("run/run.id")).unwrap();
    assert_eq!(named(&all, "worker")[0]["fields"]["run"], id.trim());
    assert_eq!(items.len(), 6);
    let written = stage.building.lines("run/instructions.jsonl").len() as u64;
    assert_eq!(items.iter().map(|item| item["fields"]["written"].as_u64().unwrap()).sum::<u64>(), written);
    assert_eq!(with(&items, "outcome", "written").len() as u64, written);

    let calls = named(&all, "call");
    assert_eq!((parents(&all, &items), parents(&all, &calls)), (["worker"].into(), ["item"].into()));
    assert_eq!(with(&calls, "from_ledger", false).len() as u64, stage.provider.log().answered);
    for purpose in ["ask", "see", "summarise", "write"] {
        assert!(!with(&calls, "purpose", purpose).is_empty(), "{purpose}");
    }
    assert_eq!(with(&calls, "purpose", "see").len(), with(&calls, "model", "server/eye").len());
    assert!(calls.iter().all(|call| call["fields"]["purpose"].is_string()));
    holds_no_words(&stage, &calls);

    // The same run elsewhere is answered by the ledger.
    assert!(matches!(stage.generate("again", &[&args[..7], &["again-spans"]].concat()).code, Some(0 | 3)));
    let again = spans(&stage.building.path("again-spans"));
    let again = named(&again, "call");
    assert_eq!((with(&again, "from_ledger", true).len(), again.len()), (again.len(), calls.len()));
    assert!(again.iter().all(|call| call["fields"]["tokens_in"].is_null()), "nothing is counted twice");
}

/// Spans contain no key, and of calls only these fields.
fn holds_no_words(stage: &Stage, calls: &[&Value]) {
    holds_no_key(&stage.building.path("spans"));
    let known = ["model", "purpose", "from_ledger", "attempts", "tokens_in", "tokens_out", "usd", "error"];
    for call in calls {
        let fields = call["fields"].as_object().unwrap();
        assert!(fields.keys().all(|name| known.contains(&name.as_str())), "{call}");
        assert!(fields.values().filter_map(Value::as_str).all(|text| !text.contains(' ')), "{call}");
    }
}

#[test]
fn a_shard_leaves_a_file_with_its_name_and_its_chunks() {
    let stage = Stage::new(cast());
    let base = stage.provider.base_url(ProviderDialect::OpenAi);
    let models = ["--llm", "server/words", "--see", "server/eye", "--base-url", &base, "--key-env", KEY_ENV];
    let rest = ["--paths", "5", "--chunk", "2", "--style", "r2r", "--hops", "3..7", "--evidence", "captions"];
    for part in ["0/2", "1/2"] {
        let mut args = vec!["generate", "--platform", "matterport", "--data", "data", "--out", "big"];
        args.extend(models.into_iter().chain(rest).chain(["--spans", "spans", "--shard", part]));
        let ran = run(stage.building.command(&args).env(KEY_ENV, KEY));
        assert_eq!(ran.code, Some(0), "{ran:?}");
    }
    let all = spans(&stage.building.path("spans"));
    let (chunks, items, calls) = (named(&all, "chunk"), named(&all, "item"), named(&all, "call"));
    let numbers: BTreeSet<u64> = chunks.iter().map(|chunk| chunk["fields"]["chunk"].as_u64().unwrap()).collect();
    assert_eq!((numbers, with(&chunks, "outcome", "done").len()), ([0, 1, 2].into(), 3));
    assert_eq!((items.len(), parents(&all, &items)), (5, ["chunk"].into()));
    assert_eq!((parents(&all, &chunks), parents(&all, &calls)), (["worker"].into(), ["item"].into()));
    assert_eq!(with(&calls, "from_ledger", false).len() as u64, stage.provider.log().answered);
    holds_no_words(&stage, &calls);
    // The files are named as the marks of the chunks name their workers.
    for chunk in ["000000", "000001", "000002"] {
        let mark = &stage.building.lines(&format!("big/chunks/{chunk}.done"))[0];
        let worker = mark["worker"].as_str().unwrap();
        assert!(stage.building.path(&format!("spans/{worker}.jsonl")).is_file());
        assert_eq!(with(&named(&all, "worker"), "worker", worker).len(), 1);
    }
}

/// Some answers are filtered, and some requests fail at first.
fn faults() -> FaultSchedule {
    FaultSchedule::default().with_fault(ServiceFault::Filtered, 0.04).with_fault(ServiceFault::EchoesKey, 0.2)
}

#[test]
fn spans_of_failed_items_name_the_kind_of_failure() {
    let stage = Stage::new(ProviderBehaviour { faults: faults(), ..cast() });
    let ran = stage.generate("run", &["--paths", "12", "--concurrency", "8", "--spans", "spans"]);
    assert!(matches!(ran.code, Some(0 | 3 | 7)), "{ran:?}");
    let all = spans(&stage.building.path("spans"));
    let (items, calls) = (named(&all, "item"), named(&all, "call"));
    let failed = with(&items, "outcome", "failed");
    assert_eq!(failed.len(), stage.building.lines("run/errors.jsonl").len());
    assert!(!failed.is_empty() && !with(&failed, "reason", "model broken").is_empty(), "{failed:?}");
    let filtered = with(&calls, "error", "failed");
    assert!(!filtered.is_empty() && filtered.iter().all(|call| call["fields"]["attempts"].as_u64() >= Some(1)));
    assert!(calls.iter().any(|call| call["fields"]["attempts"].as_u64() > Some(1)), "a fault is tried again");
    holds_no_words(&stage, &calls);
}

#[test]
fn a_run_without_models_has_items_alone_and_a_folder_that_cannot_be_made_is_refused() {
    let building = Building::new();
    let args = ["--episodes", EPISODES, "--style", "r2r"];
    let ran = building.generate("run", &[&args[..], &["--spans", "deep/spans"]].concat());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let all = spans(&building.path("deep/spans"));
    assert_eq!(named(&all, "item").len(), building.lines("run/walks.jsonl").len());
    assert_eq!(named(&all, "item").len() + 1, all.len());
    let refused = building.generate("other", &[&args[..], &["--spans", "run/walks.jsonl"]].concat());
    assert!(refused.refused().contains("run/walks.jsonl: cannot make the folder"), "{refused:?}");
    assert!(!building.path("other").exists());
}

#[cfg(not(feature = "telemetry"))]
#[test]
fn a_build_without_telemetry_does_not_look_for_a_collector() {
    let building = Building::new();
    let args = ["generate", "--paths", "1", "--style", "r2r", "--out", "run"];
    let address = format!("http://{}", crate::common::free_port());
    let ran = run(building.command(&args).env("OTEL_EXPORTER_OTLP_ENDPOINT", address));
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(!ran.err.contains("collector"), "{ran:?}");
}

#[cfg(feature = "telemetry")]
mod to_a_collector {
    use super::*;
    use crate::common::collector::Collector;
    use std::{
        net::{Ipv4Addr, TcpListener},
        process::Command,
        time::{Duration, Instant},
    };

    const ENDPOINT: &str = "OTEL_EXPORTER_OTLP_ENDPOINT";

    /// A run without models that sends its spans.
    fn sending(building: &Building, endpoint: &str) -> Command {
        let args = ["--platform", "matterport", "--data", "data", "--episodes", EPISODES, "--style", "r2r"];
        let mut command = building.command(&[&["generate", "--out", "run"], &args[..]].concat());
        command.env(ENDPOINT, endpoint);
        command
    }

    #[test]
    fn the_same_spans_arrive_with_their_parents_and_who_sent_them() {
        let (stage, collector) = (Stage::new(cast()), Collector::start());
        let mut command = stage.generating("run", &["--paths", "6", "--spans", "spans"]);
        command.env(ENDPOINT, collector.endpoint()).env("OTEL_EXPORTER_OTLP_HEADERS", "x-key=secret-of-collector");
        let ran = run(&mut command);
        assert!(matches!(ran.code, Some(0 | 3)) && !ran.err.contains("warning: spans"), "{ran:?}");
        let (lines, sent) = (spans(&stage.building.path("spans")), collector.spans());
        for name in ["worker", "item", "call"] {
            let of_name: Vec<_> = sent.iter().filter(|span| span.name == name).collect();
            assert_eq!(of_name.len(), named(&lines, name).len(), "{name}");
            let is_child = |id: &[u8]| sent.iter().any(|parent| parent.span_id == id);
            assert!(of_name.iter().all(|span| is_child(&span.parent_span_id) == (name != "worker")));
        }
        assert_eq!(sent.len(), lines.len());
        let call = sent.iter().find(|span| span.name == "call").unwrap();
        let keys: BTreeSet<&str> = call.attributes.iter().map(|attribute| attribute.key.as_str()).collect();
        assert!(keys.is_superset(&["model", "purpose", "from_ledger", "tokens_in", "attempts"].into()), "{keys:?}");
        let worker = named(&lines, "worker")[0]["fields"]["worker"].as_str().unwrap();
        assert_eq!(collector.resource("service.name"), ["wayword".to_owned()].into());
        assert_eq!(collector.resource("service.instance.id"), [worker.to_owned()].into());
        assert_eq!(collector.resource("service.version"), [env!("CARGO_PKG_VERSION").to_owned()].into());
        let heads = collector.heads();
        let has = |head: &String| head.starts_with("POST /v1/traces ") && head.contains("secret-of-collector");
        assert!(!heads.is_empty() && heads.iter().all(has), "{heads:?}");
        assert!(!collector.holds(KEY) && !format!("{ran:?}").contains("secret-of-collector"));
    }

    #[test]
    fn a_failed_item_is_marked_as_an_error() {
        let (stage, collector) = (Stage::new(ProviderBehaviour { faults: faults(), ..cast() }), Collector::start());
        let mut command = stage.generating("run", &["--paths", "12"]);
        run(command.env(ENDPOINT, collector.endpoint()));
        let is_error = |name: &str| {
            let mut of_name = collector.spans().into_iter().filter(|span| span.name == name);
            of_name.any(|span| span.status.is_some_and(|status| status.code == 2))
        };
        assert!(is_error("item") && is_error("call"));
    }

    #[test]
    fn absent_collector_gives_one_warning_and_no_delay() {
        let building = Building::new();
        let since = Instant::now();
        let ran = run(&mut sending(&building, &format!("http://user:word@{}", crate::common::free_port())));
        assert_eq!(ran.code, Some(0), "{ran:?}");
        assert_eq!(ran.err.matches("spans cannot be sent").count(), 1, "{ran:?}");
        assert!(ran.err.contains("refused") && !ran.err.contains("word@"), "{ran:?}");
        assert!(since.elapsed() < Duration::from_secs(20), "{:?}", since.elapsed());
    }

    #[test]
    fn a_collector_that_never_answers_is_waited_for_a_few_seconds() {
        let building = Building::new();
        let silent = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let since = Instant::now();
        let ran = run(&mut sending(&building, &format!("http://{}", silent.local_addr().unwrap())));
        assert_eq!(ran.code, Some(0), "{ran:?}");
        assert_eq!(ran.err.matches("spans cannot be sent").count(), 1, "{ran:?}");
        assert!(since.elapsed() < Duration::from_secs(30), "{:?}", since.elapsed());
    }

    #[test]
    fn wrong_telemetry_variables_give_a_warning_and_the_run_goes_on() {
        let building = Building::new();
        let ran = run(sending(&building, "https://[::1]:1").env("OTEL_EXPORTER_OTLP_CERTIFICATE", "none.pem"));
        assert_eq!(ran.code, Some(0), "{ran:?}");
        assert!(ran.err.contains("none.pem"), "{ran:?}");
        let ran = run(&mut sending(&building, "no address"));
        assert!(ran.code == Some(0) && ran.err.contains("is no address"), "{ran:?}");
        let ran = run(sending(&building, "no address").env("OTEL_SDK_DISABLED", "true"));
        assert!(ran.code == Some(0) && !ran.err.contains("collector"), "{ran:?}");
    }
}
