//! The environment variables of OpenTelemetry that its own crates do not read.

use std::time::Duration;

/// The variable with the address of the collector for all kinds of telemetry.
pub(super) const ENDPOINT_VARIABLE: &str = "OTEL_EXPORTER_OTLP_ENDPOINT";

/// The variable with the address of the collector for spans alone.
const SPANS_ENDPOINT: &str = "OTEL_EXPORTER_OTLP_TRACES_ENDPOINT";

/// How long a request may take, unless a variable gives another time.
const DEFAULT_TIMEOUT: Duration = Duration::from_secs(10);

/// The value of a variable; `None` if it is not set or blank.
pub(super) fn variable_text(name: &str) -> Option<String> {
    std::env::var(name).ok().filter(|value| !value.trim().is_empty())
}

/// The value of a variable of OTLP, the protocol for collectors. `what` is the end of its name, as in `TIMEOUT`. A
/// variable for spans alone (`OTEL_EXPORTER_OTLP_TRACES_TIMEOUT`) wins over the one for all telemetry
/// (`OTEL_EXPORTER_OTLP_TIMEOUT`).
pub(super) fn otlp_variable_text(what: &str) -> Option<String> {
    variable_text(&format!("OTEL_EXPORTER_OTLP_TRACES_{what}"))
        .or_else(|| variable_text(&format!("OTEL_EXPORTER_OTLP_{what}")))
}

/// Whether the environment names a collector and does not switch spans off.
pub(super) fn is_asked() -> bool {
    let is_set_to =
        |name: &str, word: &str| variable_text(name).is_some_and(|value| value.trim().eq_ignore_ascii_case(word));
    let is_off = is_set_to("OTEL_SDK_DISABLED", "true") || is_set_to("OTEL_TRACES_EXPORTER", "none");
    !is_off && (variable_text(ENDPOINT_VARIABLE).is_some() || variable_text(SPANS_ENDPOINT).is_some())
}

/// How long a request may take.
pub(super) fn request_timeout() -> Duration {
    let asked = otlp_variable_text("TIMEOUT").and_then(|text| text.trim().parse().ok());
    asked.map_or(DEFAULT_TIMEOUT, Duration::from_millis)
}
