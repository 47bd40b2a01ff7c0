//! Manifests for Kubernetes.

use super::{HOSTILE, by_part, by_queue, rules, schema, worker};
use serde::Deserialize as _;
use serde_json::{Value, json};
use wayword_queue::launch::{
    LaunchError,
    kubernetes::{KubernetesJob, SecretEnv, SecretFile, SharedFolder, write_manifest},
};

const IMAGE: &str = "registry.example/wayword:0.1.0";

fn secret(name: &str) -> SecretEnv {
    SecretEnv { name: name.to_owned(), secret: "keys".to_owned(), key: "openai".to_owned() }
}

fn small() -> KubernetesJob {
    KubernetesJob::new(by_part(), IMAGE)
}

fn full() -> KubernetesJob {
    let mut worker = by_queue(200);
    worker.program = String::new();
    KubernetesJob {
        name: "big-run".to_owned(),
        namespace: Some("robots".to_owned()),
        cpus: "1500m".to_owned(),
        memory: "16Gi".to_owned(),
        gpus: 1,
        user: 1000,
        shared: Some(SharedFolder { claim: "runs".to_owned(), mount: "/work/runs".to_owned() }),
        secrets: vec![secret("OPENAI_API_KEY")],
        pass_file: Some(SecretFile { secret: "database".to_owned(), key: "pgpass".to_owned() }),
        ..KubernetesJob::new(worker, IMAGE)
    }
}

fn read(text: &str) -> Vec<Value> {
    serde_yaml_ng::Deserializer::from_str(text).map(|document| Value::deserialize(document).unwrap()).collect()
}

fn job(job: &KubernetesJob) -> Value {
    let mut documents = read(&write_manifest(job).unwrap());
    assert_eq!(documents.len(), 1);
    documents.remove(0)
}

/// An argument as the kubelet expands it: `$$` is `$`, and `$(NAME)` a variable.
fn expanded(argument: &str) -> String {
    let mut result = String::new();
    let mut rest = argument;
    while let Some((before, after)) = rest.split_once('$') {
        result.push_str(before);
        rest = match after.strip_prefix("(JOB_COMPLETION_INDEX)") {
            Some(after) => {
                result.push('7');
                after
            }
            None => {
                result.push('$');
                after.strip_prefix('$').unwrap_or(after)
            }
        };
    }
    result + rest
}

fn arguments(job: &Value) -> Vec<String> {
    let arguments = job["spec"]["template"]["spec"]["containers"][0]["args"].as_array().unwrap();
    arguments.iter().map(|argument| expanded(argument.as_str().unwrap())).collect()
}

#[test]
fn a_small_manifest_has_a_part_for_each_worker() {
    insta::assert_snapshot!("kubernetes_small", write_manifest(&small()).unwrap());
}

#[test]
fn a_full_manifest_has_a_queue_secrets_and_a_shared_folder() {
    insta::assert_snapshot!("kubernetes_full", write_manifest(&full()).unwrap());
}

#[test]
fn manifests_fit_the_published_schemas_and_the_rules_of_a_server() {
    let no_arguments = KubernetesJob { worker: worker(&["--queue=db"], 1), ..small() };
    let many = KubernetesJob { worker: by_queue(100_000), name: "a".repeat(57), ..full() };
    for given in [small(), full(), no_arguments, many] {
        let made = job(&given);
        assert_eq!(schema::faults(&made), [""; 0], "{given:?}");
        assert_eq!(rules::broken(&made), [""; 0], "{given:?}");
    }
}

#[test]
fn the_example_of_a_model_server_fits_the_published_schemas() {
    let documents = read(include_str!("../../../../../../trials/scale/vllm.yaml"));
    assert_eq!(documents.iter().map(|document| &document["kind"]).collect::<Vec<_>>(), ["Deployment", "Service"]);
    for document in documents {
        assert_eq!(schema::faults(&document), [""; 0]);
    }
}

#[test]
fn a_manifest_that_is_broken_does_not_fit_the_schemas() {
    for (at, field, value) in [
        ("", "kind", json!("Jobs")),
        ("", "spce", json!({})),
        ("/spec", "completions", json!("40")),
        ("/spec", "completions", json!(3_000_000_000_u32)),
        ("/spec", "completions", json!(1.5)),
        ("/spec", "podReplacmentPolicy", json!("Failed")),
        ("/spec", "template", Value::Null),
        ("/spec/podFailurePolicy/rules/1/onExitCodes", "values", json!(["1"])),
        ("/spec/podFailurePolicy/rules/0/onPodConditions/0", "status", json!(true)),
        ("/spec/template/spec/containers/0", "args", json!("generate")),
        ("/spec/template/spec/containers/0/resources/limits", "cpu", json!([1])),
        ("/spec/template/spec/containers/0/env/0/valueFrom/secretKeyRef", "secret", json!("keys")),
    ] {
        let mut made = job(&full());
        made.pointer_mut(at).unwrap()[field] = value;
        assert_eq!(schema::faults(&made).len(), 1, "{at}/{field}: {:?}", schema::faults(&made));
    }
    for (at, missing) in [("/spec/podFailurePolicy/rules/0", "action"), ("/spec/template/spec/containers/0", "name")] {
        let mut made = job(&full());
        made.pointer_mut(at).unwrap().as_object_mut().unwrap().remove(missing);
        assert!(schema::faults(&made)[0].contains(&format!("{missing} is missing")), "{:?}", schema::faults(&made));
    }
}

