//! The time that the ledger adds to a call: for a call that is in the ledger, and for a new one, which is written to
//! disk twice.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "criterion's macros make undocumented items, and a bench may panic"
)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use serde_json::json;
use std::{
    sync::atomic::{AtomicUsize, Ordering},
    thread,
};
use wayword_ledger::{CallAnswer, Ledger, LedgerRun, ModelCall, RequestRefusedError, RunLimits};

fn ask(run: &LedgerRun, number: usize) {
    let request = json!({ "messages": [{ "role": "user", "text": format!("{number} {}", "word ".repeat(100)) }] });
    let call = ModelCall { model: "t/m".into(), base_url: "http://127.0.0.1".into(), request, replicate: 0 };
    let answered = run.answer_once(&call, |attempts| -> Result<CallAnswer, RequestRefusedError> {
        attempts.begin_request(Some(0.001))?;
        Ok(CallAnswer {
            text: "It is a lamp.".into(),
            finish: "stop".into(),
            tokens_in: 120,
            tokens_out: 5,
            usd: Some(0.0005),
            latency_ms: 1,
            attempts: 1,
        })
    });
    answered.unwrap();
}

fn calls(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap();
    let run = Ledger::open(&folder.path().join("l.db")).unwrap().start_run("bench", RunLimits::default()).unwrap();
    ask(&run, 0);
    criterion.bench_function("a call that is in the ledger", |bencher| bencher.iter(|| ask(&run, 0)));
    let next = AtomicUsize::new(1);
    let mut group = criterion.benchmark_group("new calls");
    group.throughput(Throughput::Elements(1)).sample_size(20);
    group.bench_function("one at a time", |bencher| {
        bencher.iter(|| ask(&run, next.fetch_add(1, Ordering::Relaxed)));
    });
    group.throughput(Throughput::Elements(320));
    group.bench_function("32 at a time", |bencher| {
        bencher.iter(|| {
            thread::scope(|scope| {
                for _ in 0..32 {
                    scope.spawn(|| (0..10).for_each(|_| ask(&run, next.fetch_add(1, Ordering::Relaxed))));
                }
            });
        });
    });
    group.finish();
}

criterion_group!(benches, calls);
criterion_main!(benches);
