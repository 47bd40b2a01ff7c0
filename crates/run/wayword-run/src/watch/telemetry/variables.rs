//! The environment variables of OpenTelemetry that its own crates do not read.

use std::time::Duration;

/// Names the collector, for all kinds of telemetry.
pub(super) const ENDPOINT_VARIABLE: &str = "OTEL_EXPORTER_OTLP_ENDPOINT";

/// The same for spans alone.
const SPANS_ENDPOINT: &str = "OTEL_EXPORTER_OTLP_TRACES_ENDPOINT";

/// How long a request may take, unless a variable gives another time.
const DEFAULT_TIMEOUT: Duration = Duration::from_secs(10);

/// A variable that is set and not empty.
pub(super) fn variable_text(name: &str) -> Option<String> {
    std::env::var(name).ok().filter(|value| !value.trim().is_empty())
}

/// Of a variable for spans and the one for all, the first that is set.
pub(super) fn of_spans_or_all(what: &str) -> Option<String> {
    variable_text(&format!("OTEL_EXPORTER_OTLP_TRACES_{what}"))
        .or_else(|| variable_text(&format!("OTEL_EXPORTER_OTLP_{what}")))
}

/// Whether the environment names a collector and does not switch spans off.
pub(super) fn is_asked() -> bool {
    let says =
        |name: &str, word: &str| variable_text(name).is_some_and(|value| value.trim().eq_ignore_ascii_case(word));
    let is_off = says("OTEL_SDK_DISABLED", "true") || says("OTEL_TRACES_EXPORTER", "none");
    !is_off && (variable_text(ENDPOINT_VARIABLE).is_some() || variable_text(SPANS_ENDPOINT).is_some())
}

/// How long a request may take.
pub(super) fn request_timeout() -> Duration {
    let asked = of_spans_or_all("TIMEOUT").and_then(|text| text.trim().parse().ok());
    asked.map_or(DEFAULT_TIMEOUT, Duration::from_millis)
}