#[test]
fn a_manifest_that_a_server_would_refuse_breaks_a_rule() {
    for (at, value) in [
        ("/spec/completionMode", json!("NonIndexed")),
        ("/spec/podReplacementPolicy", json!("TerminatingOrFailed")),
        ("/spec/template/spec/restartPolicy", json!("OnFailure")),
        ("/spec/maxFailedIndexes", json!(201)),
        ("/spec/backoffLimitPerIndex", Value::Null),
        ("/spec/parallelism", json!(3)),
        ("/spec/podFailurePolicy/rules/1/action", json!("Fail")),
        ("/spec/podFailurePolicy/rules/1/onExitCodes/values", json!([2, 1])),
        ("/spec/podFailurePolicy/rules/1/onExitCodes/values", json!([0, 1])),
        ("/spec/podFailurePolicy/rules/1/onExitCodes/containerName", json!("main")),
        ("/spec/template/spec/volumes/0/name", json!("other")),
        ("/spec/template/spec/containers/0/resources/requests/nvidia.com~1gpu", json!(2)),
        ("/metadata/name", json!("a".repeat(60))),
    ] {
        let mut made = job(&full());
        *made.pointer_mut(at).unwrap() = value;
        assert_eq!(rules::broken(&made).len(), 1, "{at}: {:?}", rules::broken(&made));
    }
}

#[test]
fn arguments_reach_the_worker_as_they_were_given() {
    let with_queue = [HOSTILE.as_slice(), &["--queue", "db"]].concat();
    let made = job(&KubernetesJob { worker: worker(&with_queue, 2), ..small() });
    assert_eq!(arguments(&made), with_queue);
}

#[test]
fn a_worker_without_a_queue_gets_the_part_of_its_number() {
    let made = job(&KubernetesJob { worker: worker(&["generate"], 40), ..small() });
    assert_eq!(arguments(&made), ["generate", "--shard", "7/40"]);
}

#[test]
fn an_empty_program_leaves_the_images_own() {
    let container = |given: &KubernetesJob| job(given)["spec"]["template"]["spec"]["containers"][0].clone();
    assert_eq!(container(&small())["command"], json!(["wayword"]));
    assert_eq!(container(&full()).get("command"), None);
}

#[test]
fn every_exit_code_of_a_worker_has_its_rule() {
    let made = job(&small());
    let rules = made["spec"]["podFailurePolicy"]["rules"].as_array().unwrap();
    let action = |code: u32| {
        let rule = rules
            .iter()
            .find(|rule| rule["onExitCodes"]["values"].as_array().is_some_and(|values| values.contains(&json!(code))));
        rule.map_or("", |rule| rule["action"].as_str().unwrap())
    };
    let actions = [1, 2, 3, 4, 5, 6, 7].map(action);
    assert_eq!(actions, ["FailJob", "FailJob", "", "Ignore", "FailJob", "Ignore", "Count"]);
}

#[test]
fn manifest_refuses_values_that_kubernetes_would_refuse() {
    let shared = |mount: &str| Some(SharedFolder { claim: "runs".to_owned(), mount: mount.to_owned() });
    let wrong = [
        KubernetesJob { name: "Big".to_owned(), ..small() },
        KubernetesJob { name: "a".repeat(61), ..small() },
        KubernetesJob { namespace: Some("a.b".to_owned()), ..small() },
        KubernetesJob { image: String::new(), ..small() },
        KubernetesJob { image: "a b".to_owned(), ..small() },
        KubernetesJob { image: "a\nb".to_owned(), ..small() },
        KubernetesJob { cpus: "0".to_owned(), ..small() },
        KubernetesJob { memory: "16GB".to_owned(), ..small() },
        KubernetesJob { user: 0, ..small() },
        KubernetesJob { shared: shared("work"), ..small() },
        KubernetesJob { shared: shared("/work/../run"), ..small() },
        KubernetesJob { shared: shared("/"), ..small() },
        KubernetesJob { shared: shared("/run/wayword"), ..small() },
        KubernetesJob { shared: shared("/a\nb"), ..small() },
        KubernetesJob { secrets: vec![secret("A=geheim")], ..small() },
        KubernetesJob { secrets: vec![secret("A"), secret("A")], ..small() },
        KubernetesJob { secrets: vec![secret("PGPASSFILE")], ..full() },
        KubernetesJob { worker: worker(&["a\nb"], 1), ..small() },
        KubernetesJob { worker: worker(&["--queue", "postgresql://me:geheim@host/db"], 1), ..small() },
        KubernetesJob { worker: worker(&[], 0), ..small() },
    ];
    for given in wrong {
        let error = write_manifest(&given).unwrap_err();
        assert!(!matches!(error, LaunchError::Template(_)), "{given:?}: {error}");
        let error = error.to_string();
        assert!(error.contains("\nhint: ") && !error.contains("geheim"), "{error}");
    }
}
