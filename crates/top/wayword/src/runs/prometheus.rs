//! The status of a run in Prometheus' text format.
//! See <https://prometheus.io/docs/instrumenting/exposition_formats/>.

use super::status::RunStatus;
use std::fmt::Write;

/// A metric: name, type, help, and its values with their labels.
type PrometheusMetric<'a> = (&'a str, &'a str, &'a str, Vec<(Vec<(&'a str, String)>, f64)>);

/// Writes the status as metrics, each with the run as a label.
pub(super) fn prometheus_text(status: &RunStatus) -> String {
    let plain = |value: f64| vec![(Vec::new(), value)];
    let states =
        [("done", status.done), ("running", status.running), ("open", status.open), ("dead", status.dead.len())];
    let texts = [("written", status.written), ("rejected", status.rejected)];
    let labelled = |label: &'static str, name: &str, value: usize| (vec![(label, name.to_owned())], value as f64);
    let metrics: [PrometheusMetric<'_>; 10] = [
        ("wayword_items", "gauge", "Items of the run.", plain(status.items as f64)),
        ("wayword_items_done", "gauge", "Items of finished chunks.", plain(status.items_done as f64)),
        ("wayword_chunks", "gauge", "Chunks by state.", states.map(|(state, n)| labelled("state", state, n)).into()),
        (
            "wayword_texts",
            "gauge",
            "Texts of finished chunks.",
            texts.map(|(fate, n)| labelled("fate", fate, n)).into(),
        ),
        (
            "wayword_items_failed",
            "gauge",
            "Items that failed, by reason.",
            status.failed.iter().map(|(reason, n)| labelled("reason", reason, *n)).collect(),
        ),
        (
            "wayword_chunk_retries",
            "gauge",
            "How often chunks were begun again, by reason.",
            status.retries.iter().map(|(reason, n)| (vec![("reason", reason.clone())], *n as f64)).collect(),
        ),
        (
            "wayword_chunk_files_damaged",
            "gauge",
            "Files of finished chunks whose length does not fit their marks.",
            plain(status.damaged.len() as f64),
        ),
        ("wayword_cost_usd", "gauge", "What the calls of finished chunks cost, US dollars.", plain(status.usd)),
        ("wayword_items_per_minute", "gauge", "Items a minute over ten minutes.", plain(status.items_per_minute)),
        (
            "wayword_worker_beat_seconds",
            "gauge",
            "Seconds since the last sign of life of a worker.",
            status.workers.iter().map(|worker| (vec![("worker", worker.worker.clone())], worker.beat_s)).collect(),
        ),
    ];
    let mut text = String::new();
    for (name, kind, help, values) in metrics {
        let _ = writeln!(text, "# HELP {name} {help}\n# TYPE {name} {kind}");
        for (labels, value) in values {
            let run = std::iter::once(("run", status.run.clone()));
            let labels: Vec<String> =
                run.chain(labels).map(|(label, name)| format!("{label}=\"{}\"", escape_label(&name))).collect();
            let _ = writeln!(text, "{name}{{{}}} {value}", labels.join(","));
        }
    }
    text
}

/// Escapes the three characters that have a meaning in a label's value.
fn escape_label(value: &str) -> String {
    value.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_writes_valid_lines_for_any_reason() {
        let mut status = RunStatus { run: "a\"b".into(), items: 3, ..RunStatus::default() };
        status.failed.insert("timed \"out\"\nhint: \\wait".into(), 2);
        let text = prometheus_text(&status);
        assert!(text.contains("wayword_items{run=\"a\\\"b\"} 3\n"), "{text}");
        assert!(text.contains("reason=\"timed \\\"out\\\"\\nhint: \\\\wait\"} 2\n"), "{text}");
        for line in text.lines().filter(|line| !line.starts_with('#')) {
            let (head, value) = line.rsplit_once(' ').unwrap();
            assert!(head.ends_with('}') && value.parse::<f64>().is_ok(), "{line}");
        }
    }
}
