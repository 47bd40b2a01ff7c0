//! Rules of a server for an Indexed Job that the schemas only describe in words. They were read there and in Kubernetes' documentation;
//! no server was asked.

use serde_json::Value;

/// Which texts a field of a job takes. Every value there must be one of them.
const ONE_OF: [(&str, &[&str]); 7] = [
    ("/spec/completionMode", &["Indexed"]),
    // With a policy of failures, no other value is allowed.
    ("/spec/podReplacementPolicy", &["Failed"]),
    ("/spec/template/spec/restartPolicy", &["Never"]),
    ("/spec/template/spec/securityContext/fsGroupChangePolicy", &["OnRootMismatch", "Always"]),
    ("/spec/template/spec/securityContext/seccompProfile/type", &["RuntimeDefault"]),
    ("/spec/podFailurePolicy/rules/0/action", &["Ignore"]),
    ("/spec/podFailurePolicy/rules/0/onPodConditions/0/type", &["DisruptionTarget"]),
];

/// Which rules a job breaks.
pub(crate) fn broken(job: &Value) -> Vec<String> {
    let mut broken = Vec::new();
    for (at, allowed) in ONE_OF {
        if !job.pointer(at).and_then(Value::as_str).is_some_and(|text| allowed.contains(&text)) {
            broken.push(format!("{at} is none of {allowed:?}"));
        }
    }
    counts(job, &mut broken);
    for rule in list(&job["spec"]["podFailurePolicy"]["rules"]) {
        failure_rule(job, rule, &mut broken);
    }
    names(job, &mut broken);
    volumes(&job["spec"]["template"]["spec"], &mut broken);
    broken
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn texts<'a>(values: &'a [Value], name: &str) -> Vec<&'a str> {
    values.iter().filter_map(|value| value[name].as_str()).collect()
}

fn counts(job: &Value, broken: &mut Vec<String>) {
    let spec = &job["spec"];
    if spec["completions"] != spec["parallelism"] || spec["completions"].as_u64().is_none_or(|count| count == 0) {
        broken.push("not all indexes run at the same time".to_owned());
    }
    if spec["backoffLimitPerIndex"].is_null() {
        broken.push("maxFailedIndexes needs backoffLimitPerIndex".to_owned());
    }
    if spec["maxFailedIndexes"].as_u64() > spec["completions"].as_u64() {
        broken.push("maxFailedIndexes is larger than completions".to_owned());
    }
}

fn failure_rule(job: &Value, rule: &Value, broken: &mut Vec<String>) {
    if !matches!(rule["action"].as_str(), Some("FailJob" | "FailIndex" | "Ignore" | "Count")) {
        broken.push(format!("{} is no action", rule["action"]));
    }
    if rule["onExitCodes"].is_null() == rule["onPodConditions"].is_null() {
        broken.push("a rule has exit codes or conditions, not both".to_owned());
    }
    let Some(codes) = rule["onExitCodes"].as_object() else { return };
    let values: Vec<i64> = list(&codes["values"]).iter().filter_map(Value::as_i64).collect();
    if values.is_empty() || values.contains(&0) || !values.is_sorted_by(|one, next| one < next) {
        broken.push(format!("{values:?} is empty, has 0, or is not in order"));
    }
    let containers = texts(list(&job["spec"]["template"]["spec"]["containers"]), "name");
    if codes["operator"] != "In" || !containers.contains(&codes["containerName"].as_str().unwrap_or_default()) {
        broken.push("exit codes are of a container that is not there".to_owned());
    }
}

/// The host of a pod is named after the job and the index; the name is a label of DNS.
fn names(job: &Value, broken: &mut Vec<String>) {
    let name = job["metadata"]["name"].as_str().unwrap_or_default();
    let last = job["spec"]["completions"].as_u64().unwrap_or_default().saturating_sub(1);
    if name.is_empty() || format!("{name}-{last}").len() > 63 {
        broken.push("the name leaves no room for the index".to_owned());
    }
}

fn volumes(pod: &Value, broken: &mut Vec<String>) {
    let volumes = texts(list(&pod["volumes"]), "name");
    let mounts = list(&pod["containers"][0]["volumeMounts"]);
    if volumes != texts(mounts, "name") {
        broken.push(format!("volumes {volumes:?} are not those that are mounted"));
    }
    let variables = texts(list(&pod["containers"][0]["env"]), "name");
    if variables.iter().collect::<std::collections::BTreeSet<_>>().len() != variables.len() {
        broken.push("a variable is set twice".to_owned());
    }
    let resources = &pod["containers"][0]["resources"];
    if resources["requests"]["nvidia.com/gpu"] != resources["limits"]["nvidia.com/gpu"] {
        broken.push("GPUs asked for and allowed must be the same".to_owned());
    }
}
