//! A layer of `tracing` that writes a line of JSON for each span when it ends.

mod file;

use crate::{error::CommandError, output::CommandOutput};
use file::LineFile;
use serde::Serialize;
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};
use std::{
    fmt,
    path::Path,
    sync::atomic::{AtomicU64, Ordering},
    time::{Instant, SystemTime, UNIX_EPOCH},
};
use tracing::{
    Subscriber,
    field::{Field, Visit},
    span::{Attributes, Id, Record},
};
use tracing_subscriber::{Layer, layer::Context, registry::LookupSpan};

/// Writes spans as lines of JSON.
pub(super) struct SpanLines {
    file: LineFile,
    /// The id of the first span. Later spans count up from it.
    first: u64,
    /// Number of spans that have begun.
    spans: AtomicU64,
}

/// A line. Times are by this machine's clock.
#[derive(Serialize)]
struct SpanLine<'a> {
    name: &'static str,
    id: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    parent: Option<String>,
    start_unix_s: f64,
    duration_s: f64,
    fields: &'a Map<String, Value>,
}

/// A span that has not ended, as `tracing` keeps it for this layer.
struct OpenSpan {
    id: u64,
    parent: Option<u64>,
    start_unix_s: f64,
    since: Instant,
    fields: SpanFields,
}

impl SpanLines {
    /// Begins this worker's file in the folder. `None` if the disk is full, after a warning.
    ///
    /// # Errors
    /// When the file cannot be made for another reason.
    pub(super) fn begin(folder: &Path, worker: &str, output: &CommandOutput) -> Result<Option<Self>, CommandError> {
        let file = LineFile::begin(&folder.join(format!("{worker}.jsonl")), output)?;
        Ok(file.map(|file| Self { file, first: first_id(worker), spans: AtomicU64::new(0) }))
    }

    fn next_id(&self) -> u64 {
        self.first.wrapping_add(self.spans.fetch_add(1, Ordering::Relaxed))
    }
}

/// The first id of a worker's spans, from a hash of its name: far from those of other workers, so that the files of many workers
/// can be joined.
fn first_id(worker: &str) -> u64 {
    Sha256::digest(worker).iter().take(8).fold(0, |id, byte| id << 8 | u64::from(*byte))
}

fn hex_id(id: u64) -> String {
    format!("{id:016x}")
}

impl<S: Subscriber + for<'a> LookupSpan<'a>> Layer<S> for SpanLines {
    fn on_new_span(&self, attributes: &Attributes<'_>, id: &Id, context: Context<'_, S>) {
        let Some(span) = context.span(id) else { return };
        let parent = span.parent().and_then(|parent| parent.extensions().get::<OpenSpan>().map(|open| open.id));
        let start_unix_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64());
        let mut fields = SpanFields::default();
        attributes.record(&mut fields);
        let open = OpenSpan { id: self.next_id(), parent, start_unix_s, since: Instant::now(), fields };
        span.extensions_mut().insert(open);
    }

    fn on_record(&self, id: &Id, values: &Record<'_>, context: Context<'_, S>) {
        let Some(span) = context.span(id) else { return };
        if let Some(open) = span.extensions_mut().get_mut::<OpenSpan>() {
            values.record(&mut open.fields);
        }
    }

    fn on_close(&self, id: Id, context: Context<'_, S>) {
        let Some(span) = context.span(&id) else { return };
        let Some(open) = span.extensions_mut().remove::<OpenSpan>() else { return };
        let OpenSpan { id, parent, start_unix_s, since, fields } = open;
        let line = SpanLine {
            name: span.name(),
            id: hex_id(id),
            parent: parent.map(hex_id),
            start_unix_s,
            duration_s: since.elapsed().as_secs_f64(),
            fields: &fields.0,
        };
        self.file.append(&line);
    }
}

/// The fields of a span, in the order in which they became known.
#[derive(Default)]
struct SpanFields(Map<String, Value>);

impl SpanFields {
    fn put_field(&mut self, field: &Field, value: impl Into<Value>) {
        // Fields for OpenTelemetry repeat other fields.
        if !field.name().starts_with("otel.") {
            self.0.insert(field.name().to_owned(), value.into());
        }
    }
}

impl Visit for SpanFields {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        self.put_field(field, format!("{value:?}"));
    }

    fn record_str(&mut self, field: &Field, value: &str) {
        self.put_field(field, value);
    }

    fn record_bool(&mut self, field: &Field, value: bool) {
        self.put_field(field, value);
    }

    fn record_i64(&mut self, field: &Field, value: i64) {
        self.put_field(field, value);
    }

    fn record_u64(&mut self, field: &Field, value: u64) {
        self.put_field(field, value);
    }

    fn record_f64(&mut self, field: &Field, value: f64) {
        self.put_field(field, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_of_workers_are_far_apart() {
        let [a, b] = ["node-1-a", "node-1-b"].map(first_id);
        assert!(a.abs_diff(b) > 1 << 32, "{a:x} {b:x}");
        assert_eq!(hex_id(10), "000000000000000a");
    }
}
